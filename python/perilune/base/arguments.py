"""Checks of arguments of the Python interface, with errors that name the argument."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any


def whole(name: str, value: Any, least: int | None = None) -> int:
    """A whole number, also NumPy's, as an int; TypeError or ValueError that names the argument."""
    if isinstance(value, bool) or not hasattr(value, "__index__"):
        raise TypeError(f"{name} = {value!r:.60}: must be a whole number")
    number = int(value.__index__())
    if least is not None and number < least:
        raise ValueError(f"{name} = {number}: must be {least} or more")
    return number


def positive(name: str, value: Any) -> float:
    """The value as a finite number above 0; TypeError or ValueError that names it otherwise."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{name}: must be a number, not {type(value).__name__}")
    if not 0.0 < value < math.inf:
        raise ValueError(f"{name}: must be above 0 and finite, not {value}")
    return float(value)


def frame_index(index: Any) -> int:
    """A frame's index as an int; TypeError, or IndexError for one that no frame has."""
    number = index.__index__() if hasattr(index, "__index__") else None
    if number is None:
        raise TypeError(f"a frame's index is an integer, not {type(index).__name__} {index!r:.60}")
    if not 0 <= number < 2**31:
        raise IndexError(f"frame {number}: indices run from 0 to 2^31 - 1")
    return int(number)


def mapping(name: str, value: Any, like: str) -> Mapping[str, Any]:
    """A mapping with texts as keys; otherwise TypeError with an example."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{name}: must be a mapping such as {like}, not {value!r:.60}")
    for key in value:
        if not isinstance(key, str):
            raise TypeError(f"{name}: a key must be a text, not {key!r}; such as {like}")
    return value


def function(name: str, value: Any, like: str) -> None:
    """TypeError for an object that cannot be called."""
    if not callable(value):
        raise TypeError(f"{name}: must be a function {like}, not {value!r:.60}")


def names(name: str, value: Any) -> list[str]:
    """A list of unique names; TypeError for a text, whose letters are no names."""
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        listed = f"; a list of one is [{value!r}]" if isinstance(value, str) else ""
        raise TypeError(f"{name}: must be a list of names, not {value!r:.60}{listed}")
    return list(dict.fromkeys(value))
