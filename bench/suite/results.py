# SPDX-License-Identifier: Apache-2.0
"""The results folder: rows of Google Benchmark programs and cells of the stability study.

results.json  {"machine": {...}, "rows": [row], "peers": {name: settings}, "programs": [...],
               "failures": [sentence]}
results.csv   one line per row: program, name, minimum, median, CPU time [ms], samples, counters
stability.csv, scenes.csv, convergence.csv, finite-stability.csv, finite-fractures.csv   as the programs write them:
               cells, points, meshes, steps, fractures
peers-alone.csv   of bench/peers-alone: each peer beside the others and alone
"""
import csv
import io
import json
import math
import os
import pathlib
import re
import statistics

UNITS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}
_KNOWN = {"name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions",
          "repetition_index", "threads", "iterations", "real_time", "cpu_time", "time_unit",
          "label", "error_occurred", "error_message", "aggregate_name", "aggregate_unit"}


class BadResults(Exception):
    """A results folder or a program's output that cannot be used; the text says why."""


def rows_of(program, output):
    """Rows of one program's JSON output, in the program's own order, whatever order it ran them in;
    repetitions become the samples of one row."""
    rows = {}
    for run in sorted(output.get("benchmarks", []), key=_place):
        if run.get("run_type", "iteration") != "iteration":
            continue
        name = name_of(run)
        row = rows.setdefault(name, {"program": program, "name": name, "samples_ms": [],
                                     "cpu_samples_ms": [], "counters": {}})
        if run.get("error_occurred"):
            row["failure"] = run.get("error_message", "failed")
            continue
        unit = UNITS[run["time_unit"]]
        row["samples_ms"].append(run["real_time"] * unit)
        row["cpu_samples_ms"].append(run["cpu_time"] * unit)
        for key, value in run.items():
            if key not in _KNOWN and isinstance(value, (int, float)):
                row["counters"][key] = _merged(key, row["counters"].get(key), value)
    return list(rows.values())


def _place(run):
    return run.get("family_index", 0), run.get("per_family_instance_index", 0)


def _merged(key, before, now):
    """Of repetitions: the least time, the largest error, the last of the rest."""
    if before is None:
        return now
    if re.search(r"(^|_)(ms|us)(_|$)", key):
        return min(before, now)
    if "error" in key:
        return before if math.isnan(before) or before > now else now
    return now


def name_of(run):
    """A row's name without what Google Benchmark adds about how it was measured."""
    return re.sub(r"/(iterations:\d+|manual_time|real_time|repeats:\d+|min_time:[\d.]+)", "",
                  run["run_name"])


def minimum(row):
    return min(row["samples_ms"]) if row["samples_ms"] else math.nan


def median(row):
    return statistics.median(row["samples_ms"]) if row["samples_ms"] else math.nan


def least(row):
    """The least time of all repetitions and, where the program tells it, of all iterations."""
    return row["counters"].get("min_ms", minimum(row))


def cells_of(text):
    """Cells of the stability study from its CSV text; numbers become numbers."""
    words = {"study", "volume", "pattern", "method", "verdict", "reason", "accuracy", "accuracy_reason"}
    cells = list(csv.DictReader(io.StringIO(text)))
    for cell in cells:
        cell.setdefault("batch", "10")  # of all cells before there was a choice
        cell.setdefault("volume", "element")
        for key in cell.keys() - words:
            cell[key] = float(cell[key])
    return cells


def points_of(text):
    """Points of error against run time on scenes; a refusal has no numbers."""
    points = list(csv.DictReader(io.StringIO(text)))
    for point in points:
        for key in ("tolerance", "frame_ms", "u_error", "stress_error", "fractures"):
            point[key] = float(point[key]) if point[key] else None
    return points


def meshes_of(text):
    """Meshes of the convergence study."""
    meshes = list(csv.DictReader(io.StringIO(text)))
    for mesh in meshes:
        for key in ("tets", "value", "error", "ms"):
            mesh[key] = float(mesh[key])
    return meshes


def steps_of(text):
    """Steps of the stability study at finite deformation."""
    words = {"study", "law", "added", "method", "motion", "verdict", "reason"}
    steps = list(csv.DictReader(io.StringIO(text)))
    for step in steps:
        step.setdefault("added", "")  # before anything was
        step.setdefault("method", "cpu")
        for key in step.keys() - words:
            step[key] = float(step[key])
    return steps


def fractures_of(text):
    """States and sequences of fractures at finite deformation."""
    words = {"part", "law", "how", "verdict"}
    rows = list(csv.DictReader(io.StringIO(text)))
    for row in rows:
        for key in row.keys() - words:
            row[key] = float(row[key])
    return rows


def alone_of(text):
    """Peers beside the others and alone, as suite/alone.py judges them."""
    entries = list(csv.DictReader(io.StringIO(text)))
    if entries and not {"body", "event", "method", "how", "together_ms", "alone_ms", "ratio",
                        "within"} <= entries[0].keys():
        raise ValueError("columns are missing")
    return entries


def write_text(path, text):
    """Writes to a temporary name and renames: a file appears complete or not at all."""
    temporary = path.with_name(path.name + ".partial")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def renew_section(path, text, begin, end):
    """Puts a section in the place of the one between its marks. Raises ValueError without them."""
    old = path.read_text(encoding="utf-8")
    start, stop = old.index(begin), old.index(end) + len(end)
    write_text(path, old[:start] + text + old[stop:])


def rows_csv(rows):
    """A counter that is called like one of the times takes its place."""
    times = ("min_ms", "median_ms", "cpu_ms")
    counters = sorted({key for row in rows for key in row["counters"]} - set(times))
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["program", "name", *times, "samples", *counters])
    for row in rows:
        own = {"min_ms": minimum(row), "median_ms": median(row),
               "cpu_ms": min(row["cpu_samples_ms"], default=math.nan), **row["counters"]}
        writer.writerow([row["program"], row["name"], *(f"{own[t]:.6g}" for t in times),
                         len(row["samples_ms"]),
                         *(f"{own[c]:.6g}" if c in own else "" for c in counters)])
    return out.getvalue()


# Parts of the results that lie beside results.json: file and reader.
PARTS = {"cells": ("stability.csv", cells_of), "points": ("scenes.csv", points_of),
         "meshes": ("convergence.csv", meshes_of), "alone": ("peers-alone.csv", alone_of),
         "steps": ("finite-stability.csv", steps_of),
         "fractures": ("finite-fractures.csv", fractures_of)}


def _text(path):
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise BadResults(f"{path} is missing; name a folder that bench/run has written") from None
    except OSError as error:
        raise BadResults(f"{path} cannot be read: {error}") from None


def read(folder):
    """The results of a folder. Raises BadResults."""
    path = pathlib.Path(folder) / "results.json"
    try:
        results = json.loads(_text(path))
    except ValueError as error:
        raise BadResults(f"{path} cannot be read: {error}") from None
    if not isinstance(results, dict) or not {"machine", "rows"} <= results.keys():
        raise BadResults(f"{path} is not a results file of bench/run")
    results = {"programs": [], "failures": [], "peers": {}, "finite_peers": {}, **results}
    for part, (name, reader) in PARTS.items():
        file = path.with_name(name)
        try:
            results[part] = reader(_text(file)) if file.is_file() else []
        except (ValueError, KeyError, TypeError) as error:
            raise BadResults(f"{file} cannot be read: {error}") from None
    return results


def table_csv(entries):
    """Dictionaries with the same keys as CSV; none as nothing."""
    out = io.StringIO()
    writer = csv.DictWriter(out, entries[0].keys(), lineterminator="\n")
    writer.writeheader()
    writer.writerows(entries)
    return out.getvalue()


def write(folder, results):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for part, (name, _) in PARTS.items():
        if results.get(part):
            write_text(folder / name, table_csv(results[part]))
        else:  # of an earlier run
            (folder / name).unlink(missing_ok=True)
    write_text(folder / "results.csv", rows_csv(results["rows"]))
    own = {key: value for key, value in results.items() if key not in PARTS}
    write_text(folder / "results.json", json.dumps(own, indent=0, allow_nan=True) + "\n")
