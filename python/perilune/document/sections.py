"""Finds the sections of the schema at a key path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args, get_origin

from perilune.config.schema import Config
from perilune.config.types import Strict


def sections_at(parts: Sequence[str]) -> list[type[Strict]]:
    """All sections possible at a path, one for each kind; none for a value, a mapping of names, or
    an unknown path."""
    found: list[Any] = [Config]
    for part in parts:
        found = [below for each in found for below in _below(each, part)]
    return [each for each in found if _is_section(each)]


def keys_of(section: type[Strict]) -> list[str]:
    """Keys of a section as in the file."""
    return [field.alias or name for name, field in section.model_fields.items()]


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Strict)


def _below(kind: Any, part: str) -> Iterator[Any]:
    """Possible types at a key or an index of a section or mapping."""
    if _is_section(kind):
        for name, field in kind.model_fields.items():
            if part == (field.alias or name):
                yield from _kinds(field.annotation)
    elif get_origin(kind) in (dict, Mapping):
        yield from _kinds(get_args(kind)[1])
    elif get_origin(kind) in (tuple, list) and part.isdecimal():
        yield from _kinds(get_args(kind)[0])


def _kinds(annotation: Any) -> Iterator[Any]:
    """Sections and containers of an annotation, through Annotated, unions and None."""
    if _is_section(annotation) or get_origin(annotation) in (dict, Mapping, tuple, list):
        yield annotation
        return
    for part in get_args(annotation):
        yield from _kinds(part)
