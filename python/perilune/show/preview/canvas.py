"""Drawing on an 8-bit RGB array: rectangles, smooth lines, text, resized pictures."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from perilune.show.preview.font import text_mask

U8 = NDArray[np.uint8]
Color = Sequence[int] | U8


def _edges(length: int, target: int) -> NDArray[np.int64]:
    return (np.arange(target + 1, dtype=np.int64) * length) // target


def resize(image: U8, height: int, width: int) -> U8:
    """(H, W, 3) to (height, width, 3): mean of the covered pixels, or nearest when enlarging."""
    rows, columns = image.shape[:2]
    if height >= rows:
        result = image[(np.arange(height) * rows) // height].astype(np.float64)
    else:
        edges = _edges(rows, height)
        result = np.add.reduceat(image, edges[:-1], axis=0, dtype=np.float64)
        result /= np.diff(edges)[:, None, None]
    if width >= columns:
        result = result[:, (np.arange(width) * columns) // width]
    else:
        edges = _edges(columns, width)
        result = np.add.reduceat(result, edges[:-1], axis=1)
        result /= np.diff(edges)[None, :, None]
    return np.asarray(np.rint(result), dtype=np.uint8)


def fitted(size: tuple[int, ...], box: tuple[int, int]) -> tuple[int, int]:
    """The largest (height, width) of the same shape inside a box (height, width).

    Small pictures are enlarged by whole factors, so that their pixels stay equal squares.
    """
    height, width = size[0], size[1]
    factor = min(box[0] / height, box[1] / width)
    if factor >= 1.0:
        whole = int(factor)
        return height * whole, width * whole
    return max(1, round(height * factor)), max(1, round(width * factor))


def blend(canvas: U8, top: int, left: int, alpha: NDArray[np.floating], color: Color) -> None:
    """Paints `color` with the opacity (h, w) at (top, left), cut at the canvas."""
    height, width = alpha.shape
    row0, row1 = max(0, top), min(canvas.shape[0], top + height)
    col0, col1 = max(0, left), min(canvas.shape[1], left + width)
    if row0 >= row1 or col0 >= col1:
        return
    part = alpha[row0 - top : row1 - top, col0 - left : col1 - left, None]
    below = canvas[row0:row1, col0:col1].astype(np.float64)
    paint = np.asarray(color, dtype=np.float64)
    canvas[row0:row1, col0:col1] = np.rint(below + part * (paint - below)).astype(np.uint8)


def fill(canvas: U8, top: int, left: int, height: int, width: int, color: Color) -> None:
    """An opaque rectangle, cut at the canvas."""
    row0, col0 = max(0, top), max(0, left)
    canvas[row0 : max(row0, top + height), col0 : max(col0, left + width)] = color


def place(canvas: U8, top: int, left: int, image: U8) -> None:
    """Copies a picture that lies inside the canvas."""
    canvas[top : top + image.shape[0], left : left + image.shape[1]] = image


def write_text(canvas: U8, top: int, left: int, text: str, color: Color, scale: int = 2) -> None:
    """One line of text with its upper left corner at (top, left)."""
    blend(canvas, top, left, text_mask(text, scale).astype(np.float64), color)


def clip_segment(
    start: tuple[float, float], end: tuple[float, float], width: float, height: float
) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """The part of a segment (x, y) inside [0, width] x [0, height] (Liang and Barsky, 1984)."""
    delta_x, delta_y = end[0] - start[0], end[1] - start[1]
    first, last = 0.0, 1.0
    for step, low, high in (
        (delta_x, -start[0], width - start[0]),
        (delta_y, -start[1], height - start[1]),
    ):
        if step == 0.0:
            if low > 0.0 or high < 0.0:
                return None
            continue
        enter, leave = sorted((low / step, high / step))
        first, last = max(first, enter), min(last, leave)
    if first > last:
        return None
    at = [(start[0] + t * delta_x, start[1] + t * delta_y) for t in (first, last)]
    return at[0], at[1]


def draw_line(
    canvas: U8,
    start: tuple[float, float],
    end: tuple[float, float],
    color: Color,
    thickness: float = 2.0,
) -> None:
    """A line with smooth edges between two points (x, y); integer coordinates are pixel centres."""
    if not np.isfinite([*start, *end]).all():
        return
    clipped = clip_segment(start, end, canvas.shape[1] - 1.0, canvas.shape[0] - 1.0)
    if clipped is None:
        return
    (x0, y0), (x1, y1) = clipped
    margin = int(thickness) + 2
    left, top = int(min(x0, x1)) - margin, int(min(y0, y1)) - margin
    columns = np.arange(left, int(max(x0, x1)) + margin + 1)[None, :]
    rows = np.arange(top, int(max(y0, y1)) + margin + 1)[:, None]
    delta_x, delta_y = x1 - x0, y1 - y0
    length2 = max(delta_x * delta_x + delta_y * delta_y, 1e-12)
    along = ((columns - x0) * delta_x + (rows - y0) * delta_y) / length2
    along = along.clip(0.0, 1.0)
    distance = np.hypot(columns - x0 - along * delta_x, rows - y0 - along * delta_y)
    blend(canvas, top, left, (thickness / 2 + 0.5 - distance).clip(0.0, 1.0), color)


def draw_box(
    canvas: U8, left: float, top: float, right: float, bottom: float, color: Color
) -> None:
    """A frame of one-and-a-half pixels."""
    corners = [(left, top), (right, top), (right, bottom), (left, bottom)]
    for index in range(4):
        draw_line(canvas, corners[index], corners[(index + 1) % 4], color, 1.5)
