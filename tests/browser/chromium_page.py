# SPDX-License-Identifier: Apache-2.0
"""A page in headless Chromium, driven through the pipe of its DevTools protocol."""
import base64
import fcntl
import json
import os
import shutil
import subprocess
import tempfile
import time

PATIENCE_S = 120  # with a busy machine


def above_4(descriptor):
    moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD, 5)
    os.close(descriptor)
    return moved


class Page:
    """One page. `problems`: errors of its console and script, and requests that it made."""

    def __init__(self, width=1280, height=900):
        self.folder = tempfile.mkdtemp(prefix="condyle_page_")
        self.problems, self.requests, self.number, self.waiting = [], [], 0, b""
        to_browser, self.to_browser = os.pipe()
        self.from_browser, from_browser = os.pipe()
        # The pipe of the protocol: descriptors 3 and 4, which may be others' here.
        to_browser, from_browser = above_4(to_browser), above_4(from_browser)
        shell = f'exec "$0" "$@" 3<&{to_browser} 4>&{from_browser}'
        command = ["bash", "-c", shell, "chromium", "--headless", "--remote-debugging-pipe",
                   "--disable-gpu", "--no-first-run", "--disable-sync", "--disable-extensions",
                   "--disable-background-networking", "--disable-component-update",
                   "--disable-dev-shm-usage", "--force-device-scale-factor=1",
                   f"--user-data-dir={self.folder}", "about:blank"]
        if os.geteuid() == 0:
            command.insert(5, "--no-sandbox")
        self.browser = subprocess.Popen(command, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        pass_fds=(to_browser, from_browser),
                                        env=dict(os.environ, HOME=self.folder))
        os.close(to_browser)
        os.close(from_browser)
        self.session = None
        target = next(one for one in self.ask("Target.getTargets")["targetInfos"]
                      if one["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=target["targetId"],
                                flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")
        self.resize(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.browser.terminate()
        self.browser.wait()
        os.close(self.to_browser)
        os.close(self.from_browser)
        shutil.rmtree(self.folder, ignore_errors=True)

    def ask(self, method, **parameters):
        """The result of a method of the protocol."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.to_browser, data):]
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def read(self):
        while b"\0" not in self.waiting:
            data = os.read(self.from_browser, 1 << 20)
            if not data:
                raise RuntimeError("Chromium ended")
            self.waiting += data
        text, self.waiting = self.waiting.split(b"\0", 1)
        message = json.loads(text)
        self.note(message.get("method", ""), message.get("params", {}))
        return message

    def note(self, method, parameters):
        if method == "Runtime.exceptionThrown":
            self.problems.append(str(parameters["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "warning"):
            self.problems.append(str(parameters["args"]))
        elif method == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
            self.problems.append(str(parameters["entry"]))
        elif method == "Network.requestWillBeSent":
            self.requests.append(parameters["request"]["url"])

    def open(self, url, is_ready="document.readyState === 'complete'"):
        """Seconds until `is_ready`."""
        begin = time.monotonic()
        self.ask("Page.navigate", url=url)
        self.wait(f"location.href !== 'about:blank' && ({is_ready})")
        return time.monotonic() - begin

    def value(self, expression):
        """Of JavaScript, which may be a promise."""
        result = self.ask("Runtime.evaluate", expression=expression, returnByValue=True,
                          awaitPromise=True, userGesture=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression[:200]}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, expression):
        """Its value, once it is true."""
        end = time.monotonic() + PATIENCE_S
        while not (value := self.value(expression)):
            if time.monotonic() > end:
                raise RuntimeError(f"never: {expression}")
            time.sleep(0.02)
        return value

    def resize(self, width, height):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height,
                 deviceScaleFactor=1, mobile=False)

    def press(self, key):
        """A key, with the text that it types if it is one character."""
        text = {"text": key} if len(key) == 1 else {}
        codes = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Home": 36,
                 "End": 35, "Tab": 9, "Enter": 13, " ": 32}
        code = {"windowsVirtualKeyCode": codes[key]} if key in codes else {}
        if key == "Enter":
            text = {"text": "\r"}
        self.ask("Input.dispatchKeyEvent", type="keyDown", key=key, **text, **code)
        self.ask("Input.dispatchKeyEvent", type="keyUp", key=key, **code)

    def mouse(self, kind, x, y, buttons=0, clicks=0):
        button = {"button": "left"} if buttons or kind == "mouseReleased" else {}
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, buttons=buttons,
                 clickCount=clicks, **button)

    def drag(self, x, y, to_x, to_y):
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, 1, 1)
        for share in (0.3, 0.6, 1):
            self.mouse("mouseMoved", x + share * (to_x - x), y + share * (to_y - y), 1)
        self.mouse("mouseReleased", to_x, to_y, 0, 1)

    def save_downloads(self, folder):
        self.ask("Page.setDownloadBehavior", behavior="allow", downloadPath=folder)

    def picture(self, path, is_whole=False, part=None):
        """Of the window, of the whole page, or of a part of it: left, top, width and height in px."""
        clip = {}
        if is_whole:
            size = self.ask("Page.getLayoutMetrics")["cssContentSize"]
            part = (0, 0, size["width"], size["height"])
        if part:
            clip = {"clip": {**dict(zip(("x", "y", "width", "height"), part)), "scale": 1},
                    "captureBeyondViewport": True}
        self.write(path, self.ask("Page.captureScreenshot", format="png", **clip)["data"])

    def print(self, path):
        self.write(path, self.ask("Page.printToPDF", printBackground=True, preferCSSPageSize=True)[
            "data"])

    @staticmethod
    def write(path, data):
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))
