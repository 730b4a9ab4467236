"""What must hold of the keypoints of a frame, in rows of any format: texts of what does not."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from perilune.export.check.geometry import project

_PIXELS = 1e-6
"""Largest distance of a point's image from its projected place."""
_OUTSIDE, _HIDDEN, _SEEN = 0, 1, 2
"""Values of `visible`."""


def _number(value: Any) -> float:
    return np.nan if value is None else float(value)


def keypoint_faults(
    rows: Iterable[Any], camera: Mapping[str, Any], meta: Mapping[str, Any]
) -> Iterator[str]:
    """Faults of the rows of Sample.keypoints, or of the same from a file. camera, meta: of the
    frame's record."""
    size = (camera["width"], camera["height"])
    table = list(rows)
    places = np.array([[_number(v) for v in row["position_m"]] for row in table], np.float64)
    images = project(camera, places.reshape(-1, 3))
    for row, place, image in zip(table, places, images, strict=True):
        who = f"object '{row['object']}': keypoint '{row['name']}'"
        x, y = (_number(value) for value in row["xy"])
        visible, hidden_by = int(row["visible"]), int(row["occluded_by"])
        if visible not in (_OUTSIDE, _HIDDEN, _SEEN):
            yield f"{who}: visible is {visible}, must be 0, 1 or 2"
        within = -0.5 <= x < size[0] - 0.5 and -0.5 <= y < size[1] - 0.5
        if within != (visible != _OUTSIDE):
            side = "inside" if within else "outside"
            yield f"{who}: visible is {visible}, its image {x:g}, {y:g} lies {side} of the picture"
        if visible == _SEEN and hidden_by:
            yield f"{who}: is seen, but occluded_by is {hidden_by}"
        if not np.isfinite(place).all():
            yield f"{who}: position_m is not finite"
        # Under a rolling shutter a point is met at the time of its row.
        elif not meta.get("rows") and not np.allclose(
            [x, y], image, rtol=1e-12, atol=_PIXELS, equal_nan=True
        ):
            yield f"{who}: xy is {x:g}, {y:g}, its position_m is seen at {image[0]:g}, {image[1]:g}"
