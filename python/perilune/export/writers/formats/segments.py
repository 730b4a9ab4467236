"""Boxes and run lengths of all ids of an image at once, from its runs down the columns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.writers.formats.base import Array

I64 = NDArray[np.int64]


@dataclass(frozen=True)
class Segment:
    """The pixels of an id."""

    area: int
    box: tuple[int, int, int, int]
    """Left, top, width, height, with the last pixel: of one pixel both are 1."""
    starts: I64
    ends: I64
    """Runs [start, end) down the columns, in order."""
    size: tuple[int, int]
    """Height, width of the image."""

    def counts(self) -> list[int]:
        """COCO's uncompressed run lengths, from the background on."""
        edges = np.stack([self.starts, self.ends], axis=1).ravel()
        height, width = self.size
        bounds = np.concatenate([[0], edges, [height * width]])
        counts: list[int] = np.diff(bounds).tolist()
        return counts if counts[-1] else counts[:-1]

    def rle(self) -> dict[str, Any]:
        """COCO's uncompressed RLE."""
        return {"counts": self.counts(), "size": list(self.size)}

    def mask(self) -> NDArray[np.bool_]:
        """The pixels (H, W)."""
        height, width = self.size
        change = np.zeros(height * width + 1, dtype=np.int8)
        change[self.starts] += 1
        change[self.ends] -= 1
        filled = np.cumsum(change[:-1], dtype=np.int8) != 0
        return np.ascontiguousarray(filled.reshape(width, height).T)


def segments(ids: Array) -> dict[int, Segment]:
    """Id -> its pixels, for all ids of an image (H, W) but 0, ascending. One pass over the image,
    whatever the number of ids."""
    height, width = ids.shape
    flat = np.ascontiguousarray(ids.T).ravel()
    starts = np.concatenate([[0], np.flatnonzero(flat[1:] != flat[:-1]) + 1])
    ends = np.concatenate([starts[1:], [flat.size]])
    values = flat[starts]
    seen = values != 0
    order = np.argsort(values[seen], kind="stable")
    starts, ends, values = starts[seen][order], ends[seen][order], values[seen][order]
    if values.size == 0:
        return {}
    first = np.concatenate([[0], np.flatnonzero(values[1:] != values[:-1]) + 1])
    last = ends - 1
    left, right = starts // height, last // height
    wraps = left != right  # then it touches the bottom of one column and the top of the next
    top = np.where(wraps, 0, starts % height)
    bottom = np.where(wraps, height - 1, last % height)
    x0, x1 = np.minimum.reduceat(left, first), np.maximum.reduceat(right, first)
    y0, y1 = np.minimum.reduceat(top, first), np.maximum.reduceat(bottom, first)
    area = np.add.reduceat(ends - starts, first)
    bounds = [*first.tolist(), values.size]
    found = {}
    for k, at in enumerate(first.tolist()):
        box = (int(x0[k]), int(y0[k]), int(x1[k] - x0[k] + 1), int(y1[k] - y0[k] + 1))
        own = slice(at, bounds[k + 1])
        found[int(values[at])] = Segment(int(area[k]), box, starts[own], ends[own], (height, width))
    return found
