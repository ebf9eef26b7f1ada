# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python package share."""
import csv
import json
import os
import pathlib
import subprocess

import sunder

SOURCE = pathlib.Path(os.environ["SUNDER_SOURCE"])
SCENES = SOURCE / "scenes"

# Two tetrahedra that share a face, volumes 1/6 and 1/3 mm^3.
NODES = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
TETS = [[0, 1, 2, 3], [1, 4, 2, 3]]


def two_tets(force=40.0, steps=1, **fracture):
    """Pulled at the corner that the first one does not have."""
    scene = sunder.Scene(mesh=(NODES, TETS))
    scene.add_material(young=5, poisson=0.4, yield_stress=2)
    scene.add_support(nodes=[0, 2, 3])
    scene.add_instrument("forceps", force=[force, 0, 0], nodes=[4])
    scene.set_fracture(**fracture)
    scene.set_solver(backend="cpu")
    scene.set_steps(steps)
    return scene


def program(*arguments):
    return subprocess.run([os.environ["SUNDER_PROGRAM"], *map(str, arguments)], capture_output=True,
                          text=True)


def program_run(scene, out, *options):
    """summary.json and the rows of frames.csv and events.csv of `sunder run`."""
    ran = program("run", scene, "--out", out, "--quiet", *options)
    if ran.returncode:
        raise AssertionError(ran.stderr)
    tables = []
    for name in ("frames.csv", "events.csv"):
        with open(out / name, newline="", encoding="utf-8") as file:
            tables.append(list(csv.DictReader(file)))
    return json.loads((out / "summary.json").read_text(encoding="utf-8")), *tables
