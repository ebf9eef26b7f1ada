#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The program built for another machine, run by its emulator, against the one of this machine: the same
events, fields, tables and meshes, the same exit codes and sentences for bad input, locks and signals.
    program.py HERE THERE [EMULATOR...]     HERE, THERE: the two programs
Names of files have spaces and letters that no code page of Windows has all of."""
import base64
import csv
import json
import os
import pathlib
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SAME = 1e-8  # of the largest number of a field or column; kCrackTolerance of tests/support/accuracy.hpp
HERE, THERE = [], []
# What depends on the clock.
CLOCK = re.compile(r"ms|ms_.*|back_solves")


def command(program, *arguments):
    return [*program, *map(str, arguments)]


def run(program, *arguments):
    done = subprocess.run(command(program, *arguments), capture_output=True, check=False, timeout=300)
    return done.returncode, done.stdout.decode("utf-8"), done.stderr.decode("utf-8")


def table(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def arrays(path):
    """The binary arrays of a .vtu by name: numbers as they stand there."""
    text = path.read_text(encoding="utf-8")
    found = {}
    for head, body in re.findall(r"<DataArray ([^>]*)>([^<]*)</DataArray>", text):
        said = dict(re.findall(r'(\w+)="([^"]*)"', head))
        code = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}[said["type"]]
        data = base64.b64decode(body)
        (length,) = struct.unpack("<Q", data[:8])
        if length != len(data) - 8:
            raise ValueError(said["Name"])
        found[said["Name"]] = [x for (x,) in struct.iter_unpack("<" + code, data[8:])]
    return found


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="sunder déchiré 裂 ")
        self.work = pathlib.Path(self.folder.name)
        self.scene = self.work / "Sehne gerissen Ω.toml"
        text = (SOURCE / "scenes/board-pull-a.toml").read_text(encoding="utf-8")
        mesh = self.work / "maillage 腱.msh"
        mesh.write_bytes((SOURCE / "scenes/meshes/board1954.msh").read_bytes())
        self.scene.write_text(text.replace("meshes/board1954.msh", mesh.name), encoding="utf-8")

    def tearDown(self):
        self.folder.cleanup()

    def ran(self, program, *arguments):
        code, out, error = run(program, *arguments)
        self.assertEqual(code, 0, error)
        return out

    def same_cells(self, here, there, left_out=CLOCK):
        self.assertEqual(len(here), len(there))
        self.assertTrue(here)
        self.assertEqual(list(here[0]), list(there[0]))
        for column in here[0]:
            if left_out.fullmatch(column):
                continue
            mine, other = [row[column] for row in here], [row[column] for row in there]
            if column in ("residual", "error"):  # of the size of rounding
                self.assertTrue(all(float(x or 0) < SAME for x in mine + other), column)
                continue
            self.same_numbers(mine, other, column)

    def same_numbers(self, mine, other, name):
        def number(x):
            try:
                return float(x)
            except ValueError:
                return None

        largest = max((abs(number(x)) for x in mine if number(x) is not None), default=0)
        for a, b in zip(mine, other, strict=True):
            x, y = number(a), number(b)
            if x is None or y is None:
                self.assertEqual(a, b, name)
            else:
                self.assertLessEqual(abs(x - y), SAME * largest, name)

    def test_tears_the_papers_board_as_here(self):
        for program, name in ((HERE, "hier"), (THERE, "dort ω")):
            out = self.ran(program, "run", self.scene, "--quiet", "--out", self.work / name, "--snapshots", "10")
            self.assertIn("first rupture: element 1117 (mss) in step 37", out)
        here, there = self.work / "hier", self.work / "dort ω"
        events = table(here / "events.csv")
        self.assertEqual(len(events), 52)
        self.same_cells(events, table(there / "events.csv"))
        self.assertEqual([e["element"] for e in events], [e["element"] for e in table(there / "events.csv")])
        self.same_cells(table(here / "frames.csv"), table(there / "frames.csv"))
        for name in ("result.vtu", "snapshot_10.vtu"):
            mine, other = arrays(here / name), arrays(there / name)
            self.assertEqual(list(mine), list(other))
            self.assertIn("displacement", mine)
            for field, numbers in mine.items():
                self.same_numbers(numbers, other[field], name + " " + field)
        mine, other = (json.loads((p / "summary.json").read_text(encoding="utf-8")) for p in (here, there))
        self.assertEqual(mine["destroyed"], other["destroyed"])
        self.assertEqual(mine["route"]["name"], other["route"]["name"])
        # All but PNG is there, whole.
        names = {p.name for p in here.iterdir() if p.suffix != ".png"}
        self.assertEqual(names, {p.name for p in there.iterdir()})
        self.assertIn("makes no PNG", " ".join(other["warnings"]))
        page = (there / "index.html").read_text(encoding="utf-8")
        self.assertIn("<svg", page)
        self.assertIn("data:image/svg+xml;base64,", page)
        # Once more over what is there: every file is replaced.
        before = (there / "events.csv").read_bytes()
        self.ran(THERE, "run", self.scene, "--quiet", "--out", there)
        self.assertEqual((there / "events.csv").read_bytes(), before)
        self.assertFalse((there / "snapshot_10.vtu").exists())

    def test_sweeps_as_here(self):
        axes = ("--vary", "instrument.0.force.1=-90,-100", "--vary", "material.upper.yield=2:4:3", "--quiet")
        for program, name in ((HERE, "a"), (THERE, "b")):
            self.ran(program, "sweep", self.scene, *axes, "--out", self.work / name, "--jobs", "2")
        rows = table(self.work / "a/sweep.csv")
        self.assertEqual(len(rows), 6)
        self.assertTrue(any(row.get("destroyed", "0") != "0" for row in rows))
        self.same_cells(rows, table(self.work / "b/sweep.csv"))
        # Parts, and what is left of a sweep whose second half was never written.
        parts = self.work / "teile"
        for part in ("1/2", "2/2"):
            self.ran(THERE, "sweep", self.scene, *axes, "--out", parts, "--part", part)
        self.ran(THERE, "sweep", self.scene, "--out", parts, "--merge")
        self.same_cells(rows, table(parts / "sweep.csv"))
        lines = (self.work / "b/sweep.rows").read_bytes().splitlines(keepends=True)
        (self.work / "b/sweep.rows").write_bytes(b"".join(lines[:3]) + lines[3][:10])
        out = self.ran(THERE, "sweep", self.scene, *axes, "--out", self.work / "b", "--resume")
        self.assertIn("3 were there before", out)
        self.same_cells(rows, table(self.work / "b/sweep.csv"))

    def test_bad_input_ends_with_the_sentence_and_the_code_of_here(self):
        broken = self.work / "kaputt é.toml"
        broken.write_text(self.scene.read_text(encoding="utf-8").replace("poisson = 0.4", "poisson = 0.7", 1),
                          encoding="utf-8")
        for arguments in (["run", self.work / "fehlt.toml"], ["run", broken], ["run", self.work],
                          ["run", self.scene, "--set", "solver.rout=1"], ["run", self.scene, "--step", "3"],
                          ["run", self.scene, "--steps", "0"], ["run", self.scene, "--backend", "metal"], [],
                          ["sweep", self.scene, "--vary", "steps=1,2", "--out", self.work / "x"],
                          ["run", self.scene, "--out", self.scene]):
            here, there = run(HERE, *arguments), run(THERE, *arguments)
            self.assertNotEqual(here[0], 0)
            self.assertEqual(here[0], there[0], there[2])
            plain = [text.replace("\\", "/").replace("Z:", "") for text in (here[2], there[2])]
            if str(arguments[-1:]) == str([self.scene]):  # the system's own words differ
                plain = [text[:text.find(": it is a file")] for text in plain]
            self.assertEqual(*[text.replace("\r", "") for text in plain])

    def test_what_a_build_has_not_it_says(self):
        for arguments, words in ((["view", self.scene, "--headless"], "without librsvg"),
                                 (["reproduce", "--out", self.work / "r"], "no gmsh|has not"),
                                 (["mesh", "board", "--tets", "500", "-o", self.work / "b.vtk"], "no gmsh")):
            code, _, error = run(THERE, *arguments)
            self.assertIn(code, (1, 2, 3, 4, 5), error)
            self.assertRegex(error, "sunder: error: .*(" + words + ")")
            self.assertEqual(error.count("\n"), 1)

    def test_finds_a_vulkan_loader_by_the_name_that_windows_has_for_it(self):
        program = pathlib.Path(shutil.copy(THERE[-1], self.work))
        loader = pathlib.Path(THERE[-1]).resolve().parents[1] / "tests/cross/loader/vulkan-1.dll"

        def devices():
            # Not wine's own.
            overrides = os.environ.get("WINEDLLOVERRIDES", "") + ";vulkan-1=n"
            done = subprocess.run(command([*THERE[:-1], program], "devices"), capture_output=True, check=True,
                                  timeout=300, env={**os.environ, "WINEDLLOVERRIDES": overrides})
            return done.stdout.decode("utf-8")

        self.assertNotIn("vulkan", devices())
        shutil.copy(loader, self.work)
        # One device, which it shows only to who asks for a portable subset too.
        self.assertRegex(devices(), r"vulkan +0 +a loader's of the tests")
        self.assertIn("vulkan 0: cannot be used: it offers Vulkan 1.1 only; 1.2 is needed", devices())

    def test_meshes_and_plans_as_here(self):
        for program, name in ((HERE, "a.msh"), (THERE, "ä b.msh")):
            self.ran(program, "mesh", "board", "--tets", "2000", "-o", self.work / name)
        self.assertEqual((self.work / "a.msh").read_bytes(), (self.work / "ä b.msh").read_bytes())
        for arguments in (["materials"], ["--version"], ["help", "run"]):
            here, there = self.ran(HERE, *arguments), self.ran(THERE, *arguments)
            self.assertEqual(here, there.replace("\r", ""))
        self.assertRegex(self.ran(THERE, "plan", self.scene), "unknowns +1,824 ")

    def long_run(self, out):
        """A run of many steps that goes on for long, begun: its first frames are there."""
        text = self.scene.read_text(encoding="utf-8").replace("steps = 50", "steps = 1000000")
        self.scene.write_text(text, encoding="utf-8")
        process = subprocess.Popen(command(THERE, "run", self.scene, "--quiet", "--out", out),
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 120
        while not any(p.stat().st_size > 5000 for p in out.glob("frames.csv*")):
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        return process

    def test_a_folder_belongs_to_one_run_until_that_is_killed(self):
        out = self.work / "beide ø"
        first = self.long_run(out)
        code, _, error = run(THERE, "run", self.scene, "--quiet", "--steps", "2", "--out", out)
        self.assertEqual(code, 2, error)
        self.assertRegex(error, r"process \d+ is writing its results there")
        first.kill()
        first.communicate()
        self.assertTrue((out / ".sunder-lock").exists())
        self.ran(THERE, "run", self.scene, "--quiet", "--steps", "2", "--out", out)
        self.assertFalse((out / ".sunder-lock").exists())
        self.assertFalse(list(out.glob("*.partial")))

    def test_ctrl_c_ends_a_run_with_its_results(self):
        out = self.work / "unterbrochen"
        process = self.long_run(out)
        process.send_signal(signal.SIGINT)  # which wine hands on as Ctrl-C
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, error)
        self.assertIn("results so far are in", error.decode("utf-8"))
        rows = table(out / "frames.csv")
        self.assertGreater(len(rows), 10)
        self.assertTrue((out / "summary.json").exists())
        self.assertFalse(list(out.glob("*.partial")) + list(out.glob(".sunder-lock")))


if __name__ == "__main__":
    HERE, THERE = [sys.argv[1]], [*sys.argv[3:], sys.argv[2]]
    unittest.main(argv=sys.argv[:1], verbosity=1)
