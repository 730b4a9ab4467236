"""Limits of drivers, tried in time that grows linearly with the number of spacecraft.

Each limit is tried in a configuration with the other values at their ideals. Spacecraft that
nothing names take part in no rule about others: they are left out where a limit of another
spacecraft is tried. Spacecraft that differ in place and attitude alone obey the same rules for all
other keys, whose limits are tried on one of them; so are those of materials."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

from perilune.drivers import Found, KeyPath

_WORD = re.compile(r"[\w-]+")
_CRAFTS = "spacecraft"
_WHERE = ("orbit", "attitude")
"""Sections that no rule relates to the values of a spacecraft's other sections."""
_ALIKE = (_CRAFTS, "materials", "material_drivers")
"""Sections whose values no rule relates to where spacecraft are that nothing names."""
ONE_OF_EACH = ""
"""In place of an owner: of all that are alike, the first takes part."""


def _texts(node: Any) -> Iterator[str]:
    """All keys and texts below a node."""
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield str(key)
            yield from _texts(value)
    elif isinstance(node, (list, tuple)):
        for item in node:
            yield from _texts(item)
    elif isinstance(node, str):
        yield node


def _unnamed(tree: Mapping[str, Any]) -> set[str]:
    """Spacecraft whose names occur nowhere else in the tree, not even within a text."""
    crafts = tree.get(_CRAFTS)
    if not isinstance(crafts, Mapping):
        return set()
    words: set[str] = set()
    for part in ({**tree, _CRAFTS: None}, *crafts.values()):
        for text in _texts(part):
            words.update(_WORD.findall(text))
    return {name for name in crafts if _WORD.fullmatch(name) and name not in words}


def contains(tree: Mapping[str, Any], path: KeyPath) -> bool:
    """Whether a tree of `Limits` has the section of a path: all do but those of spacecraft."""
    return path[0] != _CRAFTS or path[1] in tree[_CRAFTS]


class Limits:
    """The limits that have to be tried, and the tree that each is tried in."""

    def __init__(self, tree: Mapping[str, Any]) -> None:
        self._tree = tree
        self._unnamed = _unnamed(tree)
        self._texts: dict[tuple[str, bool], str] = {}
        self._tried: set[tuple[Any, ...]] = set()

    def owner(self, path: KeyPath) -> str | None:
        """The only unnamed spacecraft that takes part where a driver's limits are tried; None: all
        do."""
        if not self._unnamed or path[0] not in _ALIKE:
            return None
        name = str(path[1]) if len(path) > 2 and path[0] == _CRAFTS else ONE_OF_EACH
        return name if name in self._unnamed else ONE_OF_EACH

    def tree_for(self, owner: str | None) -> Mapping[str, Any]:
        """The tree that the limits of an owner are tried in."""
        if owner is None:
            return self._tree
        kept = {owner} if owner != ONE_OF_EACH else self._one_of_each
        others = self._unnamed - kept
        crafts = {n: craft for n, craft in self._tree[_CRAFTS].items() if n not in others}
        return {**self._tree, _CRAFTS: crafts}

    @cached_property
    def _one_of_each(self) -> set[str]:
        first: dict[str, str] = {}
        for name in self._tree[_CRAFTS]:
            if name in self._unnamed:
                first.setdefault(self._text(name, False), name)
        return set(first.values())

    def untried(self, driver: Found) -> list[tuple[str, Any]]:
        """(part, value) of a driver's limits that no spacecraft alike has had before."""
        found = []
        owner = self.owner(driver.path)
        for part, limit in driver.distribution.limits.items():
            if limit == driver.ideal:
                continue
            if owner:
                key = (self._text(owner, driver.path[2] in _WHERE), driver.path[2:], part)
                if key in self._tried:
                    continue
                self._tried.add(key)
            found.append((part, limit))
        return found

    def _text(self, owner: str, whole: bool) -> str:
        """A spacecraft's section as text, to compare: whole, or without its place and attitude."""
        key = (owner, whole)
        if key not in self._texts:
            craft = self._tree[_CRAFTS][owner]
            kept = {k: v for k, v in craft.items() if whole or k not in _WHERE}
            self._texts[key] = json.dumps(kept, sort_keys=True, default=repr)
        return self._texts[key]
