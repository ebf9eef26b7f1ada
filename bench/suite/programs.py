# SPDX-License-Identifier: Apache-2.0
"""The benchmark programs and what each mode runs of them; a further one is one entry."""
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

from . import accuracy, ratios, results

MODES = ("quick", "full")


@dataclasses.dataclass
class Share:
    """What a mode runs of a program."""
    seconds: float        # on two idle cores: for the time left, and ten times it is the limit
    rows: str = "."       # filter of rows (regular expression)
    repetitions: int = 5
    words: tuple = ()     # arguments of a study


@dataclasses.dataclass
class Program:
    name: str
    about: str
    quick: Share
    full: Share
    file: str = ""        # a study writes this CSV; without it the program is a Google Benchmark


SCENES = tuple(str(pathlib.Path(__file__).resolve().parents[2] / "scenes" / f"{name}.toml")
               for name in ("notch-b", "scripted-cut", "stiff-contrast"))

PROGRAMS = [
    Program("bench_paper", "the paper's Tables 2 and 3",
            Share(5), Share(8)),
    Program("bench_program", "start of the program to its files",
            Share(6), Share(8)),
    Program("bench_field_sif", "time to decide the rupture element",
            Share(14, repetitions=3), Share(24)),
    Program("bench_c_abi", "a step through the C interface",
            Share(1, repetitions=1), Share(2, repetitions=3)),
    Program("bench_live", "undo, removal, cuts and the surface of a live body",
            Share(6, "(inverse|rupture)/1944", 1), Share(200, repetitions=3)),
    Program("bench_hands", "quiet frames under two hands that wander",
            Share(3, "(inverse|factor)/1944/", 1), Share(60, repetitions=3)),
    Program("bench_engine", "the engine against CHOLMOD, event by event",
            Share(6, "/1944/k", 3), Share(200, "-inverse_deferred/30246/", 3)),
    Program("bench_frame_parts", "where a frame goes, from the first to 640 fractures",
            Share(5, "/1944/", 1), Share(300, repetitions=3)),
    Program("bench_split", "a tear that splits beside one that destroys elements",
            Share(1, "/k(1|10)/", 1), Share(40, repetitions=3)),
    Program("bench_inversion", "the intact inverse against OpenBLAS and Eigen",
            Share(4, "/(486|1944)/", 3), Share(40, repetitions=3)),
    Program("bench_reconstruction", "inverse reconstruction by everyone",
            Share(50, "board (486|1944)/k[0-9]+/(openblas|eigen SimplicialLDLT r|Jacobi|chol|stale|cpu|vulkan i)"
                  "|board 486/k10/|7776/k10/(cpu factor|cpu inverse def|chol|stale)"
                  "|1944/to640/(chol.*up|cpu.*def)", 3),
            Share(800, "board (486|1944)/(k|to640/([^v]|vulkan (i|con)))"
                  "|(7776|7986)/(to640/|.*(deferred| cg |chol|eigen|openblas|PCG))", 3)),
    Program("bench_finite", "finite deformation beside Newton's method and others",
            Share(25, "finite/1944/.*/1e-04/2/|finite_error/corotated/1e-0(2|6)/", 1),
            Share(600, "finite/(1944|7776)/|finite_error/", 3)),
    Program("bench_motion", "motion beside Newton's method and others, and after a random hand",
            Share(3, "motion/1944/dt 200/sunder/", 1),
            Share(900, "motion/(1944|7776)/dt 200/|motion_hand|motion_balance|motion_rest", 1)),
    Program("bench_needs", "what a scene saves that needs less",
            Share(3, "/1944/", 1), Share(200, repetitions=3)),
    Program("bench_pooled", "what pooled volume costs beside volume by element",
            Share(0), Share(60, repetitions=3)),
    Program("bench_peeling", "forces and energies of peeling beside theory",
            Share(0.5, "90 deg/0[.]3 mm/4 steps", 1), Share(140, repetitions=1)),
    Program("bench_scaling", "sizes against frames and memory",
            Share(10, "cpu.*/(486|1944)/|vulkan.*/486/", 1),
            Share(190, "/(486|1944|7776)/|cpu.*/(30246|119286)/", 3)),
    Program("bench_vulkan", "kernels and frames on the Vulkan device",
            Share(25, "board", 1), Share(120, repetitions=1)),
    Program("bench_stability", "stability of every method",
            Share(75, words=("quick",)), Share(420, words=("full",)), file="stability.csv"),
    Program("bench_finite_stability", "stability at finite deformation, two laws",
            Share(15, words=("quick",)), Share(900, words=("full",)), file="finite-stability.csv"),
    Program("bench_finite_fractures", "finite deformation along fractures, against Newton's method",
            Share(3, words=("quick",)), Share(60, words=("full",)), file="finite-fractures.csv"),
    Program("bench_scenes", "error against run time on scenes",
            Share(38, words=("--seconds=2", "--tolerances=1e-4,1e-8", *SCENES)), Share(500),
            file="scenes.csv"),
    Program("bench_convergence", "mesh size against error and time",
            Share(1, words=("30000",)), Share(7), file="convergence.csv"),
]
# Large bodies take seconds to minutes each: once is enough.
LARGE = [
    Program("bench_stability", "stability after 640 fractures",
            Share(0), Share(120, words=("many",)), file="stability.csv"),
    Program("bench_finite", "finite deformation, 30,246 and 119,286 tetrahedra",
            Share(0), Share(3000, "finite/(30246|119286)/", 1)),
    Program("bench_motion", "motion in steps of 1/1000 s, and of 30,246 tetrahedra",
            Share(0), Share(3600, "motion/((1944|7776)/dt 1000|30246)/", 1)),
    Program("bench_engine", "deferred updates over the dense inverse of 30,246 tetrahedra",
            Share(0), Share(60, "inverse_deferred/30246/", 1)),
    Program("bench_reconstruction", "inverse reconstruction where an event takes seconds",
            Share(0), Share(950, "board (30246|119286)/|(7776|7986)/.* eager"
                            "|1944/to640/vulkan cg", 1)),
    Program("bench_scaling", "conjugate gradients on the Vulkan device, large boards",
            Share(0), Share(430, "vulkan.*/(30246|119286|501126|1003686)/|block", 1)),
    Program("bench_scaling", "boards of half a million and a million tetrahedra",
            Share(0), Share(150, "cpu.*/(501126|1003686)/", 1)),
]


def planned(mode, only=()):
    """The programs of a mode, with their shares; `only`: those of these names."""
    every = PROGRAMS + (LARGE if mode == "full" else [])
    return [(p, getattr(p, mode)) for p in every if not only or p.name in only]


def split_present(build, mode, only=()):
    """What is built here, and the names of what is not."""
    there = [(p, s) for p, s in planned(mode, only) if (pathlib.Path(build) / "bench" / p.name).is_file()]
    names = [p.name for p, _ in there]
    return there, sorted({p.name for p, _ in planned(mode, only)} - set(names))


def expect_all(build, mode, only=()):
    """Raises results.BadResults where a program of the mode is not built: what it measures would be
    missing in the end."""
    _, missing = split_present(build, mode, only)
    if missing:
        raise results.BadResults(f"{', '.join(missing)}: not built in {build}, so nothing is "
                                 "measured; a build folder without the program or Vulkan "
                                 "(SUNDER_APP, SUNDER_GPU) does not do")


class Progress:
    """A line per program: what runs, how much is done, time left."""

    def __init__(self, total, out=sys.stderr):
        self.total, self.done, self.out, self.start = total, 0.0, out, time.monotonic()

    def begin(self, name):
        spent = time.monotonic() - self.start
        pace = spent / self.done if self.done > 0 else 1.0
        left = pace * (self.total - self.done)
        print(f"[{100 * self.done / self.total:3.0f} %] {name}, about {left:.0f} s left",
              file=self.out, flush=True)

    def end(self, seconds):
        self.done += seconds


def _cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _run(command, limit, allowed=(0,)):
    """Runs to the end or the limit. Raises results.BadResults."""
    name = pathlib.Path(command[0]).name
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1")
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              env=environment, timeout=limit)
    except subprocess.TimeoutExpired:
        raise results.BadResults(f"{name} was ended after {limit:.0f} s") from None
    if done.returncode not in allowed:
        raise results.BadResults(f"{name} ended with {done.returncode}: "
                                 f"{done.stderr.strip()[-400:]}")
    return done.stdout


def run_program(build, program, share, repetitions=None):
    """Its rows, or the text of its CSV file. Raises results.BadResults when it fails."""
    path = str(pathlib.Path(build) / "bench" / program.name)
    limit = max(120.0, 10 * share.seconds)
    with tempfile.TemporaryDirectory() as temporary:
        if program.file:
            file = pathlib.Path(temporary) / program.file
            # Exit code 1 of the stability studies: a cell is WRONG, which the page shows.
            _run([path, str(file), *share.words], limit, (0, 1))
            return file.read_text()
        out = pathlib.Path(temporary) / "out.json"
        count = share.repetitions if repetitions is None else repetitions
        # In a random order, so that what disturbs the machine for a while does not hit one row.
        _run([path, f"--benchmark_filter={share.rows}", f"--benchmark_repetitions={count}",
              "--benchmark_enable_random_interleaving=true",
              "--benchmark_out_format=json", f"--benchmark_out={out}"], limit)
        try:
            return results.rows_of(program.name, json.loads(out.read_text()))
        except (OSError, ValueError) as error:
            raise results.BadResults(f"{program.name} left no readable output: {error}") from None


def nothing_yet():
    return {"rows": [], "cells": [], "points": [], "meshes": [], "alone": [], "steps": [],
            "fractures": [], "programs": [], "failures": []}


def conclude(outcome):
    """What follows from what was measured: ratios of rows, judgement of cells."""
    ratios.add(outcome["rows"])
    accuracy.add(outcome["cells"])
    return outcome


def split_done(there, outcome):
    """What is still to run after an earlier run that was ended; its failures are tried again."""
    done = {p["about"] for p in outcome["programs"] if not p.get("failed")}
    outcome["programs"] = [p for p in outcome["programs"] if not p.get("failed")]
    outcome["failures"] = []
    return [(p, s) for p, s in there if p.about not in done]


def run_and_time(build, program, share, repetitions):
    """What run_program returns or None, and the program's entry. Processor seconds are those of all
    programs that ran meanwhile."""
    start, cpu = time.monotonic(), _cpu_seconds()
    entry, made = {"name": program.name, "about": program.about}, None
    try:
        made = run_program(build, program, share, repetitions)
    except results.BadResults as error:
        entry["failed"] = str(error)
    entry["seconds"] = round(time.monotonic() - start, 1)
    entry["cpu_seconds"] = round(_cpu_seconds() - cpu, 1)
    return made, entry


def run_all(build, mode, repetitions=None, outcome=None, save=lambda outcome: None, commit="",
            jobs=1, only=()):
    """Adds to the outcome what of a mode it lacks, program by program in their order, and saves it
    after each: {"rows", "cells", "points", "meshes", "steps", "fractures",
    "programs", "failures"}. `jobs` of them run at once."""
    outcome = outcome or nothing_yet()
    there, missing = split_present(build, mode, only)
    there = split_done(there, outcome)
    outcome["failures"] = [f"{name} is not built" for name in missing]
    progress = Progress(sum(share.seconds for _, share in there))
    readers = {file: (part, read) for part, (file, read) in results.PARTS.items()}

    def run(planned):
        program, share = planned
        progress.begin(f"{program.name}: {program.about}")
        ran = run_and_time(build, program, share, repetitions)
        progress.end(share.seconds)
        return ran

    def add(made, entry, file):
        try:
            if "failed" in entry:
                raise results.BadResults(entry["failed"])
            part, read = readers.get(file, ("rows", lambda rows: rows))
            outcome[part] += read(made)
            conclude(outcome)
        except results.BadResults as error:
            entry["failed"] = True
            outcome["failures"].append(str(error))
            print(f"failed: {error}", file=sys.stderr)
        entry["commit"] = commit
        outcome["programs"].append(entry)
        save(outcome)

    pool = concurrent.futures.ThreadPoolExecutor(jobs)
    try:
        # One after the other without threads: what is measured has the machine to itself.
        ran = pool.map(run, there) if jobs > 1 else map(run, there)
        for (program, _), (made, entry) in zip(there, ran):
            add(made, entry, program.file)
    finally:
        pool.shutdown(cancel_futures=True)
    return outcome


def peer_settings(build):
    """What `bench_reconstruction --peers` says of each peer."""
    return _settings(build, "bench_reconstruction")


def finite_settings(build):
    """What `bench_finite --peers` says of each method."""
    return _settings(build, "bench_finite")


def _settings(build, name):
    path = pathlib.Path(build) / "bench" / name
    if not path.is_file():
        return {}
    lines = _run([str(path), "--peers"], 60).splitlines()
    return dict(line.split("\t", 1) for line in lines)
