"""Triangle meshes of simple shapes: metres, z up, outward counter-clockwise faces, unit normals.

Flat faces meet in small bevels whose corners keep the faces' normals, so an edge catches light
like a real, rounded one and costs two triangles. Every shape here is closed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Mesh:
    positions: F64  # (V, 3), m
    normals: F64  # (V, 3), unit
    uvs: F64  # (V, 2), glTF: v down
    triangles: NDArray[np.int64]  # (T, 3)

    def moved(self, offset: ArrayLike = (0, 0, 0), rotation: F64 | None = None) -> Mesh:
        turn = np.eye(3) if rotation is None else rotation
        shift = np.asarray(offset, dtype=float)
        return Mesh(
            self.positions @ turn.T + shift, self.normals @ turn.T, self.uvs, self.triangles
        )

    def kept(self, mask: NDArray[np.bool_]) -> Mesh:
        """The triangles where `mask` is true, with the vertices they use."""
        used, triangles = np.unique(self.triangles[mask], return_inverse=True)
        return Mesh(
            self.positions[used], self.normals[used], self.uvs[used], triangles.reshape(-1, 3)
        )


def merge(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0] + [len(m.positions) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.positions for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.uvs for m in meshes]),
        np.concatenate([m.triangles + s for m, s in zip(meshes, starts, strict=True)]),
    )


def rotation(axis: ArrayLike, angle_deg: float) -> F64:
    """The matrix of a right-handed turn about an axis (Rodrigues)."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    angle = np.radians(angle_deg)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def z_to(direction: ArrayLike) -> F64:
    """A rotation that takes +z to a direction."""
    d = np.asarray(direction, dtype=float) / np.linalg.norm(direction)
    if d[2] < -1 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    v = np.array([-d[1], d[0], 0.0])  # z cross d
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1 + d[2])


def _unit(vectors: F64) -> F64:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def bevel_box(size: ArrayLike, bevel: float = 0.004) -> Mesh:
    """A box about the origin; its edges are cut at 45 degrees by `bevel`.

    Four vertices a face, in the order -x +x -y +y -z +z; uv spans 0..1 on each face.
    """
    half = np.asarray(size, dtype=float) / 2
    inner = half - min(bevel, 0.45 * float(half.min() * 2))
    positions, normals, uvs = [], [], []
    corner: dict[tuple[int, ...], int] = {}
    for axis in range(3):
        for sign in (-1, 1):
            u, v = (
                ((axis + 1) % 3, (axis + 2) % 3) if sign > 0 else ((axis + 2) % 3, (axis + 1) % 3)
            )
            for su, sv in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                signs = np.zeros(3)
                signs[[axis, u, v]] = sign, su, sv
                point = signs * inner
                point[axis] = sign * half[axis]
                corner[(axis, *signs.astype(int))] = len(positions)
                positions.append(point)
                normals.append(np.eye(3)[axis] * sign)
                uvs.append(((su + 1) / 2, (1 - sv) / 2))
    triangles = [
        t for f in range(6) for t in ((4 * f, 4 * f + 1, 4 * f + 2), (4 * f, 4 * f + 2, 4 * f + 3))
    ]
    triangles += _bevels(corner)
    mesh = Mesh(
        np.array(positions), np.array(normals), np.array(uvs, dtype=float), np.array(triangles)
    )
    return _outward(mesh)


def _bevels(corner: dict[tuple[int, ...], int]) -> list[tuple[int, int, int]]:
    """Twelve edge strips and eight corner triangles, of either winding."""
    out = []
    for a in range(3):  # the edge runs along axis a, between faces b and c
        b, c = (a + 1) % 3, (a + 2) % 3
        for sb in (-1, 1):
            for sc in (-1, 1):
                ends = []
                for sa in (-1, 1):
                    signs = [0, 0, 0]
                    signs[a], signs[b], signs[c] = sa, sb, sc
                    ends.append((corner[(b, *signs)], corner[(c, *signs)]))
                (b0, c0), (b1, c1) = ends
                out += [(b0, c0, c1), (b0, c1, b1)]
    for sx in (-1, 1):
        for sy in (-1, 1):
            for sz in (-1, 1):
                out.append(tuple(corner[(axis, sx, sy, sz)] for axis in range(3)))
    return out


def _outward(mesh: Mesh) -> Mesh:
    """Turns triangles whose winding disagrees with their vertex normals."""
    p = mesh.positions[mesh.triangles]
    face = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    flip = (face * mesh.normals[mesh.triangles].sum(axis=1)).sum(axis=1) < 0
    triangles = mesh.triangles.copy()
    triangles[flip] = triangles[flip][:, ::-1]
    return Mesh(mesh.positions, mesh.normals, mesh.uvs, triangles)


def lathe(profile: ArrayLike, sides: int = 32, crease_deg: float = 35.0) -> Mesh:
    """A surface of revolution about z from (radius, z) points.

    Walk the profile with the outside on the left hand: from the top to the bottom, for a shape
    around the axis. Points where the profile turns by more than `crease_deg` are hard edges.
    Profiles that start and end on the axis, or where they began, give closed surfaces.
    """
    points = np.asarray(profile, dtype=float)
    step = np.diff(points, axis=0)
    outward = _unit(np.stack([-step[:, 1], step[:, 0]], axis=1))
    closed = np.allclose(points[0], points[-1])
    rows = _profile_rows(points, outward, np.cos(np.radians(crease_deg)), closed)
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    angle[-1] = 0.0  # the seam closes to the last bit
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(step, axis=1))])
    positions, normals, uvs, triangles = [], [], [], []
    for (i, n0), (j, n1) in rows:
        start = len(positions) * (sides + 1)
        for k, n in ((i, n0), (j, n1)):
            r, z = points[k]
            positions.append(np.column_stack([ring * r, np.full(sides + 1, z)]))
            normals.append(np.column_stack([ring * n[0], np.full(sides + 1, n[1])]))
            turn = np.linspace(0, 1, sides + 1)
            uvs.append(np.column_stack([turn, np.full(sides + 1, along[k] / along[-1])]))
        a = start + np.arange(sides)
        b = a + sides + 1
        if points[j][0] > 0:
            triangles.append(np.stack([a, b, b + 1], axis=1))
        if points[i][0] > 0:
            triangles.append(np.stack([a, b + 1, a + 1], axis=1))
    mesh = Mesh(
        np.concatenate(positions),
        np.concatenate(normals),
        np.concatenate(uvs),
        np.concatenate(triangles),
    )
    return weld(mesh)


def _profile_rows(
    points: F64, outward: F64, cos_crease: float, closed: bool
) -> list[tuple[tuple[int, F64], tuple[int, F64]]]:
    """For each segment the profile normals at its two ends, smoothed across soft joints."""
    count = len(outward)

    def joint(before: int, after: int, own: int) -> F64:
        if not closed and (before < 0 or after >= count):
            end = outward[own].copy()
            if points[0 if before < 0 else -1][0] == 0 and abs(end[1]) > cos_crease:
                end = np.array([0.0, np.sign(end[1])])  # a smooth pole
            return end
        pair = outward[before % count], outward[after % count]
        return _unit(pair[0] + pair[1]) if pair[0] @ pair[1] > cos_crease else outward[own]

    return [((s, joint(s - 1, s, s)), (s + 1, joint(s, s + 1, s))) for s in range(count)]


def weld(mesh: Mesh) -> Mesh:
    """Joins vertices that agree in position, normal and uv to six decimals, in first-seen order."""
    key = np.round(np.column_stack([mesh.positions, mesh.normals, mesh.uvs]), 6) + 0.0
    _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    keep = first[order]
    triangles = rank[inverse.reshape(-1)][mesh.triangles]
    return Mesh(mesh.positions[keep], mesh.normals[keep], mesh.uvs[keep], triangles)


def cylinder(radius: float, height: float, sides: int = 24, bevel: float = 0.0) -> Mesh:
    """A closed cylinder about z, centred; `bevel` cuts its rims."""
    return cone(radius, radius, height, sides, bevel)


def cone(bottom: float, top: float, height: float, sides: int = 24, bevel: float = 0.0) -> Mesh:
    """A closed truncated cone about z, centred. A radius of 0 makes a point."""
    h = height / 2
    profile = [(0.0, h)]
    if top > 0:
        profile += [(top - bevel, h), (top, h - bevel)] if bevel else [(top, h)]
    if bottom > 0:
        profile += [(bottom, bevel - h), (bottom - bevel, -h)] if bevel else [(bottom, -h)]
    return lathe([*profile, (0.0, -h)], sides)


def ring(inner: float, outer: float, height: float, sides: int = 32, bevel: float = 0.0) -> Mesh:
    """A closed ring of rectangular section about z, centred."""
    h, b = height / 2, bevel
    if b == 0:
        section = [(inner, h), (outer, h), (outer, -h), (inner, -h), (inner, h)]
    else:
        section = [
            (inner + b, h),
            (outer - b, h),
            (outer, h - b),
            (outer, b - h),
            (outer - b, -h),
            (inner + b, -h),
            (inner, b - h),
            (inner, h - b),
            (inner + b, h),
        ]
    return lathe(section, sides)


def torus(radius: float, tube_radius: float, sides: int = 32, tube_sides: int = 10) -> Mesh:
    angle = np.linspace(np.pi / 2, np.pi / 2 - 2 * np.pi, tube_sides + 1)
    section = np.column_stack([radius + tube_radius * np.cos(angle), tube_radius * np.sin(angle)])
    section[-1] = section[0]
    return lathe(section, sides, crease_deg=80.0)


def sphere(radius: float, sides: int = 24, rows: int = 12) -> Mesh:
    angle = np.linspace(0, np.pi, rows + 1)
    profile = radius * np.column_stack([np.sin(angle), np.cos(angle)])
    profile[[0, -1], 0] = 0.0
    return lathe(profile, sides, crease_deg=80.0)


def dish(radius: float, depth: float, thickness: float, sides: int = 40, rows: int = 10) -> Mesh:
    """A paraboloid reflector open to +z with its vertex at the origin."""
    r = np.linspace(0, radius, rows + 1)
    front = np.column_stack([r, depth * (r / radius) ** 2])
    back = front[::-1] - [0.0, thickness]
    return lathe(np.concatenate([front, back]), sides, crease_deg=60.0)


def nozzle(
    throat: float, exit_radius: float, length: float, wall: float, sides: int = 32, rows: int = 10
) -> Mesh:
    """A bell nozzle: throat at the origin, exit at z = -length; open, with a wall."""
    t = np.linspace(0, 1, rows)
    # A parabola that leaves the throat steeply, as Rao's approximation of an ideal bell does.
    r = throat + (exit_radius - throat) * (1 - (1 - t) ** 1.9)
    inside = np.column_stack([r, -length * t])
    outside = inside + np.array([wall, 0.0])
    plug = [(0.0, 0.0)]  # the injector's end of the throat
    top = [(0.0, wall), (throat + wall, wall)]
    return lathe(np.concatenate([top, outside, inside[::-1], plug]), sides)


SHARP_BEND_DEG = 60.0


def tube(path: ArrayLike, radius: float, sides: int = 8) -> Mesh:
    """A round bar along a polyline with mitred corners and flat ends.

    Corners of more than SHARP_BEND_DEG are hard edges, others are shaded smoothly.
    """
    points = np.asarray(path, dtype=float)
    forward = _unit(np.diff(points, axis=0))
    across = z_to(forward[0])[:, 0]
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    angle[-1] = 0.0
    runs: list[list[tuple[F64, F64]]] = [[]]  # rings and their normals, between hard edges
    for i, point in enumerate(points):
        before, after = forward[max(i - 1, 0)], forward[min(i, len(forward) - 1)]
        spoke = np.outer(np.cos(angle), across) + np.outer(np.sin(angle), np.cross(before, across))
        if before @ after < np.cos(np.radians(SHARP_BEND_DEG)):
            tangent = _unit(before + after)
            slide = -(spoke @ tangent) / (before @ tangent)
            runs[-1].append((point + radius * (spoke + np.outer(slide, before)), spoke))
            runs.append([])
            # Parallel transport keeps the section from twisting: the least rotation about the bend.
            across = across - (before + after) * (across @ after) / (1.0 + before @ after)
        elif i > 0:  # the same for small bends, to first order
            across = across - after * (across @ after)
        across = across / np.linalg.norm(across)
        spoke = np.outer(np.cos(angle), across) + np.outer(np.sin(angle), np.cross(after, across))
        tangent = _unit(before + after)
        # Slide each spoke along the bar onto the mitre plane.
        slide = -(spoke @ tangent) / (after @ tangent)
        runs[-1].append((point + radius * (spoke + np.outer(slide, after)), spoke))
    walls = [_tube_wall(*(np.array(part) for part in zip(*run, strict=True))) for run in runs]
    first, last = runs[0][0][0], runs[-1][-1][0]
    return merge(*walls, _cap(first, -forward[0]), _cap(last, forward[-1]))


def _tube_wall(rings: F64, normals: F64) -> Mesh:
    rows, columns = rings.shape[:2]
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    b = a + columns
    triangles = np.concatenate(
        [np.stack([a, a + 1, b + 1], axis=1), np.stack([a, b + 1, b], axis=1)]
    )
    v, u = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    uvs = np.stack([u, v], axis=-1).reshape(-1, 2)
    return Mesh(rings.reshape(-1, 3), normals.reshape(-1, 3), uvs, triangles)


def _cap(points: F64, normal: F64) -> Mesh:
    """A fan over a convex ring of points whose first equals its last."""
    ring_points = points[:-1]
    count = len(ring_points)
    triangles = np.stack(
        [np.zeros(count - 2), np.arange(1, count - 1), np.arange(2, count)], axis=1
    )
    normals = np.tile(normal, (count, 1))
    return _outward(Mesh(ring_points, normals, np.zeros((count, 2)), triangles.astype(int)))


def prism(outline: ArrayLike, height: float, bevel: float = 0.004) -> Mesh:
    """A convex outline (x, y), counter-clockwise, extruded about z = 0, with bevelled rims."""
    points = np.asarray(outline, dtype=float)
    count = len(points)
    edge = np.roll(points, -1, axis=0) - points
    normal = _unit(np.stack([edge[:, 1], -edge[:, 0]], axis=1))
    bisector = _unit(normal + np.roll(normal, 1, axis=0))
    inner = points - bisector * bevel / (bisector * normal).sum(axis=1, keepdims=True)
    h = height / 2
    parts = [
        _cap(
            np.column_stack([np.append(inner, inner[:1], axis=0), np.full(count + 1, s * h)]),
            np.array([0.0, 0.0, s]),
        )
        for s in (-1.0, 1.0)
    ]
    for i in range(count):
        j = (i + 1) % count
        side = np.append(normal[i], 0.0)
        rows = [
            (inner[i], inner[j], h, np.array([0.0, 0.0, 1.0])),
            (points[i], points[j], h - bevel, side),
            (points[i], points[j], bevel - h, side),
            (inner[i], inner[j], -h, np.array([0.0, 0.0, -1.0])),
        ]
        positions = np.array([[*p, z] for a, b, z, _ in rows for p in (a, b)])
        normals = np.array([n for *_, n in rows for _ in (0, 1)])
        triangles = np.array([t for k in (0, 2, 4) for t in ((k, k + 2, k + 3), (k, k + 3, k + 1))])
        parts.append(_outward(Mesh(positions, normals, np.zeros((8, 2)), triangles)))
    return merge(*parts)


def smooth_normals(mesh: Mesh) -> Mesh:
    """Area-weighted vertex normals, shared by vertices at the same place."""
    p = mesh.positions[mesh.triangles]
    face = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    _, group = np.unique(np.round(mesh.positions, 6) + 0.0, axis=0, return_inverse=True)
    group = group.reshape(-1)
    total = np.zeros((group.max() + 1, 3))
    for k in range(3):
        np.add.at(total, group[mesh.triangles[:, k]], face)
    return Mesh(mesh.positions, _unit(total)[group], mesh.uvs, mesh.triangles)


def displaced(mesh: Mesh, height: Callable[[F64], F64]) -> Mesh:
    """Moves vertices along their normals by height(positions), m, and shades them smoothly."""
    positions = mesh.positions + mesh.normals * height(mesh.positions)[:, None]
    return smooth_normals(Mesh(positions, mesh.normals, mesh.uvs, mesh.triangles))


def rounded_box(size: ArrayLike, radius: float, cells: Sequence[int], arc: int = 2) -> Mesh:
    """A box about the origin with round edges and a grid on its faces, ready to be displaced."""
    half = np.asarray(size, dtype=float) / 2
    lines = []
    for axis in range(3):
        bend = half[axis] - radius * (1 - np.tan(np.linspace(0, np.pi / 4, arc + 1))[1:])
        flat = np.linspace(radius - half[axis], half[axis] - radius, cells[axis] + 1)
        lines.append(np.concatenate([-bend[::-1], flat, bend]))
    faces = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            grid_u, grid_v = np.meshgrid(lines[u], lines[v], indexing="ij")
            cube = np.empty((*grid_u.shape, 3))
            cube[..., axis], cube[..., u], cube[..., v] = sign * half[axis], grid_u, grid_v
            core = np.clip(cube, radius - half, half - radius)
            normals = _unit(cube - core)
            uvs = np.stack([grid_u + half[u], grid_v + half[v]], axis=-1).reshape(-1, 2)
            face = _tube_wall(core + radius * normals, normals)
            faces.append(_outward(Mesh(face.positions, face.normals, uvs, face.triangles)))
    return merge(*faces)


def faceted(mesh: Mesh, share: float) -> Mesh:
    """Splits the triangles' corners and turns normals from smooth (share 0) towards flat (1)."""
    corners = mesh.triangles.reshape(-1)
    p = mesh.positions[mesh.triangles]
    flat = np.repeat(_unit(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])), 3, axis=0)
    normals = _unit((1 - share) * mesh.normals[corners] + share * flat)
    triangles = np.arange(len(corners)).reshape(-1, 3)
    return Mesh(mesh.positions[corners], normals, mesh.uvs[corners], triangles)
