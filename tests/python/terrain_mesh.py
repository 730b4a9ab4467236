"""The mesh of a body's ground again, in NumPy: triangles through heights at nodes of the cube's
lattice (csrc/terrain/cube.h), on edges towards coarser tiles through those of theirs, and the
bicubic patches between them which labels show (csrc/terrain/ground_patch.h)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
TILE = 32
"""Cells of a tile on a side."""
ENOUGH = 2e-5
"""Of a cell: nearer no other level is tried."""
FACES = (
    ((0, 1, 2), (1, 1, 1)),
    ((0, 1, 2), (-1, -1, 1)),
    ((1, 0, 2), (1, -1, 1)),
    ((1, 0, 2), (-1, 1, 1)),
    ((2, 1, 0), (1, 1, -1)),
    ((2, 1, 0), (-1, 1, 1)),
)
"""Axes of a face, outwards, along s and along t, and their signs."""
TRIANGLES = (((0, 0), (1, 0), (0, 1)), ((1, 1), (0, 1), (1, 0)))
"""Corners of the lower and of the upper triangle, at (x, y), (x', y) and (x, y')."""
CORNERS = tuple(product((0, 1), repeat=2))


@dataclass(frozen=True)
class Post:
    point: F64
    slope: F64
    """(n, 3): gradient of the distance from the centre, per metre along the ground."""


def hermite(x: F64) -> tuple[tuple[F64, F64], tuple[F64, F64]]:
    """Weights of values and of slopes at 0 and 1."""
    up = x * x * (3.0 - 2.0 * x)
    return (1.0 - up, up), (x * (1.0 - x) ** 2, x * x * (x - 1.0))


def patch_m(posts: dict[tuple[int, int], Post], x: F64, y: F64) -> F64:
    """Distance from the centre of the patch through the corners (x, y) of a cell."""
    (vx, sx), (vy, sy) = hermite(x), hermite(y)
    out = np.zeros_like(x)
    for (i, j), post in posts.items():
        east = posts[1, j].point - posts[0, j].point
        north = posts[i, 1].point - posts[i, 0].point
        out += vx[i] * vy[j] * np.linalg.norm(post.point, axis=1)
        out += sx[i] * vy[j] * np.sum(post.slope * east, axis=1)
        out += vx[i] * sy[j] * np.sum(post.slope * north, axis=1)
    return out


def direction(face: int, s: F64, t: F64) -> F64:
    axes, signs = FACES[face]
    tangents = np.tan(0.25 * np.pi * s), np.tan(0.25 * np.pi * t)
    out = np.empty((len(s), 3))
    for axis, sign, along in zip(axes, signs, (np.ones_like(s), *tangents), strict=True):
        out[:, axis] = sign * along
    unit: F64 = out / np.linalg.norm(out, axis=1, keepdims=True)
    return unit


def locate(d: F64) -> tuple[I64, F64]:
    """Face, and s and t as (n, 2)."""
    main = np.abs(d).argmax(axis=1)
    face = 2 * main + (d[np.arange(len(d)), main] < 0.0)
    place = np.empty((len(d), 2))
    for f, (axes, signs) in enumerate(FACES):
        of = face == f
        across = d[of][:, axes[1:]] * signs[1:] / np.abs(d[of][:, axes[:1]])
        place[of] = np.arctan(across) * (4.0 / np.pi)
    return face, place


@dataclass(frozen=True)
class Mesh:
    """Meshes of all levels over a body of these radii."""

    terrain: _core.Terrain
    radii_m: F64

    def cell_m(self, level: int) -> float:
        return self.terrain.cell_m(level)

    def datum_m(self, d: F64) -> F64:
        out: F64 = 1.0 / np.linalg.norm(d / self.radii_m, axis=1)
        return out

    def heights(self, d: F64, level: int) -> F64:
        """As the lattice of a level resolves them."""
        return self.terrain.heights(d, self.cell_m(level) * (1.0 + 1e-9))

    def _point(self, face: int, level: int, node: F64) -> F64:
        d = direction(face, *(node * 2.0 ** (1 - level) - 1.0).T)
        return d * (self.datum_m(d) + self.heights(d, level))[:, None]

    def post(self, face: int, level: int, node: F64) -> Post:
        """With the slope by differences between the four nodes around."""
        point = self._point(face, level, node)
        away = np.linalg.norm(point, axis=1)
        up = point / away[:, None]
        steps, rises = [], []
        for by in ((1.0, 0.0), (0.0, 1.0)):
            ends = [self._point(face, level, node + sign * np.array(by)) for sign in (1.0, -1.0)]
            lengths = [np.linalg.norm(end, axis=1, keepdims=True) for end in ends]
            steps.append(ends[0] / lengths[0] - ends[1] / lengths[1])
            rises.append(((lengths[0] - lengths[1])[:, 0]) / away)
        across = np.stack([*steps, up], axis=1)  # gradient . step = rise, gradient . up = 0
        slope = np.linalg.solve(across, np.stack([*rises, np.zeros_like(away)], axis=1)[..., None])
        return Post(point, slope[..., 0])

    def _coarse_post(self, face: int, level: int, node: F64) -> Post:
        """Of the tile of the next coarser level beside the edge that the node lies on: its node, or
        the middle of two."""
        odd = node % 2.0  # at most one of both on an edge
        a = self.post(face, level - 1, 0.5 * (node - odd))
        b = self.post(face, level - 1, 0.5 * (node + odd))
        return Post(0.5 * (a.point + b.point), 0.5 * (a.slope + b.slope))

    def meet(self, d: F64, posts: dict[tuple[int, int], Post]) -> tuple[F64, F64]:
        """Distances of a cell's triangle and of its patch along directions, inf beside it."""
        plane, patch = np.full((2, len(d)), np.inf)
        for upper, triangle in enumerate(TRIANGLES):
            corners = np.stack([posts[at].point for at in triangle], axis=2)
            weights = np.linalg.solve(corners, d[:, :, None])[:, :, 0]
            total = weights.sum(axis=1)
            inside = weights.min(axis=1) > -1e-4 * total
            x, y = (weights[:, 1:] / total[:, None]).T
            place = (1.0 - x, 1.0 - y) if upper else (x, y)
            plane = np.where(inside, 1.0 / total, plane)
            patch = np.where(inside, patch_m(posts, *place), patch)
        return plane, patch

    def _off(self, points: F64, face: int, level: int, seams: bool) -> F64:
        """Distance along the radius from the surface of a level, of tiles beside coarser ones too
        with `seams`. At outlines points are those of triangles."""
        away = np.linalg.norm(points, axis=1)
        d = points / away[:, None]
        cell = np.floor((locate(d)[1] + 1.0) * 2.0 ** (level - 1))
        off = np.full(len(d), np.inf)
        nodes = {corner: cell + corner for corner in CORNERS}
        kinds = [{at: self.post(face, level, node) for at, node in nodes.items()}]
        if seams:
            kinds.append({at: self._coarse_post(face, level, node) for at, node in nodes.items()})
        edge = {at: (node % TILE == 0.0).any(axis=1) for at, node in nodes.items()}
        for choice in product(range(len(kinds)), repeat=4):
            posts = {at: kinds[kind][at] for at, kind in zip(CORNERS, choice, strict=True)}
            free = [edge[at] for at, kind in zip(CORNERS, choice, strict=True) if kind]
            may = np.all([np.ones(len(d), dtype=bool), *free], axis=0)
            if not may.any():
                continue
            for found in self.meet(d, posts):
                off = np.where(may, np.fmin(off, np.abs(found - away)), off)
        return off

    def fit(self, points: F64, coarsest: I64, finest: int) -> tuple[F64, I64, I64]:
        """Distances along the radius from the nearest mesh, in its cells, and its levels: the
        coarser of both at edges, and how many more the finer has; from `coarsest` on, and at most
        `finest` levels more."""
        d = points / np.linalg.norm(points, axis=1, keepdims=True)
        faces, _ = locate(d)
        best = np.full(len(d), np.inf)
        levels = coarsest.copy()
        wider = np.zeros_like(levels)
        for seams, more in product((False, True), range(finest + 1)):
            left = np.flatnonzero(best > ENOUGH)
            for face, level in {(int(faces[k]), int(coarsest[k]) + more) for k in left}:
                of = left[(faces[left] == face) & (coarsest[left] + more == level)]
                off = self._off(points[of], face, level, seams) / self.cell_m(level)
                better = of[off < best[of]]
                best[better] = off[off < best[of]]
                levels[better] = level - seams
                wider[better] = seams
        return best, levels, wider

    def cell_range_m(self, d: F64, levels: I64, side: int) -> tuple[F64, F64]:
        """Lowest and highest height, as their level resolves it and with all detail, at side^2
        places of the cells of directions."""
        low, high = np.full(len(d), np.inf), np.full(len(d), -np.inf)
        faces, place = locate(d)
        scale = 2.0 ** (levels - 1)[:, None]
        cell = np.floor((place + 1.0) * scale)
        for corner in product(np.linspace(0.0, 1.0, side), repeat=2):
            s_t = (cell + corner) / scale - 1.0
            for face, level in set(zip(faces.tolist(), levels.tolist(), strict=True)):
                of = (faces == face) & (levels == level)
                at = direction(face, *s_t[of].T)
                for found in (self.terrain.heights(at), self.heights(at, level)):
                    low[of], high[of] = np.fmin(low[of], found), np.fmax(high[of], found)
        return low, high
