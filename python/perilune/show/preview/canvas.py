"""Drawing with Pillow: text, rectangles, smooth lines, resized pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

U8 = NDArray[np.uint8]
F64 = NDArray[np.float64]
Color = Sequence[int] | U8

_SUBPIXELS = 4
"""Lines are drawn on this many subpixels per pixel and averaged, because Pillow's own have hard
edges."""
_FAR_PX = 1e6
"""Limit of line coordinates, because Pillow converts them to 32-bit integers."""


@lru_cache
def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font, `size` pixels high."""
    return ImageFont.load_default(size)


def text_width(text: str, size: int) -> int:
    """Width of a line of text in pixels."""
    return int(np.ceil(font(size).getlength(text)))


def shortened(text: str, width: int, size: int) -> str:
    """A line cut to a width, ending in two dots if something is cut."""
    if text_width(text, size) <= width:
        return text
    kept = len(text) - 1
    while kept > 1 and text_width(text[:kept] + "..", size) > width:
        kept -= 1
    return text[:kept] + ".."


def _rgb(color: Color) -> tuple[int, int, int]:
    red, green, blue = (int(part) for part in color)
    return red, green, blue


@dataclass(frozen=True)
class Canvas:
    """A picture to draw on; everything outside is clipped."""

    image: Image.Image
    draw: ImageDraw.ImageDraw

    @classmethod
    def blank(cls, width: int, height: int, color: Color) -> Canvas:
        image = Image.new("RGB", (width, height), _rgb(color))
        return cls(image, ImageDraw.Draw(image))

    def fill(self, top: int, left: int, height: int, width: int, color: Color) -> None:
        """An opaque rectangle."""
        self.draw.rectangle((left, top, left + width - 1, top + height - 1), fill=_rgb(color))

    def place(self, top: int, left: int, picture: U8) -> None:
        """Places a picture (H, W, 3) with its upper left corner at (top, left)."""
        self.image.paste(Image.fromarray(picture), (left, top))

    def text(self, base: int, left: int, text: str, color: Color, size: int) -> None:
        """Draws one line of text on the base line, the row `base`."""
        self.draw.text((left, base), text, fill=_rgb(color), font=font(size), anchor="ls")

    def pixels(self) -> U8:
        """(H, W, 3)."""
        return np.array(self.image)


def resize(image: U8, height: int, width: int) -> U8:
    """(H, W, 3) to (height, width, 3): mean of the covered pixels, or nearest when enlarging."""
    resized = Image.fromarray(image).resize((width, height), Image.Resampling.BOX)
    return np.array(resized)


def fitted(size: tuple[int, ...], box: tuple[int, int]) -> tuple[int, int]:
    """The largest (height, width) of the same aspect ratio inside a box (height, width).

    Small pictures are enlarged by whole factors, so that their pixels stay equal squares."""
    height, width = size[0], size[1]
    factor = min(box[0] / height, box[1] / width)
    if factor >= 1.0:
        whole = int(factor)
        return height * whole, width * whole
    return max(1, round(height * factor)), max(1, round(width * factor))


@dataclass(frozen=True)
class Line:
    """Connected points (n, 2), x and y; integers are pixel centres."""

    points: F64
    color: Color
    thickness: float


def draw_lines(picture: U8, lines: Sequence[Line]) -> U8:
    """The picture with smooth lines over it; lines with an end that is not finite are left out."""
    height, width = picture.shape[:2]
    fine = Image.fromarray(picture).resize((width * _SUBPIXELS, height * _SUBPIXELS), 0)
    draw = ImageDraw.Draw(fine)
    for line in lines:
        if np.isfinite(line.points).all():
            at = (line.points.clip(-_FAR_PX, _FAR_PX) + 0.5) * _SUBPIXELS - 0.5
            thickness = round(line.thickness * _SUBPIXELS)
            draw.line(at.ravel().tolist(), _rgb(line.color), thickness, joint="curve")
    return np.array(fine.resize((width, height), Image.Resampling.BOX))
