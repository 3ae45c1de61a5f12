#!/usr/bin/env python3
"""spoor-figures as a program: figures_test.py BIN_DIRECTORY SOURCE_DIRECTORY"""
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

BIN = pathlib.Path(sys.argv[1])
SOURCE = pathlib.Path(sys.argv[2])
LIMIT_S = 120


def figures(*options):
    return subprocess.run([BIN / "spoor-figures", "--backend=native", *options], capture_output=True, text=True, timeout=LIMIT_S)


def rows_of(file):
    """A picture's size and its rows of 8-bit RGB, without the filters."""
    data = file.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", f"{file} is no PNG"
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, colours = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert (depth, colours) == (8, 2), f"{file}: not 8-bit RGB"
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    raw, rows, before = zlib.decompress(packed), [], bytes(width * 3)
    for y in range(height):
        line = bytearray(raw[y * (width * 3 + 1) + 1:(y + 1) * (width * 3 + 1)])
        way = raw[y * (width * 3 + 1)]
        for i in range(len(line)):
            left, up, corner = (line[i - 3], before[i], before[i - 3]) if i > 2 else (0, before[i], 0)
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, paeth)[way]) & 255
        rows.append(bytes(line))
        before = rows[-1]
    return width, height, rows


def colour_count(file, size):
    width, height, rows = rows_of(file)
    assert (width, height) == size, f"{file}: {width}x{height}"
    return len({row[i:i + 3] for row in rows for i in range(0, len(row), 3)})


def the_pressed_box_is_drawn_with_each_metric(folder):
    done = figures(f"--out={folder}", "--only=5.2", "--size=160x120")
    assert done.returncode == 0, done.stderr
    files = sorted(file.name for file in folder.iterdir())
    assert files == [f"figure_5.2_direct_{metric}.png" for metric in ("chebyshev", "euclidean", "manhattan")], files
    for name in files:
        assert colour_count(folder / name, (160, 120)) > 100, f"{name} is blank"


def a_pack_is_drawn_before_and_after_its_session(folder):
    pack = SOURCE / "tests/golden/box.pack"
    for look in ("trails", "follow", "above", "overview", "columns"):
        done = figures(f"--out={folder}", f"--pack={pack}", "--ticks=30", f"--look={look}", "--size=96x64", "--highlight")
        assert done.returncode == 0, done.stderr
        assert colour_count(folder / f"box_{look}.png", (96, 64)) > 50, f"{look} is blank"
    for tick in ("0", "30"):
        assert figures(f"--out={folder}", f"--pack={pack}", f"--ticks={tick}", "--look=above", "--no-bodies", f"--name=at_{tick}", "--size=96x64").returncode == 0
    assert rows_of(folder / "at_0.png") != rows_of(folder / "at_30.png"), "the box left no track"


def a_crater_of_each_kind_is_drawn(folder):
    done = figures(f"--out={folder}", "--only=craters", "--size=96x54", "--ground=grass")
    assert done.returncode == 0, done.stderr
    files = sorted(file.name for file in folder.iterdir())
    kinds = ("above", "deep", "double", "ground", "inside", "shallow", "single")
    assert files == [f"crater_{kind}_grass.png" for kind in kinds], files
    for name in files:
        assert colour_count(folder / name, (96, 54)) > 200, f"{name} is blank"


def what_cannot_be_drawn_is_said_in_one_line(folder):
    for options, code, text in (
        (["--only=5.4"], 2, "5.1, 5.2 or 5.3, or craters or drift"),
        (["--measure=tiles"], 2, "want craters or drift"),
        (["--json=numbers.json"], 2, "--measure"),
        ([f"--pack={SOURCE / 'tests/golden/box.pack'}", "--ticks=0", "--look=crater"], 1, "crater 0 is asked for, there are 0 at tick 0"),
        (["--look=inside"], 2, "--look"),
        (["--ground=lava"], 2, "--ground"),
        (["--blur-normals=17"], 2, "blur-normals"),
        (["--pack=missing.pack"], 1, "missing.pack"),
        ([f"--pack={SOURCE / 'README.md'}"], 1, "not a Spoor scene pack"),
    ):
        done = figures(f"--out={folder}", *options)
        assert done.returncode == code and text in done.stderr and done.stderr.count("\n") == 1, (options, done.returncode, done.stderr)


for case in (the_pressed_box_is_drawn_with_each_metric, a_pack_is_drawn_before_and_after_its_session, a_crater_of_each_kind_is_drawn, what_cannot_be_drawn_is_said_in_one_line):
    with tempfile.TemporaryDirectory() as scratch:
        case(pathlib.Path(scratch))
    print(f"ok {case.__name__}")
