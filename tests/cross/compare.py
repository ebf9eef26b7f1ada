#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether boards tore on another machine as on this one: the same ruptures in the same order, and
nodes within 1e-8 of where they are here.   compare.py HERE THERE
Bits need not be the same; of every board it is said whether they are."""
import math
import sys

SAME = 1e-8  # of the largest displacement; kCrackTolerance of tests/support/accuracy.hpp


def boards(path):
    found = {}
    with open(path, encoding="ascii") as file:
        for line in file:
            word, *rest = line.split()
            if word == "board":
                ruptures, places = found.setdefault(rest[0], ([], []))
            elif word == "rupture":
                ruptures.append(tuple(map(int, rest)))
            else:
                places.append([float.fromhex(x) for x in rest])
    return found


def main(here, there):
    here, there = boards(here), boards(there)
    wrong = [] if list(here) == list(there) and len(here) > 5 else ["the boards are not the same ones"]
    for name, (ruptures, places) in here.items():
        others, moved = there.get(name, ([], []))
        largest = max((math.hypot(*u) for u in places), default=0)
        apart = max((math.dist(a, b) for a, b in zip(places, moved)), default=math.inf)
        apart = apart / largest if largest and len(places) == len(moved) else math.inf
        print(f"{name}: {len(ruptures)} ruptures, {'the same' if ruptures == others else 'others'}; nodes "
              f"{apart:.1e} of the largest displacement apart"
              + (", the same bits" if places == moved else ""))
        if not ruptures or ruptures != others:
            wrong.append(f"{name}: other ruptures, or none")
        if not apart <= SAME:
            wrong.append(f"{name}: nodes {apart:.1e} apart, allowed {SAME:.0e}")
    for sentence in wrong:
        print(f"WRONG {sentence}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
