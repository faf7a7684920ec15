# SPDX-License-Identifier: Apache-2.0
"""How far long work is, on a terminal."""
import sys
import threading


class Progress:
    def __init__(self, what, total):
        self.what, self.total, self.done = what, total, 0
        self.lock = threading.Lock()

    def step(self, count=1):
        with self.lock:
            self.done += count
            if sys.stderr.isatty():
                end = "\n" if self.done >= self.total else ""
                print(f"\r{self.what}: {self.done} of {self.total} ", end=end, file=sys.stderr,
                      flush=True)
