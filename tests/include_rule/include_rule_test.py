#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A file that includes what its folder may not is refused, in every folder.
include_rule_test.py SOURCE CMAKE"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE = sys.argv.pop()
SOURCE = pathlib.Path(sys.argv.pop())
RULE = SOURCE / "cmake" / "include_rule.cmake"
ROOMS = re.findall(r'^  "([\w/]+):[^"]*"$', RULE.read_text(encoding="utf-8"), flags=re.M)


def checked(root):
    return subprocess.run([CMAKE, f"-DROOT={root}", "-P", RULE], capture_output=True, text=True)


class IncludeRule(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.root = pathlib.Path(tempfile.mkdtemp())
        for top in ("core", "cpu_reference", "shaders", "gpu", "api", "app"):
            shutil.copytree(SOURCE / top, cls.root / top)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.root)

    def refuse(self, includes):
        """{file: header}: all of them are named."""
        for file, header in includes.items():
            (self.root / file).parent.mkdir(exist_ok=True)
            (self.root / file).write_text(f'#include "{header}"\n')
        outcome = checked(self.root)
        for file in includes:
            (self.root / file).unlink()
        self.assertNotEqual(outcome.returncode, 0)
        return " ".join(outcome.stderr.split())

    def test_the_sources_keep_it(self):
        outcome = checked(self.root)
        self.assertEqual(outcome.returncode, 0, outcome.stderr)

    def test_every_room_refuses_what_lies_above_it(self):
        self.assertGreater(len(ROOMS), 15)
        above = {room: "gpu/plan.hpp" if room.startswith("app") else "app/cli/options.hpp"
                 for room in ROOMS}
        said = self.refuse({f"{room}/intruder.hpp": header for room, header in above.items()})
        for room, header in above.items():
            self.assertIn(f"{room}/intruder.hpp includes {header} ({room} may include: {room}", said)

    def test_devices_program_and_interface_keep_apart(self):
        wrong = {"gpu/intruder.cpp": "cpu_reference/routes.hpp",
                 "cpu_reference/intruder.cpp": "gpu/plan.hpp",
                 "app/input/intruder.cpp": "fem/element.hpp",
                 "app/report/intruder.cpp": "engine/deferred.hpp"}
        said = self.refuse(wrong)
        for file in wrong:
            self.assertIn(f"{file} includes ", said)

    def test_a_folder_without_a_room_is_refused(self):
        said = self.refuse({"app/nowhere/stray.cpp": "sunder/mesh.hpp"})
        self.assertIn("app/nowhere/stray.cpp lies in no room", said)


if __name__ == "__main__":
    unittest.main()
