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
        """{file: header}: all of them are named. A header comes in quotes where it has no brackets."""
        for file, header in includes.items():
            (self.root / file).parent.mkdir(exist_ok=True)
            quoted = header if header.startswith("<") else f'"{header}"'
            (self.root / file).write_text(f"#include {quoted}\n")
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
        above = {room: "gpu/plan_device.hpp" if room.startswith("app") else "app/cli/options.hpp"
                 for room in ROOMS}
        said = self.refuse({f"{room}/intruder.hpp": header for room, header in above.items()})
        for room, header in above.items():
            self.assertIn(f"{room}/intruder.hpp includes {header} ({room} may include: {room}", said)

    def test_devices_program_and_interface_keep_apart(self):
        wrong = {"gpu/intruder.cpp": "cpu_reference/routes.hpp",
                 "cpu_reference/intruder.cpp": "gpu/plan_device.hpp",
                 "cpu_reference/routes_intruder.cpp": "cpu_reference/plain/plain.hpp",
                 "app/input/intruder.cpp": "body/element.hpp",
                 "app/report/intruder.cpp": "solver/deferred.hpp"}
        said = self.refuse(wrong)
        for file in wrong:
            self.assertIn(f"{file} includes ", said)

    def test_angle_brackets_open_no_way_round_it(self):
        wrong = {"core/body/intruder.cpp": "<gpu/plan_device.hpp>",
                 "core/solver/intruder.hpp": "<frame/loads.hpp>",
                 "api/sunder/intruder.h": "<c/structs.hpp>",
                 "cpu_reference/plain/intruder.cpp": "<body/element.hpp> // after a word \"of ours\""}
        said = self.refuse(wrong)
        for file in wrong:
            self.assertIn(f"{file} includes ", said)

    def test_public_headers_and_those_of_others_may_stand_in_angle_brackets(self):
        file = self.root / "app" / "input" / "guest.hpp"
        file.write_text("#include <sunder/mesh.hpp>\n#include <vector>\n#include <loads.hpp>\n")
        outcome = checked(self.root)
        file.unlink()
        self.assertEqual(outcome.returncode, 0, outcome.stderr)

    def test_the_yardstick_takes_public_headers_alone(self):
        wrong = {"cpu_reference/plain/a.cpp": "body/element.hpp",
                 "cpu_reference/plain/b.cpp": "solver/deferred.hpp",
                 "cpu_reference/plain/c.cpp": "material/linear.hpp",
                 "cpu_reference/plain/d.cpp": "cpu_reference/routes.hpp",
                 "cpu_reference/plain/e.cpp": "frame/loads.hpp"}
        said = self.refuse(wrong)
        for file, header in wrong.items():
            self.assertIn(f"{file} includes ", said, header)

    def test_the_yardstick_reads_the_mesh_and_the_checked_problem_itself(self):
        files = sorted((SOURCE / "cpu_reference" / "plain").glob("*"))
        lines = [line for file in files for line in file.read_text("utf-8").splitlines()]
        self.assertGreater(len(files), 4)
        # The linear law, three further ones, Newton's method, and what whole scenes ask of them:
        # stress, strain and rotation; fibres, by two theories and their strength; how near an
        # interface is to parting.
        self.assertLessEqual(len(lines), 400 + 3 * 50 + 50 + 80 + 200 + 40)
        judged = r"small_strain|problem.*\.shape\(|stress_measures|yield_measure\(|max_shear\(|anchor"
        self.assertEqual([line for line in lines if re.search(judged, line)], [])

    def test_e_and_nu_of_a_material_are_read_in_few_places(self):
        read = re.compile(r"\b(m|material)\.(young|poisson)\b|\bmaterial\(\w+\)\.(young|poisson)")
        readers = {str(file.relative_to(SOURCE))
                   for top in ("core", "cpu_reference", "gpu")
                   for file in (SOURCE / top).rglob("*.?pp")
                   if read.search(file.read_text("utf-8"))}
        # The law; what checks it and scales springs by it; transversely isotropic elasticity, of which
        # they are the constants across; the yardstick, which judges both; and the mean of several
        # laws at a tip, a material by name alone.
        self.assertEqual(readers, {"core/material/linear.cpp", "core/body/problem.cpp",
                                   "core/body/problem_fibres.cpp",
                                   "core/body/problem_supports.cpp", "cpu_reference/plain/element.cpp",
                                   "cpu_reference/plain/fibres.cpp",
                                   "core/fracture/field_sif/auxiliary_field.cpp",
                                   "core/fracture/field_sif/field_intensity.cpp"})

    def test_a_folder_without_a_room_is_refused(self):
        said = self.refuse({"app/nowhere/stray.cpp": "sunder/mesh.hpp"})
        self.assertIn("app/nowhere/stray.cpp lies in no room", said)


if __name__ == "__main__":
    unittest.main()
