"""The rgb picture with the visible boxes and the objects' axes drawn over it."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.camera.label import CameraLabel
from perilune.show.preview import canvas, colors

if TYPE_CHECKING:
    pass

U8 = NDArray[np.uint8]
F64 = NDArray[np.float64]

_AXIS_COLORS = ((255, 92, 82), (110, 220, 90), (90, 150, 255))


_STEPS = 12
"""Segments of an axis: lenses bend straight lines."""


def axes_px(R_m2c: F64, t_m2c: F64, bbox: NDArray[Any], camera: CameraLabel) -> F64:
    """(3, _STEPS + 1, 2): the object's axes from its origin, in pixels of the labels; nan where
    the camera does not see. As long as half the visible box would be at the origin's distance."""
    K = np.asarray(camera.K, dtype=np.float64)
    step_m = 1e-4 * float(np.linalg.norm(t_m2c))
    beside = _core.project(K, camera.lens, np.stack([t_m2c, t_m2c + np.array([step_m, 0, 0])]))
    px_per_m = float(np.linalg.norm(beside[1] - beside[0])) / step_m if step_m > 0.0 else np.nan
    length_m = 0.5 * max(8.0, float(bbox[2]), float(bbox[3])) / px_per_m
    along = length_m * np.linspace(0.0, 1.0, _STEPS + 1)
    points = t_m2c + along[:, None] * np.asarray(R_m2c, dtype=np.float64).T[:, None, :]
    return _core.project(K, camera.lens, points.reshape(-1, 3)).reshape(3, _STEPS + 1, 2)


def draw_objects(picture: U8, objects: NDArray[Any], camera: CameraLabel, image_width: int) -> None:
    """Draws on a picture that shows an image `image_width` pixels wide."""
    scale = picture.shape[1] / image_width

    def placed(pixel: F64) -> tuple[float, float]:
        # Integer pixel centres on both sides: the image's edge is at -0.5.
        return (pixel[0] + 0.5) * scale - 0.5, (pixel[1] + 0.5) * scale - 0.5

    for row in objects:
        if row["px_count_visib"] <= 0:
            continue
        x, y, width, height = (float(value) for value in row["bbox_visib"])
        color = colors.id_colors(np.array([row["instance_id"]]))[0]
        left, top = placed(np.array([x - 0.5, y - 0.5]))
        right, bottom = placed(np.array([x + width + 0.5, y + height + 0.5]))
        right = min(right, picture.shape[1] - 2.0)
        bottom = min(bottom, picture.shape[0] - 2.0)
        canvas.draw_box(picture, max(left, 1.0), max(top, 1.0), right, bottom, color)
        lines = axes_px(row["R_m2c"], row["t_m2c"], row["bbox_visib"], camera)
        if not np.isfinite(lines).all():
            continue
        for line, axis_color in zip(lines, _AXIS_COLORS, strict=True):
            corners = [placed(pixel) for pixel in line]
            # A dark border keeps the line visible on a bright spacecraft.
            for ink, thickness in ((colors.BACKGROUND, 4.0), (axis_color, 2.0)):
                for start, end in pairwise(corners):
                    canvas.draw_line(picture, start, end, ink, thickness)
