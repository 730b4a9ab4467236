"""The files that a configuration names: all keys of the type `FileName`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any, get_args

from perilune.config.types import NAMES_A_FILE, Strict
from perilune.drivers import KeyPath


def _is_marked(annotation: Any) -> bool:
    marked = NAMES_A_FILE in getattr(annotation, "__metadata__", ())
    return marked or any(_is_marked(part) for part in get_args(annotation))


@cache
def _file_keys(section: type[Strict]) -> frozenset[str]:
    """Names of a section's fields that are names of files, or lists of them."""
    return frozenset(
        name
        for name, field in section.model_fields.items()
        if NAMES_A_FILE in field.metadata or _is_marked(field.annotation)
    )


def file_names(
    value: Any, path: KeyPath = (), named: bool = False
) -> Iterator[tuple[KeyPath, str]]:
    """(key path, file) of all that a section names, in the order of the schema, without the images
    in graphs. named: whether the value itself is a name."""
    if isinstance(value, Strict):
        keys = _file_keys(type(value))
        for name, field in type(value).model_fields.items():
            yield from file_names(
                getattr(value, name), (*path, field.alias or name), named=name in keys
            )
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from file_names(item, (*path, name))
    elif isinstance(value, (list, tuple)):
        for k, item in enumerate(value):
            yield from file_names(item, (*path, k), named)
    elif named and value:
        yield path, value
