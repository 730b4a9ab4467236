"""Scalar drivers: a number of the configuration replaced by a random variable.

A driver is a mapping {ideal, jitter_variance, clip_min, clip_max} in the place of a number, with
`interval` (steps of the timeline) and `strength` optional. Its value at a frame is

    clip(ideal + N(0, jitter_variance * strength), clip_min, clip_max)

The mapping {uniform: [low, high]} draws uniformly between two limits; a strength other than 1 draws
about the middle, clipped to the limits, with the variance times the strength.

All draws are keyed by (seed, key path, step // interval): independent of order, worker and other
drivers, and the same for all sensors of a step. Without an interval of its own, or a default one in
the section `drivers`, a value is drawn once a scene (time.frames_per_scene steps).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from perilune.random import generator

_NUMBERS = ("ideal", "jitter_variance", "clip_min", "clip_max")
_UNIFORM = "uniform"
_OPTIONAL = ("interval", "strength")


class Drawn(float):
    """A number that a driver put in place of its mapping; keys that cannot vary refuse it."""


class DriverError(ValueError):
    """A mapping that is meant as a driver, but is none."""

    def __init__(self, path: str, text: str) -> None:
        super().__init__(f"{path}: {text}")


@dataclass(frozen=True)
class Driver:
    """One driven key; `path` addresses it in the tree, `name` is the path as text."""

    path: tuple[str | int, ...]
    name: str
    ideal: float
    jitter_variance: float
    clip_min: float
    clip_max: float
    interval: int | None
    strength: float | None
    uniform: bool = False
    """Uniform from clip_min to clip_max rather than normal."""

    def draw(self, seed: int, step: int, strength: float, interval: int) -> float:
        """The value at a step; strength and interval are the defaults of the configuration."""
        own_strength = strength if self.strength is None else self.strength
        deviation = math.sqrt(self.jitter_variance * own_strength)
        if deviation == 0.0:
            return self.ideal
        epoch = step // (self.interval or interval)
        rng = generator(seed, f"driver:{self.name}", epoch)
        # Both of mean 0 and variance 1.
        unit = math.sqrt(12.0) * (rng.random() - 0.5) if self.uniform else rng.standard_normal()
        return min(max(self.ideal + deviation * float(unit), self.clip_min), self.clip_max)


def path_text(path: tuple[str | int, ...]) -> str:
    """('camera', 'K', 4) -> 'camera.K[4]'."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise DriverError(name, f"must be a finite number, not {value!r}")
    return float(value)


def _normal(name: str, raw: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """ideal, jitter_variance, clip_min, clip_max."""
    for key in _NUMBERS:
        if key not in raw:
            raise DriverError(name, f"a driver needs {', '.join(_NUMBERS)}; {key} is missing")
    ideal, variance, low, high = (_number(f"{name}.{key}", raw[key]) for key in _NUMBERS)
    if variance < 0.0:
        raise DriverError(f"{name}.jitter_variance", f"must not be negative: {variance:g}")
    if not low <= ideal <= high:
        raise DriverError(
            f"{name}.ideal", f"{ideal:g} is outside [clip_min, clip_max] = [{low:g}, {high:g}]"
        )
    return ideal, variance, low, high


def _uniform(name: str, raw: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """The same of the uniform distribution between two limits."""
    limits = raw[_UNIFORM]
    if not isinstance(limits, (list, tuple)) or len(limits) != 2:
        raise DriverError(f"{name}.{_UNIFORM}", f"must be [low, high], not {limits!r}")
    low, high = (_number(f"{name}.{_UNIFORM}[{k}]", value) for k, value in enumerate(limits))
    if low > high:
        raise DriverError(f"{name}.{_UNIFORM}", f"must be [low, high], not [{low:g}, {high:g}]")
    return 0.5 * (low + high), (high - low) ** 2 / 12.0, low, high


def _parse(path: tuple[str | int, ...], raw: Mapping[str, Any]) -> Driver:
    name = path_text(path)
    own = (_UNIFORM,) if _UNIFORM in raw else _NUMBERS
    for key in raw:
        if key not in own + _OPTIONAL:
            allowed = ", ".join(own + _OPTIONAL)
            raise DriverError(f"{name}.{key}", f"unknown key of a driver; allowed: {allowed}")
    numbers = _uniform(name, raw) if _UNIFORM in raw else _normal(name, raw)
    interval = raw.get("interval")
    if interval is not None and (type(interval) is not int or interval < 1):
        raise DriverError(f"{name}.interval", f"must be a whole number of steps, not {interval!r}")
    strength = raw.get("strength")
    if strength is not None:
        strength = _number(f"{name}.strength", strength)
        if strength < 0.0:
            raise DriverError(f"{name}.strength", f"must not be negative: {strength:g}")
    return Driver(path, name, *numbers, interval, strength, _UNIFORM in raw)


def find(tree: Any, path: tuple[str | int, ...] = ()) -> Iterator[Driver]:
    """All drivers of a tree, in its order: mappings that hold the key `ideal` or `uniform`."""
    if isinstance(tree, Mapping):
        if "ideal" in tree or "jitter_variance" in tree or _UNIFORM in tree:
            yield _parse(path, tree)
            return
        for key, value in tree.items():
            yield from find(value, (*path, key))
    elif isinstance(tree, (list, tuple)):
        for index, value in enumerate(tree):
            yield from find(value, (*path, index))


def substitute(tree: Any, values: Mapping[tuple[str | int, ...], float]) -> Any:
    """The tree with the mappings at the given paths replaced by numbers.

    The tree itself is left alone; what no driver stands in is shared with it.
    """
    for path, value in values.items():
        tree = _replaced(tree, path, Drawn(value))
    return tree


def _replaced(node: Any, path: tuple[str | int, ...], value: float) -> Any:
    if not path:
        return value
    result = copy.copy(node)
    result[path[0]] = _replaced(node[path[0]], path[1:], value)
    return result
