"""A ray caster of our own for tests: NumPy, double precision, every triangle at every pixel that it
may cover. It shares nothing with the core but the triangles and the pose."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


class Cast(NamedTuple):
    """What the centre rays of all pixels meet."""

    mask: NDArray[np.bool_]
    position: F64  # (height, width, 3): camera axes, m; nan where nothing is met
    edge: F64  # (height, width): least distance at which a ray passes an edge, m; inf for none


def corners_of(model: Any, scale: float, offset: F64) -> F64:
    """(n, 3, 3) corners in the object's frame, m."""
    mesh = model.mesh()
    return scale * (mesh["positions"][mesh["indices"]] - offset)


def double_sided(model: Any, path: Path) -> NDArray[Any]:
    """(n,) whether each triangle is there from behind too, as the materials of a .glb state."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + length])
    both = {m.get("name", ""): m.get("doubleSided", False) for m in tree.get("materials", [])}
    sides = np.array([both.get(part["material"], False) for part in model.parts])
    return sides[model.mesh()["triangle_part"]]


def _pairs(low: NDArray[Any], high: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Number of each box, and of each of its cells (x, y), for boxes of whole pixels."""
    size = np.maximum(high - low + 1, 0)
    count = size[:, 0] * size[:, 1]
    owner = np.repeat(np.arange(len(low)), count)
    nth = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    width = size[owner, 0]
    cell = np.stack([nth % np.maximum(width, 1), nth // np.maximum(width, 1)], axis=1)
    return owner, low[owner] + cell


def cast(corners: F64, both: NDArray[Any], k: F64, width: int, height: int) -> Cast:
    """Corners (n, 3, 3) in camera axes, all before the camera; `k`: its matrix."""
    seen = corners[..., :2] / corners[..., 2:]
    pixels = seen @ k[:2, :2].T + k[:2, 2]
    size = np.array([width, height])
    low = np.clip(np.floor(pixels.min(axis=1)), 0, size).astype(int)
    high = np.clip(np.ceil(pixels.max(axis=1)), -1, size - 1).astype(int)
    depth = np.full(width * height, np.inf)
    edge = np.full(width * height, np.inf)
    area = np.maximum(high - low + 1, 0).prod(axis=1)
    for part in np.array_split(np.arange(len(corners)), int(area.sum() // 2_000_000) + 1):
        owner, cell = _pairs(low[part], high[part])
        _meet(corners[part[owner]], both[part[owner]], cell, np.linalg.inv(k), width, depth, edge)
    rays = _rays(np.stack(np.meshgrid(np.arange(width), np.arange(height)), -1), np.linalg.inv(k))
    depth, edge = depth.reshape(height, width), edge.reshape(height, width)
    mask = np.isfinite(depth)
    return Cast(mask, np.where(mask, depth, np.nan)[..., None] * rays, edge)


def _rays(cell: NDArray[Any], inverse: F64) -> F64:
    """Of unit depth."""
    ones = np.ones((*cell.shape[:-1], 1))
    return np.concatenate([cell, ones], axis=-1) @ inverse.T


def _meet(
    c: F64, both: NDArray[Any], cell: NDArray[Any], inverse: F64, width: int, depth: F64, edge: F64
) -> None:
    """Offers each pair of a triangle and a pixel to the pixel's depth."""
    d = _rays(cell, inverse)
    pixel = cell[:, 1] * width + cell[:, 0]
    e1, e2 = c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]
    normal = np.cross(e1, e2)
    facing = (normal * d).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (normal * c[:, 0]).sum(axis=1) / facing
    # The ray on the triangle's plane, relative to a corner: far away, places have lost digits.
    t0 = c[:, 0, 2]
    at = (t0[:, None] * d - c[:, 0]) + (t - t0)[:, None] * d
    inside = np.full(len(c), np.inf)
    nearest = np.full(len(c), np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        side = c[:, b] - c[:, a]
        from_a = at - (c[:, a] - c[:, 0])
        cross = np.cross(side, from_a)
        length = np.linalg.norm(side, axis=1)
        inside = np.minimum(inside, (cross * normal).sum(axis=1))
        # Distance of the ray from the edge as a line, within its ends.
        along = np.clip((from_a * side).sum(axis=1) / length**2, 0.0, 1.0)
        off = from_a - along[:, None] * side
        unit = d / np.linalg.norm(d, axis=1)[:, None]
        off -= (off * unit).sum(axis=1)[:, None] * unit
        nearest = np.minimum(nearest, np.linalg.norm(off, axis=1))
    np.minimum.at(edge, pixel, np.where(np.isnan(nearest), np.inf, nearest))
    met = (inside >= 0.0) & (t > 0.0) & (both | (facing < 0.0))
    np.minimum.at(depth, pixel[met], t[met])
