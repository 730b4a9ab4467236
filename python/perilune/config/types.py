"""Types of numbers, ranges and vectors in the schema, and the base class of its sections."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    model_validator,
)

from perilune.base.html import flat, folded, heading, table, whole
from perilune.config.errors import fail, fail_unread, nearest
from perilune.drivers import Drawn

_C = TypeVar("_C")


def of_structure(check: _C) -> _C:
    """Marks a check after a section's keys that reads no numbers: only names, kinds, and which keys
    are given. It need not run again when drivers change numbers."""
    check.of_structure = True  # type: ignore[attr-defined]  # a function
    return check


def refuse_drawn(value: Any) -> Any:
    """For BeforeValidator: refuses a driver's value."""
    items = value if isinstance(value, (list, tuple)) else [value]
    if any(isinstance(item, Drawn) for item in items):
        fail("", "takes no driver: it is fixed when the scene is built")
    return value


def _pair(value: Any) -> Any:
    return value if isinstance(value, (list, tuple, Mapping, str, type(None))) else (value, value)


def triple(value: Any) -> Any:
    """For BeforeValidator: a single number becomes three."""
    plain = isinstance(value, (list, tuple, Mapping, str, type(None)))
    return value if plain else (value, value, value)


def _ordered(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        fail("", f"a range is [smallest, largest], not [{value[0]:g}, {value[1]:g}]")
    return value


def _direction(value: tuple[float, float, float]) -> tuple[float, float, float]:
    norm = math.hypot(*value)
    if not norm > 0.0:
        fail("", "a direction must not be zero")
    return (value[0] / norm, value[1] / norm, value[2] / norm)


# Far beyond use; within these no cube of a length overflows.
_HUGE, _TINY = 1e30, 1e-30


def _not_tiny(value: float) -> float:
    if value < _TINY:
        fail("", f"must be at least {_TINY:g}")
    return value


# Strict numbers: a quoted "3" or a boolean is a mistake, and an int key does not take 3.0, which is
# also what makes counts and identities refuse drivers.
Finite = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-_HUGE, le=_HUGE)]
Positive = Annotated[
    float, Field(strict=True, allow_inf_nan=False, gt=0.0, le=_HUGE), AfterValidator(_not_tiny)
]
NonNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=_HUGE)]
PositiveByAxis = Annotated[
    Annotated[Positive, Tag("even")]
    | Annotated[tuple[Positive, Positive, Positive], BeforeValidator(refuse_drawn), Tag("by axis")],
    Discriminator(lambda value: "by axis" if isinstance(value, (list, tuple)) else "even"),
]
"""A number, or one for each of the axes x, y, z; the three take no driver."""
Fraction = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]
Inclination = Annotated[float, Field(strict=True, ge=0.0, le=180.0)]
Integer = Annotated[int, Field(strict=True)]
StaticFinite = Annotated[Finite, BeforeValidator(refuse_drawn)]
StaticNonNegative = Annotated[NonNegative, BeforeValidator(refuse_drawn)]
Vec3 = tuple[Finite, Finite, Finite]
PositiveVec3 = Annotated[tuple[Positive, Positive, Positive], BeforeValidator(triple)]
Direction = Annotated[Vec3, AfterValidator(_direction)]
Rgb = Annotated[tuple[NonNegative, NonNegative, NonNegative], BeforeValidator(triple)]
"""A number for all three bands, or [r, g, b] (linear)."""
PositiveRange = Annotated[
    tuple[Positive, Positive], BeforeValidator(_pair), AfterValidator(_ordered)
]
"""A number, or [smallest, largest]."""
FiniteRange = Annotated[tuple[Finite, Finite], BeforeValidator(_pair), AfterValidator(_ordered)]
_HalfTurn = Annotated[float, Field(strict=True, ge=0.0, le=180.0)]
AngleRange = Annotated[
    tuple[_HalfTurn, _HalfTurn], BeforeValidator(_pair), AfterValidator(_ordered)
]
StaticVec3 = Annotated[Vec3, BeforeValidator(refuse_drawn)]


NAMES_A_FILE = "names a file"
FileName = Annotated[str, NAMES_A_FILE]
"""A path as written in the configuration; datasets record the file (see file_names.py)."""


def _module_function(value: str) -> str:
    module, _, function = value.partition(":")
    if not module or not all(part.isidentifier() for part in function.split(".")):
        fail("", "must be module:function")
    return value


FunctionName = Annotated[str, AfterValidator(_module_function)]


def hook_or_function(schema: dict[str, Any]) -> None:
    """For the JSON Schema of a section with a `hook`: also allows the key's former name."""
    keys, required = schema["properties"], schema["required"]
    older = {"type": "string", "deprecated": True, "description": "What `hook` was called before."}
    schema["properties"] = {**keys, "function": older}
    schema["required"] = [key for key in required if key != "hook"]
    schema["oneOf"] = [{"required": ["hook"]}, {"required": ["function"]}]


"""A user's function, as module:function."""


Latitudes = Literal["geodetic", "geocentric"]


@cache
def _keys_of(kind: type[BaseModel]) -> dict[str, None]:
    """The keys of a section, in its order."""
    return {field.alias or name: None for name, field in kind.model_fields.items()}


class Strict(BaseModel):
    """Base of every section: values are frozen; unknown keys are refused with the nearest known
    name."""

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    @classmethod
    def of_defaults(cls) -> Self:
        """The section with the default of every key; for defaults of other sections.

        Equal to `cls()`, which would build the section's validator when the schema is imported.
        """
        return cls.model_construct()

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, data: Any) -> Any:
        if not isinstance(data, Mapping):
            return data
        allowed = _keys_of(cls)
        for key in data:
            if key not in allowed:
                fail(str(key), f"unknown key{nearest(key, allowed)}")
        return data

    @classmethod
    def _renamed(cls, data: Any, old: str, new: str) -> Any:
        """In a validator that runs first: accepts a key by its former name."""
        if not isinstance(data, Mapping) or old not in data:
            return data
        if new in data:
            fail(old, f"was the name of `{new}`, which stands here too; give one of them")
        return {(new if key == old else key): value for key, value in data.items()}

    def _repr_html_(self) -> str:
        """Table of all keys; those that are given come before those left at their default."""
        given = flat(self.model_dump(by_alias=True, exclude_unset=True, mode="json"))
        names = {path for path, _ in given}
        every = flat(self.model_dump(by_alias=True, exclude_none=True, mode="json"))
        others = [(path, value) for path, value in every if path not in names]
        defaults = table(("key", "value"), others, most=400)
        return whole(
            heading(type(self).__name__, (self.__doc__ or "").split("\n")[0]),
            table(("key", "value"), given, most=400),
            folded(f"defaults ({len(others)})", defaults),
        )

    def _only_with(self, needed: str, *keys: str) -> None:
        """Refuses keys that have no effect without `needed`."""
        for key in keys:
            if key in self.model_fields_set:
                fail_unread(key, f"does nothing without {needed}")

    def _exactly_one(self, *names: str, optional: bool = False) -> None:
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) > 1:
            fail("", f"give only one of {', '.join(given)}")
        if not given and not optional:
            fail("", f"give exactly one of {', '.join(names)}")
