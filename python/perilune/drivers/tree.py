"""Finds drivers in a tree of mappings and lists, and replaces them by values."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from perilune.drivers.choice import KIND as CHOICE
from perilune.drivers.common import (
    Distribution,
    Drawn,
    DriverError,
    KeyPath,
    Kind,
    number,
    path_text,
)
from perilune.drivers.hook import KIND as HOOK
from perilune.drivers.log_normal import KIND as LOG_NORMAL
from perilune.drivers.normal import KIND as NORMAL
from perilune.drivers.truncated import KIND as TRUNCATED
from perilune.drivers.uniform import KIND as UNIFORM

KINDS: tuple[Kind, ...] = (HOOK, CHOICE, UNIFORM, TRUNCATED, LOG_NORMAL, NORMAL)
"""Table of distributions; the first kind with a marker in a mapping determines its kind."""

SETTINGS = ("interval", "strength", "group")
"""Keys of every driver."""
SECTION = ("drivers", "jitter_strength", "step_interval", "per")
"""Keys of a section of drivers, such as a material's."""


@dataclass(frozen=True)
class Section:
    """Settings of a section of drivers, for all drivers below it."""

    strength: float | tuple[float, ...] | None = None
    """Several numbers: one per draw, the last for all later draws."""
    interval: int | None = None


@dataclass(frozen=True)
class Found:
    """A driven key; `path` addresses it in the tree, `name` is the path as text."""

    path: KeyPath
    name: str
    kind: Kind
    distribution: Distribution
    interval: int | None = None
    strength: float | None = None
    group: str | None = None
    section: Section = Section()

    @property
    def ideal(self) -> Any:
        """Value at a strength of 0."""
        return self.distribution.ideal


def _interval(name: str, value: Any) -> int | None:
    if value is not None and (type(value) is not int or value < 1):
        raise DriverError(name, f"must be a whole number of steps, not {value!r}")
    return value


def _strength(name: str, value: Any) -> float | None:
    if value is None:
        return None
    strength = number(name, value)
    if strength < 0.0:
        raise DriverError(name, f"must not be negative: {strength:g}")
    return strength


def _strengths(name: str, value: Any) -> float | tuple[float, ...] | None:
    """One number, or one per draw."""
    if not isinstance(value, (list, tuple)):
        return _strength(name, value)
    if not value:
        raise DriverError(name, "must be a number, or a list of them, one a draw")
    rows = (_strength(f"{name}[{k}]", number(f"{name}[{k}]", v)) for k, v in enumerate(value))
    return tuple(row for row in rows if row is not None)


def kind_of(raw: Mapping[str, Any]) -> Kind | None:
    """The kind of driver that a mapping represents; None for no driver."""
    if raw.get("kind") == HOOK.name:
        return None  # a section whose function has the key `hook` too
    for kind in KINDS:
        if any(key in raw and kind.marks(raw[key]) for key in kind.markers):
            return kind
    return None


def _parse(path: KeyPath, raw: Mapping[str, Any], kind: Kind, section: Section) -> Found:
    name = path_text(path)
    known = kind.keys + SETTINGS
    for key in raw:
        if key not in known:
            close = get_close_matches(key, known, n=1, cutoff=0.5)
            hint = f"did you mean '{close[0]}'? " if close else ""
            text = f"unknown key of a driver; {hint}allowed: {', '.join(known)}"
            raise DriverError(f"{name}.{key}", text)
    group = raw.get("group")
    if group is not None and not isinstance(group, str):
        raise DriverError(f"{name}.group", f"must be the name of a group, not {group!r}")
    distribution = kind.parse(name, raw)
    if kind is CHOICE:
        for k, value in enumerate(raw["choice"]):
            for inner in find(value, (*path, "choice", k)):
                raise DriverError(inner.name, "a value of a choice takes no driver")
    interval = _interval(f"{name}.interval", raw.get("interval"))
    strength = _strength(f"{name}.strength", raw.get("strength"))
    return Found(path, name, kind, distribution, interval, strength, group, section)


def _section(path: KeyPath, raw: Mapping[str, Any], outer: Section) -> Section:
    """Settings of a mapping for the drivers below it, if it is a section of drivers."""
    if "drivers" not in raw or not isinstance(raw["drivers"], Mapping) or set(raw) - set(SECTION):
        return outer
    name = path_text(path)
    strength = _strengths(f"{name}.jitter_strength", raw.get("jitter_strength"))
    interval = _interval(f"{name}.step_interval", raw.get("step_interval"))
    return Section(
        outer.strength if strength is None else strength,
        outer.interval if interval is None else interval,
    )


def find(tree: Any, path: KeyPath = (), section: Section | None = None) -> Iterator[Found]:
    """All drivers of a tree in its order: mappings with a key that marks a distribution."""
    section = section or Section()
    if isinstance(tree, Mapping):
        kind = kind_of(tree) if path else None
        if kind is not None:
            yield _parse(path, tree, kind, section)
            return
        section = _section(path, tree, section)
        for key, value in tree.items():
            yield from find(value, (*path, key), section)
    elif isinstance(tree, (list, tuple)):
        for index, value in enumerate(tree):
            yield from find(value, (*path, index), section)


def names(tree: Any, path: KeyPath = ()) -> Iterator[str]:
    """The key paths of everything in a tree, as text."""
    if isinstance(tree, Mapping):
        below: Iterator[tuple[str | int, Any]] = iter(tree.items())
    elif isinstance(tree, (list, tuple)):
        below = iter(enumerate(tree))
    else:
        return
    for key, value in below:
        yield path_text((*path, key))
        yield from names(value, (*path, key))


def substitute(tree: Any, values: Mapping[KeyPath, Any]) -> Any:
    """The tree with the mappings at the given paths replaced by values.

    The given tree stays unchanged; the result shares with it all parts without drivers."""
    if isinstance(tree, dict) and all(len(path) == 1 for path in values):
        return tree | {path[0]: marked(value) for path, value in values.items()}
    for path, value in values.items():
        tree = _replaced(tree, path, marked(value))
    return tree


def marked(value: Any) -> Any:
    """Numbers, and those of lists, become Drawn; sections are taken as they are."""
    if type(value) is float:
        return Drawn(value)
    if isinstance(value, (list, tuple)):
        return [marked(item) for item in value]
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return Drawn(value)
    return value


def _replaced(node: Any, path: KeyPath, value: Any) -> Any:
    if not path:
        return value
    result = node.copy()
    result[path[0]] = _replaced(node[path[0]], path[1:], value)
    return result


def without(tree: Any, path: KeyPath) -> Any:
    """The tree without a key of a mapping; the given tree stays unchanged."""
    result = copy.copy(tree)
    if len(path) == 1:
        del result[path[0]]
    else:
        result[path[0]] = without(tree[path[0]], path[1:])
    return result
