# SPDX-License-Identifier: Apache-2.0
"""Programs that serve pages."""
import os
import re
import subprocess
import time

PATIENCE_S = 60  # with a busy machine


class Service:
    """A program that serves the page, until it is left."""

    def __init__(self, command, folder, address):
        self.said = os.path.join(folder, "said")
        with open(self.said, "w", encoding="utf-8") as file:
            self.process = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stdout=file,
                                            stderr=subprocess.STDOUT)
        end = time.monotonic() + PATIENCE_S
        while not (found := re.search(address, self.text())):
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"{command} does not serve: {self.text()}")
            time.sleep(0.02)
        self.port = int(found.group(1))

    def text(self):
        with open(self.said, encoding="utf-8") as file:
            return file.read()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(PATIENCE_S)
