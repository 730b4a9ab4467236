"""What all distributions share: errors, numbers and vectors of mappings, the source of draws."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from perilune.base.random import generator

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


def clip(values: F64, low: tuple[float, ...], high: tuple[float, ...]) -> tuple[float, ...]:
    """Each value within its limits."""
    rows = zip(values.tolist(), low, high, strict=True)
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
    correlated: Callable[[int], F64] | None = None
    """Standard normals, as many as asked for, that the driver's group correlates."""

    def _generator(self) -> np.random.Generator:
        return generator(self.seed, f"driver:{self.name}", self.epoch)

    def normals(self, count: int, jointly: bool = False) -> F64:
        """(count,) of mean 0 and variance 1; independent of each other, or all the same."""
        own = 1 if jointly else count
        if self.correlated is not None:
            found = self.correlated(own)
        else:
            found = self._generator().standard_normal(own)
        return np.broadcast_to(found, (count,))

    def uniforms(self, count: int, jointly: bool = False) -> F64:
        """(count,) in [0, 1]; in a correlated group those of its normals (a Gaussian copula)."""
        if self.correlated is not None:
            found = self.normals(count, jointly)
            return np.array([0.5 * math.erfc(-x / math.sqrt(2.0)) for x in found.tolist()])
        return np.broadcast_to(self._generator().random(1 if jointly else count), (count,))


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
