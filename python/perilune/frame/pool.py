"""Reuses arrays of frames that nobody references any more.

The system clears the pages of every large new array. For all labels of a frame this takes a tenth
of the rendering time, and threads wait for each other meanwhile."""

from __future__ import annotations

import math
import sys
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

_LARGE = 1 << 17
"""Bytes from which malloc requests new pages from the system."""
_MOST = 2
"""Arrays to keep per channel: in a loop the last frame is held while the next one renders."""


def _is_whole(array: Array, shape: tuple[int, ...], dtype: np.dtype[Any]) -> bool:
    """Whether an array is as it was made; holders may reshape or lock it in place."""
    flags = array.flags
    same = array.shape == shape and array.dtype == dtype
    return same and flags.c_contiguous and flags.owndata and flags.writeable


def _holders(kept: list[Array], index: int) -> int:
    return sys.getrefcount(kept[index])


_ALONE = _holders([np.empty(0)], 0)
"""Reference count of an array held only by the list. Views and buffers of an array count too."""


class Pool:
    """Thread-safe pool of arrays. It never keeps more than were in use at once."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: dict[str, list[Array]] = {}

    def take(self, name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> Array:
        """An array for a channel, with arbitrary content."""
        if dtype.itemsize * math.prod(shape) < _LARGE:
            return np.empty(shape, dtype)
        with self._lock:
            kept = [a for a in self._kept.pop(name, []) if _is_whole(a, shape, dtype)]
            free = next((i for i in range(len(kept)) if _holders(kept, i) == _ALONE), None)
            kept.append(np.empty(shape, dtype) if free is None else kept.pop(free))
            self._kept[name] = kept[-_MOST:]
            return kept[-1]
