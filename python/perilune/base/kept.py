"""Room in dictionaries of values that are kept for later."""

from __future__ import annotations

from typing import Any


def make_room(kept: dict[Any, Any], most: int) -> None:
    """Removes the oldest entries until fewer than `most` (>= 1) are left."""
    while len(kept) >= most:
        del kept[next(iter(kept))]
