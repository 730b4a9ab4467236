"""Graphs in model files: `perilune_graph` in the extras of glTF materials.

They become entries of `materials` and uses of the spacecraft, so that everything else treats them
as part of the configuration. A model's file is not trusted: it may name no function, and no file
outside its folder."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from perilune import _core
from perilune.config.errors import ConfigError
from perilune.document.loader import parse_json
from perilune.document.material_files import from_file, merged, move_images
from perilune.document.paths import DATA_PREFIX, resolve
from perilune.drivers import path_text

Tree = dict[str, Any]
_EXTRAS = "extras.perilune_graph"


def include_models(tree: Tree, base: Path, source: str) -> dict[str, str]:
    """Adds the graphs of the spacecraft's models to `materials`, and their uses after all others.

    Returns key path -> `file: key path`, for errors. ConfigError names file and key. Missing models
    are reported later, by the code that loads them."""
    origins: dict[str, str] = {}
    entries: dict[Path, list[Tree]] = {}
    for craft in _crafts(tree):
        path = _model_of(craft, base)
        if path is None or craft.get("model_graphs") is False:
            continue
        if path not in entries:
            entries[path] = list(_entries(tree, path, str(craft["model"]), base, source, origins))
        if entries[path]:
            craft["materials"] = [*(craft.get("materials") or []), *entries[path]]
    return origins


def _crafts(tree: Tree) -> Iterator[Tree]:
    """Sections of spacecraft that can take graphs; faults in others are reported later."""
    crafts = tree.get("spacecraft")
    for craft in crafts.values() if isinstance(crafts, dict) else ():
        if isinstance(craft, dict) and isinstance(craft.get("materials") or [], list):
            yield craft


def _model_of(craft: Tree, base: Path) -> Path | None:
    text = craft.get("model")
    try:
        return resolve(text, base, "").resolve() if isinstance(text, str) else None
    except OSError:
        return None


def _entries(
    tree: Tree, path: Path, text: str, base: Path, source: str, origins: dict[str, str]
) -> Iterator[Tree]:
    """Uses of the graphs of a model; adds their entries."""
    try:
        rows = parse_json(_core.gltf_graphs(str(path)), text)
    except (ValueError, OSError) as error:
        raise ConfigError(f"{source}:\n  {error}") from None
    names = [row["name"].casefold() for row in rows]
    materials = tree.get("materials")
    if not isinstance(materials, dict):
        materials = {}
    for row in rows:
        if "graph" not in row:
            continue
        key = f"materials[{row['index']}].{_EXTRAS}"
        if names.count(row["name"].casefold()) > 1:
            raise ConfigError(f"{text}:\n  {key}: another material is named '{row['name']}' too")
        held = row["graph"]
        _check(held, path.parent, f"{text}:\n  {key}")
        move_images(held, os.path.relpath(path.parent, base.resolve()))
        entry = _free_name(f"{path.stem}-{row['name']}", origins)
        beside = materials.get(entry)
        beside = beside if isinstance(beside, dict) else {}
        for at in from_file(held, beside, ()):
            origins[f"materials.{entry}.{path_text(at)}"] = f"{text}: {key}.{path_text(at)}"
        origins.setdefault(f"materials.{entry}", f"{text}: {key}")
        materials[entry] = merged(held, beside)
        tree["materials"] = materials
        yield {"material": glob.escape(row["name"]), "use": entry, "required": False}


def _free_name(wanted: str, origins: Mapping[str, str]) -> str:
    """Name of an entry of `materials` that no other model has."""
    name = re.sub(r"[^A-Za-z0-9_-]", "_", wanted)
    name = name if re.match(r"[A-Za-z_]", name) else f"_{name}"
    number = 1
    while f"materials.{name if number == 1 else f'{name}-{number}'}" in origins:
        number += 1
    return name if number == 1 else f"{name}-{number}"


def _check(held: Any, folder: Path, where: str) -> None:
    """ConfigError for a value that is no mapping, and for what a model's file may not use."""
    if not isinstance(held, dict):
        raise ConfigError(f"{where}: must be a mapping, not {held!r:.60}")
    if "file" in held:
        raise ConfigError(f"{where}.file: a graph in a model names no other file")
    for path, key, value in _walk(held, ()):
        at = f"{where}.{path_text(path)}"
        if key == "hook":
            raise ConfigError(f"{at}: a model's file names no function")
        if key == "file" and isinstance(value, str) and not _is_below(value, folder):
            raise ConfigError(f"{at}: '{value}' lies outside the model's folder")


def _walk(value: Any, path: tuple[str | int, ...]) -> Iterator[tuple[Any, str, Any]]:
    """(path, key, value) of all keys of mappings."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield (*path, key), key, item
            yield from _walk(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _walk(item, (*path, index))


def _is_below(text: str, folder: Path) -> bool:
    if text.startswith(DATA_PREFIX) or "\0" in text:
        return False
    return (folder / text).resolve().is_relative_to(folder.resolve())
