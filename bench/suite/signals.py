# SPDX-License-Identifier: Apache-2.0
"""How long after a signal the program computes, and how long after it ends: bench/signals.

A moment begins and ends with what can be seen from outside: a file that appears in the result
folder, an age, the process's end.
"""
import dataclasses
import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import time
import typing

from .results import BadResults

BEGIN, END = "<!-- table of bench/signals -->", "<!-- end of table -->"
POLL = 2e-4  # s between two looks
PATIENCE = 300  # s until a moment must have come
AGAIN = 0.02  # s from the first signal to the second
LIMIT = 1.0  # s until the computing has stopped: what docs/interface.md promises

SCENE = """title = "Signals"
mesh = "{mesh}"
[material]
{names[0]} = {{ young = 5.0, poisson = 0.4, yield = 2.0 }}
{names[1]} = {{ young = 8.0, poisson = 0.4, yield = 4.0 }}
{names[2]} = {{ young = 500.0, poisson = 0.4 }}
{names[3]} = {{ young = 500.0, poisson = 0.4 }}
[[fixed]]
box = [[-1.0, 49.999, -1.0], [51.0, 50.001, 3.0]]
[[instrument]]
name = "forceps"
kind = "expansion"
box = [[49.999, -0.001, -1.0], [50.001, 0.001, 3.0]]
force = [0.0, {force}, 0.0]
ramp = [0.0, 1.0]
[[destroy]]
step = 0
elements = [0, 1, 2, 3, 4, 5, 6, 7]
[fracture]
model = "B"
max_events = 1000000
[time]
steps = {steps}
"""

# Medit's .mesh has no names.
NAMES = {"msh": ("upper", "lower", "top-frame", "bottom-frame"),
         "mesh": ("volume-1", "volume-2", "volume-3", "volume-4")}


class NoMoment(BadResults):
    """A run that ended, or did not get anywhere, before its moment."""


class Run:
    """One start of the program, watched by what it leaves in the folder and in the kernel."""

    def __init__(self, command, out, log):
        self.out, self.log = out, log
        with open(log, "wb") as errors:
            self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=errors)
        self.pid = self.process.pid
        self.started = self.begun = time.monotonic()

    def ended(self):
        # It stays a zombie, so that its use of the processors can still be read.
        flags = os.WEXITED | os.WNOHANG | os.WNOWAIT
        return os.waitid(os.P_PID, self.pid, flags) is not None

    def has(self, name):
        return (self.out / name.format(pid=self.pid)).exists()

    def computed(self):
        """Seconds of processor time of all threads so far: the process's CPU clock of Linux."""
        return time.clock_gettime(~self.pid << 3 | 2)

    def wait_until(self, condition):
        limit = time.monotonic() + PATIENCE
        while not condition(self):
            if self.ended():
                text = self.log.read_text(errors="replace").strip()
                raise NoMoment(f"the run was over before its moment: {text}")
            if time.monotonic() > limit:
                raise NoMoment(f"the moment did not come within {PATIENCE} s")
            time.sleep(POLL)

    def kill(self):
        self.process.kill()
        self.process.wait()


def start(_):
    return True


def file(*names):
    """One of these is there; {pid} stands for the process."""
    return lambda run: any(run.has(name) for name in names)


def lasting(seconds):
    return lambda run: time.monotonic() - run.begun >= seconds


READ = file(".sunder-lock")  # the scene and its mesh
PREPARED = file("frames.csv.{pid}.partial")


@dataclasses.dataclass(frozen=True)
class Moment:
    name: str
    begin: typing.Callable
    end: typing.Callable
    arguments: tuple = ()  # after the scene's; without a scene the command itself
    tets: int = 0  # of the scene's board; 0: no scene
    format: str = "msh"  # of its mesh
    force: float = -1.0  # N; -150 tears
    steps: int = 1000000
    results: bool = False  # a signal finds some
    complete: bool = False  # all steps are computed
    again: bool = False  # a second signal follows the first


def preparing(name, tets, *arguments):
    return Moment(name, READ, PREPARED, arguments, tets)


def computing(name, tets, *arguments, seconds=4, **more):
    return Moment(name, PREPARED, lasting(seconds), arguments, tets, results=True, **more)


def writing(name, begin, end, *arguments, **more):
    return Moment(name, begin, end, ("--route", "factor", *arguments), 120000, results=True, **more)


SNAPSHOTS = ("--steps", "2", "--snapshots", "1,2,3,4,5,6,7,8")
DRAWING = (file("result.vtu"), file("figure.svg"), "--steps", "1")
MOMENTS = (
    Moment("start", start, lasting(0.1), ("--steps", "1"), 120000),
    Moment("import, .msh", start, READ, ("--steps", "1"), 120000),
    Moment("import through gmsh, .mesh", start, READ, ("--steps", "1"), 120000, "mesh"),
    preparing("factor: assembly, nested dissection, factorisation", 120000, "--route", "factor"),
    preparing("cg: preconditioner", 120000, "--route", "cg"),
    preparing("dense inverse", 30000, "--route", "inverse"),
    preparing("condensed: Schur complement", 30000, "--route", "condensed"),
    preparing("Vulkan cg: shaders, preconditioner", 30000, "--backend", "vulkan", "--route", "cg"),
    computing("quiet frames, factor", 120000, "--route", "factor"),
    computing("cascade, factor, new bases beside it", 30000, "--route", "factor", "--steps", "1",
              "--set", "instrument.0.ramp=[0, 0]", force=-150.0, seconds=15),
    computing("cascade, factor", 120000, "--route", "factor", "--steps", "1",
              "--set", "instrument.0.ramp=[0, 0]", force=-150.0),
    computing("cascade, inverse", 8000, "--route", "inverse", "--steps", "1",
              "--set", "instrument.0.ramp=[0, 0]", force=-150.0),
    computing("cascade, condensed", 4000, "--route", "condensed", "--steps", "1",
              "--set", "instrument.0.ramp=[0, 0]", force=-150.0, seconds=2),
    computing("frames, cg", 120000, "--route", "cg"),
    computing("frames, Vulkan cg", 30000, "--backend", "vulkan", "--route", "cg"),
    computing("frames, Vulkan cg", 120000, "--backend", "vulkan", "--route", "cg"),
    writing("a .vtu each step", PREPARED, lasting(3), "--series"),
    writing("a .vtu each step, a second signal", PREPARED, lasting(3), "--series", again=True),
    writing("eight snapshots", file("snapshot_1.svg"), file("snapshot_8.vtu"), *SNAPSHOTS),
    writing("eight snapshots, a second signal", file("snapshot_1.svg"), file("snapshot_8.vtu"),
            *SNAPSHOTS, again=True),
    writing("last .vtu", file("events.csv"), file("result.vtu"), "--steps", "1", complete=True),
    writing("last figure, .svg and .png", *DRAWING, complete=True),
    writing("last figure, a second signal", *DRAWING, complete=True, again=True),
    writing("figure.png and page, .html", file("figure.svg"), file("summary.json"), "--steps", "1",
            complete=True),
    Moment("mesh board in gmsh", start, lasting(4),
           ("mesh", "board", "--unstructured", "--tets", "400000", "-o", "{out}/board.msh")),
    Moment("mesh board, .vtk", start, lasting(2),
           ("mesh", "board", "--tets", "1000000", "-o", "{out}/board.vtk")),
    Moment("plan", start, lasting(2), ("plan", "{scene}", "--route", "factor"), 120000),
    Moment("reproduce", start, lasting(6), ("reproduce", "--quick", "--out", "{out}")),
)


@dataclasses.dataclass
class Row:
    """The worst of its signals."""
    moment: Moment
    lasts: float  # s
    signals: int = 0
    stopped: float = 0.0  # s until files are written alone, or the end
    computed: float = 0.0  # s of processor time until then
    ended: float = 0.0  # s
    faults: list = dataclasses.field(default_factory=list)


class Bench:
    """The program, and a folder for its bodies and results."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.count = itertools.count()

    def board(self, tets, format):
        path = self.folder / f"board-{tets}.{format}"
        if not path.exists():
            command = [self.program, "mesh", "board", "--tets", str(tets), "-o", path]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return path

    def start(self, moment):
        out = self.folder / f"out-{next(self.count)}"
        scene = self.folder / "scene.toml"
        places = {"out": out, "scene": scene}
        arguments = [a.format(**places) for a in moment.arguments]
        if moment.tets:
            mesh = self.board(moment.tets, moment.format)
            scene.write_text(SCENE.format(mesh=mesh, names=NAMES[moment.format],
                                          force=moment.force, steps=moment.steps))
            if "{scene}" not in moment.arguments:
                arguments = ["run", str(scene), "--out", str(out), *arguments]
        else:
            out.mkdir()
        return Run([self.program, *arguments], out, self.folder / "stderr.txt")

    def begun(self, moment):
        run = self.start(moment)
        try:
            run.wait_until(moment.begin)
            run.begun = time.monotonic()
        except NoMoment:
            run.kill()
            raise
        return run

    def length(self, moment):
        run = self.begun(moment)
        try:
            run.wait_until(lambda r: moment.end(r) or r.ended())  # on a fast machine the latter
            return time.monotonic() - run.begun
        finally:
            run.kill()
            shutil.rmtree(run.out, ignore_errors=True)

    def measure(self, moment, signals):
        row = Row(moment, self.length(moment))
        for i in range(signals):
            after = row.lasts * (i + 0.5) / signals
            run = self.begun(moment)
            time.sleep(max(0.0, run.begun + after - time.monotonic()))
            if run.ended() or moment.end(run):  # quicker than the first
                run.kill()
            else:
                found = self.interrupt(run, row) + faults(run, moment)
                row.faults += [f"{moment.name}, signal after {after:.3f} s: {fault}"
                               for fault in found]
            shutil.rmtree(run.out, ignore_errors=True)
        if row.signals == 0:
            row.faults.append(f"{moment.name}: no run was still there when its signal was due")
        return row

    def interrupt(self, run, row):
        """The signal, and what is measured from it; returns what should not be of the times."""
        before = run.computed()
        run.process.send_signal(signal.SIGINT)
        sent = time.monotonic()
        again = row.moment.again
        while not run.ended():
            now = time.monotonic()
            if again and now - sent > AGAIN:
                run.process.send_signal(signal.SIGINT)
                again = False
            if now - sent > PATIENCE:
                run.process.kill()
            time.sleep(POLL)
        took = time.monotonic() - sent
        computed = run.computed() - before
        run.process.wait()
        row.signals += 1
        row.ended = max(row.ended, took)
        stopped, until = told(run.log.read_text(errors="replace")) or (took, computed)
        row.stopped = max(row.stopped, stopped)
        row.computed = max(row.computed, until)
        return too_late(stopped, until)


def too_late(stopped, computed):
    """What should not be of the times [s] from a signal until the computing had stopped."""
    if stopped <= LIMIT:
        return []
    return [f"stopped {stopped:.2f} s after it ({computed:.2f} s of processor), over {LIMIT:g} s; "
            "where other programs ran beside it, measure again without them"]


def told(text):
    """(s, s of processor time) that the program says the computing still took."""
    found = re.search(r"sunder: stopped (\S+) s after the signal \((\S+) s of processor", text)
    return (float(found[1]), float(found[2])) if found else None


def faults(run, moment):
    """What should not be, of a run that got its signal."""
    found = []
    if run.process.returncode != 130:
        text = run.log.read_text(errors="replace").strip()
        found.append(f"exit code {run.process.returncode}: {text}")
    names = sorted(p.name for p in run.out.iterdir()) if run.out.exists() else []
    half = [name for name in names if name.endswith(".partial") or name.startswith(".")]
    if half:
        found.append(f"left {', '.join(half)}")
    if moment.results and not moment.again:
        found += faults_of_results(run.out, names, moment)
    elif names:
        found.append(f"left {', '.join(names)}")
    elif moment.tets and run.out.exists():  # else the folder was there before
        found.append("left an empty folder")
    return found


def faults_of_results(out, names, moment):
    if "summary.json" not in names:
        return ["no whole results"]
    summary = json.loads((out / "summary.json").read_text())
    rows = len((out / "frames.csv").read_text().splitlines()) - 1
    found = []
    if rows != summary["steps_done"]:
        found.append(f"{rows} rows in frames.csv of {summary['steps_done']} steps")
    if summary["interrupted"] == moment.complete:
        found.append(f"interrupted is {summary['interrupted']} in summary.json")
    return found


def body(moment):
    return f"{moment.tets:,}" if moment.tets else ""


def line(row):
    return (f"{row.moment.name} {body(row.moment)}: lasts {row.lasts:.2f} s; of {row.signals} "
            f"signals: stopped {row.stopped:.3f} s ({row.computed:.3f} s of processor), "
            f"ended {row.ended:.3f} s{'; WRONG' if row.faults else ''}")


def markdown(rows, about):
    """The section of docs/signals.md."""
    lines = [BEGIN, "",
             f"{about['cpu']}, {about['cores']} cores, {about['date']}, commit {about['commit']}, "
             f"load {about['load_before']} before the first run.", "",
             "| the signal comes during | tetrahedra | lasts [s] | signals | stopped [s] "
             "| of processor [s] | ended [s] |", "|---|---:|---:|---:|---:|---:|---:|"]
    for row in rows:
        lines.append(f"| {row.moment.name} | {body(row.moment)} | {row.lasts:.2f} | {row.signals} "
                     f"| {row.stopped:.2f} | {row.computed:.2f} | {row.ended:.2f} |")
    return "\n".join(lines + ["", END])
