"""Configuration errors that read like help: file, key path, value, what is allowed."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NoReturn

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from perilune.base.names import nearest
from perilune.config.wording import shown, wording
from perilune.drivers import KeyPath, path_text

__all__ = [
    "ConfigError",
    "ConfigWarning",
    "ModelWarning",
    "fail",
    "fail_unread",
    "from_validation",
    "named",
    "nearest",
    "origin",
    "shown",
    "unread",
    "warn",
]

_OWN, _UNREAD = "perilune", "perilune_unread"


class ConfigError(ValueError):
    """An invalid configuration; the text names the file and every faulty key.

    unread: key paths that have no effect beside the others of their sections."""

    unread: Sequence[KeyPath] = ()


class ConfigWarning(UserWarning):
    """A setting that is allowed but probably not intended; the text names the file and the key."""


class ModelWarning(UserWarning):
    """Content of a model's file that is ignored or changed."""


def warn(text: str) -> None:
    """A ConfigWarning located at the caller outside the package."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back and str(frame.f_globals.get("__name__", "")).startswith("perilune."):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, ConfigWarning, stacklevel=level)


def fail(path: str, text: str) -> NoReturn:
    """Inside a validator: raises an error at `path` below the value being validated."""
    raise PydanticCustomError(_OWN, "{text}", {"text": text, "path": path})


def fail_unread(key: str, text: str) -> NoReturn:
    """As `fail`, for a key that has no effect beside the others of its section."""
    raise PydanticCustomError(_UNREAD, "{text}", {"text": text, "path": key})


def unread(error: ValidationError, tree: Any) -> list[KeyPath]:
    """Key paths that `fail_unread` has refused, if they are in the tree; values of a preset are
    not."""
    found = []
    for detail in error.errors():
        if detail["type"] == _UNREAD:
            path, section = _walk(tree, detail["loc"], False)
            if isinstance(section, Mapping) and (key := detail["ctx"]["path"]) in section:
                found.append((*path, key))
    return found


def _walk(tree: Any, loc: Sequence[Any], missing: bool) -> tuple[list[Any], Any]:
    """Path in the file for pydantic's location (without union tags), and its value."""
    path: list[Any] = []
    value = tree
    tagged = False
    for position, part in enumerate(loc):
        if not tagged and isinstance(value, Mapping) and value.get("kind") == part:
            tagged = True  # the tag of a union, though a key be called so too
            continue
        below = isinstance(value, Mapping) and part in value
        if isinstance(value, list) and isinstance(part, int):
            below = part < len(value)
        if below:
            path.append(part)
            value, tagged = value[part], False
        elif missing and position == len(loc) - 1:
            path.append(part)
            value = None
    return path, value


def named(text: str, origins: Mapping[str, str]) -> str:
    """A message `key: fault` with the key as in the translated file."""
    key, colon, rest = text.partition(": ")
    return f"{origin(key, origins)}{colon}{rest}" if colon else text


def origin(key: str, origins: Mapping[str, str]) -> str:
    """A key of the tree as in the translated file: `theirs (here: ours)`."""
    at = key
    while at:
        if at in origins:
            return f"{origins[at]} (here: {key})"
        at = at[: max(at.rfind("."), at.rfind("["), 0)]
    return key


def _describe(
    error: ErrorDetails, tree: Any, driven: Mapping[str, str], origins: Mapping[str, str]
) -> str:
    path, value = _walk(tree, error["loc"], error["type"] == "missing")
    below = error.get("ctx", {}).get("path", "") if error["type"] in (_OWN, _UNREAD) else ""
    key = path_text((*path, below) if below else tuple(path))
    shown_key = origin(key, origins)
    if error["type"] == "missing":
        return f"{shown_key}: required, but missing"
    if error["loc"] and error["loc"][-1] == "[key]":  # the name is wrong, not its value
        value = path[-1]
    scalar = not below and not isinstance(value, (Mapping, list, tuple)) and value is not None
    mark = f" = {shown(value)}" if scalar else ""
    text = wording(error, value)
    name = next((n for n in driven if key == n or key.startswith((f"{n}.", f"{n}["))), None)
    if name is None or text.startswith("takes no driver"):
        return f"{shown_key or '(top level)'}{mark}: {text}"
    if error["type"] == "int_type" and key == name:
        why = "it fixes a count, an identity or the shape of an array"
        return f"{shown_key}: takes no driver ({why})"
    at = origin(name + driven[name] + key[len(name) :], origins)
    drawn = "" if driven[name] else " (drawn by its driver)"
    return f"{at}{mark}: {text}{drawn}"


def _causes(details: Sequence[ErrorDetails]) -> list[ErrorDetails]:
    """Errors without those of lists that are too short only because their items are invalid."""
    return [
        detail
        for detail in details
        if detail["type"] != "too_short"
        or not any(
            len(other["loc"]) > len(detail["loc"])
            and other["loc"][: len(detail["loc"])] == detail["loc"]
            for other in details
        )
    ]


def _is_short(detail: ErrorDetails) -> bool:
    """Whether an error reports a missing item of a list."""
    return detail["type"] == "missing" and isinstance(detail["loc"][-1], int)


def _short_lists(
    details: Sequence[ErrorDetails], tree: Any, origins: Mapping[str, str]
) -> Iterator[str]:
    """One line for each list with missing items."""
    needed: dict[str, tuple[int, Any]] = {}
    for detail in filter(_is_short, details):
        path, value = _walk(tree, detail["loc"][:-1], False)
        key = path_text(tuple(path))
        count = max(needed.get(key, (0, None))[0], int(detail["loc"][-1]) + 1)
        needed[key] = (count, value)
    for key, (count, value) in needed.items():
        given = len(value) if isinstance(value, (list, tuple)) else 0
        yield f"{origin(key, origins)}: must be a list of {count} values, not of {given}"


def from_validation(
    error: ValidationError,
    tree: Any,
    source: str,
    driven: Mapping[str, str] | None = None,
    origins: Mapping[str, str] | None = None,
) -> ConfigError:
    """A pydantic error in terms of the configuration file.

    driven: key path of each driver -> the driver's key that the value comes from, such as
    `.clip_min`; empty for a drawn value. origins: key paths of the tree -> those of the file, if it
    was translated."""
    details = _causes(error.errors(include_url=False))
    lines = [*_short_lists(details, tree, origins or {})]
    rest = [detail for detail in details if not _is_short(detail)]
    lines += [_describe(detail, tree, driven or {}, origins or {}) for detail in rest]
    text = f"{source}:\n" + "\n".join(f"  {line}" for line in dict.fromkeys(lines))
    result = ConfigError(text)
    result.unread = unread(error, tree)
    return result
