"""What all distributions share: errors, numbers and vectors of mappings, the source of draws."""

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
    """A mapping that is meant as a driver, but is none."""

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
    """A number as (x,) where count is None, else count numbers; one number stands for all."""
    if not isinstance(value, (list, tuple)):
        return (number(name, value),) * (count or 1)
    if count is None:
        raise DriverError(name, f"must be one number, not {value!r}, as the other keys are")
    if len(value) != count:
        raise DriverError(name, f"must be a number or {count} numbers, not {value!r}")
    return tuple(number(f"{name}[{k}]", item) for k, item in enumerate(value))


def size(name: str, value: Any) -> int | None:
    """How many numbers a driver stands for: None for one alone, n for a list of n."""
    if not isinstance(value, (list, tuple)):
        return None
    if not value:
        raise DriverError(name, "must be a number or a list of numbers, not an empty list")
    return len(value)


def joint(name: str, raw: Mapping[str, Any]) -> bool:
    """The key `jointly`: whether all numbers of a list vary by one and the same draw."""
    value = raw.get("jointly", False)
    if not isinstance(value, bool):
        raise DriverError(f"{name}.jointly", f"must be true or false, not {value!r}")
    return value


def shaped(values: tuple[float, ...], count: int | None) -> Any:
    """What stands in the tree: a number, or a list."""
    return values[0] if count is None else list(values)


def clip(
    values: Sequence[float], low: tuple[float, ...], high: tuple[float, ...]
) -> tuple[float, ...]:
    """Each value within its limits."""
    rows = zip(values, low, high, strict=True)
    return tuple(min(max(value, least), most) for value, least, most in rows)


@dataclass(frozen=True)
class Source:
    """What a driver draws from at one step."""

    name: str
    """Key path of the driver."""
    seed: int
    step: int
    """The first one that the draw is for."""
    epoch: int
    """Counts the draws: the step divided by the interval."""
    drawn: Sequence[float] = ()
    """What the distribution needs: standard normals, or numbers uniform in [0, 1)."""
    correlates: bool = False
    """Whether these are normals that the driver's group correlates, whatever is needed."""

    def normals(self, count: int, jointly: bool = False) -> list[float]:
        """(count,) of mean 0 and variance 1; independent of each other, or all the same."""
        return list(self.drawn) * (count if jointly else 1)

    def uniforms(self, count: int, jointly: bool = False) -> list[float]:
        """(count,) in [0, 1]; in a correlated group those of its normals (a Gaussian copula)."""
        found = self.normals(count, jointly)
        if self.correlates:
            return [0.5 * math.erfc(-x / math.sqrt(2.0)) for x in found]
        return found


class Need(NamedTuple):
    """Standard numbers for one draw."""

    normal: bool
    """Normals; else uniform ones."""
    numbers: int


class Distribution(Protocol):
    """What a row of the table makes of a mapping."""

    @property
    def ideal(self) -> Any:
        """The value without strength: a number, a list of numbers, or what a choice offers."""

    @property
    def limits(self) -> Mapping[str, Any]:
        """Values that must be valid in the driver's place: key of the driver, as `.clip_min` or
        `.choice[1]` -> value."""

    @property
    def ideal_key(self) -> str:
        """Which key of the driver says the ideal, likewise."""

    def needs(self, strength: float) -> Need | None:
        """What a draw takes of the source; None where nothing varies, or a hook draws."""

    def draw(self, source: Source, strength: float) -> Any:
        """A value; the ideal, to the bit, at a strength of 0."""


@dataclass(frozen=True)
class Kind:
    """A row of the table of distributions."""

    name: str
    markers: tuple[str, ...]
    """A mapping with one of these keys is meant as this kind."""
    keys: tuple[str, ...]
    """All keys of its own."""
    parse: Callable[[str, Mapping[str, Any]], Distribution]
    correlates: bool = True
    """Whether it can be in a group with `shared` or `correlation`."""
    marks: Callable[[Any], bool] = lambda value: True
    """What a marker's value must be like; a section that is called like a marker is none."""
