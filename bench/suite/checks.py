# SPDX-License-Identifier: Apache-2.0
"""What must not pass unseen in a run: wrong cells, numbers that are none, failures, missing peers."""
import math

from . import results


def _bad_numbers(row):
    values = [("time", v) for v in row["samples_ms"]] + list(row["counters"].items())
    return [f"{row['name']}: {key} is {value}" for key, value in values
            if not math.isfinite(value)]


def _row_problems(row):
    failure = row.get("failure", "")
    if failure.startswith("refused: "):
        return []
    if failure:
        return [f"{row['name']} fails: {failure}"]
    return _bad_numbers(row)


def _cell_problems(cell):
    name = f"stability, {cell['study']}, {cell['method']}"
    if cell["verdict"] == "WRONG":
        return [f"{name}: WRONG, stress error {cell['stress_error']:.3g}"]
    if cell["verdict"] != "refused" and not math.isfinite(cell["stress_error"]):
        return [f"{name}: stress error is {cell['stress_error']}"]
    return []


def missing_peers(outcome):
    """Peers that bench_reconstruction knows and that no row of this run shows."""
    shown = {r["name"].split("/")[-1] for r in outcome["rows"] if r["samples_ms"]}
    return [name for name in outcome["peers"] if name not in shown]


def problems(outcome, every_peer=True):
    """Sentences; none: the run is good."""
    found = list(outcome["failures"])
    for row in outcome["rows"]:
        found += _row_problems(row)
    for cell in outcome["cells"]:
        found += _cell_problems(cell)
    for point in outcome["points"]:
        error = point["stress_error"]
        if error is not None and not math.isfinite(error):
            found.append(f"scene {point['scene']}, {point['method']}: stress error is {error}")
    found += [f"{m['case']}, {m['tets']:g} tetrahedra: error is {m['error']}"
              for m in outcome["meshes"] if not math.isfinite(m["error"])]
    if not outcome["peers"]:
        found.append("no peers: bench_reconstruction is missing")
    elif every_peer:
        found += [f"peer {name}: no row of this run" for name in missing_peers(outcome)]
    return found


def minimum_or_none(row):
    """For tables: nothing where a row failed."""
    return results.minimum(row) if row["samples_ms"] else None
