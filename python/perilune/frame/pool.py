"""Arrays of frames, used again when nobody holds them any more.

The system clears the pages of every large array that is new: for all labels of a frame that takes
as long as a tenth of rendering them, and threads wait for each other meanwhile.
"""

from __future__ import annotations

import sys
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

_LARGE = 1 << 17
"""Bytes from which malloc asks the system for new pages."""
_MOST = 2
"""Arrays kept of a channel: in a loop the last frame is held while the next one renders."""


def _is_whole(array: Array, shape: tuple[int, ...], dtype: np.dtype[Any]) -> bool:
    """Whether it is as it was made: holders may reshape or lock an array in place."""
    flags = array.flags
    same = array.shape == shape and array.dtype == dtype
    return same and flags.c_contiguous and flags.owndata and flags.writeable


def _holders(kept: list[Array], index: int) -> int:
    return sys.getrefcount(kept[index])


_ALONE = _holders([np.empty(0)], 0)
"""What is counted where the list alone holds it. Views and buffers of an array count as holders."""


class Pool:
    """For several threads. What it keeps is never more than was in use at once."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: dict[str, list[Array]] = {}

    def take(self, name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> Array:
        """An array for a channel, of any content."""
        if dtype.itemsize * int(np.prod(shape)) < _LARGE:
            return np.empty(shape, dtype)
        with self._lock:
            kept = [a for a in self._kept.pop(name, []) if _is_whole(a, shape, dtype)]
            free = next((i for i in range(len(kept)) if _holders(kept, i) == _ALONE), None)
            kept.append(np.empty(shape, dtype) if free is None else kept.pop(free))
            self._kept[name] = kept[-_MOST:]
            return kept[-1]
