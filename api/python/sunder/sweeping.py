# SPDX-License-Identifier: Apache-2.0
"""Many runs of one scene with other values, on this machine's processors or by a Dask client."""
from __future__ import annotations

import concurrent.futures
import itertools
import os
import threading
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from . import _fill
from ._progress import Line
from .errors import Error, InputError
from .mesh import Mesh
from .scene import Scene
from .simulation import Bodies, Simulation, cause_name

RESULT = np.dtype([
    ("run", "i8"), ("status", "i4"), ("steps_done", "i4"), ("events", "i4"), ("destroyed", "i4"),
    ("cracks", "i4"), ("first_step", "i4"), ("first_load_factor", "f8"), ("first_element", "i4"),
    ("first_criterion", "U9"), ("crack_length", "f8"), ("compliance", "f8"), ("error", "f8"),
    ("max_yield_ratio", "f8"), ("strain_max", "f8"), ("rotation_max_deg", "f8"), ("support", "f8", 3),
    ("message", "U300"),
])


def _measured(simulation, steps, record):
    events, cracks = simulation.events(), simulation.cracks()
    ruptures = events[(events["cause"] != 2) & (events["cause"] != 3)]
    record["steps_done"], record["cracks"] = len(steps), len(cracks)
    record["events"] = len(np.unique(events["event"]))
    record["destroyed"] = int((events["lives"] == 0).sum())
    record["crack_length"] = cracks["length"].sum()
    record["first_step"] = record["first_element"] = -1
    record["first_load_factor"] = np.nan
    if len(ruptures):
        first = ruptures[0]
        record["first_step"], record["first_element"] = first["step"], first["element"]
        record["first_load_factor"] = first["load_factor"]
        record["first_criterion"] = cause_name(first["cause"])
    if steps:
        for name in ("compliance", "error", "max_yield_ratio"):
            record[name] = getattr(steps[-1], name)
        largest = max((s.strain_max for s in steps), key=abs)
        record["strain_max"] = largest
        record["rotation_max_deg"] = max(s.rotation_max_deg for s in steps)
        record["support"] = simulation.support_reaction()


def run_one(tree: Mapping[str, Any], run: int, values: Mapping[str, Any],
            measure: Callable[[Simulation], Any] | None = None,
            bodies: Bodies | None = None) -> tuple[np.ndarray, Any]:
    """One run of a sweep, a function by itself so that a scheduler can carry it. Returns one of the
    records RESULT, an array of shape (), and what `measure` returned. An error of the scene or of the
    computation is in the record. Without `bodies` the runs of a process share what is made of a
    body."""
    record = np.zeros((), RESULT)
    record["run"] = run
    measured = None
    try:
        with Scene(tree, set={**values, "solver.prepare": False}) as scene:
            shared = None if _elsewhere(tree, values) else bodies or _process_bodies()
            simulation = Simulation(scene, bodies=shared)
        with simulation:
            steps = []
            try:
                for step in simulation.steps():
                    steps.append(step)
            finally:
                _measured(simulation, steps, record)
            if measure is not None:
                measured = measure(simulation)
    except Error as error:
        record["status"], record["message"] = error.status, str(error)[:300]
    return record, measured


def _elsewhere(tree, values):
    """Whether a run names another backend than the CPU's: that shares nothing."""
    backend = values.get("solver.backend", (tree.get("solver") or {}).get("backend", "auto"))
    return backend not in ("auto", "cpu")


_of_process: Bodies | None = None
_making = threading.Lock()


def _process_bodies():
    """Of a worker of a cluster, which has no place of its own for what its runs share."""
    global _of_process
    with _making:
        if _of_process is None:
            _of_process = Bodies(1)
        return _of_process


def _runs(vary):
    for key, values in vary.items():
        if isinstance(values, (str, bytes)) or not hasattr(values, "__len__") or not len(values):
            raise InputError(f"vary {key!r} is {values!r}; allowed is a list of values, not empty")
    if not vary:
        raise InputError("a sweep needs something to vary")
    keys = list(vary)
    for run, place in enumerate(itertools.product(*(range(len(vary[k])) for k in keys))):
        yield run, {k: _plain(vary[k][i]) for k, i in zip(keys, place)}


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value


def sweep(source: Any, vary: Mapping[str, Sequence[Any]], *, set: Mapping[str, Any] | None = None,
          mesh: Any = None, jobs: int | None = None, client: Any = None,
          measure: Callable[[Simulation], Any] | None = None,
          progress: bool = False) -> np.ndarray | tuple[np.ndarray, list[Any]]:
    """All combinations of `vary`, {"instrument.0.force.1": [-90, -95], ...}, the first key slowest.

    source, set, mesh: as Scene() takes them.
    jobs: runs at a time on this machine (default: one a processor).
    client: a dask.distributed.Client; its workers compute, and a worker that dies costs nothing but
        the time of its runs, which others do again.
    measure: called with each simulation at its end; what it returns comes back as a list. For a
        client it has to be a function that can be pickled.
    Returns (runs,) records RESULT, by run, or that and the list of `measure`. A run that is
    refused or fails has its status (as Error.status) and message; the others go on.

    On the CPU, which backend "auto" is here, runs of one intact body share its factor and inverse;
    a worker of a cluster keeps those of the body that it had last.
    """
    tree, folder, _ = _fill.load(source, set or {})
    if mesh is not None:
        tree["mesh"] = Mesh.of(mesh)
    elif isinstance(tree.get("mesh"), (str, os.PathLike)) and "mesh" not in vary:
        tree["mesh"] = Mesh.read(folder / tree["mesh"])  # once, and workers need no file
    runs = list(_runs(vary))
    line = Line("sweep", "run") if progress else None
    carry = _by_client if client is not None else _by_threads
    results: list[Any] = [None] * len(runs)
    failed = 0
    for done, (record, measured) in enumerate(carry(tree, runs, measure, client or jobs), 1):
        results[int(record["run"])] = (record, measured)
        failed += int(record["status"] != 0)
        if line:
            line.show(done, f"{failed} failed", len(runs))
    if line:
        line.close()
    table = np.array([record for record, _ in results], RESULT)
    return table if measure is None else (table, [m for _, m in results])


def _by_threads(tree, runs, measure, jobs):
    # The library computes without Python's lock, so threads are enough.
    count = jobs or len(os.sched_getaffinity(0))
    with Bodies(count + 1) as bodies, concurrent.futures.ThreadPoolExecutor(count) as pool:
        waiting = [pool.submit(run_one, tree, run, values, measure, bodies) for run, values in runs]
        try:
            for future in concurrent.futures.as_completed(waiting):
                yield future.result()
        except BaseException:
            for future in waiting:
                future.cancel()
            raise


def _by_client(tree, runs, measure, client):
    from distributed import as_completed
    shared = client.scatter(tree, broadcast=True)
    futures = [client.submit(run_one, shared, run, values, measure, pure=False)
               for run, values in runs]
    try:
        for future in as_completed(futures):
            yield future.result()
    except BaseException:
        client.cancel(futures)
        raise
