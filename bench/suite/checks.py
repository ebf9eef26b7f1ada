# SPDX-License-Identifier: Apache-2.0
"""What must not pass unseen in a run: wrong cells, numbers that are none, failures, missing peers."""
import math

from . import style

PROMISE = 1e-4  # the default tolerance


def _bad_numbers(row):
    values = [("time", v) for v in row["samples_ms"]] + list(row["counters"].items())
    return [f"{row['name']}: {key} is {value}" for key, value in values
            if not math.isfinite(value)]


def _row_problems(row):
    failure = row.get("failure", "")
    # A peer that comes to no end is shown, and is no fault of the run.
    if failure.startswith("refused: ") or (failure.startswith("not in ") and
                                           style.is_peer(row["name"].split("/")[-1])):
        return []
    if failure:
        return [f"{row['name']} fails: {failure}"]
    return _bad_numbers(row) + _broken_promise(row) + _bad_motion(row)


def _bad_motion(row):
    """After a random hand no step may end with a number that is none, and by neo-Hookean, whose
    energy forbids it, none with an inverted element; other laws' are counted only."""
    if not row["name"].startswith("motion_hand/"):
        return []
    law = row["name"].split("/")[1]
    never = ("nan", "inverted") if law == "neo-hookean" else ("nan",)
    return [f"{row['name']}: {key} in {row['counters'][key]:g} steps" for key in never
            if row["counters"].get(key, 0) > 0]


def _broken_promise(row):
    """Sunder's own rows of the reconstruction: every frame is promised to PROMISE."""
    method, error = row["name"].split("/")[-1], row["counters"].get("error_stress", 0)
    if row["program"] != "bench_reconstruction" or style.is_peer(method) or not error > PROMISE:
        return []
    return [f"{row['name']}: error of stress {error:.3g}, promised {PROMISE:g}"]


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
        if point["verdict"] == "WRONG":
            found.append(f"scene {point['scene']}, {point['method']}, tolerance "
                         f"{point['tolerance']:g}: WRONG, stress error {error:.3g}")
    found += [f"finite stability, {s['study']}, {s['law']}, {s['motion']} {s['amount']:g}: WRONG, "
              f"stress error {s['stress_error']:.3g}" + (f", {s['reason']}" if s["reason"] else "")
              for s in outcome.get("steps", []) if s["verdict"] == "WRONG"]
    found += [f"finite {f['part']}, {f['law']}, {f['degrees']:.0f} degrees, {f['gone']:g} gone: WRONG, "
              f"stress error {f['stress_error']:.3g}"
              for f in outcome.get("fractures", []) if f["verdict"] == "WRONG"]
    found += [f"{m['case']}, {m['tets']:g} tetrahedra: error is {m['error']}"
              for m in outcome["meshes"] if not math.isfinite(m["error"])]
    only = outcome["machine"].get("only")
    if only and "bench_reconstruction" not in only:
        return found
    if not outcome["peers"]:
        found.append("no peers: bench_reconstruction is missing")
    elif every_peer:
        found += [f"peer {name}: no row of this run" for name in missing_peers(outcome)]
    return found
