# SPDX-License-Identifier: Apache-2.0
"""Scenes and meshes: by Python they are what they are by the program."""
import pathlib
import re
import tempfile
import tomllib
import types
import unittest

import numpy as np
import sunder
from sunder import _words
from support import NODES, SCENES, SOURCE, TETS, program, program_run

STEPS = 2


class Scenes(unittest.TestCase):
    def test_every_scene_is_what_the_program_makes_of_it(self):
        paths = sorted(SCENES.glob("**/*.toml"))
        self.assertGreater(len(paths), 20)
        for path in paths:
            with self.subTest(path.stem), tempfile.TemporaryDirectory() as folder:
                changed = {"time.steps": STEPS, "solver.backend": "cpu"}
                options = ["--backend", "cpu"]
                tree = tomllib.loads(path.read_text(encoding="utf-8"))
                cuts = tree.get("destroy", [])
                last = max((cut["step"] for cut in cuts), default=0)
                if last < 5:
                    changed["time.steps"] = max(STEPS, last + 1)
                else:  # too far away
                    changed["destroy"] = []
                    options += ["--set", "destroy=[]"]
                options += ["--steps", str(changed["time.steps"])]
                # A strip is not peeled in two steps.
                for i, tool in enumerate(tree.get("instrument", []) if "interface" in tree else []):
                    for key in ("displacement", "turn"):
                        if key in tool:
                            less = [0.05 * x for x in tool[key]]
                            changed[f"instrument.{i}.{key}"] = less
                            options += ["--set", f"instrument.{i}.{key}={less}"]
                _, frames, events = program_run(path, pathlib.Path(folder), *options)
                with sunder.Scene(path, set=changed) as scene, sunder.Simulation(scene) as simulation:
                    steps = simulation.run()
                    self.assertEqual(len(steps), len(frames))
                    for step, frame in zip(steps, frames):
                        self.assertEqual(step.compliance, float(frame["compliance"]))
                        self.assertEqual(step.residual, float(frame["residual"]))
                        self.assertEqual(step.destroyed, int(frame["destroyed"]))
                    broken = simulation.events()
                    self.assertEqual([str(e) for e in broken["element"] if e >= 0],
                                     [e["element"] for e in events if e["element"]])

    def test_a_dict_is_what_its_file_is(self):
        path = SCENES / "notch-b.toml"
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
        tree["mesh"] = sunder.Mesh.read(SCENES / tree["mesh"])
        before = str(tree["instrument"])
        few = {"time.steps": 1}
        with sunder.run(path, set=few) as of_file, sunder.run(tree, set=few) as of_dict:
            self.assertTrue((of_file.displacement() == of_dict.displacement()).all())
        self.assertEqual(str(tree["instrument"]), before, "the caller's dict has changed")

    def test_keys_and_words_are_those_of_the_document(self):
        text = (SOURCE / "docs/interface.md").read_text(encoding="utf-8")
        text = text[text.index("<!-- keys:"):text.index("<!-- end of keys")]
        tables, table, selection = {"": []}, "", "a selection of nodes"
        for name, kind in re.findall(r"^\| (.+?) \| (.*?) \|", text, flags=re.M)[1:]:
            if heading := re.match(r"\*\*`\[+([\w.]+?)\]+`\*\*|\*\*(.+)\*\*", name):
                *above, table = ["nodes"] if heading[2] else heading[1].replace(".NAME", "").split(".")
                if not heading[2]:
                    tables[above[-1] if above else ""] += [table]
                tables[table] = []
            elif name == selection:
                tables[table] += [selection]
            else:
                key = name.strip("`")
                tables[table].append(key)
                words = re.findall(r'"([^"]+)"', kind)
                if words and key != "preset":
                    self.assertEqual(_words.WORDS[table, key], tuple(words), f"{table}.{key}")
        nodes = tables.pop("nodes")
        for table, keys in tables.items():
            spread = [n for k in keys for n in (nodes if k == selection else [k])]
            self.assertEqual(sorted(_words.KEYS[table]), sorted(spread), table)

    def test_overrides_reach_every_place(self):
        tree = {"mesh": (NODES, TETS), "material": {"volume": {"young": 5, "poisson": 0.3}},
                "fixed": [{"nodes": [0, 2, 3]}],
                "instrument": [{"kind": "expansion", "nodes": [4], "force": [1, 0, 0]}]}
        plain = sunder.run(tree).displacement()
        for key, value, factor in (("instrument.0.force.0", 3, 3), ("instrument.0.force", [2, 0, 0], 2),
                                   ("material.volume.young", 10, 0.5)):
            moved = sunder.run(tree, set={key: value}).displacement()
            np.testing.assert_allclose(moved, factor * plain, rtol=1e-12)
        more = {"instrument.1": {"kind": "expansion", "nodes": [4], "force": [1, 0, 0]}}
        np.testing.assert_allclose(sunder.run(tree, set=more).displacement(), 2 * plain, rtol=1e-12)

    def test_materials_go_to_volumes_by_name(self):
        mesh = sunder.Mesh(NODES, TETS, [0, 1], ("soft", "hard"))
        moved = []
        for order in (("soft", "hard"), ("hard", "soft")):
            with sunder.Scene(mesh=mesh) as scene:
                for name in order:
                    scene.add_material(name, young={"soft": 1, "hard": 100}[name], poisson=0.3)
                scene.add_support(nodes=[0, 2, 3])
                scene.add_instrument(force=[0.01, 0, 0], nodes=[4])
                with sunder.Simulation(scene) as simulation:
                    simulation.step()
                    moved.append(simulation.displacement())
        self.assertTrue((moved[0] == moved[1]).all())
        self.assertGreater(abs(moved[0]).max(), 0)

    def test_a_plan_says_what_a_scene_takes(self):
        with sunder.Scene(SCENES / "board-pull-b.toml", set={"solver.backend": "cpu"}) as scene:
            plan = scene.plan()
        self.assertEqual((plan["nodes"], plan["tets"], plan["unknowns"]), (652, 1954, 1824))
        self.assertEqual(plan["buffers"]["inverse (dense, n x n)"], 1824 * 1824 * 8)
        self.assertTrue(plan["left_out"])

    def test_presets_and_devices(self):
        self.assertIn("liver-porcine", sunder.presets())
        self.assertTrue(any(d["chosen"] for d in sunder.devices()))
        with sunder.Scene(mesh=(NODES, TETS)) as scene:
            scene.add_material(preset="liver-porcine")


class Meshes(unittest.TestCase):
    def test_of_every_version_that_the_program_writes(self):
        with tempfile.TemporaryDirectory() as folder:
            for options in ([], ["--ascii"]):
                path = pathlib.Path(folder) / "board.msh"
                made = program("mesh", "board", "--nx", 3, "--ny", 4, "--nz", 2, *options, "-o", path)
                self.assertEqual(made.returncode, 0, made.stderr)
                mesh = sunder.Mesh.read(path)
                x = mesh.nodes[mesh.tets]
                volume = np.linalg.det(x[:, 1:] - x[:, :1]) / 6
                self.assertAlmostEqual(volume.sum(), 50 * 50 * 2, places=9)
                self.assertTrue((volume > 0).all())
                self.assertEqual(mesh.volumes, ("bottom-frame", "lower", "upper", "top-frame"))

    def test_of_meshio_like_objects(self):
        block = types.SimpleNamespace
        mesh = sunder.Mesh.of(block(
            points=np.array(NODES + [[9, 9, 9]], float),
            cells=[block(type="triangle", data=np.array([[1, 2, 3]])),
                   block(type="tetra", data=np.array(TETS))],
            cell_data={"gmsh:physical": [np.array([7]), np.array([2, 1])]},
            field_data={"soft": np.array([1, 3]), "hard": np.array([2, 3]), "cut": np.array([7, 2])}))
        self.assertEqual(mesh.nodes.shape, (5, 3), "a node that no tetrahedron uses stays away")
        self.assertEqual(mesh.volumes, ("soft", "hard"))
        self.assertEqual(mesh.volume_of.tolist(), [1, 0])
        self.assertEqual(mesh.surface_nodes("cut").tolist(), [1, 2, 3])
        plain = sunder.Mesh.of(block(points=NODES, cells={"tetra": TETS}))
        self.assertEqual((plain.tets.tolist(), plain.volumes), (TETS, ("volume",)))


if __name__ == "__main__":
    unittest.main()
