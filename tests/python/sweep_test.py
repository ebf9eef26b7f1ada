# SPDX-License-Identifier: Apache-2.0
"""sunder.sweep: by threads, by a Dask cluster, one of whose workers is killed; what is wrong."""
import os
import pathlib
import signal
import tempfile
import threading
import time
import unittest

import numpy as np
import sunder
from support import NODES, SCENES, TETS, program_run

SCENE = SCENES / "board-pull-b.toml"
FEW = {"time.steps": 20, "solver.backend": "cpu"}
VARY = {"instrument.0.force.1": [-80.0, -98.0, -110.0], "material.upper.yield": [1.8, 2.2]}


def largest(simulation):
    return float(abs(simulation.displacement()).max())


def slow(simulation):
    time.sleep(0.3)
    return os.getpid()


def bits(table):
    return [row.tobytes() for row in table]  # a NaN is the same bits


class Sweeps(unittest.TestCase):
    def test_rows_are_what_the_program_says(self):
        table, moved = sunder.sweep(SCENE, VARY, set=FEW, jobs=2, measure=largest)
        self.assertEqual(table["run"].tolist(), list(range(6)))
        self.assertEqual(set(table["status"]), {0})
        place = 0
        for force in VARY["instrument.0.force.1"]:
            for strength in VARY["material.upper.yield"]:
                with tempfile.TemporaryDirectory() as folder:
                    summary, _, _ = program_run(
                        SCENE, pathlib.Path(folder), "--steps", "20", "--backend", "cpu", "--set",
                        f"instrument.0.force.1={force}", "--set", f"material.upper.yield={strength}")
                row = table[place]
                self.assertEqual(row["compliance"], summary["compliance"])
                self.assertEqual(row["destroyed"], len(summary["destroyed"]))
                self.assertEqual(row["events"], summary["events"])
                self.assertEqual(row["support"].tolist(), summary["supports"])
                first = summary["first_rupture"]
                self.assertEqual(row["first_element"], first["element"] if first else -1)
                self.assertEqual(row["first_criterion"], first["criterion"] if first else "")
                self.assertGreater(moved[place], 0)
                place += 1
        self.assertEqual(bits(sunder.sweep(SCENE, VARY, set=FEW, jobs=1)), bits(table))

    def test_a_run_that_is_refused_is_a_row(self):
        table = sunder.sweep(SCENE, {"material.upper.young": [5, -5], "solver.tolerance": [1e-4, 1e-300]},
                             set={**FEW, "time.steps": 1})
        self.assertEqual(table["status"].tolist(), [0, 5, 3, 3])
        self.assertIn("young", table["message"][2])

    def test_meshes_may_be_varied_and_scenes_be_dicts(self):
        tree = {"material": {"volume": {"young": 5, "poisson": 0.3}}, "fixed": [{"nodes": [0, 2, 3]}],
                "instrument": [{"kind": "expansion", "nodes": [4], "force": [1, 0, 0]}],
                "solver": {"backend": "cpu"}}
        meshes = [(NODES, TETS), (2 * np.array(NODES), TETS)]
        one, two = sunder.sweep(tree, {"mesh": meshes})["compliance"]
        self.assertAlmostEqual(two, one / 2, places=12)  # u = F / (E l) of similar bodies

    def test_what_is_wrong(self):
        for vary, part in (({}, "something to vary"), ({"time.steps": 3}, "a list of values"),
                           ({"time.steps": []}, "a list of values"), ({"time.steps": "12"}, "a list of")):
            with self.assertRaisesRegex(sunder.InputError, part):
                sunder.sweep(SCENE, vary)
        with self.assertRaisesRegex(sunder.InputError, "No such file"):
            sunder.sweep("nowhere.toml", VARY)

    def test_what_measure_raises_comes_out(self):
        def fail(simulation):
            raise KeyError("mine")
        with self.assertRaisesRegex(KeyError, "mine"):
            sunder.sweep(SCENE, VARY, set={**FEW, "time.steps": 1}, measure=fail)


class Clusters(unittest.TestCase):
    def test_a_worker_that_is_killed_costs_no_run(self):
        import dask
        from distributed import Client, LocalCluster
        dask.config.set({"distributed.worker.daemon": True})
        here = os.path.dirname(os.path.abspath(__file__))
        with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
                          silence_logs=50) as cluster, Client(cluster) as client:
            # Workers find this file as the caller does.
            client.run(__import__("sys").path.insert, 0, here)
            workers = client.run(os.getpid)
            victim = list(workers.values())[0]

            def kill():
                time.sleep(1.0)
                os.kill(victim, signal.SIGKILL)
            killer = threading.Thread(target=kill)
            killer.start()
            vary = {"instrument.0.force.1": np.linspace(-80, -110, 12)}
            table, by = sunder.sweep(SCENE, vary, set=FEW, client=client, measure=slow)
            killer.join()
        self.assertEqual(table["run"].tolist(), list(range(12)))
        self.assertEqual(set(table["status"]), {0})
        self.assertTrue(set(by) - {victim}, "all was computed by the worker that was killed")
        self.assertEqual(bits(table), bits(sunder.sweep(SCENE, vary, set=FEW)))


if __name__ == "__main__":
    unittest.main()
