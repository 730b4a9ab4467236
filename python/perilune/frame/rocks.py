"""The rocks of a terrain in a frame: what is seen of them, and where they lie."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.camera.label import CameraLabel
from perilune.world import World

Array = NDArray[np.void]
F64 = NDArray[np.float64]

ROCK_LABEL = np.dtype(
    [
        ("id", "i8"),
        ("instance_id", "i4"),
        ("family", "U8"),
        *((name, *rest) for name, *rest in _core.ROCK if name not in ("id", "family", "center")),
        ("lon_deg", "f8"),
        ("lat_deg", "f8"),
        ("center_m", "f8", 3),
        ("bbox_obj", "i4", 4),
        ("bbox_visib", "i4", 4),
        ("px_count_visib", "i4"),
        ("cut", "?"),
    ]
)
"""A row of `Simulation.rocks`; docs/labels.md explains the fields."""

NO_BOX = -1
"""In all of `bbox_obj`: a part of the rock is behind the camera, or beyond what its lens sees."""

_FAMILIES = np.array([row["name"] for row in _core.ROCK_FAMILIES])


def pixels_of(ids: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array]:
    """The ids other than 0 of a channel (H, W), rising, and what pixels they have: rows of
    bbox_visib, px_count_visib."""
    height, width = ids.shape
    known, of = np.unique(ids, return_inverse=True)
    of = of.reshape(ids.shape)
    boxes = np.zeros(len(known), [("bbox_visib", "i4", 4), ("px_count_visib", "i4")])
    boxes["px_count_visib"] = np.bincount(of.ravel(), minlength=len(known))
    lines, columns = np.indices(ids.shape)
    for axis, (at, size) in enumerate(((columns, width), (lines, height))):
        low, high = np.full(len(known), size), np.full(len(known), -1)
        np.minimum.at(low, of.ravel(), at.ravel())
        np.maximum.at(high, of.ravel(), at.ravel())
        boxes["bbox_visib"][:, axis] = low
        boxes["bbox_visib"][:, 2 + axis] = high - low + 1
    return known[known != 0], boxes[known != 0]


def _whole_boxes(
    uv: F64, first: NDArray[np.int64], visible: NDArray[np.int32]
) -> NDArray[np.int32]:
    """(n, 4) boxes of silhouettes that nothing hides and no edge cuts, and of visible pixels. uv:
    pixels of points of all rocks, which begin at `first` (n + 1,)."""
    boxes = np.full((len(visible), 4), NO_BOX, np.int32)
    for k, (begin, end) in enumerate(pairwise(first.tolist())):
        at, box = uv[begin:end], visible[k]
        if begin == end or not np.isfinite(at).all():
            continue
        low = np.minimum(np.ceil(at.min(axis=0)), box[:2])
        high = np.maximum(np.floor(at.max(axis=0)), box[:2] + box[2:] - 1)
        boxes[k] = np.concatenate([low, high - low + 1.0])
    return boxes


def in_view(
    ids: NDArray[np.int64], camera: CameraLabel, world: World, body: str, terrain: _core.Terrain
) -> Array:
    """Rows of ROCK_LABEL, most pixels first. ids: the channel `rock_id`, 0 off the body. world: in
    the middle of the exposure."""
    pose = world.poses[body][0]
    turn = rotations.to_matrix(pose[3:])
    eye = (camera.position_m - pose[:3]) @ turn
    pixel_rad = 1.0 / float(max(camera.K[0, 0], camera.K[1, 1]))
    known, pixels = pixels_of(ids)
    found, points, first = terrain.rock_surfaces(known.astype(np.uint64), eye, pixel_rad)
    rows = np.zeros(len(known), ROCK_LABEL)
    shared = set(found.dtype.names or ()) & set(ROCK_LABEL.names or ())
    for name in shared - {"family"}:
        rows[name] = found[name]
    rows["family"] = _FAMILIES[found["family"]]
    up = found["direction"]
    rows["lon_deg"] = np.degrees(np.arctan2(up[:, 1], up[:, 0]))
    rows["lat_deg"] = np.degrees(np.arcsin(np.clip(up[:, 2], -1.0, 1.0)))
    rows["center_m"] = found["center"]
    for name in ("bbox_visib", "px_count_visib"):
        rows[name] = pixels[name]
    uv = camera.project(points @ turn.T + pose[:3])
    rows["bbox_obj"] = _whole_boxes(uv, first, rows["bbox_visib"])
    low, size = rows["bbox_visib"][:, :2], rows["bbox_visib"][:, 2:]
    edge = np.array([camera.width, camera.height])
    rows["cut"] = ((low == 0) | (low + size == edge)).any(axis=1)
    return rows[np.lexsort((rows["id"], -rows["px_count_visib"]))]
