#!/usr/bin/env python3
"""Draws the figures of Persson's thesis: figures.py BIN_DIRECTORY OUT_DIRECTORY [--only NUMBER] [--size WIDTHxHEIGHT] [--backend NAME]

Imports the scenes beside this file to packs in OUT_DIRECTORY/packs and calls spoor-figures. File names say what a picture shows.
"""
import argparse
import pathlib
import subprocess
import sys

SCENES = pathlib.Path(__file__).resolve().parent

# Figure, picture, scene, and how to draw it.
FIGURES = [
    ("5.8", "figure_5.8_all_of_the_terrain", "thesis_5_8", ["--look=overview", "--sun=12", "--highlight", "--all-active", "--ticks=200"]),
    ("5.8", "figure_5.8_active_areas", "thesis_5_8", ["--look=overview", "--sun=12", "--highlight", "--ticks=200"]),
    ("5.10", "figure_5.10_before", "thesis_5_3", ["--look=overview", "--sun=12", "--ticks=0"]),
    ("5.10", "figure_5.10_after", "thesis_5_3", ["--look=overview", "--sun=12"]),
    ("5.11", "figure_5.11_heightmap_512", "thesis_5_11_left", ["--look=trails"]),
    ("5.11", "figure_5.11_heightmap_4096", "thesis_5_11_right", ["--look=trails"]),
    ("5.12", "figure_5.12_compression_0", "thesis_5_12_left", ["--look=trails"]),
    ("5.12", "figure_5.12_compression_0.9", "thesis_5_12_right", ["--look=trails"]),
    ("5.13", "figure_5.13_roughness_0.1", "thesis_5_13_left", ["--look=trails"]),
    ("5.13", "figure_5.13_roughness_0.8", "thesis_5_13_right", ["--look=trails"]),
    ("5.14", "figure_5.14_slope_threshold_0.1", "thesis_5_14_left", ["--look=trails", "--sun=10"]),
    ("5.14", "figure_5.14_slope_threshold_4.9", "thesis_5_14_right", ["--look=trails", "--sun=10"]),
    ("5.15", "figure_5.15_left_firm_snow", "thesis_5_15_left", ["--look=trails"]),
    ("5.15", "figure_5.15_middle_firm_snow", "thesis_5_15_middle", ["--look=trails"]),
    ("5.15", "figure_5.15_right_loose_snow", "thesis_5_15_right", ["--look=trails"]),
]
WITHOUT_PACK = ["5.1", "5.2", "5.3"]


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bin", type=pathlib.Path, metavar="BIN_DIRECTORY")
    parser.add_argument("out", type=pathlib.Path, metavar="OUT_DIRECTORY")
    parser.add_argument("--only", choices=WITHOUT_PACK + sorted({figure for figure, *_ in FIGURES}))
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--backend", default="auto")
    return parser.parse_args()


def main():
    arguments = parse()
    common = [f"--out={arguments.out}", f"--size={arguments.size}", f"--backend={arguments.backend}"]
    packs = arguments.out / "packs"
    packs.mkdir(parents=True, exist_ok=True)
    for figure in WITHOUT_PACK:
        if arguments.only in (None, figure):
            subprocess.run([arguments.bin / "spoor-figures", f"--only={figure}", *common], check=True)
    for figure, name, scene, how in FIGURES:
        if arguments.only not in (None, figure):
            continue
        pack = packs / f"{scene}.pack"
        subprocess.run([arguments.bin / "spoor-import", f"--scene={SCENES / scene}.toml", f"--out={pack}"], check=True, stdout=subprocess.DEVNULL)
        subprocess.run([arguments.bin / "spoor-figures", f"--pack={pack}", f"--name={name}", *how, *common], check=True)


try:
    main()
except (subprocess.CalledProcessError, OSError) as problem:
    sys.exit(f"figures.py: {problem}")
