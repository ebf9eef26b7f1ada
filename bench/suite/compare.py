# SPDX-License-Identifier: Apache-2.0
"""Compares two results folders: what became slower, faster or wrong, noise taken into account.

A row is slower when the whole 95 % interval of the ratio of medians (bootstrap over the
repetitions, fixed seed) lies above 1 + margin. One sample gives no interval: such rows are listed
and not judged. An error grows when it is 10 times the old one and above its floor.
"""
import dataclasses
import math
import statistics

import numpy

MARGIN = 0.05      # differences below this are of no interest
ERROR_FACTOR = 10
ERROR_FLOOR = 1e-9  # rounding of another order of operations
GOOD = {"ok", "polished", "rounded"}


@dataclasses.dataclass
class Finding:
    kind: str  # slower, faster, wrong, gone, new, unjudged
    name: str
    text: str


def ratio_interval(old, new, seed=20131):
    """Ratio new/old of the medians and its 95 % interval."""
    draw = numpy.random.default_rng(seed)
    old, new = numpy.asarray(old), numpy.asarray(new)
    a = numpy.median(draw.choice(old, (2000, len(old))), axis=1)
    b = numpy.median(draw.choice(new, (2000, len(new))), axis=1)
    low, high = numpy.quantile(b / a, [0.025, 0.975])
    return statistics.median(new) / statistics.median(old), low, high


def compare_times(old, new):
    if not old["samples_ms"] or not new["samples_ms"]:
        return []
    if min(len(old["samples_ms"]), len(new["samples_ms"])) < 3:
        return [Finding("unjudged", new["name"], "fewer than three repetitions")]
    ratio, low, high = ratio_interval(old["samples_ms"], new["samples_ms"])
    text = f"time x {ratio:.3f} (95 %: {low:.3f} to {high:.3f})"
    if low > 1 + MARGIN:
        return [Finding("slower", new["name"], text)]
    if high < 1 / (1 + MARGIN):
        return [Finding("faster", new["name"], text)]
    return []


def worse_error(old, new):
    if math.isnan(new):
        return not math.isnan(old)
    return new > ERROR_FLOOR and new > ERROR_FACTOR * old


def compare_rows(old, new):
    findings = compare_times(old, new)
    if new.get("failure") and not old.get("failure"):
        findings.append(Finding("wrong", new["name"], "fails: " + new["failure"]))
    for key in sorted(old["counters"].keys() & new["counters"].keys()):
        if "error" in key and worse_error(old["counters"][key], new["counters"][key]):
            findings.append(Finding("wrong", new["name"], f"{key} {old['counters'][key]:.3g} -> "
                                    f"{new['counters'][key]:.3g}"))
    return findings


def cell_key(cell):
    return tuple(str(cell[k]) for k in ("study", "contrast", "nu", "sliver", "alpha", "unit",
                                        "pattern", "fractures", "batch", "method"))


def compare_cells(old, new):
    name = " ".join(cell_key(new))
    if old["verdict"] in GOOD and new["verdict"] not in GOOD:
        return [Finding("wrong", name, f"{old['verdict']} -> {new['verdict']} {new['reason']}")]
    if old.get("accuracy") == "within" and new.get("accuracy") == "beyond":
        return [Finding("wrong", name, "beyond the promised accuracy: " + new["accuracy_reason"])]
    if new["verdict"] in GOOD and worse_error(old["stress_error"], new["stress_error"]):
        return [Finding("wrong", name, f"stress error {old['stress_error']:.3g} -> "
                        f"{new['stress_error']:.3g}")]
    return []


def compare(old, new):
    """Findings between two results (results.read), in the order of the new one."""
    findings = []
    for part, key, judge in (("rows", lambda r: (r["program"], r["name"]), compare_rows),
                             ("cells", cell_key, compare_cells)):
        before = {key(item): item for item in old[part]}
        after = {key(item): item for item in new[part]}
        for k, item in after.items():
            if k in before:
                findings += judge(before[k], item)
            else:
                findings.append(Finding("new", " ".join(k), "not in the old results"))
        findings += [Finding("gone", " ".join(k), "not in the new results")
                     for k in before if k not in after]
    return findings


def bad(findings):
    """Whether something became slower, wrong, or is missing."""
    return any(f.kind in ("slower", "wrong", "gone") for f in findings)
