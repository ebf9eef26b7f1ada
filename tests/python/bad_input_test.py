# SPDX-License-Identifier: Apache-2.0
"""What is wrong is refused in one sentence, and what was there before goes on."""
import pathlib
import tempfile
import unittest

import numpy as np
import sunder
from support import NODES, SCENES, TETS, two_tets

GOOD = {"mesh": (NODES, TETS), "material": {"volume": {"young": 5, "poisson": 0.3}},
        "fixed": [{"nodes": [0, 2, 3]}],
        "instrument": [{"kind": "expansion", "nodes": [4], "force": [1, 0, 0]}]}


class Arrays(unittest.TestCase):
    def refused(self, part, **mesh):
        with self.assertRaises(sunder.InputError) as caught:
            sunder.Mesh(**{"nodes": NODES, "tets": TETS, **mesh})
        self.assertIn(part, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_types(self):
        self.refused("the type <U1", nodes=[["a", "b", "c"]])
        self.refused("the type complex128", nodes=np.array(NODES, complex))
        self.refused("the type float64; allowed are whole numbers", tets=np.array(TETS, float))
        self.refused("the type bool", tets=np.array(TETS, bool))
        self.refused("the type object", nodes=np.array([[None, 1, 2]]))
        self.refused("32 bits do not hold", tets=np.array(TETS, np.int64) + 2**40)
        self.refused("nodes: not an array of numbers", nodes=[[1, 2], [3]])

    def test_shapes(self):
        self.refused("the shape (15,); allowed is (any, 3)", nodes=np.ravel(NODES))
        self.refused("the shape (5, 2); allowed is (any, 3)", nodes=np.array(NODES)[:, :2])
        self.refused("the shape (2, 3); allowed is (any, 4)", tets=np.array(TETS)[:, :3])
        self.refused("the shape (3,); allowed is (2)", volume_of=[0, 0, 0])
        self.refused("an index outside 0 to 0", volume_of=[0, 1])
        self.refused("a name twice", volumes=("a", "a"))

    def test_not_finite(self):
        for value, text in ((np.nan, "nan"), (np.inf, "inf")):
            nodes = np.array(NODES, float)
            nodes[3, 1] = value
            self.refused(f"nodes has {text} at (3, 1); allowed are finite numbers", nodes=nodes)

    def test_not_contiguous_and_read_only_ones_are_read(self):
        wide = np.zeros((5, 6))
        wide[:, ::2] = NODES
        fortran = np.asfortranarray(np.array(TETS, np.int64))
        for nodes, tets in ((wide[:, ::2], fortran), (np.array(NODES, np.float32), np.array(TETS, np.uint8)),
                            (np.array(NODES, ">f8"), np.array(TETS, ">i4"))):
            nodes.flags.writeable = tets.flags.writeable = False
            mesh = sunder.Mesh(nodes, tets)
            np.testing.assert_array_equal(mesh.nodes, NODES)
            np.testing.assert_array_equal(mesh.tets, TETS)

    def test_fields(self):
        with sunder.Simulation(SCENES / "motion/board.toml") as simulation:
            good = simulation.velocity()
            for wrong in (good[:-1], good.ravel(), good.astype(complex), np.full_like(good, np.nan)):
                with self.assertRaises(sunder.InputError):
                    simulation.set_velocity(wrong)
            with self.assertRaises(sunder.AllowedError):
                simulation.step_by(-1.0)
            with self.assertRaises(sunder.AllowedError):
                simulation.step_by(float("nan"))
            simulation.step()


class Scenes(unittest.TestCase):
    def refused(self, part, keys=None, error=sunder.InputError, source=GOOD):
        with self.assertRaises(error) as caught:
            sunder.Simulation(sunder.Scene(source, set=keys or {}))
        self.assertIn(part, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_keys(self):
        self.refused('unknown key "colour"', {"colour": 1})
        self.refused('unknown key "material.yeild"', {"material.volume.yeild": 1})
        self.refused('unknown key "fracture.models"', {"fracture.models": "A"})
        self.refused('unknown key "fixed.nods"', {"fixed.0.nods": [1]})
        self.refused("has no young", {"material": {"volume": {"poisson": 0.3}}})
        self.refused("instrument has no kind", {"instrument": [{"nodes": [1], "force": [1, 0, 0]}]})
        self.refused("'7' is no index here", {"instrument.7.force": [1, 0, 0]})
        self.refused("fracture is not a table", {"fracture": 3})
        self.refused("fixed is not an array of tables", {"fixed": {"nodes": [1]}})

    def test_values(self):
        self.refused("fracture.model is 'C'; allowed are \"none\", \"A\"", {"fracture.model": "C"})
        self.refused("solver.prepare is 1", {"solver.prepare": 1})
        self.refused("fracture.contact is 1", {"fracture.contact": 1})
        self.refused("contact", {"fracture.contact": True})  # without cracks that split
        self.refused("steps has the type", {"time.steps": 1.5})
        self.refused("solver.tolerance has nan", {"solver.tolerance": float("nan")})
        self.refused("force of instrument None has the shape (2,)", {"instrument.0.force": [1, 2]})
        self.refused("has force and displacement", {"instrument.0.displacement": [1, 0, 0]})
        self.refused("axes of a support is 'xx'", {"fixed.0.axes": "xx"})
        self.refused("young", {"material.volume.young": -5})
        self.refused("yield is 0; allowed are numbers above 0", {"material.volume.yield": 0})
        self.refused("selects by nodes and box", {"fixed.0.box": [[0, 0, 0], [1, 1, 1]]})
        self.refused("near and radius come together", {"fixed": [{"near": [0, 0, 0]}]})
        self.refused('no surface "skin"', {"fixed": [{"surface": "skin"}]})
        self.refused("node", {"fixed.0.nodes": [99]})
        self.refused('material "tissue": the mesh has no such volume',
                     {"material.tissue": {"young": 1, "poisson": 0.3}})
        fibres = "material.volume.fibres"
        self.refused("lacks young_along", {fibres: {"direction": [1, 0, 0]}})
        self.refused("is not a dict, or a list of them", {fibres: 3})
        self.refused("has direction and field; allowed is one of them",
                     {fibres: {"direction": [1, 0, 0], "field": np.ones((2, 3))}})
        self.refused("has no direction, around, curve or field", {fibres: {"k1": 1}})
        self.refused("takes point and axis", {fibres: {"around": {"axis": [0, 0, 1]}}})
        self.refused("needs two points or more", {fibres: {"curve": [[1, 2, 3]]}})
        self.refused("has a point twice in a row", {fibres: {"curve": [[1, 2, 3], [1, 2, 3]]}})
        self.refused("which the mesh has not", {fibres: {"direction": [1, 0, 0], "surface": "no"}})
        self.refused("goes with direction only", {fibres: {"curve": [[0, 0, 0], [1, 0, 0]], "surface": "no"}})
        self.refused("which the program alone looks up", {fibres: {"field": "helix"}})
        self.refused("allowed is (any, 3)", {fibres: {"field": np.ones((2, 2))}})
        self.refused("which has 5 vectors for 2 elements",
                     {fibres: {"field": np.ones((5, 3)), "young_along": 9, "shear_along": 3,
                               "poisson_along": 0.3}})
        self.refused("k1 of fibres 0", {fibres: {"direction": [1, 0, 0], "k1": 0}})
        self.refused("k_1", {fibres: {"direction": [1, 0, 0], "k_1": 1}})
        self.refused('preset is "stone"; allowed: ', {"material.volume.preset": "stone"}, sunder.Error)
        self.refused("is not held", {"fixed": []})

    def test_no_such_route_and_no_accuracy(self):
        self.refused("cpu", {"solver.backend": "cpu", "solver.precision": "fp32"}, sunder.DeviceError)
        scene = sunder.Scene(GOOD, set={"solver.tolerance": 1e-300, "solver.backend": "cpu"})
        with sunder.Simulation(scene) as simulation, self.assertRaises(sunder.NumericalError) as caught:
            simulation.step()
        self.assertEqual(caught.exception.status, 5)
        self.assertIsInstance(caught.exception, ArithmeticError)

    def test_sources(self):
        self.refused("No such file", source="nowhere.toml")
        self.refused("not int", source=7)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.toml"
            for text, part in (("mesh = ", "not valid TOML"), ("mesh = 'none.msh'", "No such file"),
                               ("mesh = 'none.vtk'", "only .msh is read"), ("", "no mesh"),
                               ("mesh = ''", "mesh is empty")):
                path.write_text(text, encoding="utf-8")
                self.refused(part, source=path)

    def test_meshes_that_are_cut_off_or_none(self):
        whole = (SCENES / "meshes/board1954.msh").read_bytes()
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "m.msh"
            for data in (b"", b"nothing", whole[:200], whole[:20000], whole[:-20000],
                         whole.replace(b"2.2 0 8", b"3.0 0 8"), whole.replace(b"$Elements", b"$Elephant"),
                         whole.replace(b"\n1 0 0 0\n", b"\n1 0 x 0\n")):
                path.write_bytes(data)
                with self.assertRaises(sunder.InputError) as caught:
                    sunder.Mesh.read(path)
                self.assertIn("m.msh", str(caught.exception))

    def test_a_failed_call_changes_nothing(self):
        with two_tets() as scene:
            for wrong in (lambda: scene.add_instrument("x", force=[np.nan, 0, 0], nodes=[1]),
                          lambda: scene.add_support(nodes=[1.5]),
                          lambda: scene.add_material(young="stiff", poisson=0.3),
                          lambda: scene.set_steps(0), lambda: scene.set_gravity([0, 0])):
                with self.assertRaises(sunder.Error):
                    wrong()
            self.assertEqual(scene.instruments, ["forceps"])
            with sunder.Simulation(scene) as simulation:
                self.assertEqual(len(simulation.run()), 1)


if __name__ == "__main__":
    unittest.main()
