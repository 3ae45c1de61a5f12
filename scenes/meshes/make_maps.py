#!/usr/bin/env python3
"""Writes the example description map beside itself, materials.png: 64 x 64 pixels, three strips with wavy borders.

Its pixels are stored, not compressed, so that every run writes the same bytes.
"""
import math
import os
import struct
import zlib

SIZE = 64
COLOURS = ((0x5B, 0x43, 0x31), (0xD8, 0xBC, 0x8A), (0x8D, 0x8A, 0x83))  # mud, sand, pebbles


def strip(column, row):
    bend = 2.5 * math.sin(2 * math.pi * row / SIZE)
    return sum(column + bend >= border for border in (SIZE * 0.36, SIZE * 0.66))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def stored(data):
    """A zlib stream of one stored block; data: less than 64 KiB."""
    return b"\x78\x01\x01" + struct.pack("<HH", len(data), len(data) ^ 0xFFFF) + data + struct.pack(">I", zlib.adler32(data))


if __name__ == "__main__":
    rows = b"".join(b"\0" + b"".join(bytes(COLOURS[strip(column, row)]) for column in range(SIZE)) for row in range(SIZE))
    header = struct.pack(">IIBBBBB", SIZE, SIZE, 8, 2, 0, 0, 0)
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "materials.png")
    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", stored(rows)) + chunk(b"IEND", b""))
