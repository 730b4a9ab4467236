"""Common parts of all distributions: errors, numbers and vectors of mappings, sources of draws."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]
KeyPath = tuple[str | int, ...]


class Drawn(float):
    """A number that a driver put in place of its mapping; keys that cannot vary refuse it."""


class DriverError(ValueError):
    """A mapping with a driver's keys that is not a valid driver."""

    def __init__(self, path: str, text: str) -> None:
        super().__init__(f"{path}: {text}")


def path_text(path: KeyPath) -> str:
    """('camera', 'K', 4) -> 'camera.K[4]'."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def number(name: str, value: Any) -> float:
    """A finite number, or DriverError."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise DriverError(name, f"must be a finite number, not {value!r}")
    return float(value)


def numbers(name: str, value: Any, count: int | None) -> tuple[float, ...]:
    """(x,) if count is None, else count numbers; a single number is repeated."""
    if not isinstance(value, (list, tuple)):
        return (number(name, value),) * (count or 1)
    if count is None:
        raise DriverError(name, f"must be one number, not {value!r}, as the other keys are")
    if len(value) != count:
        raise DriverError(name, f"must be a number or {count} numbers, not {value!r}")
    return tuple(number(f"{name}[{k}]", item) for k, item in enumerate(value))


def size(name: str, value: Any) -> int | None:
    """Number of values of a driver: None for a single number, n for a list of n."""
    if not isinstance(value, (list, tuple)):
        return None
    if not value:
        raise DriverError(name, "must be a number or a list of numbers, not an empty list")
    return len(value)


def joint(name: str, raw: Mapping[str, Any]) -> bool:
    """The key `jointly`: whether one draw varies all numbers of a list."""
    value = raw.get("jointly", False)
    if not isinstance(value, bool):
        raise DriverError(f"{name}.jointly", f"must be true or false, not {value!r}")
    return value


def shaped(values: tuple[float, ...], count: int | None) -> Any:
    """The value as in the tree: a number or a list."""
    return values[0] if count is None else list(values)


def clip(
    values: Sequence[float], low: tuple[float, ...], high: tuple[float, ...]
) -> tuple[float, ...]:
    """Each value within its limits."""
    rows = zip(values, low, high, strict=True)
    return tuple(min(max(value, least), most) for value, least, most in rows)


class Source(NamedTuple):
    """Random numbers for a driver's draw at one step."""

    name: str
    """Key path of the driver."""
    seed: int
    step: int
    """First step that the draw is for."""
    epoch: int
    """Number of the draw: the step divided by the interval."""
    drawn: Sequence[float] = ()
    """Numbers that the distribution needs: standard normals, or uniform in [0, 1)."""
    correlates: bool = False
    """Whether these are the group's correlated normals, whatever the distribution needs."""

    def normals(self, count: int, jointly: bool = False) -> list[float]:
        """(count,) normal numbers of mean 0 and variance 1: independent, or all equal."""
        return list(self.drawn) * (count if jointly else 1)

    def uniforms(self, count: int, jointly: bool = False) -> list[float]:
        """(count,) numbers in [0, 1]; in a correlated group those of its normals (a Gaussian
        copula)."""
        found = self.normals(count, jointly)
        if self.correlates:
            return [0.5 * math.erfc(-x / math.sqrt(2.0)) for x in found]
        return found


class Need(NamedTuple):
    """Standard random numbers that one draw needs."""

    normal: bool
    """Whether they are normal; otherwise uniform."""
    numbers: int


class Distribution(Protocol):
    """A driver parsed from a mapping."""

    @property
    def ideal(self) -> Any:
        """Value at a strength of 0: a number, a list of numbers, or an option of a choice."""

    @property
    def limits(self) -> Mapping[str, Any]:
        """Values that must be valid in the driver's place: key of the driver, such as `.clip_min`
        or `.choice[1]` -> value."""

    @property
    def ideal_key(self) -> str:
        """Key of the driver that holds the ideal, in the same form."""

    def needs(self, strength: float) -> Need | None:
        """Random numbers that a draw needs; None if nothing varies or a hook draws."""

    def draw(self, source: Source, strength: float) -> Any:
        """A value; exactly the ideal at a strength of 0."""


@dataclass(frozen=True)
class Kind:
    """A row of the table of distributions."""

    name: str
    markers: tuple[str, ...]
    """Keys of which one marks a mapping as this kind."""
    keys: tuple[str, ...]
    """All keys of this kind."""
    parse: Callable[[str, Mapping[str, Any]], Distribution]
    correlates: bool = True
    """Whether it may be in a group with `shared` or `correlation`."""
    marks: Callable[[Any], bool] = lambda value: True
    """Test of a marker's value, so that a section of the same name is no driver."""
