# SPDX-License-Identifier: Apache-2.0
"""The device is lost under the drawing of a window: at a submit, then as a picture is shown. The body goes on as
it was, and can go back; where there is no other device, what was done is recorded before the end.
    window_lost_test.py PROGRAM SCENES OUT [MORE OPTIONS OF THE VIEW]      screenshots go to OUT"""
import pathlib
import re
import subprocess
import tempfile
import time

from window_test import (LIMIT, MORE, OUT, PROGRAM, SCENES, Display, expect, expect_valid, projected, until, validated)


class View:
    """A window with a cut, which can lose its device."""

    def __init__(self, display, folder, devices=""):
        self.display, self.out = display, folder / "out"
        self.probes = {kind: folder / f"lose-{kind}" for kind in ("submit", "present")}
        environment = validated(folder, display)
        environment["SUNDER_VIEW_PROBE"] = ",".join(f"{k}_file={p}" for k, p in self.probes.items()) + devices
        self.program = subprocess.Popen([PROGRAM, "view", SCENES / "board-grip-b.toml", "--out", self.out,
                                         "--steps", "2000", *MORE], env=environment, stderr=subprocess.PIPE, text=True)
        until("a window", lambda: subprocess.run(["xdotool", "search", "--name", "Board"], capture_output=True,
                                                 env=environment).stdout or self.ended())
        time.sleep(2)
        display.do("mousemove", 20, 400)
        until("steps", lambda: display.do("key", "s") or self.recorded(r"^step"))
        stroke = [projected((-4 + i, 26, 1.25)) for i in range(19)]
        self.recorded_cut = until("a cut", lambda: display.drag(3, stroke, 0.1) or self.recorded("remove "))

    def ended(self):
        if self.program.poll() is not None:
            raise AssertionError(f"exit code {self.program.returncode}: {self.program.stderr.read()}")

    def recorded(self, pattern):
        """What was done, where it looks so; it is the same twice, so that nothing is in work."""
        inputs = self.out / "recording.inputs"
        texts = []
        for _ in range(2):
            self.ended()
            self.display.do("key", "e")
            time.sleep(0.5)
            texts.append(inputs.read_text() if inputs.exists() else "")
        return texts[0] == texts[1] and re.search(pattern, texts[0]) and texts[0]

    def lose(self, kind):
        self.probes[kind].write_text("")
        until(f"a loss at a {kind}", lambda: not self.probes[kind].exists())

    def close(self):
        if self.program.poll() is None:
            self.program.kill()
            self.program.wait()


def run_again(folder):
    done = subprocess.run([PROGRAM, "run", folder / "out" / "recording.toml", "--out", folder / "run", "--quiet"],
                          capture_output=True, text=True)
    expect(done.returncode == 0, done.stderr)
    expect(",script" in (folder / "run" / "events.csv").read_text(), "the run has not removed what was cut")


def goes_on(display, folder):
    view = View(display, folder)
    try:
        for kind in ("submit", "present"):
            before = view.recorded("remove ")
            whole = display.screenshot(OUT / f"window-before-{kind}.png")
            view.lose(kind)
            time.sleep(3)
            view.ended()
            shown = display.screenshot(OUT / f"window-lost-{kind}.png")
            left = [i for i in range(0, len(whole), 97) if i % (3 * 1280 + 1) < 3 * 700]  # beside the panel
            expect(sum(whole[i] != shown[i] for i in left) < len(left) // 50, "the picture is another one")
            expect(view.recorded("remove ") == before, "what was done is lost, or has gone on")
            display.do("key", "s")
            until("a step", lambda: (t := view.recorded("remove ")) and t != before)
        until("undo", lambda: display.do("key", "z") or ((t := view.recorded("step")) and "remove " not in t))
        until("redo", lambda: display.do("key", "y") or view.recorded("remove "))
        display.do("key", "Escape")
        errors = view.program.communicate(timeout=LIMIT)[1]
        expect(view.program.returncode == 0, f"exit code {view.program.returncode}: {errors}")
        run_again(folder)
        expect_valid(folder)
    finally:
        view.close()


def ends_with_a_recording(display, folder):
    view = View(display, folder, ",devices=1")
    try:
        before = view.recorded_cut
        (view.out / "recording.toml").unlink()
        (view.out / "recording.inputs").unlink()
        view.lose("submit")
        errors = view.program.communicate(timeout=LIMIT)[1]
        expect(view.program.returncode == 4, f"exit code {view.program.returncode}: {errors}")
        expect(str(view.out / "recording.toml") in errors and "device was lost" in errors, errors)
        expect((view.out / "recording.inputs").read_text() == before, "what was done is lost")
        run_again(folder)
        expect_valid(folder)
    finally:
        view.close()


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    for part in (goes_on, ends_with_a_recording):
        with tempfile.TemporaryDirectory() as name:
            display = Display(name)
            try:
                part(display, pathlib.Path(name))
            finally:
                display.close()
    print("ok; screenshots in", OUT)


main()
