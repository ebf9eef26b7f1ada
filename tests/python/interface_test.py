# SPDX-License-Identifier: Apache-2.0
"""Interfaces by Python: a body that parts by hand values, the same from a dict, what is refused."""
import unittest

import numpy as np
import sunder
from support import NODES, TETS

STRENGTH, ENERGY = 0.2, 0.05  # MPa, N/mm
MESH = sunder.Mesh(NODES, TETS, [0, 1], ("skin", "muscle"),
                   {"outside": np.array([[1, 4, 2], [1, 3, 4], [4, 3, 2]])})
AREA = 3 ** 0.5 / 2  # mm^2, of the face that both share
AWAY = np.ones(3) / 3 ** 0.5  # across it, to the muscle


def tree(**interface):
    rows = {"between": ["skin", "muscle"], "strength": STRENGTH, "energy": ENERGY, **interface}
    tissue = {"young": 500, "poisson": 0.3, "law": "neo-hookean"}
    return {"mesh": MESH, "material": {"muscle": tissue, "skin": tissue},
            "fixed": [{"nodes": [1, 2, 3]}], "fracture": {"model": "A"},
            "solver": {"backend": "cpu"}, "time": {"steps": 3},
            # All of the muscle's surface but the face itself: its copies of 1, 2 and 3 too.
            "instrument": [{"kind": "expansion", "name": "forceps", "surface": "outside",
                            "displacement": list(0.9 * AWAY), "ramp": [0, 1]}],
            "interface": [rows]}


class Interfaces(unittest.TestCase):
    def test_part_by_hand_values(self):
        with sunder.Simulation(tree()) as simulation:
            self.assertEqual(len(simulation.mesh.nodes), 8)
            self.assertEqual(len(simulation.mesh.tets), 5)
            self.assertEqual(simulation.mesh.volumes, ("skin", "muscle", "interface-0"))
            self.assertEqual(simulation.mesh.volume_of.tolist(), [0, 1, 2, 2, 2])
            self.assertEqual(simulation.body_parents()[:5].tolist(), [0, 1, 2, 3, 4])
            self.assertEqual(sorted(simulation.body_parents()[5:]), [1, 2, 3])
            np.testing.assert_array_equal(simulation.mesh.nodes[:5], NODES)
            one = simulation.interfaces()[0]
            self.assertEqual(one["materials"].tolist(), [1, 0], "as they were added")
            self.assertAlmostEqual(one["area"], AREA, delta=1e-4 * AREA)
            simulation.step()  # 0.3 mm of 0.5
            self.assertEqual(simulation.displacement().shape, (8, 3))
            force = simulation.reactions()[0] @ AWAY
            self.assertAlmostEqual(force / AREA, 0.3 * STRENGTH ** 2 / (2 * ENERGY), delta=0.01)
            self.assertEqual(len(simulation.events()), 0)
            simulation.run()
            events = simulation.events()
            self.assertEqual({sunder.cause_name(cause) for cause in events["cause"]}, {"interface"})
            self.assertEqual(sorted(events["element"]), [2, 3, 4])
            one = simulation.interfaces()[0]
            self.assertAlmostEqual(one["parted"], one["area"], places=12)
            self.assertAlmostEqual(one["spent"], ENERGY * AREA, delta=0.02 * ENERGY * AREA)
            self.assertAlmostEqual(events["energy"].sum(), one["spent"], places=15)
            self.assertEqual(simulation.view("destroyed").tolist(), [False, False, True, True, True])

    def test_of_a_dict_are_those_of_the_calls(self):
        keys = tree()
        with sunder.Scene(mesh=MESH) as scene:
            for name in keys["material"]:
                scene.add_material(name, **keys["material"][name])
            scene.add_support(nodes=[1, 2, 3])
            scene.add_instrument(displacement=0.9 * AWAY, surface="outside", ramp=[0, 1])
            scene.add_interface(("skin", "muscle"), strength=STRENGTH, energy=ENERGY)
            scene.set_fracture(model="A")
            scene.set_solver(backend="cpu")
            scene.set_steps(3)
            with sunder.Simulation(scene) as by_calls, sunder.run(keys) as by_keys:
                by_calls.run()
                self.assertEqual(by_calls.displacement().tolist(), by_keys.displacement().tolist())

    def test_volumes_go_by_their_place_where_materials_have_no_name(self):
        with sunder.Scene(mesh=MESH) as scene:
            scene.add_material(young=5, poisson=0.3)
            with self.assertRaisesRegex(sunder.InputError, "'muscle' has no material yet"):
                scene.add_interface(("skin", "muscle"), strength=1, energy=1)
            scene.add_material(young=5, poisson=0.3)
            scene.add_support(nodes=[1, 2, 3])
            scene.add_interface(("skin", "muscle"), strength=1, energy=1)
            with sunder.Simulation(scene) as simulation:
                self.assertEqual(simulation.interfaces()["materials"].tolist(), [[0, 1]])

    def test_what_is_refused(self):
        for part, keys in (("strength = 0; it must be finite and above 0 MPa", {"strength": 0}),
                           ("shear_ratio = -1", {"shear_ratio": -1}),
                           ("has nan at", {"energy": float("nan")}),
                           ("names volume 'bone'; there are", {"between": ["skin", "bone"]}),
                           ("allowed are the names of two volumes", {"between": ["skin"]}),
                           ("the same volume on both sides", {"between": ["skin", "skin"]}),
                           ("unknown key \"interface.width\"", {"width": 1})):
            with self.subTest(part), self.assertRaises(sunder.InputError) as caught:
                sunder.Simulation(tree(**keys)).close()
            self.assertIn(part, str(caught.exception))
        missing = tree()
        del missing["interface"][0]["energy"]
        with self.assertRaisesRegex(sunder.InputError, "interface has no energy"):
            sunder.Scene(missing)


if __name__ == "__main__":
    unittest.main()
