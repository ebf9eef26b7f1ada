# SPDX-License-Identifier: Apache-2.0
"""The window under synthetic input: a mouse and keys in a display of its own (Xvfb), under Vulkan's
validation. What was done is recorded, and a run does it again.
    window_test.py PROGRAM SCENES OUT [MORE OPTIONS OF THE VIEW]      screenshots go to OUT"""
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zlib

PROGRAM, SCENES, OUT = (pathlib.Path(a).resolve() for a in sys.argv[1:4])
MORE = sys.argv[4:]
WIDTH, HEIGHT = 1280, 800
LIMIT = 90  # [s] for anything to happen
SETTINGS = """khronos_validation.debug_action = VK_DBG_LAYER_ACTION_LOG_MSG
khronos_validation.report_flags = error,warn
khronos_validation.log_filename = {log}
khronos_validation.enables = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
"""


def projected(point, grips=((50, -28),)):
    """Where the standard camera of a window sees a point of the board (app/view/camera.cpp)."""
    a, e = math.radians(25), math.radians(18)
    eye = (math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e))
    right = (math.cos(a), 0, -math.sin(a))
    up = (eye[1] * right[2] - eye[2] * right[1], eye[2] * right[0] - eye[0] * right[2],
          eye[0] * right[1] - eye[1] * right[0])
    flat = lambda p: tuple(sum(x * y for x, y in zip(p, axis)) for axis in (right, up))
    shown = [flat((x, y, z)) for x in (0, 50) for y in (0, 50) for z in (0, 2.5)]
    shown += [flat((x, y, z)) for x, y in grips for z in (0, 2.5)]  # where grips will be
    low, high = ([f(c) for c in zip(*shown)] for f in (min, max))
    above, below, left, aside = 90, 84, 56, 150
    room = (WIDTH - left - aside, HEIGHT - above - below)
    scale = min(room[i] / (high[i] - low[i]) for i in range(2))
    at = flat(point)
    return (left + room[0] / 2 + scale * (at[0] - (low[0] + high[0]) / 2),
            above + room[1] / 2 - scale * (at[1] - (low[1] + high[1]) / 2))


class Display:
    def __init__(self, folder):
        self.folder = folder
        reading, writing = os.pipe()
        # Without -noreset the server starts again when its last client leaves, and refuses who comes then.
        self.server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", folder,
             "-noreset"], pass_fds=[writing], stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as pipe:
            self.name = ":" + pipe.readline().strip()

    def do(self, *words):
        subprocess.run(["xdotool", *map(str, words)], check=True, env=dict(os.environ, DISPLAY=self.name))

    def drag(self, button, points, pause=0.03):
        self.do("mousemove", *map(round, points[0]))
        time.sleep(0.3)
        self.do("mousedown", button)
        for p in points[1:]:
            time.sleep(pause)
            self.do("mousemove", *map(round, p))
        time.sleep(0.3)
        self.do("mouseup", button)
        time.sleep(0.3)

    def screenshot(self, path):
        """Of an XWD file, as PNG."""
        data = (pathlib.Path(self.folder) / "Xvfb_screen0").read_bytes()
        head = struct.unpack(">25I", data[:100])
        start, width, height, row = head[0] + 12 * head[19], head[4], head[5], head[12]
        raw = bytearray()
        for y in range(height):
            line = data[start + y * row:start + y * row + 4 * width]
            pixels = bytearray(3 * width)
            pixels[0::3], pixels[1::3], pixels[2::3] = line[2::4], line[1::4], line[0::4]
            raw += b"\0" + pixels
        chunk = lambda kind, body: (struct.pack(">I", len(body)) + kind + body +
                                    struct.pack(">I", zlib.crc32(kind + body)))
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
                         chunk(b"IDAT", zlib.compress(bytes(raw))) + chunk(b"IEND", b""))
        return bytes(raw)

    def close(self):
        self.server.terminate()
        self.server.wait()


def until(what, so):
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        value = so()
        if value:
            return value
        time.sleep(0.3)
    raise AssertionError(f"did not happen: {what}")


def expect(condition, what):
    if not condition:
        raise AssertionError(what)


def validated(folder, display):
    """The environment of a program in the display, under Vulkan's validation."""
    settings = folder / "vk_layer_settings.txt"
    settings.write_text(SETTINGS.format(log=folder / "layer.log"))
    return dict(os.environ, DISPLAY=display.name, VK_INSTANCE_LAYERS="VK_LAYER_KHRONOS_validation",
                VK_LAYER_SETTINGS_PATH=str(settings))


def expect_valid(folder):
    log = folder / "layer.log"
    said = log.read_text() if log.exists() else ""
    expect("VUID" not in said and "SYNC" not in said and "error" not in said.lower(), said)


def turn_a_patch(display, recorded):
    """With shift a patch in the hand turns where it is."""
    display.do("key", "r")
    until("a body at its start", lambda: recorded("") == "" or "grasp" not in recorded(""))
    for _ in range(4):
        display.do("key", "plus")
    x, y = projected((25, 25, 2.5))
    display.do("mousemove", round(x), round(y))
    time.sleep(0.5)
    display.do("mousedown", 1)
    time.sleep(1)
    display.do("keydown", "shift")
    for i in range(30):
        time.sleep(0.04)
        display.do("mousemove", round(x + 2 * i), round(y))
    turned = until("a turn", lambda: recorded(r"grasp \S+ \S+ \S+ \S+ rigid\n(.*\n)*pose \d+( \S+){7}\n"))
    display.screenshot(OUT / "window-patch.png")
    display.do("keyup", "shift")
    display.do("mouseup", 1)
    places = re.findall(r"pose \d+ (\S+) (\S+) (\S+) (\S+) (\S+) (\S+) (\S+)\n", turned)
    quaternion = [float(part) for part in places[-1][3:]]
    expect(abs(quaternion[3]) < 0.999 * math.hypot(*quaternion), f"it has not turned: {places[-1]}")
    way = [float(a) - float(b) for a, b in zip(places[-1][:3], places[0][:3])]
    expect(math.hypot(*way) < 1e-6, f"it has moved: {way}")
    until("a patch let go", lambda: recorded(r"release \d+"))


def change_the_material(display, recorded, scene):
    """By the panel: E of volume lower, which takes a new base, then its yield stress, which takes none."""
    display.drag(3, [projected((-4, 26, 1.25)), projected((6, 26, 1.25)), projected((14, 26, 1.25))], 0.1)
    until("a cut", lambda: recorded(r"remove "))
    display.do("key", "m")
    time.sleep(1)

    def enter(x, y, text):
        display.do("mousemove", x, y, "click", 1)
        time.sleep(0.5)
        display.do("key", "ctrl+a")
        time.sleep(0.3)
        display.do("type", "--delay", 120, text)
        time.sleep(0.3)
        display.do("key", "Return")
        time.sleep(0.5)
        display.screenshot(OUT / "window-edit.png")

    def applied(value):
        display.do("key", "Return", "key", "a")  # the field lets the keys go first
        return recorded("") is not None and value in scene.read_text()

    # Four volumes by name, each of a line and three rows of 24 px: lower is the second one.
    volume, row = 90, 24
    modulus = 128 + volume + 18 + row + row // 2 - 2
    enter(70, modulus, "2.5")
    until("another modulus", lambda: applied("young = 2.5"))
    until("what was cut", lambda: recorded(r"^remove "))
    enter(70, modulus + row, "0.75")
    until("another yield stress", lambda: applied("yield = 0.75"))
    time.sleep(1)
    display.screenshot(OUT / "window-material.png")
    display.do("key", "m")


def drop_files(display, view, recorded, scene, environment):
    """As a file manager does. A bad one is told of, and the body stays; another scene takes its place."""
    drop = pathlib.Path(__file__).with_name("drop_files.py")

    def dropped(*files):
        done = subprocess.run([sys.executable, drop, display.name, "Board", *files], capture_output=True, text=True)
        expect(done.returncode == 0, done.stderr)

    bad = scene.parent / "bad.toml"
    bad.write_text("mesh = 3\n")
    before = recorded("")
    dropped(bad)
    time.sleep(2)
    display.screenshot(OUT / "window-bad-file.png")
    expect(view.poll() is None, "the window went away with a bad file")
    expect(recorded("").startswith(before.rsplit("step", 1)[0]), "what was done is lost")
    other = SCENES / "pressure-upper.toml"
    title = re.search(r'title = "(.*)"', other.read_text())[1]
    dropped(other)
    until("another title", lambda: subprocess.run(["xdotool", "search", "--name", title], capture_output=True,
                                                  env=environment).stdout)
    display.do("key", "s")
    until("its recording", lambda: recorded("step") and title in scene.read_text())
    display.screenshot(OUT / "window-another.png")
    # Its spatula presses on the notch's upper face, as hard as the mouse pulls it.
    x, y = projected((44.5, 25.5, 1.25), ())  # within reach of it, beside the panel
    display.drag(1, [(x, y - 3 * i) for i in range(20)])
    pressed = until("a press", lambda: recorded(r'drive "upper spatula" .*\n[^#]*step'))
    expect(float(re.findall(r'drive "upper spatula" \S+ (\S+)', pressed)[-1]) > 0, pressed)
    display.screenshot(OUT / "window-pressed.png")


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        display = Display(name)
        view = None
        try:
            environment = validated(folder, display)
            scene = SCENES / "board-grip-b.toml"
            view = subprocess.Popen([PROGRAM, "view", scene, "--out", folder / "out", "--steps", "2000", *MORE],
                                    env=environment, stderr=subprocess.PIPE, text=True)
            inputs = folder / "out" / "recording.inputs"

            def recorded(pattern):
                display.do("key", "e")
                time.sleep(0.5)
                return inputs.exists() and re.search(pattern, inputs.read_text()) and inputs.read_text()

            def window_is_there():
                expect(view.poll() is None, "the program ended: " + (view.stderr.read() if view.poll() else ""))
                return subprocess.run(["xdotool", "search", "--name", "Board"], capture_output=True,
                                      env=environment).stdout

            until("a window", window_is_there)
            time.sleep(2)
            display.do("mousemove", 20, 400)
            until("single steps", lambda: display.do("key", "s") or recorded(r"^step"))
            before = display.screenshot(OUT / "window-begin.png")
            # The grip is taken at the lower right corner and pulled down; the body goes on by itself then.
            x, y = projected((50, 0, 1.25))
            display.drag(1, [(x, y)] + [(x, y + 4 * i) for i in range(1, 25)])
            pulled = until("a pull", lambda: recorded(r'drive "right forceps" .*\n[^#]*step'))
            expect(float(re.findall(r'drive "right forceps" \S+ (\S+)', pulled)[-1]) < -5, pulled)
            display.do("key", "space")
            time.sleep(1)
            after = display.screenshot(OUT / "window-pulled.png")
            expect(sum(a != b for a, b in zip(before[::97], after[::97])) > 100, "the picture has not changed")
            # A cut from the left along a stroke, taken back and done again.
            left, right = projected((-4, 26, 1.25)), projected((18, 26, 1.25))
            stroke = [tuple(a + (b - a) * i / 20 for a, b in zip(left, right)) for i in range(21)]
            display.drag(3, stroke)
            until("a cut", lambda: recorded(r"^remove ") or recorded(r"\nremove "))
            display.screenshot(OUT / "window-cut.png")
            display.do("key", "z")
            until("undo", lambda: (t := recorded("step")) and "remove " not in t)
            display.do("key", "y")
            text = until("redo", lambda: recorded(r"\nremove "))
            # Tissue is taken in hand anywhere, by its own thread; P pins it, so that a second hand has room.
            first, second = projected((12, 40, 2.5)), projected((38, 40, 2.5))
            way = [(first[0] - i, first[1] + i / 2) for i in range(25)]
            display.do("mousemove", *map(round, first))
            time.sleep(0.5)
            display.do("mousedown", 1)
            for p in way:
                time.sleep(0.04)
                display.do("mousemove", *map(round, p))
            display.do("key", "p")
            time.sleep(1)
            display.screenshot(OUT / "window-hand.png")
            display.do("mouseup", 1)
            pinned = until("a grip", lambda: recorded(r"\ngrasp nodes \d+\n(.*\n)*pose 1 "))
            expect("release" not in pinned, "what is pinned was let go")
            display.drag(1, [(second[0] + i, second[1] + i / 2) for i in range(25)], 0.04)
            until("two hands", lambda: recorded(r"\npose 2 (.*\n)*release 2"))
            display.screenshot(OUT / "window-two-hands.png")
            display.do("key", "space")
            time.sleep(1)
            text = recorded("grasp")
            # The camera turns with the mouse, and what is recorded does not change by it.
            display.drag(1, [(200, 400), (260, 420)])
            display.do("key", "w")
            time.sleep(1)
            display.screenshot(OUT / "window-turned.png")
            expect(recorded("remove") == text, "looking has changed the recording")
            # What cannot be done pauses and says so, and the window stays.
            for _ in range(3):
                display.do("key", "y")
            time.sleep(1)
            display.screenshot(OUT / "window-error.png")
            expect(view.poll() is None, "the window went away with an error")
            shutil.copytree(folder / "out", folder / "hands")  # which is replayed at the end
            turn_a_patch(display, recorded)
            change_the_material(display, recorded, folder / "out" / "recording.toml")
            drop_files(display, view, recorded, folder / "out" / "recording.toml", environment)
            display.do("key", "Escape")
            errors = view.communicate(timeout=LIMIT)[1]
            expect(view.returncode == 0, f"exit code {view.returncode}: {errors}")
            run = subprocess.run([PROGRAM, "run", folder / "hands" / "recording.toml", "--out", folder / "run",
                                  "--quiet"], capture_output=True, text=True)
            expect(run.returncode == 0, run.stderr)
            last = subprocess.run([PROGRAM, "run", folder / "out" / "recording.toml", "--out",
                                   folder / "last", "--quiet"], capture_output=True, text=True)
            expect(last.returncode == 0, last.stderr)
            gone = re.findall(r"\d+", re.search(r"\nremove (.*)", text)[1])
            events = (folder / "run" / "events.csv").read_text()
            expect(all(f",{e},script" in events for e in gone), "the run has not removed what was cut")
            expect_valid(folder)
        finally:
            if view and view.poll() is None:
                view.kill()
                view.wait()
            display.close()
    print("ok; screenshots in", OUT)


if __name__ == "__main__":
    main()
