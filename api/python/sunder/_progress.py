# SPDX-License-Identifier: Apache-2.0
"""Progress of a run: a line that renews itself on a terminal and in a notebook."""
import sys
import time

_SECONDS = 0.1  # between two updates


class Line:
    def __init__(self, title, what="step"):
        self._title, self._what = title, what
        self._start = self._last = time.monotonic()
        self._notebook = "ipykernel" in sys.modules
        self._shown = self._notebook or sys.stderr.isatty()
        self._open = False

    def __call__(self, step):
        self.show(step.step + 1, f"{step.destroyed} destroyed")

    def show(self, done, more, all_of=None):
        now = time.monotonic()
        if not self._shown or now - self._last < _SECONDS:
            return
        self._last = now
        count = f"{done}/{all_of}" if all_of else f"{done}"
        rate = done / max(now - self._start, 1e-9)
        text = f"{self._title}: {self._what} {count}, {more}, {rate:.3g} {self._what}s/s"
        sys.stderr.write("\r" + text + ("   " if self._notebook else "\033[K"))
        sys.stderr.flush()
        self._open = True

    def close(self):
        if self._open:
            sys.stderr.write("\n" if self._notebook else "\r\033[K")
        self._open = False
