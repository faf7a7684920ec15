# SPDX-License-Identifier: Apache-2.0
"""A condyle-box on its made-up facebow, with a folder of its own, asked over HTTP."""
import http.client
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time

PATIENCE_S = 60  # with a busy machine


def memory_folder():
    """Of a disk that does not stall behind other work: only faults that are put in shall count."""
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


class Box:
    def __init__(self, build, name, parent=None, sessions=None, priority=0):
        self.bin = os.path.join(build, "bin")
        self.folder = tempfile.mkdtemp(prefix=f"condyle_{name}_", dir=parent or memory_folder())
        self.sessions = sessions or os.path.join(self.folder, "sessions")
        os.makedirs(self.sessions, exist_ok=True)
        self.fault_file = os.path.join(self.folder, "fault")
        self.errors = os.path.join(self.folder, "errors")
        source = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
        configuration = os.path.join(self.folder, "box.toml")
        with open(configuration, "w") as file:
            file.write(f'[facebow]\nsource = "synth:{source}/hal/profiles/condyle_facebow.toml"\n'
                       f'[estimator]\npriority = {priority}\n'
                       f'[recording]\nfolder = "{self.sessions}"\nreserve_MB = 1\n'
                       '[http]\nport = 0\n')
        environment = dict(os.environ, LD_PRELOAD=os.path.abspath(f"{self.bin}/hung_disk.so"),
                           CONDYLE_HUNG_DISK=self.fault_file)
        with open(self.errors, "w") as errors:
            self.process = subprocess.Popen(
                [f"{self.bin}/condyle-box", "--config", configuration], stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL, stderr=errors, env=environment)
        self.port = 0
        self.wait("the port", lambda: self._told_port())
        self.wait("estimates", lambda: self.status()["estimator"]["estimates"] > 0)

    def _told_port(self):
        if self.process.poll() is not None:
            raise RuntimeError(f"condyle-box ended with {self.process.returncode}: {self.said()}")
        found = re.search(r"listening on \S+ port (\d+)", self.said())
        self.port = int(found.group(1)) if found else 0
        return self.port

    def said(self):
        with open(self.errors) as file:
            return file.read()

    def ask(self, method, path, body=None, timeout=PATIENCE_S):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        try:
            headers = {"Content-Type": "application/json"} if body is not None else {}
            connection.request(method, path, body=body, headers=headers)
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def status(self):
        code, body = self.ask("GET", "/v1/status")
        if code != 200:
            raise RuntimeError(f"status: HTTP {code}: {body[:200]}")
        return json.loads(body)

    def session(self):
        return self.status()["session"]

    def start(self):
        return self.ask("POST", "/v1/session/start", "{}")

    def stop(self):
        return self.ask("POST", "/v1/session/stop", "{}")

    def wait(self, what, is_so, patience_s=PATIENCE_S):
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            if is_so():
                return
            time.sleep(0.02)
        raise RuntimeError(f"waited in vain for {what}")

    def fault(self, text=""):
        with open(self.fault_file + ".new", "w") as file:
            file.write(text)
        os.rename(self.fault_file + ".new", self.fault_file)

    def mend(self):
        if os.path.exists(self.fault_file):
            os.remove(self.fault_file)

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.process.pid}/fd"))

    def memory_MB(self):
        with open(f"/proc/{self.process.pid}/status") as file:
            return int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1)) / 1024

    def end(self, number=signal.SIGTERM):
        if self.process.poll() is None:
            self.process.send_signal(number)
        return self.process.wait(PATIENCE_S)

    def close(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
