#!/usr/bin/env python3
"""Fails when the reference compiler of GLSL (glslang) refuses a shader or warns: drivers are more lenient, each in its own way.

check_shaders.py SOURCE_DIRECTORY; exit 77 (skipped) where glslangValidator is missing.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1]).resolve()
STAGES = {".comp": "comp", ".vert": "vert", ".tesc": "tesc", ".tese": "tese", ".frag": "frag"}
# What the host defines (gl_programs.cpp, renderer.cpp), in every combination that makes another text.
COMPACTS = [f"SPOOR_COMPACTS {compacts}" for compacts in (0, 1)]
METRICS = [f"SPOOR_METRIC {metric}" for metric in (0, 1, 2)]
SPREADS = [f"SPOOR_SPREAD {spread}" for spread in (0, 1)]
MIXED = [f"SPOOR_MIXED {mixed}" for mixed in (0, 1)]
SLOPES = [f"{mixed}|SPOOR_BENEATH {beneath}" for mixed in MIXED for beneath in (0, 1)]
DEFINES = {
    "gather.comp": [f"{mixed}|{compacts}" for mixed in MIXED for compacts in COMPACTS],
    "penetration.comp": ["SPOOR_COMPACTS 0"] + [f"{mixed}|SPOOR_COMPACTS 1" for mixed in MIXED],
    "hash.comp": COMPACTS,
    "nearest_search.comp": METRICS,
    "flood_pass.comp": METRICS,
    "flow_begin.comp": METRICS,
    "displace_request.comp": [f"{spread}|SPOOR_SEARCH 0" for spread in SPREADS] + [f"{spread}|SPOOR_SEARCH 1|{metric}" for spread in SPREADS for metric in METRICS],
    "displace_take.comp": SPREADS,
    "picture.frag": [f"SPOOR_TEXTURES {textures}|SPOOR_COVER {cover}" for textures in (1, 511) for cover in (0, 1)],
    "terrain.tese": [f"SPOOR_STONES {stones}|SPOOR_COVER {cover}" for stones in (0, 1) for cover in (0, 1)],
    "slope_amounts.comp": SLOPES,
    "slope_gather.comp": SLOPES,
    "slope_scatter.comp": SLOPES,
    "slope_flux.comp": SLOPES,
    "drift.comp": [f"{slopes}|SPOOR_WEIGHTS {weights}|SPOOR_PUSHES {pushes}"
                   for slopes in SLOPES for weights in (0, 1, 2) for pushes in (0, 1)],
    "push_soil.comp": MIXED,
    "sweep.comp": MIXED,
    "exchange_along.comp": [f"{slopes}|SPOOR_PARITY {parity}|SPOOR_SHIFT 0" for slopes in SLOPES for parity in (0, 1)],
    "exchange_across.comp": [f"{slopes}|SPOOR_PARITY {parity}|SPOOR_SHIFT {shift}"
                             for slopes in SLOPES for parity in (0, 1) for shift in (0, 1, -1)],
}


def expanded(file):
    """A shader with its includes put in; those of C++ left out."""
    lines = []
    for line in file.read_text().splitlines():
        if wanted := re.match(r'\s*#\s*include\s*"([^"]+)"', line):
            lines += expanded(file.parent / wanted.group(1))
        elif not re.match(r"\s*#\s*include\s*<", line):
            lines.append(line)
    return lines


def faults(file, defines, scratch):
    lines = expanded(file)
    version = next((i for i, line in enumerate(lines) if line.startswith("#version")), None)
    if version is None:
        return [f"{file}: has no #version line"]
    source = scratch / file.name
    source.write_text("\n".join([lines[version], "#define SPOOR_GROUP 64"] + [f"#define {d}" for d in defines] + lines[version + 1:]))
    run = subprocess.run(["glslangValidator", "-S", STAGES[file.suffix], source], capture_output=True, text=True)
    said = [line for line in run.stdout.splitlines() if line.strip() and line.strip() != str(source)]
    return [f"{file.relative_to(ROOT)} {' '.join(defines)}: {line}" for line in said] or ([f"{file}: refused"] if run.returncode else [])


def main():
    if shutil.which("glslangValidator") is None:
        print("skipped: glslangValidator is missing (Debian: glslang-tools)")
        return 77
    found, count = [], 0
    with tempfile.TemporaryDirectory() as scratch:
        for file in sorted([*(ROOT / "shaders").rglob("*"), *(ROOT / "tests").glob("*")]):
            if file.suffix not in STAGES:
                continue
            for defines in DEFINES.get(file.name, [""]):
                found += faults(file, [d for d in defines.split("|") if d], pathlib.Path(scratch))
                count += 1
    print("\n".join(found + [f"{count} shaders compiled, {len(found)} complaints"]))
    return 1 if found or count == 0 else 0


sys.exit(main())
