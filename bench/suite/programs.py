# SPDX-License-Identifier: Apache-2.0
"""The benchmark programs and what the quick mode runs of each; a further one is one line."""
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from . import results


@dataclasses.dataclass
class Program:
    name: str
    quick: str       # filter of rows (regular expression), "-" in front: all but these
    seconds: tuple   # rough duration quick, full: for the time left
    about: str


PROGRAMS = [
    Program("bench_program", ".", (25, 60), "start of the program to its files"),
    Program("bench_field_sif", ".", (10, 60), "time to decide the rupture element"),
    Program("bench_engine", "/1944/k|/7776/k1/", (60, 900), "inverse reconstruction against CHOLMOD"),
    Program("bench_inversion", "/(486|1944)/", (10, 60), "the intact inverse against OpenBLAS, Eigen"),
    Program("bench_scaling", "/(486|1944)/", (30, 900), "sizes against frames and memory"),
    Program("bench_vulkan", "board", (40, 300), "kernels and frames on the Vulkan device"),
    Program("bench_c_abi", ".", (10, 60), "a step through the C interface"),
]
STABILITY_SECONDS = (60, 1200)
SCENES_SECONDS = 3600


def present(build):
    found = [p for p in PROGRAMS if (pathlib.Path(build) / "bench" / p.name).is_file()]
    return found, [p for p in PROGRAMS if p not in found]


class Progress:
    """One line: what runs, how much is done, time left."""

    def __init__(self, total):
        self.total, self.done, self.start = total, 0.0, time.monotonic()

    def begin(self, name):
        spent = time.monotonic() - self.start
        pace = spent / self.done if self.done > 0 else 1.0
        left = pace * (self.total - self.done)
        print(f"[{100 * self.done / self.total:3.0f} %] {name}, about {left:.0f} s left",
              file=sys.stderr, flush=True)

    def end(self, planned):
        self.done += planned


def run_program(build, program, quick, repetitions):
    """Rows of one program. Raises results.BadResults when it fails."""
    pattern = program.quick if quick else "."
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.json"
        command = [str(pathlib.Path(build) / "bench" / program.name),
                   f"--benchmark_filter={pattern}", f"--benchmark_repetitions={repetitions}",
                   "--benchmark_out_format=json", f"--benchmark_out={out}"]
        environment = dict(os.environ, OPENBLAS_NUM_THREADS="1")
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                              env=environment)
        if done.returncode != 0:
            raise results.BadResults(f"{program.name} ended with {done.returncode}: "
                                     f"{done.stderr.strip()[-400:]}")
        try:
            return results.rows_of(program.name, json.loads(out.read_text()))
        except (OSError, ValueError) as error:
            raise results.BadResults(f"{program.name} left no readable output: {error}") from None


def run_stability(build, quick, folder):
    """Cells of the study; exit code 1 means that one is WRONG, which the page shows."""
    file = pathlib.Path(folder) / "stability.csv"
    program = pathlib.Path(build) / "bench" / "bench_stability"
    done = subprocess.run([str(program), str(file), "quick" if quick else "full"])
    if done.returncode not in (0, 1):
        raise results.BadResults(f"bench_stability ended with {done.returncode}")
    return results.cells_of(file.read_text())


def run_scenes(build, folder):
    """Points of error against run time, all scenes."""
    file = pathlib.Path(folder) / "scenes.csv"
    program = pathlib.Path(build) / "bench" / "bench_scenes"
    done = subprocess.run([str(program), str(file)])
    if done.returncode != 0:
        raise results.BadResults(f"bench_scenes ended with {done.returncode}")
    return results.points_of(file.read_text())
