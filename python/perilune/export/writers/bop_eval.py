"""Evaluation models of BOP: coarser, and with evenly spread vertices.

Pose errors of the BOP toolkit are means and maxima over vertices, so the number of vertices
determines the cost, and their distribution the weights. Edges are collapsed where the surface stays
within a tolerance; then long edges are halved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.export.writers.bop_models import BopModel

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

TOLERANCE = 0.002
"""Largest displacement of the surface, relative to the model's extent."""
_VERTICES = 8000
"""Approximate number of vertices by default."""
_HALVINGS = 40
"""Largest number of halving passes: an edge is at most about 2^20 times the target length."""


def evaluation_model(model: BopModel) -> BopModel:
    """The same model with fewer, evenly spread vertices, in the same frame."""
    corners, first = _welded(model)
    positions = model.positions_mm[first]
    faces = _single_faces(corners)
    kept = _core.simplify(
        positions.astype(np.float32), faces.astype(np.uint32), 2 * _VERTICES, TOLERANCE
    ).astype(np.int64)
    values = np.concatenate([positions, _attributes(model.vertices[first])], axis=1)
    values, kept = _halved(values, kept if len(kept) else faces)
    used, faces = np.unique(kept, return_inverse=True)
    return replace(
        model,
        vertices=_vertices(model.vertices.dtype, values[used]),
        faces=faces.reshape(-1, 3).astype(np.int32),
        counts={},
        nodes=(),
        face_nodes=None,
    )


def _welded(model: BopModel) -> tuple[I64, I64]:
    """Corners (F, 3) as indices of distinct positions, and a vertex of each position."""
    places = np.stack([model.vertices[name] for name in "xyz"], axis=1)
    _, first, number = np.unique(places, axis=0, return_index=True, return_inverse=True)
    return number.reshape(-1)[model.faces], first


def _single_faces(corners: I64) -> I64:
    """Each triangle once, whatever its side, and none without area."""
    ordered = np.sort(corners, axis=1)
    proper = (ordered[:, 0] != ordered[:, 1]) & (ordered[:, 1] != ordered[:, 2])
    _, first = np.unique(ordered[proper], axis=0, return_index=True)
    return np.asarray(corners[proper][np.sort(first)])


def _attributes(vertices: NDArray[Any]) -> F64:
    names = ("nx", "ny", "nz", "red", "green", "blue")
    return np.stack([vertices[name].astype(np.float64) for name in names], axis=1)


def _vertices(dtype: np.dtype[Any], values: F64) -> NDArray[Any]:
    out = np.zeros(len(values), dtype=dtype)
    lengths = np.linalg.norm(values[:, 3:6], axis=1)
    normals = values[:, 3:6] / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    normals[lengths < 1e-3] = (0.0, 0.0, 1.0)  # of opposite normals that met there is no mean
    for axis in range(3):
        out["xyz"[axis]], out["n" + "xyz"[axis]] = values[:, axis], normals[:, axis]
    for k, name in enumerate(("red", "green", "blue")):
        out[name] = np.rint(values[:, 6 + k])
    return out


def _longest(values: F64, faces: I64) -> float:
    """Edge length that gives about the target number of even vertices on the surface.

    Halved edges have between half of it and all of it; the factor gives published models 9 000 to
    25 000 vertices."""
    a, b, c = (values[faces[:, k], :3] for k in range(3))
    area = 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    extent = float(np.ptp(values[:, :3], axis=0).max())
    return max(float(np.sqrt(area / _VERTICES)) * 3.0, extent * 1e-3)


def _halved(values: F64, faces: I64) -> tuple[F64, I64]:
    """Halves edges that are too long, in both adjacent faces alike, until there are none."""
    longest = _longest(values, faces)
    for _ in range(_HALVINGS):
        edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2))
        # Each pair of corners as one number, in the order of pairs: NumPy sorts rows slowly.
        numbers, of_face = np.unique(edges @ (len(values), 1), return_inverse=True)
        pairs = np.stack(np.divmod(numbers, len(values)), axis=1)
        ends = values[pairs]
        long = np.linalg.norm(ends[:, 0, :3] - ends[:, 1, :3], axis=1) > longest
        if not long.any():
            break
        middle = np.full(len(pairs), -1, dtype=np.int64)
        middle[long] = len(values) + np.arange(int(long.sum()))
        values = np.concatenate([values, ends[long].mean(axis=1)])
        faces = _split(faces, middle[of_face.reshape(-1, 3)])
    return values, faces


def _split(faces: I64, middle: I64) -> I64:
    """Splits faces (n, 3) at the midpoints (n, 3) of their edges 01, 12, 20; -1: the edge stays."""
    cut = middle >= 0
    count = cut.sum(axis=1)
    out = [faces[count == 0]]
    for wanted in (1, 2, 3):
        rows = np.flatnonzero(count == wanted)
        # Turned so that the cut edges come first.
        turn = np.zeros(len(rows), dtype=np.int64)
        if wanted == 1:
            turn = cut[rows].argmax(axis=1)
        elif wanted == 2:
            turn = (np.argmin(cut[rows], axis=1) + 1) % 3
        order = (np.arange(3) + turn[:, None]) % 3
        a, b, c = np.take_along_axis(faces[rows], order, axis=1).T
        ab, bc, ca = np.take_along_axis(middle[rows], order, axis=1).T
        new = {
            1: [(a, ab, c), (ab, b, c)],
            2: [(ab, b, bc), (a, ab, bc), (a, bc, c)],
            3: [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)],
        }[wanted]
        out += [np.stack(corners, axis=1) for corners in new]
    return np.concatenate(out)
