"""Follows key paths through the JSON Schema of a configuration, to a section, a kind or a key."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from perilune.config.errors import ConfigError, nearest

_DRIVERS = ("Driver", "ListDriver", "AnyDriver")
_KIND_KEYS = ("kind", "pointing", "model", "shape", "type")
ANY_NAME = "NAME"


@dataclass(frozen=True)
class Value:
    """Alternatives for the value of a key, without null and drivers."""

    leaves: tuple[Mapping[str, Any], ...]
    varies: bool = False
    """Whether a driver may replace it."""
    nullable: bool = False


@dataclass(frozen=True)
class Found:
    """The target of a path."""

    path: str
    node: Mapping[str, Any]
    value: Value
    sections: tuple[tuple[str, Mapping[str, Any]], ...] = field(default=())
    """(kind, section) of all alternatives; the kind is empty if there is only one."""


class Schema:
    """The schema with its references resolved."""

    def __init__(self, schema: Mapping[str, Any]) -> None:
        self.root = schema
        self._definitions: Mapping[str, Any] = schema["$defs"]

    def value(self, node: Mapping[str, Any]) -> Value:
        """Alternatives of a node."""
        leaves, varies, nullable = [], False, False
        for leaf, name in self._leaves(node):
            varies |= name in _DRIVERS
            nullable |= leaf.get("type") == "null"
            if name not in _DRIVERS and leaf.get("type") != "null":
                leaves.append(leaf)
        return Value(tuple(leaves), varies, nullable)

    def _leaves(
        self, node: Mapping[str, Any], name: str = ""
    ) -> Iterator[tuple[Mapping[str, Any], str]]:
        if "$ref" in node:
            name = node["$ref"].rsplit("/", 1)[-1]
            target = self._definitions[name]
            yield from [(target, name)] if name in _DRIVERS else self._leaves(target, name)
            return
        parts = node.get("anyOf") or node.get("oneOf") or ()
        if "properties" in node or not parts:
            yield node, name
            return
        for part in parts:
            yield from self._leaves(part, name)

    def sections(self, value: Value) -> tuple[tuple[str, Mapping[str, Any]], ...]:
        """(kind, section) of the alternatives that have keys, including items of lists and
        entries."""
        found = [leaf for leaf in value.leaves if "properties" in leaf]
        return tuple((self.kind(leaf) if len(found) > 1 else "", leaf) for leaf in found)

    def kind(self, section: Mapping[str, Any]) -> str:
        """Kind of a section by its key `kind`, such as `relative`."""
        for key in _KIND_KEYS:
            names = self._names(section["properties"].get(key, {}))
            if names:
                return names[0]
        return ""

    def _names(self, node: Mapping[str, Any]) -> list[str]:
        """The texts that a key may be, if it may be nothing else."""
        found: list[str] = []
        for leaf in self.value(node).leaves:
            found += [leaf["const"]] if "const" in leaf else leaf.get("enum", [])
        return [name for name in found if isinstance(name, str)]

    def entries(self, value: Value) -> Mapping[str, Any] | None:
        """Schema of the entries of a mapping or the items of a list."""
        for leaf in value.leaves:
            below = leaf.get("additionalProperties") or leaf.get("items")
            if isinstance(below, Mapping):
                return below
            if leaf.get("prefixItems"):
                first: Mapping[str, Any] = leaf["prefixItems"][0]
                return first
        return None

    def find(self, path: str) -> Found:
        """Finds the target of a path such as `camera.trajectory.relative.ahead_m`.

        The path may contain kinds, names of entries and indices. ConfigError with the nearest name
        for an unknown one."""
        node: Mapping[str, Any] = self.root
        value = Value((self.root,))
        sections = self.sections(value)
        done: list[str] = []
        for part in path.replace("[", ".").replace("]", "").split("."):
            node, value, sections = self._step(part, done, (node, value, sections))
            done.append(part)
        return Found(path, node, value, sections)

    def _step(
        self, part: str, done: list[str], at: tuple[Mapping[str, Any], Value, Any]
    ) -> tuple[Mapping[str, Any], Value, Any]:
        node, value, sections = at
        for kind, section in sections:
            if (part and part == kind) or (len(sections) > 1 and part in self.kinds(section)):
                return node, Value((section,)), (("", section),)
        for _, section in sections:
            if part in section["properties"]:
                below = section["properties"][part]
                return self._at(below)
        entry = self.entries(value)
        if entry is not None and not sections:
            found = self._at(entry)
            if part.isdecimal() or part in (ANY_NAME, "*") or not self._is_key(part, found):
                return found
            return self._step(part, done, found)
        allowed = [kind for kind, _ in sections if kind]
        allowed += dict.fromkeys(key for _, section in sections for key in section["properties"])
        where = ".".join(done) or "the configuration"
        if not allowed:
            raise ConfigError(f"{where}: has no keys, so no '{part}'")
        raise ConfigError(f"{where}: no key or kind '{part}'{nearest(part, allowed)}")

    def kinds(self, section: Mapping[str, Any]) -> list[str]:
        """All names of a section's kind (`lvlh` is also `nadir`)."""
        for key in _KIND_KEYS:
            if names := self._names(section["properties"].get(key, {})):
                return names
        return []

    def _is_key(self, part: str, at: tuple[Mapping[str, Any], Value, Any]) -> bool:
        """Whether a name is a key below the entries, which then need no name in the path."""
        sections = at[2]
        return any(
            part in section["properties"] or part in self.kinds(section)[: len(sections) > 1]
            for _, section in sections
        )

    def _at(self, node: Mapping[str, Any]) -> tuple[Mapping[str, Any], Value, Any]:
        value = self.value(node)
        return node, value, self.sections(value)


def default_text(node: Mapping[str, Any], required: bool) -> str:
    """`required`, or the default of a key."""
    if required:
        return "required"
    if "default" not in node:
        return ""
    value = node["default"]
    if isinstance(value, Mapping):
        return "its defaults" if value else "{}"
    return "none" if value is None else json.dumps(value).strip('"')
