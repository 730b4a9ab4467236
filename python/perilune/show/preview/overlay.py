"""The rgb picture with visible boxes and the objects' axes drawn over it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import colors
from perilune.camera.label import CameraLabel
from perilune.show.preview.canvas import Line, draw_lines

U8 = NDArray[np.uint8]
F64 = NDArray[np.float64]

_AXIS_COLORS = ((255, 92, 82), (110, 220, 90), (90, 150, 255))
_AXIS_PX, _BOX_PX = 2.0, 1.5
"""Thickness of lines."""
_STEPS = 12
"""Segments of an axis, because lenses bend straight lines."""


def axes_px(R_m2c: F64, t_m2c: F64, bbox: NDArray[Any], camera: CameraLabel) -> F64:
    """(3, _STEPS + 1, 2): the object's axes from its origin, in pixels of the labels; nan where the
    camera does not see. Their length is half the visible box at the origin's distance."""
    K = np.asarray(camera.K, dtype=np.float64)
    step_m = 1e-4 * float(np.linalg.norm(t_m2c))
    beside = _core.project(K, camera.lens, np.stack([t_m2c, t_m2c + np.array([step_m, 0, 0])]))
    px_per_m = float(np.linalg.norm(beside[1] - beside[0])) / step_m if step_m > 0.0 else np.nan
    length_m = 0.5 * max(8.0, float(bbox[2]), float(bbox[3])) / px_per_m
    along = length_m * np.linspace(0.0, 1.0, _STEPS + 1)
    points = t_m2c + along[:, None] * np.asarray(R_m2c, dtype=np.float64).T[:, None, :]
    return _core.project(K, camera.lens, points.reshape(-1, 3)).reshape(3, _STEPS + 1, 2)


def box_line(row: Any, placed: Callable[[Any], F64], edges: F64) -> Line:
    """The visible box of an object, within a picture that ends at `edges`. placed: pixels of the
    frame -> pixels of the picture."""
    x, y, width, height = (float(value) for value in row["bbox_visib"])
    color = colors.id_colors(np.array([row["instance_id"]]))[0]
    left, top = placed(np.array([x - 0.5, y - 0.5])).clip(min=1.0)
    right, bottom = placed(np.array([x + width + 0.5, y + height + 0.5])).clip(max=edges - 2.0)
    corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]
    return Line(np.array(corners), color, _BOX_PX)


def with_objects(picture: U8, objects: NDArray[Any], camera: CameraLabel, image_width: int) -> U8:
    """The picture with boxes and axes over it; it shows an image `image_width` pixels wide."""
    scale = picture.shape[1] / image_width

    def placed(pixels: NDArray[Any]) -> F64:
        # Integer pixel centres on both sides: the image's edge is at -0.5.
        return np.asarray((pixels + 0.5) * scale - 0.5)

    found: list[Line] = []
    for row in objects[objects["px_count_visib"] > 0]:
        found.append(box_line(row, placed, np.array(picture.shape[1::-1], dtype=np.float64)))
        axes = placed(axes_px(row["R_m2c"], row["t_m2c"], row["bbox_visib"], camera))
        if np.isfinite(axes).all():
            for axis, axis_color in zip(axes, _AXIS_COLORS, strict=True):
                # A dark border keeps the line visible on a bright spacecraft.
                found.append(Line(axis, colors.BACKGROUND, 2.0 * _AXIS_PX))
                found.append(Line(axis, axis_color, _AXIS_PX))
    return draw_lines(picture, found)
