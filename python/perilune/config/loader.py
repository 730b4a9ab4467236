"""Reads YAML and JSON into one plain tree: dict, list, str, int, float, bool, None."""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import yaml

from perilune.config import shipped
from perilune.config.errors import ConfigError, nearest
from perilune.drivers import path_text

_MAX_NODES = 200_000  # aliases can make a small file a tree without end
_MAX_DEPTH = 64


class _Loader(yaml.SafeLoader):
    """YAML with the scalars of version 1.2: no dates, no base-60 numbers, no yes/no/on/off."""

    yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}  # type: ignore[misc]

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: dict[str, int] = {}
        for key, _ in node.value:
            line = key.start_mark.line + 1
            if key.value in seen and key.tag != "tag:yaml.org,2002:merge":
                text = f"key '{key.value}' occurs twice (lines {seen[key.value]} and {line})"
                raise yaml.MarkedYAMLError(None, None, text, key.start_mark)
            seen[key.value] = line
        return super().construct_mapping(node, deep)

    def construct_decimal(self, node: yaml.ScalarNode) -> int:
        """YAML 1.2: 010 is ten, not eight."""
        return int(self.construct_scalar(node))


_FLOAT = (
    r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
)
for _tag, _pattern, _first in (
    ("bool", r"true|True|TRUE|false|False|FALSE", "tTfF"),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", _FLOAT, "-+0123456789."),
    ("merge", r"<<", "<"),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(rf"(?:{_pattern})\Z"), list(_first)
    )
_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_decimal)


def parse_yaml(text: str, source: str) -> Any:
    """The tree of a YAML text; `source` names it in errors."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f" line {mark.line + 1}, column {mark.column + 1}:" if mark else ""
        raise ConfigError(f"{source}:{where} {error.problem or error}") from None
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise ConfigError(f"{source}: {error}") from None


def parse_json(text: str, source: str) -> Any:
    """The tree of a JSON text; `source` names it in errors."""

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        result: dict[str, Any] = {}
        for key, value in pairs:
            if key in result:
                raise ConfigError(f"{source}: key '{key}' occurs twice in one object")
            result[key] = value
        return result

    try:
        return json.loads(text, object_pairs_hook=unique)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise ConfigError(f"{source}: {where}: {error.msg}") from None
    except RecursionError:
        raise ConfigError(f"{source}: nested too deeply") from None


def read_tree(path: Path) -> dict[str, Any]:
    """The tree of a .yaml, .yml or .json file."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        near = nearest(path.as_posix(), shipped.configurations())
        raise FileNotFoundError(f"{path}: no such configuration file{near}") from None
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not UTF-8 text: {error}") from None
    parse = parse_json if path.suffix.lower() == ".json" else parse_yaml
    return plain_tree(parse(text, str(path)), str(path))


def plain_tree(tree: Any, source: str) -> dict[str, Any]:
    """A copy made of plain types, without sharing; refuses what a file could not hold."""
    if not isinstance(tree, Mapping):
        raise ConfigError(f"{source}: must be a mapping of sections, not {type(tree).__name__}")
    count = 0

    def copy(node: Any, path: tuple[str | int, ...]) -> Any:
        nonlocal count
        count += 1
        if count > _MAX_NODES or len(path) > _MAX_DEPTH:
            raise ConfigError(f"{source}: too large, or nested too deeply ({_MAX_DEPTH} levels)")
        if isinstance(node, Mapping):
            for key in node:
                if not isinstance(key, str):
                    text = f"a key must be a text, not {key!r} (quote it)"
                    raise ConfigError(f"{source}: {path_text(path) or '(top level)'}: {text}")
            return {key: copy(value, (*path, key)) for key, value in node.items()}
        if isinstance(node, (list, tuple)):
            return [copy(value, (*path, index)) for index, value in enumerate(node)]
        if hasattr(node, "tolist"):  # NumPy scalars and arrays in a dict from Python
            return copy(node.tolist(), path)
        if node is None or isinstance(node, (str, bool, int, float)):
            return node
        if isinstance(node, Path):
            return str(node)
        text = f"a value of type {type(node).__name__} has no place in a configuration"
        raise ConfigError(f"{source}: {path_text(path)}: {text}")

    result: dict[str, Any] = copy(tree, ())
    return result
