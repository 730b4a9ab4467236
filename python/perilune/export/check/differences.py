"""Describes differences of two JSON values: key by key, poses in degrees and millimetres."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

_LONG = 6
"""Longer lists are described by their first difference."""


@dataclass(frozen=True)
class Tolerance:
    """Allowed differences between two builds of the core; the same build gives the same bits."""

    relative: float = 0.0
    """Relative difference of numbers; absolute below 1."""
    pixels: float = 0.0
    """Fraction of the pixels of a mask, and of counts of pixels."""
    few: int = 0
    """Number of pixels in addition to that fraction."""

    def same(self, found: object, expected: object) -> bool:
        """Whether two plain values are equal within the tolerance."""
        if type(found) is bool or type(expected) is bool:
            return found is expected
        if isinstance(found, int) and isinstance(expected, int):
            return abs(found - expected) <= self.pixels_of(expected)
        if isinstance(found, (int, float)) and isinstance(expected, (int, float)):
            slack = self.relative * max(1.0, abs(expected))
            return found == expected or abs(found - expected) <= slack
        return found == expected

    def pixels_of(self, count: int) -> int:
        """Allowed number of different pixels among this many."""
        return int(self.few + self.pixels * abs(count))


EXACT = Tolerance()
OTHER_BUILD = Tolerance(1e-9, 1e-3, 3)
"""For files made by another version or instruction set: rounding differs, and with it pixels whose
centre is on an edge."""


def _is_list(value: object) -> bool:
    return isinstance(value, (list, tuple))


def _turned(found: Any, expected: Any) -> str:
    """Angle between two rotations."""
    away = float(np.linalg.norm(np.subtract(found, expected)))
    angle = 2.0 * math.asin(min(1.0, away / math.sqrt(8.0)))
    return f"is turned by {math.degrees(angle):.3g} deg against"


def _moved(found: Any, expected: Any) -> str:
    away = float(np.linalg.norm(np.subtract(found, expected)))
    return f"is {away:.3g} mm away from"


_WORDS = {"cam_R_m2c": _turned, "cam_R_w2c": _turned, "cam_t_m2c": _moved, "cam_t_w2c": _moved}


def differences(
    found: Any, expected: Any, tolerance: Tolerance, key: str = ""
) -> Iterator[tuple[str, str]]:
    """(key path, found and expected value) of all differences."""
    name = key.rpartition(".")[2]
    if isinstance(found, Mapping) and isinstance(expected, Mapping):
        for entry in sorted({*found, *expected}):
            where = f"{key}.{entry}" if key else str(entry)
            if entry not in found:
                yield where, f"is missing, must be {_short(expected[entry])}"
            elif entry not in expected:
                yield where, f"is {_short(found[entry])}, but does not belong there"
            else:
                yield from differences(found[entry], expected[entry], tolerance, where)
    elif _is_list(found) and _is_list(expected):
        yield from _of_lists(found, expected, tolerance, key, name)
    elif not tolerance.same(found, expected):
        yield key, f"is {_short(found)}, must be {_short(expected)}"


def _of_lists(
    found: Any, expected: Any, tolerance: Tolerance, key: str, name: str
) -> Iterator[tuple[str, str]]:
    if len(found) != len(expected):
        yield key, f"has {len(found)} entries, must have {len(expected)}"
        return
    pairs = enumerate(zip(found, expected, strict=True))
    rows = [(k, list(differences(a, b, tolerance, f"{key}[{k}]"))) for k, (a, b) in pairs]
    faults = [fault for _, row in rows for fault in row]
    if not faults:
        return
    try:
        words = _WORDS[name](found, expected) if name in _WORDS else None
    except (TypeError, ValueError):
        words = None
    plain = not any(isinstance(value, (Mapping, list)) for value in (*found, *expected))
    if words is not None:
        yield key, f"{words} what must be there: {_short(found)}, must be {_short(expected)}"
    elif plain and len(found) <= _LONG:
        yield key, f"is {_short(found)}, must be {_short(expected)}"
    elif plain:
        where, what = faults[0]
        more = f" (and {len(faults) - 1} more of its numbers)" if len(faults) > 1 else ""
        yield where, what + more
    else:
        yield from faults


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 240 else text[:200] + " ..."
