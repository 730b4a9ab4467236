"""Finds closed hulls of a model, whose backs cannot be seen from outside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from perilune import _core


def closed(model: _core.Model, presence: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """(T,): whether a triangle belongs to a connected piece without open edges or holes, wound
    outwards.

    In such a piece, each edge is used once in each direction by triangles of one node, and the
    volume is positive. presence (T,): as in Surfaces; a piece cut by alpha is open. Assumes that no
    piece turns inside out by intersecting itself."""
    mesh = model.mesh()
    points, place = np.unique(mesh["positions"] + 0.0, axis=0, return_inverse=True)
    corners = place.reshape(-1)[mesh["indices"].astype(np.int64)]
    node = np.array([part["node"] for part in model.parts])[mesh["triangle_part"]]
    component = model.components().astype(np.int64)
    open_at = component[_has_open_edge(corners, node) | (presence != 2)]
    a, b, c = (points[corners[:, k]] for k in range(3))
    volume = np.bincount(component, weights=np.einsum("ij,ij->i", a, np.cross(b, c)))
    is_closed = volume > 0.0
    is_closed[open_at] = False
    found: NDArray[np.bool_] = is_closed[component]
    return found


def _has_open_edge(corners: NDArray[np.int64], node: NDArray[np.int64]) -> NDArray[np.bool_]:
    """(T,): whether an edge of a triangle is not used once in each direction by triangles of its
    node."""
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    ways = np.stack([np.repeat(node, 3), np.minimum(start, end), np.maximum(start, end)])
    _, edge, uses = np.unique(ways, axis=1, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    balance = np.bincount(edge, weights=np.where(start < end, 1.0, -1.0))
    is_open = (uses != 2) | (balance != 0.0)
    found: NDArray[np.bool_] = is_open[edge].reshape(-1, 3).any(axis=1)
    return found
