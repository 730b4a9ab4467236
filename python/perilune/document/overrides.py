"""Dotted overrides: {"camera.width": 64} applied to a configuration's tree."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from perilune.config.errors import ConfigError, nearest, warn
from perilune.document.loader import parse_yaml
from perilune.document.sections import keys_of, sections_at
from perilune.drivers import KeyPath, path_text, without
from perilune.drivers.tree import kind_of

_INDEX = re.compile(r"\[(\d+)\]")


def parse_override(text: str) -> tuple[str, Any]:
    """'camera.width=64' -> ('camera.width', 64); the value is read as YAML."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise ConfigError(f"--set {text}: must be key=value, such as camera.width=64")
    return key.strip(), parse_yaml(value, f"--set {text}")


def _step(node: Any, part: str, key: str) -> tuple[Any, str | int]:
    """The container and the index that `part` addresses in it."""
    if isinstance(node, dict):
        return node, part
    if isinstance(node, list):
        if not part.isdecimal() or int(part) >= len(node):
            raise ConfigError(
                f"override {key}: '{part}' is no index of a list of {len(node)} values"
            )
        return node, int(part)
    raise ConfigError(f"override {key}: '{part}' is below a single value, {node!r}")


def _parts(key: str) -> list[str]:
    return _INDEX.sub(r".\1", key).split(".")


def without_unread(
    tree: dict[str, Any], unread: Iterable[KeyPath], overrides: Iterable[str]
) -> dict[str, Any] | None:
    """The tree without the keys that nothing reads after an override has changed others of their
    section; None if one of them comes from elsewhere."""
    changed = [_parts(key) for key in overrides]
    for path in unread:
        parts = [str(part) for part in path]
        given = any(key == parts[: len(key)] for key in changed)
        beside = any(key[: len(parts) - 1] == parts[:-1] for key in changed)
        if given or not beside:
            return None
        tree = without(tree, path)
    return tree


def joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
    """One set of overrides with the effect of two in sequence."""
    later = [_parts(key) for key in second]

    def hidden(key: str) -> bool:
        parts = _parts(key)
        return any(parts[: len(other)] == other for other in later)

    together = {**{key: value for key, value in first.items() if not hidden(key)}, **second}
    return {_key_path(key): value for key, value in together.items()}


def _key_path(key: str) -> str:
    """`camera.K.4` as errors and drivers write it, `camera.K[4]`: metadata use one name only."""
    return path_text(tuple(int(part) if part.isdecimal() else part for part in _parts(key)))


def apply_overrides(tree: dict[str, Any], overrides: Mapping[str, Any]) -> None:
    """Changes the tree: sets each dotted key and creates sections on the way; None removes the key.

    Indices of lists are numbers between dots, or in brackets as in key paths: `camera.K.4` or
    `camera.K[4]`. The validation that follows refuses keys unknown to the schema; `without_unread`
    removes keys that only a former mode reads."""
    names: dict[tuple[str, ...], str] = {}
    for key in overrides:
        other = names.setdefault(tuple(_parts(key)), key)
        if other != key:
            raise ConfigError(f"override {key}: is another name of {other}; give one of the two")
    for key, value in overrides.items():
        node: Any = tree
        parts = _parts(key)
        for part in parts[:-1]:
            node, index = _step(node, part, key)
            if isinstance(node, dict) and node.get(part) is None:
                node[part] = {}
            node = node[index]
        node, index = _step(node, parts[-1], key)
        if value is None and isinstance(node, dict):
            _check_removal(node, parts, key)
            node.pop(parts[-1], None)
        else:
            if isinstance(node, dict):
                _warn_of_lost(node.get(parts[-1]), value, parts, key)
            node[index] = value


def _check_removal(node: Mapping[str, Any], parts: list[str], key: str) -> None:
    """ConfigError for a key that is neither present nor in the schema, because it is misspelt."""
    allowed = [name for section in sections_at(parts[:-1]) for name in keys_of(section)]
    if allowed and parts[-1] not in node and parts[-1] not in allowed:
        raise ConfigError(f"override {key}: nothing to remove{nearest(parts[-1], allowed)}")


def _warn_of_lost(old: Any, new: Any, parts: list[str], key: str) -> None:
    """Warns if a mapping replaces a whole section, where only some keys may have been meant."""
    if not isinstance(old, Mapping) or not isinstance(new, Mapping):
        return
    # Of a section that has kinds, one is given instead of another.
    if kind_of(old) is not None or kind_of(new) is not None or len(sections_at(parts)) != 1:
        return
    lost = [name for name in old if name not in new]
    if lost and "file" not in new:
        one = next(iter(new), "KEY")
        warn(
            f"override {key}: replaces the section as a whole, without its {', '.join(lost)}; "
            f"'{key}.{one}' changes one key"
        )
