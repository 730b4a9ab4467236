"""Scenes of bodies with shapes: balls of facets as OBJ files, and frames of them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np


def ball(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a unit ball of facets, wound outwards."""
    columns = 2 * rings
    vertices = [(0.0, 0.0, 1.0)]
    for i in range(1, rings):
        for k in range(columns):
            lat, lon = math.pi * i / rings, 2.0 * math.pi * k / columns
            vertices.append(
                (math.sin(lat) * math.cos(lon), math.sin(lat) * math.sin(lon), math.cos(lat))
            )
    vertices.append((0.0, 0.0, -1.0))
    faces = []
    last = len(vertices) - 1
    for k in range(columns):
        after = (k + 1) % columns
        faces.append((0, 1 + k, 1 + after))
        for i in range(rings - 2):
            a, b = 1 + i * columns + k, 1 + i * columns + after
            faces += [(a, a + columns, b + columns), (a, b + columns, b)]
        foot = 1 + (rings - 2) * columns
        faces.append((foot + k, last, foot + after))
    return np.array(vertices), np.array(faces)


def write_obj(path: Path, vertices: np.ndarray, faces: np.ndarray) -> Path:
    rows = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    rows += [f"f {a} {b} {c}" for a, b, c in faces + 1]
    path.write_text("\n".join(rows) + "\n")
    return path


def scene(body: dict, position_m: tuple, fov_deg: float = 40.0, **options) -> dict:
    """A body named `rock` at the root, seen from a place; the sun over the shoulder."""
    return {
        "version": 1,
        "seed": 5,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "rock",
        "bodies": {
            "rock": {
                "kind": "ellipsoid",
                "gm_km3_s2": 1e-6,
                "albedo": [0.3, 0.2, 0.1],
                "radii_km": 1.0,
                **body,
            }
        },
        "sun": {"direction": options.pop("sun", [0.6, -0.5, 0.62])},
        "spacecraft": options.pop("spacecraft", {}),
        "camera": {
            "width": 48,
            "height": 48,
            "fov_deg": fov_deg,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 130.0},
            "trajectory": {"kind": "fixed", "target": "rock", "position_m": list(position_m)},
        },
        "render": {
            "samples": 4,
            "channels": ["radiance", "rgb", "range", "normal", "instance", "object_coords"],
            **options.pop("render", {}),
        },
        **options,
    }
