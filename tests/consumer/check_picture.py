#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What must be seen in the picture of examples/host: three moments of a tearing board.
   check_picture.py PICTURE.png"""
import struct
import sys
import zlib

PANEL, HEIGHT = 600, 700


def read_png(path):
    """Rows of RGBA bytes of a PNG whose rows have no filter."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    at, packed, size = 8, b"", None
    while at < len(data):
        length, = struct.unpack(">I", data[at:at + 4])
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + length]
        crc, = struct.unpack(">I", data[at + 8 + length:at + 12 + length])
        assert crc == zlib.crc32(kind + body), f"wrong checksum of {kind}"
        if kind == b"IHDR":
            size = struct.unpack(">II", body[:8])
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, stride = zlib.decompress(packed), 4 * size[0] + 1
    assert len(raw) == stride * size[1], "wrong number of pixels"
    assert all(raw[y * stride] == 0 for y in range(size[1])), "a filter"
    return size, [raw[y * stride + 1:(y + 1) * stride] for y in range(size[1])]


def kind_of(r, g, b):
    if r > 250 and g > 250 and b > 250:
        return "nothing"
    if r > 240 and 190 < g < 220 and b < 20:
        return "mark"
    if abs(r - g) < 8 and abs(g - b) < 8:
        return "frame"
    return "red" if r > 130 and g < 0.25 * r else "tissue"


def measure(rows, panel):
    count = dict.fromkeys(("nothing", "mark", "frame", "red", "tissue", "gap"), 0)
    for x in range(panel * PANEL, (panel + 1) * PANEL):
        column = [kind_of(*row[4 * x:4 * x + 3]) for row in rows]
        for kind in column:
            count[kind] += 1
        body = [y for y, kind in enumerate(column) if kind not in ("nothing", "mark")]
        if body:  # background between the body's highest and lowest pixel: a tear
            count["gap"] += column[body[0]:body[-1]].count("nothing")
    return count


size, picture = read_png(sys.argv[1])
assert size == (3 * PANEL, HEIGHT), size
intact, tearing, torn = (measure(picture, p) for p in range(3))
print("intact ", intact, "\ntearing", tearing, "\ntorn   ", torn)

# The expected sizes follow from the scene: the board is 50 x 50 mm at 600 / (2 x 41) pixels a mm,
# its frames take 2 x 6.25 mm of the height, the arrow is 9 mm long.
pixels = (PANEL / (2 * 41)) ** 2
for part in (intact, tearing, torn):
    assert 0.8 < part["frame"] / (2 * 6.25 * 50 * pixels) < 1.3, "both frames are there, unbroken"
    assert part["mark"] > 9 * 0.1 * 9 * pixels * 0.8, "the instrument is marked"
assert intact["gap"] < 60, "no tear before the first rupture"
assert 0.5 * 37.5 * 50 * pixels < intact["tissue"] + intact["red"], "the tissue is there"
assert intact["gap"] + 500 < tearing["gap"] < torn["gap"] / 4, "destroyed elements are gone"
assert tearing["red"] > intact["red"] > 0, "the crack's tip carries the stress"
assert torn["red"] < tearing["red"] / 2, "the torn board is relieved"
print("the picture shows what it must")
