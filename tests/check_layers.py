#!/usr/bin/env python3
"""Fails when an include or a link crosses an arrow of the rooms (README, "Layout").

rules <- shared <- {protocol, shaders/host} <- {server, client, bench}; server and client never meet; outside libraries
stay in the room that owns them.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()

# A room may include from these folders. The longest matching name is a file's room.
MAY_INCLUDE = {
    "shaders/rules": ["shaders/rules"],
    "shared/base": ["shaders/rules", "shared/base"],
    "shared/world": ["shaders/rules", "shared/base", "shared/world"],
    "shared/codec": ["shaders/rules", "shared/base", "shared/world", "shared/codec"],
    "shared/sim": ["shaders/rules", "shared"],
    "shaders/sim": ["shaders/rules", "shaders/sim"],
    "shaders/host": ["shaders/rules", "shared", "shaders/sim", "shaders/host"],
    "protocol": ["shaders/rules", "shared", "protocol"],
    "server": ["shaders/rules", "shared", "protocol", "shaders/host", "server"],
    "shaders/render": ["shaders/rules", "shaders/sim", "shaders/render"],
    "client": ["shaders/rules", "shaders/render", "shared", "protocol", "shaders/host", "client"],
    "tests/bench": ["shaders/rules", "shared", "shaders/host", "tests/bench"],
}
# An outside library (first part of the include) and the only files that may name it.
OWNERS = {
    "enet": r"protocol/enet_[a-z_]*\.(h|cpp)$",
    "flatbuffers": r"protocol/[a-z_]*\.cpp$",
    "messages_generated.h": r"protocol/[a-z_]*\.cpp$",
    "zstd.h": r"protocol/[a-z_]*\.cpp$",
    "gdal": r"server/import/", "gdal_priv.h": r"server/import/", "ogr_spatialref.h": r"server/import/",
    "assimp": r"server/import/",
    "toml++": r"server/import/",
    "epoxy": r"(client|shaders/host)/", "GLFW": r"client/", "glm": r"(client|shaders/render)/", "png.h": r"client/",
    "fmt": r"(protocol|server|client)/", "spdlog": r"(protocol|server|client)/",
}
# Rooms of the core, and what they may include besides the project and what they own: the C++ standard library and the C
# library's option parser and loader.
CORE = ("shaders/rules", "shaders/sim", "shaders/host", "shared")
STANDARD = re.compile(r"^([a-z_]+|getopt\.h|dlfcn\.h)$")
# Libraries a room's targets may be linked to.
MAY_LINK = {
    "shared": {"spoor_flags", "spoor_shared", "Threads::Threads"},
    "shaders": {"spoor_gl", "spoor_backends", "spoor_shared", "epoxy", "${CMAKE_DL_LIBS}"},
    "protocol": {"spoor_protocol", "spoor_shared", "enet", "flatbuffers", "zstd", "fmt", "spdlog"},
    "tests/bench": {"spoor-bench", "spoor_backends", "spoor_gl"},
}
NEVER_LINK = {"server": {"spoor_render", "spoor_client", "spoor_session"}, "client": {"spoor_import", "spoor_host"}}

INCLUDE = re.compile(r'^\s*#\s*include\s+[<"]([^>"]+)[>"]', re.M)


def room_of(path):
    rooms = [room for room in MAY_INCLUDE if path.startswith(room + "/")]
    return max(rooms, key=len, default=None)


def check_includes(path, room, faults):
    for include in INCLUDE.findall((ROOT / path).read_text()):
        beside = (ROOT / path).parent / include
        if beside.is_file() and beside.resolve().is_relative_to(ROOT):
            include = beside.resolve().relative_to(ROOT).as_posix()
        if (ROOT / include).is_file():
            if not any(include.startswith(folder + "/") for folder in MAY_INCLUDE[room]):
                faults.append(f"{path}: includes {include}, which {room} may not know")
            continue
        library = include.split("/")[0]
        owner = OWNERS.get(include) or OWNERS.get(library)
        if owner and not re.match(owner, path):
            faults.append(f"{path}: includes {include}, which belongs to {owner}")
        if room.startswith(CORE) and not owner and not STANDARD.match(include):
            faults.append(f"{path}: includes {include}; the core knows the standard library only")


def check_links(path, faults):
    room = str(pathlib.PurePosixPath(path).parent)
    for call in re.findall(r"target_link_libraries\(([^)]*)\)", (ROOT / path).read_text()):
        names = {word for word in re.sub(r"#.*", "", call).split() if word not in ("PUBLIC", "PRIVATE", "INTERFACE")}
        plain = {re.sub(r"^PkgConfig::|::.*$", "", name).lower() if name not in MAY_LINK.get(room, ()) else name for name in names}
        if room in MAY_LINK:
            for name in sorted(plain - {n.lower() for n in MAY_LINK[room]} - MAY_LINK[room]):
                faults.append(f"{path}: links {name}, which {room} may not know")
        for name in sorted(names & NEVER_LINK.get(room, set())):
            faults.append(f"{path}: links {name}, which {room} may not know")


def main():
    faults = []
    files = 0
    for suffix in ("*.h", "*.cpp", "*.inl", "*.glsl", "*.vert", "*.tesc", "*.tese", "*.frag", "*.comp"):
        for file in sorted(ROOT.rglob(suffix)):
            path = file.relative_to(ROOT).as_posix()
            room = room_of(path)
            if room and not path.startswith("build"):
                files += 1
                check_includes(path, room, faults)
    for file in sorted(ROOT.rglob("CMakeLists.txt")):
        path = file.relative_to(ROOT).as_posix()
        if not path.startswith("build"):
            check_links(path, faults)
    for fault in faults:
        print(fault)
    print(f"{files} files checked, {len(faults)} arrows crossed")
    return 1 if faults or files == 0 else 0


sys.exit(main())
