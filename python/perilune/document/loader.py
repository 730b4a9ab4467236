"""Reads YAML and JSON into a plain tree: dict, list, str, int, float, bool, None."""

from __future__ import annotations

import json
import re
from collections.abc import Hashable, Mapping
from datetime import UTC, date, datetime
from functools import lru_cache
from pathlib import Path
from typing import Any, ClassVar

import yaml

from perilune.base.files import Stamp, stamp
from perilune.config.errors import ConfigError, nearest
from perilune.config.wording import kind_of
from perilune.document import shipped
from perilune.drivers import path_text

_MAX_NODES = 200_000  # aliases can make a small file a tree without end
_MAX_DEPTH = 64
_TOO_DEEP = f"nested too deeply; at most {_MAX_DEPTH} levels"
_MAX_DIGITS = 400

OAISYS_SECTIONS = (
    "SIMULATION_SETUP",
    "RENDER_SETUP",
    "RENDER_POST_PROCESSING_EFFECTS_SETUP",
    "SENSOR_SETUP",
    "ENVIRONMENT_EFFECTS_SETUP",
    "ASSET_SETUP",
)


class _Scalars(yaml.constructor.SafeConstructor, yaml.resolver.Resolver):
    """YAML with the scalars of version 1.2: no dates, no base-60 numbers, no yes/no/on/off."""

    yaml_implicit_resolvers: ClassVar[dict[str, Any]] = {}  # type: ignore[misc]

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: dict[str, int] = {}
        for key, _ in node.value:
            line = key.start_mark.line + 1
            if not isinstance(key, yaml.ScalarNode):
                text = "a key must be a text, not a list or a mapping"
                raise yaml.MarkedYAMLError(None, None, text, key.start_mark)
            if key.value in seen and key.tag != "tag:yaml.org,2002:merge":
                text = f"key '{key.value}' occurs twice (lines {seen[key.value]} and {line})"
                raise yaml.MarkedYAMLError(None, None, text, key.start_mark)
            seen[key.value] = line
        return super().construct_mapping(node, deep)

    def construct_decimal(self, node: yaml.ScalarNode) -> int:
        """YAML 1.2: 010 is ten, not eight."""
        text = self.construct_scalar(node)
        if len(text) > _MAX_DIGITS:
            wrong = f"a whole number of {len(text)} digits; at most {_MAX_DIGITS}"
            raise yaml.MarkedYAMLError(None, None, wrong, node.start_mark)
        return int(text)


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
    _Scalars.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(rf"(?:{_pattern})\Z"), list(_first)
    )


class _Loader(_Scalars, yaml.SafeLoader):
    """The loader whose errors are told."""


_Loader.add_constructor(
    "tag:yaml.org,2002:int",
    _Loader.construct_decimal,  # type: ignore[type-var]  # of the class above
)

_Fast: Any = None
"""The same with the parser of libyaml, which is ten times as fast; None without libyaml."""
if yaml.__with_libyaml__:
    _Fast = type(
        "_Fast", (_Scalars, yaml.CSafeLoader), {"yaml_constructors": _Loader.yaml_constructors}
    )

_READ_OTHERWISE = re.compile("[|>][-+0-9]*#|[\t!?\x85\u2028\u2029\ufeff]")
"""Characters about which the two parsers do not always agree."""


def _parsed_fast(text: str) -> Any:
    """The tree by libyaml; None without it, for a text that is faulty or that it may read in
    another way, and for an empty one."""
    if _Fast is None or _READ_OTHERWISE.search(text):
        return None
    try:
        return yaml.load(text, Loader=_Fast)
    except (yaml.YAMLError, ValueError, RecursionError):
        return None


def parse_yaml(text: str, source: str) -> Any:
    """The tree of a YAML text; `source` names it in errors."""
    tree = _parsed_fast(text)
    if tree is not None:
        return tree
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        where = f" line {mark.line + 1}, column {mark.column + 1}:" if mark else ""
        raise ConfigError(f"{source}:{where} {error.problem or error}") from None
    except RecursionError:
        raise ConfigError(f"{source}: {_TOO_DEEP}") from None
    except yaml.reader.ReaderError as error:
        where = f"character {error.position + 1} (U+{error.character:04X})"
        raise ConfigError(f"{source}: {where}: {error.reason}") from None
    except (yaml.YAMLError, ValueError) as error:
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

    def whole(digits: str) -> int:
        if len(digits) > _MAX_DIGITS:
            wrong = f"a whole number of {len(digits)} digits; at most {_MAX_DIGITS}"
            raise ConfigError(f"{source}: {wrong} ({digits[:20]}...)")
        return int(digits)

    try:
        return json.loads(text, object_pairs_hook=unique, parse_int=whole)
    except json.JSONDecodeError as error:
        where = f"line {error.lineno}, column {error.colno}"
        raise ConfigError(f"{source}: {where}: {error.msg}") from None
    except RecursionError:
        raise ConfigError(f"{source}: {_TOO_DEEP}") from None


_MODEL = "a model, not a configuration; one names it: spacecraft: {NAME: {model: FILE, ...}}"
_PICTURE = "a picture, not a configuration"
_OTHER_FILES = {
    **dict.fromkeys((".glb", ".gltf", ".obj", ".stl", ".blend", ".fbx", ".usdz"), _MODEL),
    **dict.fromkeys((".png", ".jpg", ".jpeg", ".tif", ".tiff"), _PICTURE),
}


def read_tree(path: Path) -> dict[str, Any]:
    """The tree of a .yaml, .yml or .json file, cached until the file changes."""
    if what := _OTHER_FILES.get(path.suffix.lower()):
        raise ConfigError(f"{path}: {what}")
    try:
        return plain_tree(_parsed(path, stamp(path)), str(path))
    except FileNotFoundError:
        near = nearest(path.as_posix(), shipped.configurations())
        raise FileNotFoundError(f"{path}: no such configuration file{near}") from None
    except IsADirectoryError:
        raise IsADirectoryError(f"{path}: is a folder, not a configuration file") from None


@lru_cache(maxsize=64)
def _parsed(path: Path, _: Stamp) -> Any:
    """Content of a file, shared by all readers, who must copy it."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not UTF-8 text: {error}") from None
    parse = parse_json if path.suffix.lower() == ".json" else parse_yaml
    return parse(text, str(path))


def _date_text(value: date) -> str:
    """ISO 8601 in UTC, which YAML assumes for a time without a zone."""
    if not isinstance(value, datetime):
        return value.isoformat()
    utc = value if value.tzinfo is None else value.astimezone(UTC)
    return utc.replace(tzinfo=None).isoformat() + "Z"


def plain_tree(tree: Any, source: str) -> dict[str, Any]:
    """A copy of plain types without sharing; refuses what a file cannot hold."""
    if not isinstance(tree, Mapping):
        raise ConfigError(f"{source}: must be a mapping of sections, not {kind_of(tree)}")
    count = 0

    def copy(node: Any, path: tuple[str | int, ...]) -> Any:
        nonlocal count
        count += 1
        if count > _MAX_NODES or len(path) > _MAX_DEPTH:
            wrong = f"too large: more than {_MAX_NODES} values" if count > _MAX_NODES else _TOO_DEEP
            raise ConfigError(f"{source}: {path_text(path[:4])}: {wrong}")
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
        if isinstance(node, date):  # what PyYAML's own loaders make of a date without quotes
            return _date_text(node)
        text = f"a value of type {type(node).__name__} has no place in a configuration"
        raise ConfigError(f"{source}: {path_text(path)}: {text}")

    result: dict[str, Any] = copy(tree, ())
    return result


def is_oaisys(tree: Mapping[str, Any]) -> bool:
    """Whether a tree has the sections of an OAISYS file."""
    return any(name in tree for name in OAISYS_SECTIONS)
