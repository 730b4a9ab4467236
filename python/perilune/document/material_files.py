"""Materials in separate files: reads `materials.X.file` and inserts the content."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from perilune.config.errors import ConfigError
from perilune.document.loader import read_tree
from perilune.document.paths import DATA_PREFIX, resolve
from perilune.drivers import path_text

Tree = dict[str, Any]
_KEY = "file"
_DEPTH = 3  # nodes.NAME.KEY


def include(tree: Tree, base: Path, source: str) -> dict[str, str]:
    """Replaces each `materials.X.file` by the content of the file; keys given beside it take
    precedence.

    Returns key path -> `file: key path` for everything from files, for errors. ConfigError and
    FileNotFoundError name the key and the file."""
    origins: dict[str, str] = {}
    materials = tree.get("materials")
    if not isinstance(materials, dict):
        return origins
    for name, material in materials.items():
        if not isinstance(material, dict) or _KEY not in material:
            continue
        key = f"materials.{name}.{_KEY}"
        text = material.pop(_KEY)
        if not isinstance(text, str):
            raise ConfigError(f"{source}:\n  {key}: must be the path of a file, not {text!r}")
        path_of_file = resolve(text, base, f"{source}: {key}")
        try:
            held = read_tree(path_of_file)
        except ConfigError as error:
            raise ConfigError(f"{source}:\n  {key}: {error}") from None
        if _KEY in held:
            raise ConfigError(f"{text}:\n  {_KEY}: a file of a material names no other file")
        move_images(held, os.path.relpath(path_of_file.parent, base))
        for path in from_file(held, material, ()):
            origins[f"materials.{name}.{path_text(path)}"] = f"{text}: {path_text(path)}"
        materials[name] = merged(held, material)
    return origins


def move_images(held: Mapping[str, Any], folder: str) -> None:
    """Converts image paths relative to the material's file to paths relative to the
    configuration."""
    nodes = held.get("nodes")
    for node in nodes.values() if isinstance(nodes, dict) else ():
        text = node.get(_KEY) if isinstance(node, dict) else None
        if isinstance(text, str) and text and not text.startswith(DATA_PREFIX):
            node[_KEY] = os.path.normpath(os.path.join(folder, text))


def merged(held: Mapping[str, Any], beside: Mapping[str, Any]) -> Tree:
    """The mapping of a file, overridden by the keys given beside it."""
    result = {**held, **beside}
    for key, merge in (("nodes", _nodes), ("drivers", _drivers)):
        if isinstance(held.get(key), dict) and isinstance(beside.get(key), dict):
            result[key] = merge(held[key], beside[key])
    return result


def _nodes(held: Tree, beside: Tree) -> Tree:
    """Merges nodes key by key; a key's value is replaced as a whole, and so is a node of another
    type."""

    def one(old: Any, new: Any) -> Any:
        if not isinstance(old, dict) or not isinstance(new, dict):
            return new
        same = "type" not in new or new["type"] == old.get("type")
        return {**old, **new} if same else new

    return {**held, **{name: one(held.get(name), new) for name, new in beside.items()}}


def _drivers(held: Tree, beside: Tree) -> Tree:
    """Merges named drivers key by key; one of another distribution is replaced as a whole."""

    def one(old: Any, new: Any) -> Any:
        both = isinstance(old, dict) and isinstance(new, dict)
        return {**old, **new} if both and new.keys() <= old.keys() else new

    result = {**held, **beside}
    if isinstance(held.get("drivers"), dict) and isinstance(beside.get("drivers"), dict):
        old, new = held["drivers"], beside["drivers"]
        result["drivers"] = {**old, **{name: one(old.get(name), new[name]) for name in new}}
    return result


def from_file(held: Any, beside: Any, path: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Paths of the file's keys without overriding keys below them, down to inputs of nodes."""
    for key, value in held.items():
        at = (*path, key)
        alone = not isinstance(beside, dict) or key not in beside
        if alone:
            yield at
        below = {} if alone else beside[key]
        if isinstance(value, dict) and isinstance(below, dict) and len(at) < _DEPTH:
            yield from from_file(value, below, at)
