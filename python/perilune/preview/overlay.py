"""The rgb picture with the visible boxes and the objects' axes drawn over it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.preview import canvas, colors

U8 = NDArray[np.uint8]
F64 = NDArray[np.float64]

_AXIS_COLORS = ((255, 92, 82), (110, 220, 90), (90, 150, 255))


def project(K: F64, points_c: F64) -> F64:
    """(n, 3) points in front of the camera to (n, 2) pixels."""
    projected = points_c @ np.asarray(K, dtype=np.float64).T
    return projected[:, :2] / projected[:, 2:]


def axis_tips_m(R_m2c: F64, t_m2c: F64, bbox: NDArray[Any], K: F64) -> F64:
    """(4, 3): origin and the three axis ends, as long as half the visible box at that distance."""
    extent_px = max(8.0, float(bbox[2]), float(bbox[3]))
    length_m = 0.5 * extent_px * float(t_m2c[2]) / float(K[0, 0])
    return np.vstack([t_m2c, t_m2c + length_m * np.asarray(R_m2c, dtype=np.float64).T])


def draw_objects(picture: U8, objects: NDArray[Any], K: F64, image_width: int) -> None:
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
        tips = axis_tips_m(row["R_m2c"], row["t_m2c"], row["bbox_visib"], K)
        if not np.isfinite(tips).all() or (tips[:, 2] <= 0.0).any():
            continue
        pixels = project(K, tips)
        start = placed(pixels[0])
        for axis, axis_color in enumerate(_AXIS_COLORS):
            end = placed(pixels[axis + 1])
            # A dark border keeps the line visible on a bright spacecraft.
            canvas.draw_line(picture, start, end, colors.BACKGROUND, 4.0)
            canvas.draw_line(picture, start, end, axis_color)
