#!/usr/bin/env python3
"""Writes the example meshes beside itself as OBJ files: x forward, y left, z up, metres.

Every mesh is a grid of blocks, solid or empty, bent into shape: faces between solid and empty blocks become two
triangles each, wound outwards. So each mesh is closed by construction, and every run writes the same bytes.
"""
import math
import os


def block_mesh(counts, is_solid, place, wraps=False):
    """The surface of the solid blocks of a grid.

    counts: blocks along i, j, k.  is_solid(i, j, k): whether a block is there.
    place(i, j, k): where a corner of the grid lies.  wraps: the grid is a ring along i.
    Returns vertices and triangles. Corners that fall together are one vertex; faces without area are left out.
    """
    vertices, index_of, triangles = [], {}, []

    def solid(i, j, k):
        if wraps:
            i %= counts[0]
        return all(0 <= a < n for a, n in zip((i, j, k), counts)) and is_solid(i, j, k)

    def point_at(i, j, k):
        return tuple(round(v, 4) + 0.0 for v in place(i % counts[0] if wraps else i, j, k))

    def vertex(point):
        if point not in index_of:
            index_of[point] = len(vertices)
            vertices.append(point)
        return index_of[point]

    # The corners of a block's face at its lower and upper side of each axis, wound outwards where the grid's axes and
    # the mesh's have the same handedness.
    faces = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            loop = [(0, 0), (1, 0), (1, 1), (0, 1)]
            if side == 0:
                loop.reverse()
            corners = []
            for a, b in loop:
                corner = [0, 0, 0]
                corner[axis], corner[u], corner[v] = side, a, b
                corners.append(tuple(corner))
            step = [0, 0, 0]
            step[axis] = 1 if side else -1
            faces.append((step, corners))

    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                if not solid(i, j, k):
                    continue
                for step, corners in faces:
                    if solid(i + step[0], j + step[1], k + step[2]):
                        continue
                    a, b, c, d = (point_at(i + x, j + y, k + z) for x, y, z in corners)
                    for triangle in ((a, b, c), (a, c, d)):
                        if len(set(triangle)) == 3:
                            triangles.append(tuple(vertex(point) for point in triangle))
    if signed_volume(vertices, triangles) < 0:
        triangles = [(a, c, b) for a, b, c in triangles]
    return vertices, triangles


def signed_volume(vertices, triangles):
    total = 0.0
    for a, b, c in triangles:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = vertices[a], vertices[b], vertices[c]
        total += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    return total / 6


def tyre():
    """Radius 0.4, width 0.28, axle along y through the origin; 12 rows of lugs in a chevron, 3 cm deep."""
    around, radii = 48, [0.0, 0.21, 0.37, 0.40]
    across = [-0.14, -0.07, 0.0, 0.07, 0.14]

    def solid(i, j, k):
        if k == 0:
            return j in (1, 2)  # the rim lies deeper than the sides
        return k == 1 or (i + (0 if j in (0, 3) else 1)) % 4 < 2

    def place(i, j, k):
        angle = 2 * math.pi * i / around
        return radii[k] * math.cos(angle), across[j], radii[k] * math.sin(angle)

    return block_mesh((around, 4, 3), solid, place, wraps=True)


def track():
    """A track's loop, 2.56 long, 0.45 wide, 0.61 high, its underside flat and at z = 0; grousers 3 cm high."""
    around, radius, straight = 56, 0.275, 1.95
    layers = [-0.06, 0.0, 0.03]
    length = 2 * straight + 2 * math.pi * radius

    def place(i, j, k):
        along = length * i / around
        reach = radius + layers[k]
        arc = math.pi * radius
        if along < straight:  # underside, forwards
            x, z = along - straight / 2, -reach
        elif along < straight + arc:
            angle = (along - straight) / radius - math.pi / 2
            x, z = straight / 2 + reach * math.cos(angle), reach * math.sin(angle)
        elif along < 2 * straight + arc:
            x, z = straight / 2 - (along - straight - arc), reach
        else:
            angle = (along - 2 * straight - arc) / radius + math.pi / 2
            x, z = -straight / 2 + reach * math.cos(angle), reach * math.sin(angle)
        return x, -0.225 + 0.45 * j, z + radius + layers[-1]

    return block_mesh((around, 1, 2), lambda i, j, k: k == 0 or i % 2 == 0, place, wraps=True)


def boot():
    """A boot 0.3 long: heel, arch, a forefoot with bars across it, and a shaft. Its sole is at z = 0."""
    stations = [-0.15, -0.12, -0.09, -0.06, -0.03, 0.0, 0.02, 0.04, 0.06, 0.08, 0.10, 0.12, 0.15]
    half_width = [0.028, 0.036, 0.037, 0.034, 0.031, 0.034, 0.040, 0.045, 0.048, 0.049, 0.046, 0.040, 0.022]
    levels = [0.0, 0.008, 0.016, 0.05, 0.10, 0.26]
    lowest = [0, 0, 0, 2, 2, 1, 0, 1, 0, 1, 0, 0]    # level of the underside of each slice
    highest = [5, 5, 5, 5, 4, 4, 3, 3, 3, 3, 3, 3]   # and of its top

    def place(i, j, k):
        return stations[i], half_width[i] * (2 * j - 1), levels[k]

    return block_mesh((12, 1, 5), lambda i, j, k: lowest[i] <= k < highest[i], place)


def blade():
    """A dozer's blade, 1.6 wide, 0.5 high, 4 mm thick, hollow towards the front; its lower edge at z = 0."""
    across, up = 16, 6

    def place(i, j, k):
        y, z = -0.8 + 1.6 * j / across, 0.5 * k / up
        back = 0.06 * (1 - ((z - 0.25) / 0.25) ** 2)
        ends = 0.08 * (y / 0.8) ** 2
        return ends - back + 0.004 * i, y, z

    return block_mesh((1, across, up), lambda i, j, k: True, place)


def box():
    """A cube of 1 m standing on z = 0."""
    return block_mesh((1, 1, 1), lambda i, j, k: True, lambda i, j, k: (i - 0.5, j - 0.5, float(k)))


def chassis():
    """A buggy's hull, 2.4 x 1.2 x 0.7, on z = 0: nose, cabin, tail, and arches where the wheels turn."""
    x = [-1.2, -1.12, -0.38, -0.25, 0.25, 0.38, 1.12, 1.2]
    y = [-0.6, -0.36, 0.36, 0.6]
    z = [0.0, 0.25, 0.45, 0.7]

    def solid(i, j, k):
        beside_wheels = i in (0, 1, 5, 6) and j != 1
        if k == 2:
            return i in (2, 3, 4) and j == 1   # cabin
        return not beside_wheels

    def place(i, j, k):
        px, py, pz = x[i], y[j], z[k]
        if k == 3:                              # the cabin tapers upwards
            px = {2: -0.34, 3: -0.22, 4: 0.08, 5: 0.20}.get(i, px)
            py *= 0.8
        if k == 0:                              # nose and tail rise at the ends
            pz += 0.12 if i in (0, 7) else 0.0
        if k == 2 and i == 7:                   # and the bonnet falls
            pz -= 0.10
        return px, py, pz

    return block_mesh((7, 3, 3), solid, place)


def write(name, mesh):
    vertices, triangles = mesh
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), name + ".obj")
    with open(path, "w", newline="\n") as out:
        out.write("# Made by make_meshes.py: x forward, y left, z up, metres\no %s\n" % name)
        for v in vertices:
            out.write("v %.4f %.4f %.4f\n" % v)
        for a, b, c in triangles:
            out.write("f %d %d %d\n" % (a + 1, b + 1, c + 1))
    print("%s.obj: %d vertices, %d triangles" % (name, len(vertices), len(triangles)))


if __name__ == "__main__":
    for make in (tyre, track, boot, blade, box, chassis):
        write(make.__name__, make())
