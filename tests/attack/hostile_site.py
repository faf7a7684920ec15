# SPDX-License-Identifier: Apache-2.0
"""A web site with a hostile page. A relay also passes on what the site does not have itself to a box:
`rebinding`, unchanged, as to a name that points at the box; `naive`, as the box's own client would ask
and with leave for every page to read the answer, which is a box without any defence."""
import base64
import hashlib
import http.client
import os
import queue
import threading
import urllib.parse
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "hostile_page.html")
PATIENCE_S = 60
OF_A_CONNECTION = {"connection", "transfer-encoding", "content-length", "keep-alive"}
WEBSOCKET_KEY = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"

# Leaves for another site; its own load waits, so that what is loaded is the other one.
LEAVE = """<!DOCTYPE html><img src="/held"><form method="{method}" action="{to}" enctype="text/plain">
<input name='{{"subject": "' value='x"}}'></form><script>document.forms[0].submit()</script>"""


class Handler(BaseHTTPRequestHandler):
    def log_message(self, *_):
        pass

    def do_GET(self):
        self.serve()

    def do_POST(self):
        self.serve()

    def do_OPTIONS(self):
        self.serve()

    def serve(self):
        site = self.server.site
        length = int(self.headers.get("Content-Length") or 0)
        body = self.rfile.read(length)
        url = urllib.parse.urlsplit(self.path)
        asked = dict(urllib.parse.parse_qsl(url.query))
        if url.path == "/hostile":
            with open(PAGE, "rb") as page:
                self.answer(200, page.read())
        elif url.path == "/leave":
            self.answer(200, LEAVE.format(**asked).encode())
        elif url.path == "/held":
            site.ends.wait(PATIENCE_S)
        elif url.path == "/redirect":
            self.answer(307, b"", {"Location": asked["to"]})
        elif url.path == "/report":
            site.reports.put(body)
            self.answer(200, b"")
        elif site.relays_to is None:
            self.answer(404, b"")
        else:
            try:
                self.relay(site, asked.get("by", ""), body)
            except OSError:
                pass  # either end left

    def answer(self, code, body, headers=None):
        self.send_response(code)
        headers = {"Content-Type": "text/html; charset=utf-8", **(headers or {})}
        for name, value in {**headers, "Content-Length": len(body)}.items():
            self.send_header(name, str(value))
        self.end_headers()
        self.wfile.write(body)

    def relay(self, site, by, body):
        leave = {"Access-Control-Allow-Origin": self.headers.get("Origin", "*"),
                 "Access-Control-Allow-Credentials": "true",
                 "Access-Control-Allow-Headers": "Content-Type"} if site.is_naive else {}
        if site.is_naive and self.command == "OPTIONS":
            return self.answer(204, b"", leave)
        if site.is_naive and "Sec-WebSocket-Key" in self.headers:
            return self.accept_websocket(site, by)
        box = http.client.HTTPConnection("127.0.0.1", site.relays_to, timeout=PATIENCE_S)
        try:
            if site.is_naive:
                headers = {"Content-Type": "application/json"} if self.command == "POST" else {}
                box.request(self.command, self.path, b"{}" if headers else None, headers)
            else:
                box.putrequest(self.command, self.path, skip_host=True, skip_accept_encoding=True)
                for name, value in self.headers.items():
                    box.putheader(name, value)
                box.endheaders(body)
            answer = box.getresponse()
            site.answered.append((by, answer.status))
            self.send_response(answer.status)
            for name, value in answer.getheaders():
                if name.lower() not in OF_A_CONNECTION:
                    self.send_header(name, value)
            for name, value in leave.items():
                self.send_header(name, value)
            self.end_headers()
            while piece := answer.read1(65536):
                self.wfile.write(piece)
        finally:
            box.close()

    def accept_websocket(self, site, by):
        key = self.headers["Sec-WebSocket-Key"] + WEBSOCKET_KEY
        self.protocol_version = "HTTP/1.1"
        self.send_response(101)
        for name, value in (("Upgrade", "websocket"), ("Connection", "Upgrade"), (
                "Sec-WebSocket-Accept",
                base64.b64encode(hashlib.sha1(key.encode()).digest()).decode())):
            self.send_header(name, value)
        self.end_headers()
        words = b"a naive box"
        self.wfile.write(bytes([0x81, len(words)]) + words)
        site.answered.append((by, 101))


class Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, *_):
        pass  # a browser leaves connections


class HostileSite:
    def __init__(self, relays_to=None, is_naive=False):
        self.relays_to, self.is_naive = relays_to, is_naive
        self.reports, self.ends = queue.Queue(), threading.Event()
        self.answered = []  # which attack had which status from the box
        self.server = Server(("127.0.0.1", 0), Handler)
        self.server.site = self
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.ends.set()
        self.server.shutdown()
        self.server.server_close()
