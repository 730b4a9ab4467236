"""Derives the configuration of a step from a validated one: only driven keys are validated again.

A configuration is a tree of frozen sections. With the same choices, that of another step differs in
some keys alone. These keys are validated by the types of their fields, their sections are copied
with the new values, and pydantic's checks after a section's keys (`mode="after"`) run on every
copied section, up to the top, except those of its structure alone. Errors and results are the same
as if the whole tree were validated. A section with other validators is validated as a whole."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from types import SimpleNamespace
from typing import Annotated, Any, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    PlainValidator,
    TypeAdapter,
    ValidationError,
    WrapValidator,
)
from pydantic_core import PydanticCustomError

from perilune.config.schema import Config
from perilune.config.types import of_structure
from perilune.drivers import KeyPath, marked, substitute

_FUNCTIONS = (AfterValidator, BeforeValidator, PlainValidator, WrapValidator)
_OF_ALL = "_known_keys"
"""The only check before a section's keys whose result drivers cannot change."""

_set = object.__setattr__  # sections are frozen

_Check: TypeAlias = Callable[[Any, SimpleNamespace], Any]


@lru_cache(maxsize=4096)
def _adapter(section: type[BaseModel], name: str) -> TypeAdapter[Any]:
    """Validates one field of a section."""
    info = section.model_fields[name]
    kind: Any = Annotated[info.annotation, info]
    return TypeAdapter(kind)


@lru_cache(maxsize=1024)
def _checks(section: type[BaseModel]) -> tuple[_Check, ...]:
    """Checks that run after the keys of a section, in order, except those that drivers cannot
    fail."""
    found: list[_Check] = []
    for row in section.__pydantic_decorators__.model_validators.values():
        if row.info.mode == "after" and not hasattr(row.func, of_structure.__name__):
            takes_info = len(inspect.signature(row.func).parameters) > 1
            function: Any = row.func
            found.append(function if takes_info else partial(_without_info, function))
    return tuple(found)


def _without_info(check: Callable[[Any], Any], section: Any, _: SimpleNamespace) -> Any:
    return check(section)


@lru_cache(maxsize=1024)
def _is_plain(section: type[BaseModel]) -> bool:
    """Whether a section is made only by the types of its fields and `_checks`."""
    rows = section.__pydantic_decorators__
    before = [name for name, row in rows.model_validators.items() if row.info.mode != "after"]
    plain = not (rows.root_validators or rows.validators or section.__private_attributes__)
    return before in ([], [_OF_ALL]) and plain


@lru_cache(maxsize=1024)
def _names(section: type[BaseModel]) -> dict[str, str]:
    """Key -> field."""
    return {info.alias or name: name for name, info in section.model_fields.items()}


@dataclass(frozen=True)
class _Field:
    """A field that is validated as a whole."""

    validate: Callable[..., Any]
    given: Any
    """The value in the tree, with drivers."""
    drivers: Mapping[KeyPath, KeyPath]
    """Path of each driver in the tree -> path below `given`."""
    alone: KeyPath | None
    """Path of a driver that replaces the whole field."""

    def tree(self, values: Mapping[KeyPath, Any]) -> Any:
        """The value in the tree with drivers replaced by values."""
        if self.alone is not None:
            return marked(values[self.alone])
        return substitute(self.given, {at: values[path] for path, at in self.drivers.items()})


@dataclass
class _Section:
    """Driven parts of a section: whole fields, sections below, and mappings of sections."""

    fields: dict[str, _Field] = field(default_factory=dict)
    below: dict[str, _Section] = field(default_factory=dict)
    """Field -> driven parts of its section."""
    entries: dict[str, dict[str, _Section]] = field(default_factory=dict)
    """Field with a mapping of sections -> driven parts of its entries."""

    def applied(
        self, model: BaseModel, values: Mapping[KeyPath, Any], info: SimpleNamespace
    ) -> Any:
        """The section with drivers replaced by values."""
        new: dict[str, Any] = {}
        for name, row in self.fields.items():
            new[name] = row.validate(row.tree(values), context=info.context)
        held = model.__dict__
        for name, section in self.below.items():
            new[name] = section.applied(held[name], values, info)
        for name, sections in self.entries.items():
            entries = dict(held[name])
            for entry, section in sections.items():
                entries[entry] = section.applied(entries[entry], values, info)
            new[name] = entries
        found: Any = _copied(model, new)
        for check in _checks(type(model)):
            found = check(found, info)
        return found


def _copied(model: BaseModel, new: Mapping[str, Any]) -> BaseModel:
    """A copy of a section as by `model_copy`, without extra and private keys, which it has none
    of."""
    kind = type(model)
    made = kind.__new__(kind)
    given = model.__pydantic_fields_set__  # driven keys are among them
    _set(made, "__dict__", {**model.__dict__, **new})
    _set(made, "__pydantic_fields_set__", given if given >= new.keys() else given | new.keys())
    _set(made, "__pydantic_extra__", None)
    _set(made, "__pydantic_private__", None)
    return made


def _section(model: BaseModel, given: Any, paths: Iterable[KeyPath], depth: int) -> _Section | None:
    """Driven parts of a section; None if it must be validated as a whole.

    given: the section in the tree. paths: those of its drivers. depth: length of the section's path
    in these."""
    kind = type(model)
    if not _is_plain(kind):
        return None
    with_function = {
        name
        for row in kind.__pydantic_decorators__.field_validators.values()
        for name in row.info.fields
    }
    by_key: dict[Any, list[KeyPath]] = {}
    for path in paths:
        if len(path) <= depth:
            return None
        by_key.setdefault(path[depth], []).append(path)
    result = _Section()
    for key, rows in by_key.items():
        name = _names(kind).get(key)
        if name is None or name in with_function:
            return None
        value = getattr(model, name)
        special = any(isinstance(row, _FUNCTIONS) for row in kind.model_fields[name].metadata)
        section = None
        if isinstance(value, BaseModel) and not special:
            section = _section(value, given[key], rows, depth + 1)
        if section is not None:
            result.below[name] = section
        elif (entries := _entries(value, given[key], rows, depth + 1)) and not special:
            result.entries[name] = entries
        else:
            drivers = {path: path[depth + 1 :] for path in rows}
            alone = rows[0] if drivers[rows[0]] == () else None
            validate = _adapter(kind, name).validator.validate_python
            result.fields[name] = _Field(validate, given[key], drivers, alone)
    return result


def _entries(
    value: Any, given: Any, paths: Sequence[KeyPath], depth: int
) -> dict[str, _Section] | None:
    """Driven parts of a mapping of sections; None if it is none, or if one is validated as a
    whole."""
    if not isinstance(value, dict):
        return None
    by_entry: dict[str, list[KeyPath]] = {}
    for path in paths:
        if len(path) < depth + 2 or not isinstance(value.get(str(path[depth])), BaseModel):
            return None
        by_entry.setdefault(str(path[depth]), []).append(path)
    found = {}
    for name, rows in by_entry.items():
        section = _section(value[name], given[name], rows, depth + 1)
        if section is None:
            return None
        found[name] = section
    return found


class Patch:
    """A validated configuration, and the keys in which others differ from it."""

    def __init__(
        self, config: Config, tree: Mapping[str, Any], paths: Iterable[KeyPath], find: Any
    ) -> None:
        """tree: the configuration's, with choices replaced by values. paths: those of all other
        drivers. find: the validation context's `path`."""
        self._config = config
        self._driven = _section(config, tree, paths, 0)
        self._info = SimpleNamespace(context={"path": find})

    def config(self, values: Mapping[KeyPath, Any]) -> Config | None:
        """The configuration with other values of drivers; None if all of it must be validated.

        Raises as validation does, with paths relative to the faulty section."""
        if self._driven is None:
            return None
        found: Config = self._driven.applied(self._config, values, self._info)
        return found

    def tried(self, values: Mapping[KeyPath, Any]) -> Config | None:
        """As `config`; None also for values at fault, so that errors are those of the whole
        configuration."""
        try:
            return self.config(values)
        except (ValidationError, PydanticCustomError, ValueError):
            return None
