"""The mesh of a body's ground again, in NumPy: triangles through heights at nodes of the cube's
lattice (csrc/terrain/cube.h), and on edges towards coarser tiles through those of theirs."""

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
ENOUGH = 1e-5
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
TRIANGLES = (((0, 0), (1, 0), (0, 1)), ((1, 1), (1, 0), (0, 1)))


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

    def _post(self, face: int, level: int, node: F64) -> F64:
        d = direction(face, *(node * 2.0 ** (1 - level) - 1.0).T)
        return d * (self.datum_m(d) + self.heights(d, level))[:, None]

    def _coarse_post(self, face: int, level: int, node: F64) -> F64:
        """Of the tile of the next coarser level beside the edge that the node lies on: its node, or
        the middle of two."""
        odd = node % 2.0  # at most one of both on an edge
        return 0.5 * (
            self._post(face, level - 1, 0.5 * (node - odd))
            + self._post(face, level - 1, 0.5 * (node + odd))
        )

    def _meet(self, d: F64, posts: tuple[F64, ...]) -> F64:
        """Distance of a triangle along directions, inf beside it."""
        corners = np.stack(posts, axis=2)
        weights = np.linalg.solve(corners, d[:, :, None])[:, :, 0]
        total = weights.sum(axis=1)
        out: F64 = np.where(weights.min(axis=1) > -1e-4 * total, 1.0 / total, np.inf)
        return out

    def _off(self, points: F64, face: int, level: int, seams: bool) -> F64:
        """Distance along the radius from the mesh of a level, of tiles beside coarser ones too with
        `seams`."""
        away = np.linalg.norm(points, axis=1)
        d = points / away[:, None]
        cell = np.floor((locate(d)[1] + 1.0) * 2.0 ** (level - 1))
        off = np.full(len(d), np.inf)
        for triangle in TRIANGLES:
            nodes = [cell + corner for corner in triangle]
            kinds = [[self._post(face, level, node) for node in nodes]]
            if seams:
                kinds.append([self._coarse_post(face, level, node) for node in nodes])
            edge = [(node % TILE == 0.0).any(axis=1) for node in nodes]
            for choice in product(range(len(kinds)), repeat=3):
                posts = tuple(kinds[kind][k] for k, kind in enumerate(choice))
                free = [edge[k] for k, kind in enumerate(choice) if kind]
                found = np.abs(self._meet(d, posts) - away)
                may = np.all([np.ones(len(d), dtype=bool), *free], axis=0)
                off = np.where(may, np.fmin(off, found), off)
        return off

    def fit(self, points: F64, coarsest: I64, finest: int) -> tuple[F64, I64]:
        """Distances along the radius from the nearest mesh, in its cells, and its level, that of
        the coarser tile at edges; from `coarsest` on, and at most `finest` levels more."""
        d = points / np.linalg.norm(points, axis=1, keepdims=True)
        faces, _ = locate(d)
        best = np.full(len(d), np.inf)
        levels = coarsest.copy()
        for seams, more in product((False, True), range(finest + 1)):
            left = np.flatnonzero(best > ENOUGH)
            for face, level in {(int(faces[k]), int(coarsest[k]) + more) for k in left}:
                of = left[(faces[left] == face) & (coarsest[left] + more == level)]
                off = self._off(points[of], face, level, seams) / self.cell_m(level)
                better = of[off < best[of]]
                best[better] = off[off < best[of]]
                levels[better] = level - seams
        return best, levels

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
