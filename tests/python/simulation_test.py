# SPDX-License-Identifier: Apache-2.0
"""Simulations: fields, records, callbacks, what the C interface has."""
import concurrent.futures
import ctypes as c
import gc
import io
import os
import pathlib
import re
import sys
import tempfile
import threading
import time
import types
import unittest
from unittest import mock

import numpy as np
import sunder
from sunder import _c
from support import SCENES, SOURCE, program_run, two_tets

# Not of Python: a host's own Vulkan device, what stands in for macros and struct sizes.
NOT_WRAPPED = {"sunder_status_text", "sunder_error_of"}


class Fields(unittest.TestCase):
    def test_pulls_as_hooke_says(self):
        # A bar of 1 x 1 x 4 in 24 tetrahedra, pulled at its end, poisson 0: u = F z / (E A).
        nodes = np.array([[x, y, z] for z in range(5) for y in range(2) for x in range(2)], float)
        six = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]])
        tets = np.concatenate([six + 4 * z for z in range(4)])
        # Nodal forces of an even traction: each end face is two triangles, corners 0 and 3 have both.
        with sunder.Scene(mesh=(nodes, tets)) as scene:
            scene.add_material(young=8, poisson=0)
            scene.add_support(nodes=[0, 1, 2, 3])
            for name, ids, force in (("both", [16, 19], 2 * 0.1 / 3), ("one", [17, 18], 0.1 / 3)):
                scene.add_instrument(name, force=[0, 0, force], nodes=ids)
            with sunder.Simulation(scene) as simulation:
                simulation.step()
                u, stress = simulation.displacement(), simulation.stress()
                reaction = simulation.support_reaction()
        np.testing.assert_allclose(u[:, 2], 0.1 * nodes[:, 2] / 8, atol=1e-12)
        np.testing.assert_allclose(u[:, :2], 0, atol=1e-12)
        np.testing.assert_allclose(stress[:, 2], 0.1, atol=1e-12)
        np.testing.assert_allclose(reaction, [0, 0, -0.1], atol=1e-12)

    def test_out_takes_what_the_library_writes(self):
        with sunder.Simulation(two_tets()) as simulation:
            simulation.step()
            for name, shape, kind in (("displacement", (5, 3), "f8"), ("stress", (2, 6), "f8"),
                                      ("max_shear", (2,), "f8"), ("yield_ratio", (2,), "f8"),
                                      ("destroyed", (2,), "?"), ("reactions", (1, 3), "f8"),
                                      ("support_reaction", (3,), "f8"), ("body_corners", (2, 4), "i4"),
                                      ("body_parents", (5,), "i4"), ("body_displacement", (5, 3), "f8")):
                with self.subTest(name):
                    field = getattr(simulation, name)
                    mine = np.zeros(shape, kind)
                    self.assertIs(field(out=mine), mine)
                    new = field()
                    self.assertEqual((new.shape, new.dtype), (shape, np.dtype(kind)))
                    self.assertTrue((new == mine).all())
                    for wrong in (np.zeros(shape, "f4"), np.zeros(shape + (1,), kind),
                                  np.zeros((*shape, 2), kind)[..., 0], mine.tolist()):
                        with self.assertRaises(sunder.InputError):
                            field(out=wrong)
                    mine.flags.writeable = False
                    with self.assertRaisesRegex(sunder.InputError, "read-only"):
                        field(out=mine)

    def test_views_are_the_librarys_memory(self):
        with sunder.Simulation(two_tets(force=1, steps=3)) as simulation:
            simulation.step()
            for name in ("displacement", "stress", "max_shear", "yield_ratio", "destroyed"):
                with self.subTest(name):
                    view = simulation.view(name)
                    read = getattr(simulation, name)()
                    self.assertEqual((view.shape, view.dtype), (read.shape, read.dtype))
                    self.assertTrue((view == read).all())
                    self.assertFalse(view.flags.owndata or view.flags.writeable)
                    self.assertEqual(view.ctypes.data, simulation.view(name).ctypes.data)
            with self.assertRaisesRegex(sunder.InputError, "allowed are displacement, velocity"):
                simulation.view("pressure")
            with self.assertRaises(sunder.OrderError):
                simulation.view("velocity")

    def test_views_stay_through_steps_and_after_the_end(self):
        simulation = sunder.Simulation(two_tets(force=1, steps=3))
        simulation.drive(0, [1, 0, 0])
        simulation.step()
        view = simulation.view("displacement")
        first = view.copy()
        simulation.drive(0, [2, 0, 0])
        simulation.step()
        self.assertTrue((view == first).all())
        simulation.view("displacement")
        np.testing.assert_allclose(view, 2 * first, rtol=1e-9)
        number = simulation.handle
        simulation.close()
        with self.assertRaises(sunder.HandleError):
            simulation.view("displacement")
        np.testing.assert_allclose(view, 2 * first, rtol=1e-9)
        self.assertEqual(_c.library.sunder_simulation_cancel(number), 0)  # the view keeps it
        del view
        self.assertNotEqual(_c.library.sunder_simulation_cancel(number), 0)

    def test_bodies_in_common_change_nothing(self):
        def made(**bodies):
            with sunder.Scene(SCENES / "board-pull-b.toml",
                              set={"solver.backend": "cpu", "solver.route": "inverse"}) as scene:
                simulation = sunder.Simulation(scene, **bodies)
                simulation.step()
                return simulation
        with sunder.Bodies() as bodies:
            first, second = made(bodies=bodies), made(bodies=bodies)
        alone = made()
        for simulation in (first, second):
            self.assertTrue((simulation.displacement() == alone.displacement()).all())
            simulation.close()
        alone.close()
        with self.assertRaisesRegex(sunder.HandleError, "closed"):
            made(bodies=bodies)
        with self.assertRaisesRegex(sunder.Error, "most is 0; allowed is 1 or more"):
            sunder.Bodies(0)

    def test_what_tore_is_what_the_program_says(self):
        with tempfile.TemporaryDirectory() as folder:
            path = SCENES / "board-pull-b.toml"
            summary, _, events = program_run(path, pathlib.Path(folder), "--backend", "cpu", "--steps", "20")
        with sunder.run(path, set={"time.steps": 20, "solver.backend": "cpu"}) as simulation:
            mine, cracks, tips = simulation.events(), simulation.cracks(), simulation.tips()
            self.assertEqual(len(mine), len(events))
            for event, row in zip(mine, events):
                self.assertEqual(str(event["element"]), row["element"])
                self.assertEqual(sunder.cause_name(event["cause"]), row["criterion"])
                self.assertEqual(event["load_factor"], float(row["load_factor"]))
                if row["K"]:
                    self.assertEqual(event["k"], float(row["K"]))
            (crack,) = summary["cracks"]
            self.assertEqual(cracks["length"].tolist(), [crack["length"]])
            np.testing.assert_array_equal(simulation.crack_path(0), crack["path_xyz"])
            self.assertEqual(len(simulation.crack_elements(0)), cracks["element_count"][0])
            self.assertEqual(len(tips), 1)
            self.assertEqual(simulation.warnings, [w for w in summary["warnings"] if "GPU" not in w])
            self.assertEqual(np.flatnonzero(simulation.destroyed()).tolist(), sorted(summary["destroyed"]))
            self.assertEqual(simulation.engine["route"], "inverse")
            np.testing.assert_array_equal(simulation.reactions()[0], summary["reactions"]["right forceps"])

    def test_split_cracks_bring_nodes(self):
        with sunder.run(SCENES / "split/board-split.toml", set={"time.steps": 40}) as simulation:
            body = simulation.body
            self.assertGreater(body["node_count"], len(simulation.mesh.nodes))
            faces, parents = simulation.crack_faces(), simulation.body_parents()
            self.assertEqual(faces.shape, (body["crack_face_count"], 7))
            # Both lips lie at the same places.
            np.testing.assert_array_equal(parents[faces[:, 1:4]], parents[faces[:, 4:]])
            self.assertTrue((simulation.events()["lives"] == 1).any())

    def test_a_blade_opens_split_bodies(self):
        with sunder.Simulation(SCENES / "split/board-split.toml") as simulation:
            simulation.keep_history()
            nodes = simulation.mesh.nodes
            low, high = nodes.min(axis=0), nodes.max(axis=0)
            x, y = (low[0] + 0.3 * (high[0] - low[0])), 0.45 * (low[1] + high[1])
            # Two places of a blade that stands across the board: two triangles.
            a, b = [low[0] - 1, y, low[2] - 1], [low[0] - 1, y, high[2] + 1]
            c, d = [x, y, low[2] - 1], [x, y, high[2] + 1]
            opened = simulation.cut([[a, b, c], [b, d, c]])
            self.assertGreater(opened, 0)
            body = simulation.body
            self.assertEqual(body["crack_face_count"], opened)
            self.assertGreater(body["node_count"], len(nodes))
            self.assertFalse(simulation.destroyed().any())
            faces, parents = simulation.crack_faces(), simulation.body_parents()
            np.testing.assert_array_equal(parents[faces[:, 1:4]], parents[faces[:, 4:]])
            surface = simulation.surface()
            self.assertEqual(int(simulation.surface_changes()["opened"].sum()), 2 * opened)
            simulation.step()
            moved = simulation.body_displacement()
            self.assertEqual(moved.shape, (simulation.body["node_count"], 3))
            self.assertTrue(np.isfinite(moved).all())
            while simulation.history()[0] > 0:
                simulation.undo()
            self.assertEqual(simulation.body["node_count"], len(nodes))
            self.assertGreater(simulation.surface()["version"], surface["version"])
            self.assertEqual(simulation.surface_changes()["opened"].sum(), 0)
            with self.assertRaises(sunder.Error):
                simulation.cut([[a, b, [x, y, float("nan")]]])
            with self.assertRaises(sunder.Error):  # it lies along the board's plane
                z = (low[2] + high[2]) / 2
                simulation.cut([[[0, 0, z], [9, 0, z], [0, 9, z]]])

    def test_motion(self):
        with sunder.Simulation(sunder.Scene(SCENES / "motion/board.toml")) as simulation:
            first = simulation.step()
            self.assertEqual((first.moves, simulation.velocity().shape), (1, simulation.displacement().shape))
            simulation.set_velocity(np.zeros_like(simulation.velocity()))
            self.assertEqual(abs(simulation.velocity()).max(), 0)
            second = simulation.step_by(1e-4)
            self.assertAlmostEqual(second.time, first.time + 1e-4, places=12)

    def test_grips_answer_beside_the_steps(self):
        with sunder.Simulation(SCENES / "board-grip-b.toml") as simulation:
            step = simulation.step()
            with simulation.grips() as grips:
                at = np.array([[0, -28 / 50 / 0.9, 0]])
                self.assertEqual(step.load_factor, 1 / 50)
                np.testing.assert_allclose(grips.forces(at), simulation.reactions(), rtol=1e-9)
                np.testing.assert_allclose(grips.forces(2 * at), 2 * simulation.reactions(), rtol=1e-6)
            with self.assertRaises(sunder.HandleError):
                grips.forces(at)

    def test_by_hand(self):
        with sunder.Simulation(two_tets(force=1, steps=3)) as simulation:
            simulation.step()
            one = simulation.displacement()
            simulation.drive("forceps", [3, 0, 0])
            simulation.step()
            np.testing.assert_allclose(simulation.displacement(), 3 * one, rtol=1e-12)
            with self.assertRaisesRegex(sunder.InputError, "no instrument"):
                simulation.drive("scalpel", [1, 0, 0])
            with self.assertRaises(sunder.AllowedError):
                simulation.drive(1, [1, 0, 0])
            with self.assertRaises(sunder.AllowedError):
                simulation.turn(0, [1, 0, 0])

    def test_a_grip_of_the_scene_lets_go(self):
        with sunder.Simulation(two_tets(force=1, steps=2)) as simulation:
            simulation.run()
            never_held = simulation.displacement()
        scene = two_tets(force=1, steps=100)
        scene.add_instrument("clamp", displacement=[0.1, 0, 0], nodes=[1])
        scene.set_live()
        with sunder.Simulation(scene) as simulation:
            simulation.step()
            np.testing.assert_allclose(simulation.displacement()[1], [0.1, 0, 0])
            self.assertGreater(abs(simulation.reactions()[1]).max(), 0.1)
            simulation.release(1)
            simulation.step()
            self.assertEqual(abs(simulation.reactions()[1]).max(), 0)
            np.testing.assert_allclose(simulation.displacement(), never_held, rtol=1e-9)

    def test_a_live_body(self):
        # Three layers of six tetrahedra, held below.
        nodes = np.array([[x, y, z] for z in range(4) for y in range(2) for x in range(2)], float)
        six = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]])
        with sunder.Scene(mesh=(nodes, np.concatenate([six + 4 * z for z in range(3)]))) as scene:
            scene.add_material(young=8, poisson=0)
            scene.add_support(nodes=[0, 1, 2, 3])
            scene.set_live()
            scene.set_solver(backend="cpu")
            scene.set_steps(1000)
            simulation = sunder.Simulation(scene)
        with simulation as s:
            s.warm_up()
            s.keep_history()
            start = s.save()
            grips = s.grips()
            grip = s.grasp([12, 13, 14, 15], rigid=True)
            np.testing.assert_array_equal(s.held_nodes(grip), [12, 13, 14, 15])
            np.testing.assert_allclose(s.grip_place(grip), [0.5, 0.5, 3])
            self.assertEqual(grips.feel({grip: [0.5, 0.5, 3.3]})[1].state, "waiting")
            frames = s.frames("displacement", "destroyed", nodes=[15, 0])
            self.assertEqual(frames.take()[0], -1)
            with self.assertRaises(sunder.InputError):
                s.frames("colour")
            s.pose(grip, [0.5, 0.5, 3.3], [0, 0, 0, 2])
            s.step()
            step, fields = frames.take()
            self.assertEqual(step, 0)
            np.testing.assert_allclose(fields["displacement"], [[0, 0, 0.3], [0, 0, 0]], atol=1e-9)
            self.assertFalse(fields["destroyed"].any())
            # Twice as far as it is: twice the force.
            grips.blend(2)
            held, felt = grips.feel({grip: ([0.5, 0.5, 3.6], [0, 0, 0, 1]), 99: [0, 0, 0]})
            self.assertEqual((felt.state, felt.step, felt.share), ("live", 0, 1))
            self.assertEqual(list(held), [grip])
            np.testing.assert_allclose(held[grip][0], [0, 0, 1.6], atol=1e-9)
            with self.assertRaises(sunder.AllowedError):
                grips.feel({grip: ([0.5, 0.5, 3], [0, 0, 0, 0])})
            with self.assertRaises(sunder.AllowedError):
                grips.blend(-1)
            # Hooke, poisson 0: the face is 1 mm^2 and 3 mm long, by .3 mm: .8 N.
            force, torque = s.wrench(grip)
            np.testing.assert_allclose(force, [0, 0, 0.8], atol=1e-9)
            np.testing.assert_allclose(torque, 0, atol=1e-9)
            np.testing.assert_allclose(s.displacement()[:, 2], 0.1 * nodes[:, 2], atol=1e-9)
            other = s.grasp(near=[0, 0, 2.2], radius=0.3)
            np.testing.assert_array_equal(s.held_nodes(other), [8])
            with self.assertRaises(sunder.OrderError):
                s.grasp([8])
            with self.assertRaises(sunder.InputError):
                s.grasp([8], near=[0, 0, 0])
            with self.assertRaises(sunder.AllowedError):
                s.pose(grip, [0, 0, 3], [0, 0, 0, 0])
            s.release(other)
            s.release(grip)
            self.assertEqual(grips.feel({grip: [0.5, 0.5, 3.6]})[0], {})
            push = s.push([12, 13, 14, 15], [0, 0, 0.4])
            s.move(push, [12, 15], [0, 0, 0.4])
            s.step()
            self.assertGreater(s.displacement()[12, 2], 0.1)
            s.drop(push)
            self.assertEqual(s.prepare([0]), 1)
            near = s.prepare(near=[0.5, 0.5, 0.5], radius=0.9)
            self.assertGreater(near, 1)
            s.remove([0])
            self.assertEqual(s.prepare(near=[0.5, 0.5, 0.5], radius=0.9), near - 1)
            with self.assertRaises(sunder.InputError):
                s.prepare([0], near=[0, 0, 0])
            self.assertEqual(s.history(), (7, 0))
            self.assertEqual(s.undo(), (1, False))
            self.assertEqual(s.redo(), 1)
            surface = s.surface()
            triangles = s.surface_changes()
            self.assertEqual(len(triangles), surface["triangle_count"])
            self.assertNotIn(0, triangles["element"])
            places, normals = s.surface_points()
            self.assertEqual(places.shape, normals.shape)
            s.set_skin([[0.5, 0.5, 2.5]])
            (at,), (lives,) = s.skin()
            self.assertTrue(lives)
            self.assertGreater(s.cut([[[-1, -1, 2.5], [2, -1, 2.5], [-1, 4, 2.5]]]), 0)
            stored = s.store()
            gone = s.destroyed()
            self.assertFalse(s.restore(start))
            self.assertFalse(s.destroyed().any())
            s.load(stored)
            np.testing.assert_array_equal(s.destroyed(), gone)
            s.forget(start)
            self.assertEqual(s.step_within(1000).out_of_time, 0)

    def test_a_picture(self):
        with tempfile.TemporaryDirectory() as folder, sunder.Simulation(two_tets()) as simulation:
            simulation.step()
            for field in ("max_shear", "yield_ratio", "displacement"):
                path = pathlib.Path(folder) / f"{field}.png"
                simulation.plot(field=field, path=path)
                self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
            with self.assertRaisesRegex(sunder.InputError, "field is 'colour'"):
                simulation.plot(field="colour")


class Running(unittest.TestCase):
    def test_callbacks_see_the_phases_and_can_cancel(self):
        seen, logged = [], []
        with sunder.Simulation(two_tets(model="A"), log=lambda level, text: logged.append((level, text)),
                               progress=lambda p: seen.append(p["phase"])) as simulation:
            simulation.step()
        self.assertEqual(seen[:2], [0, 1])
        self.assertIn(2, seen)
        with self.assertRaises(sunder.Cancelled):
            sunder.Simulation(two_tets(), progress=lambda p: True)

    def test_what_a_callback_raises_comes_out(self):
        def fail(progress):
            raise KeyError("mine")
        with self.assertRaisesRegex(KeyError, "mine"):
            sunder.Simulation(two_tets(), progress=fail)

    def test_done_closed_and_out_of_order(self):
        simulation = sunder.Simulation(two_tets())
        simulation.step()
        with self.assertRaises(sunder.OrderError):
            simulation.step()
        with self.assertRaises(sunder.OrderError):
            simulation.velocity()
        simulation.close()
        simulation.close()
        for use in (simulation.step, simulation.displacement, simulation.events, lambda: simulation.body):
            with self.assertRaises(sunder.HandleError):
                use()
        scene = two_tets()
        scene.close()
        with self.assertRaises(sunder.HandleError):
            scene.set_steps(2)

    def test_many_threads_at_once(self):
        def work(force):
            with sunder.Simulation(two_tets(force=force, steps=40)) as simulation:
                for _ in simulation.steps():
                    view = simulation.view("displacement")
                    simulation.stress()
            return view.copy()
        forces = [0.1, 0.2, 0.3, 0.4] * 4
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            ends = list(pool.map(work, forces))
        for force, end in zip(forces, ends):
            self.assertTrue((end == ends[forces.index(force)]).all())
            np.testing.assert_allclose(end, ends[0] * force / forces[0], rtol=1e-9)

    def test_progress_on_a_terminal_in_a_notebook_and_in_a_file(self):
        class Stream(io.StringIO):
            terminal = False

            def isatty(self):
                return self.terminal

        def shown(terminal, notebook):
            stream = Stream()
            stream.terminal = terminal
            modules = {"ipykernel": types.ModuleType("ipykernel")} if notebook else {}
            with mock.patch.object(sys, "stderr", stream), mock.patch.dict(sys.modules, modules), \
                    mock.patch("sunder._progress._SECONDS", 0), \
                    sunder.Simulation(two_tets(force=1, steps=3)) as simulation:
                self.assertEqual(len(simulation.run(progress=True)), 3)
            return stream.getvalue()
        terminal = shown(True, False)
        self.assertRegex(terminal, r"\r.*: step 3, 0 destroyed, [\d.e+]+ steps/s\x1b\[K")
        self.assertTrue(terminal.endswith("\r\x1b[K"), "the line is not taken away at the end")
        notebook = shown(False, True)
        self.assertRegex(notebook, r"step 3, 0 destroyed")
        self.assertNotIn("\x1b", notebook)
        self.assertEqual(shown(False, False), "")

    def test_a_second_thread_finds_it_busy_and_the_lock_is_free_meanwhile(self):
        scene = sunder.Scene(SCENES / "finite/liver.toml", set={"solver.backend": "cpu"})
        with scene, sunder.Simulation(scene) as simulation:
            def step():  # which may itself find the handle taken by the other thread's call
                while True:
                    try:
                        return simulation.step()
                    except sunder.BusyError:
                        continue

            thread = threading.Thread(target=step)
            busy, counted = 0, 0
            thread.start()
            while thread.is_alive():
                counted += 1
                try:
                    simulation.warnings
                except sunder.BusyError:
                    busy += 1
            thread.join()
        self.assertGreater(counted, 10, "Python stood still while the library computed")
        self.assertGreater(busy, 0)

    def test_nothing_is_left_behind(self):
        def resident():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        def work(times):
            for _ in range(times):
                with sunder.run(SCENES / "notch-b.toml", set={"time.steps": 1}) as simulation:
                    simulation.events(), simulation.stress(), simulation.view("stress")
                sunder.Simulation(two_tets()).step()  # given back without close()
            gc.collect()
        work(5)
        before = resident()
        work(25)
        # One of these bodies takes 20 MB and more.
        self.assertLess(resident() - before, 30e6)

    def test_a_step_costs_what_the_frame_costs(self):
        # Beside the same call by ctypes alone; the least of several, since others compute here too.
        step_of_c = _c.library.sunder_simulation_step
        count, ours, bare = 300, [], []  # shorter than a slice of a busy processor's time
        with sunder.Simulation(two_tets(force=1, steps=2**31 - 1)) as simulation:
            struct, handle = _c.structs["sunder_step"](), simulation.handle
            address = c.byref(struct)
            for _ in range(120):
                start = time.perf_counter()
                for _ in range(count):
                    simulation.step()
                middle = time.perf_counter()
                for _ in range(count):
                    step_of_c(handle, address)
                ours.append((middle - start) / count)
                bare.append((time.perf_counter() - middle) / count)
        over = (min(ours) - min(bare)) * 1e6
        print(f"\na step of two tetrahedra: {min(ours) * 1e6:.2f} us, by ctypes alone "
              f"{min(bare) * 1e6:.2f} us: {over:.2f} us over it", end=" ")
        self.assertLess(over, 10)

    def test_every_function_of_the_header_is_used(self):
        text = "".join(p.read_text(encoding="utf-8")
                       for p in pathlib.Path(sunder.__file__).parent.glob("*.py"))
        used = set(re.findall(r"\b(sunder_\w+)\b", text))
        used |= {f"{name}_init" for name in used}
        left = set(_c.header.functions) - used - NOT_WRAPPED
        self.assertEqual(left, set())
        header = (SOURCE / "api/sunder/sunder.h").read_text(encoding="utf-8")
        self.assertEqual(set(re.findall(r"SUNDER_API [\w* ]+?\*?(sunder_\w+)\(", header)),
                         set(_c.header.functions))


if __name__ == "__main__":
    unittest.main()
