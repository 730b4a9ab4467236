"""Sheets back to back, told apart for renderers that do not know them (docs/faces.md).

Rounding has left them in either order: drawn from both sides, others show stripes of both paints.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from .scene import Array

HAIR = 1e-4
"""How far apart two such sheets are at most, of the model's longest side (csrc/trace/backing.h)."""


def apart(mesh: dict[str, Any], backed: Array) -> dict[str, Any]:
    """The mesh with its backed triangles (T,) moved by a hair to where they look.

    They get corners of their own: what they share with others stays. Of two sheets that are in the
    wrong order by less than a hair each is then before the other, seen from where it looks."""
    if not backed.any():
        return mesh
    corners = mesh["indices"][backed]
    own = corners.reshape(-1)
    points = mesh["positions"][corners].astype(float)
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    hair = HAIR * np.ptp(mesh["positions"].astype(float), axis=0).max()
    moved = (points + hair * normals[:, np.newaxis]).reshape(-1, 3)
    indices = mesh["indices"].copy()
    count = len(mesh["positions"])
    indices[backed] = (count + np.arange(len(own))).reshape(-1, 3)
    out = {**mesh, "indices": indices, "positions": np.concatenate([mesh["positions"], moved])}
    for key in ("normals", "uv"):
        if key in mesh:
            out[key] = np.concatenate([mesh[key], mesh[key][own]])
    return out
