# SPDX-License-Identifier: Apache-2.0
"""Ratio columns of the rows, taken after the run: repetitions run in a random order, so that a
program knows its peers' times only in part while it runs. Least time of all repetitions over the
peer's least, of the same program, body and event."""
import collections
import math
import re

from . import plots, results, style

# Rows of bench_engine that a user would pick instead, by the columns' names.
_LIBRARIES = {"cholmod_updown": "updown", "cholmod_updown_solve": "updown_solve",
              "cholmod_refactor": "refactor", "openblas_inverse": "openblas_inverse"}


def _engine(rows):
    """Events, {name: row} each, and the column that a peer's name gives the others. An update that
    the library leaves for a new factor is no match for a peer."""
    events = collections.defaultdict(dict)
    for row in rows:
        found = re.fullmatch(r"(\w+)/(\d+/k\d+)", row["name"])
        if row["program"] == "bench_engine" and found and not found[1].startswith("forced_"):
            events[found[2]][found[1]] = row
    return events.values(), lambda name: _LIBRARIES.get(name, "")


def _reconstruction(rows):
    events = collections.defaultdict(dict)
    for body, event, method, row in plots.reconstruction_rows(rows):
        events[body, event][method] = row

    def column(method):
        if not style.is_peer(method):
            return ""
        return {"cholmod updown": "updown", "cholmod updown_solve": "updown_solve"}.get(
            method, "refactor" if method.endswith("refactor") else "other")
    return events.values(), column


def _over_peers(methods, column):
    """Gives the rows of one event their columns; "best" is the least of all peers."""
    peers = {}
    for method, row in methods.items():
        kind, ms = column(method), results.least(row)
        if kind and math.isfinite(ms):
            for key in (kind, "best"):
                peers[key] = min(ms, peers.get(key, math.inf))
    peers.pop("other", None)
    for row in methods.values():
        ms = results.least(row)
        if math.isfinite(ms):
            row["counters"].update({f"over_{key}": ms / peer for key, peer in peers.items()})


def _finite(rows):
    """Shares of the best peer's median, by the clock and in processor time: the quickest frame of a
    sequence that foresees the next one says little."""
    events = collections.defaultdict(list)
    for *what, method, row in plots.finite_rows(rows):
        if row["samples_ms"]:
            events[tuple(what)].append((method, row["counters"]))
    for methods in events.values():
        for key, counter in (("over_best", "median_ms"), ("over_best_cpu", "cpu_ms")):
            best = min((c[counter] for m, c in methods if style.is_peer(m) and counter in c),
                       default=0)
            for _, counters in methods:
                if best > 0 and counter in counters:
                    counters[key] = counters[counter] / best


# Of a row's own counters, by the name of the ratio: (above, below).
_OWN = {"over_reference": ("min_ms", "reference_ms"),
        "last_over_first_ms": ("last_ms", "first_ms"),
        "predicted_quiet_over_measured": ("predicted_quiet_ms", "quiet_ms"),
        "predicted_fracture_over_measured": ("predicted_fracture_ms", "min_ms"),
        **{f"p99_over_median_{unit}": (f"p99_{unit}", f"median_{unit}")
           for unit in ("ms", "us", "cpu_ms", "cpu_us")}}


def _own(counters):
    for name, (above, below) in _OWN.items():
        if counters.get(above, 0) > 0 and counters.get(below, 0) > 0:
            counters[name] = counters[above] / counters[below]
    if counters.get("us_cpp", 0) > 0:
        counters["share"] = counters["us_c"] / counters["us_cpp"] - 1


def _is_ratio(counter):
    return counter.startswith("over_") or counter in _OWN or counter == "share"


def add(rows):
    """Renews every ratio of the rows."""
    for row in rows:
        row["counters"] = {key: value for key, value in row["counters"].items()
                           if not _is_ratio(key)}
        _own(row["counters"])
    for events, column in (_engine(rows), _reconstruction(rows)):
        for methods in events:
            _over_peers(methods, column)
    _finite(rows)
    return rows
