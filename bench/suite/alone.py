# SPDX-License-Identifier: Apache-2.0
"""Each peer beside the others in bench_reconstruction, and alone: both in turns, so that what else
the machine does meets both alike."""
import collections
import pathlib
import re
import statistics
import subprocess
import tempfile

from . import compare, plots, programs, results, style

BAND = 1.25
WIDEST = 2.0  # high over low of an interval that still tells something
REPETITIONS = 3  # within a process; a turn's sample is the least of them


def peer_rows(build, pattern):
    """{(body, event, method): row} of the peers that the filter leaves."""
    program = next(p for p in programs.PROGRAMS if p.name == "bench_reconstruction")
    rows = programs.run_program(build, program, programs.Share(60, pattern, REPETITIONS))
    return {(body, event, method): row
            for body, event, method, row in plots.reconstruction_rows(rows)
            if style.is_peer(method) and row["samples_ms"]}


def _escaped(name):
    return re.sub(r"([+().])", r"\\\1", name)


def _update_and_solution(method, row):
    """What the run from files measures: no stress, and of a dense inverse no product."""
    counters = row["counters"]
    return counters["update_ms"] + (0 if method.startswith("openblas") else counters["solve_ms"])


def _from_files(build, folder):
    made = subprocess.run([pathlib.Path(build) / "bench" / "bench_peers_alone", folder,
                           str(REPETITIONS)], check=True, capture_output=True, text=True)
    return {method: float(least) for method, least, *_ in
            (line.split("\t") for line in made.stdout.splitlines())}


def _turn(build, body, event, names, folder, samples):
    together = peer_rows(build, f"{_escaped(body)}/{event}/({'|'.join(map(_escaped, names))})/")
    files = _from_files(build, folder)
    for (_, _, method), row in together.items():
        alone = peer_rows(build, f"{_escaped(body)}/{event}/{_escaped(method)}/")
        own = samples[method, "a process of its own"]
        own.append((results.minimum(row), results.minimum(alone[body, event, method])))
        if method in files:
            samples[method, "without Sunder, from files"].append(
                (_update_and_solution(method, row), files[method]))


def _verdict(ratio, low, high):
    """yes; no: the whole interval lies outside; too noisy: it is too wide to tell."""
    if 1 / BAND <= ratio <= BAND:
        return "yes"
    if low > BAND or high < 1 / BAND:
        return "no"
    return "too noisy" if high > WIDEST * low else "yes"


def _judged(body, event, method, how, pairs):
    together, alone = zip(*pairs)
    _, low, high = compare.ratio_interval(together, alone)
    ratio = min(alone) / min(together)
    return {"body": body, "event": event, "method": method, "how": how,
            "together_ms": f"{min(together):.6g}", "alone_ms": f"{min(alone):.6g}",
            "ratio": f"{ratio:.4g}", "median_ratio": f"{statistics.median(b / a for a, b in pairs):.4g}",
            "low": f"{low:.4g}", "high": f"{high:.4g}", "within": _verdict(ratio, low, high)}


def measure(build, body, event, names, turns):
    """One dictionary per peer and way of standing alone. Raises results.BadResults."""
    samples = collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([pathlib.Path(build) / "bench" / "bench_reconstruction", "--write", folder,
                        body, event[1:]], check=True)
        for _ in range(turns):
            _turn(build, body, event, names, folder, samples)
    return [_judged(body, event, method, how, pairs) for (method, how), pairs in samples.items()]
