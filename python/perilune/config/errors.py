"""Configuration errors that read like help: file, key path, value, what is allowed."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NoReturn

from pydantic import ValidationError
from pydantic_core import ErrorDetails, PydanticCustomError

from perilune.drivers import KeyPath, path_text

_SHOWN_NAMES = 40
_OWN, _UNREAD = "perilune", "perilune_unread"
_MAPPING = re.compile(r"a valid dictionary( or .*)?$")


class ConfigError(ValueError):
    """A configuration that cannot be used; the text names the file and every faulty key.

    unread: key paths of those that nothing reads beside the others of their sections."""

    unread: Sequence[KeyPath] = ()


class ConfigWarning(UserWarning):
    """What a configuration asks for, and hardly means; the text names the file and the key."""


def nearest(name: object, allowed: Iterable[str]) -> str:
    """`; did you mean 'x'? allowed: a, b` for a name that is not one of `allowed`."""
    names = list(allowed)
    close = difflib.get_close_matches(str(name), names, n=1, cutoff=0.5)
    hint = f"; did you mean '{close[0]}'?" if close else ";"
    shown = ", ".join(names[:_SHOWN_NAMES]) + (", ..." if len(names) > _SHOWN_NAMES else "")
    return f"{hint} allowed: {shown or '(none)'}"


def fail(path: str, text: str) -> NoReturn:
    """Raises, inside a validator, an error at `path` below the value being validated."""
    raise PydanticCustomError(_OWN, "{text}", {"text": text, "path": path})


def fail_unread(key: str, text: str) -> NoReturn:
    """As `fail`, of a key that nothing reads beside the others of its section."""
    raise PydanticCustomError(_UNREAD, "{text}", {"text": text, "path": key})


def unread(error: ValidationError, tree: Any) -> list[KeyPath]:
    """Key paths of what `fail_unread` has refused, without what is not in the tree, as the values
    of a preset are not."""
    found = []
    for detail in error.errors():
        if detail["type"] == _UNREAD:
            path, section = _walk(tree, detail["loc"], False)
            if isinstance(section, Mapping) and (key := detail["ctx"]["path"]) in section:
                found.append((*path, key))
    return found


def _walk(tree: Any, loc: Sequence[Any], missing: bool) -> tuple[list[Any], Any]:
    """The path in the file that pydantic's location means (no union tags), and its value."""
    path: list[Any] = []
    value = tree
    for position, part in enumerate(loc):
        below = isinstance(value, Mapping) and part in value
        if isinstance(value, list) and isinstance(part, int):
            below = part < len(value)
        if below:
            path.append(part)
            value = value[part]
        elif missing and position == len(loc) - 1:
            path.append(part)
            value = None
    return path, value


def named(text: str, origins: Mapping[str, str]) -> str:
    """A message `key: what is wrong` with the key as the file that was translated has it."""
    key, colon, rest = text.partition(": ")
    return f"{origin(key, origins)}{colon}{rest}" if colon else text


def origin(key: str, origins: Mapping[str, str]) -> str:
    """A key of the tree as the file that was translated has it: `theirs (here: ours)`."""
    at = key
    while at:
        if at in origins:
            return f"{origins[at]} (here: {key})"
        at = at[: max(at.rfind("."), at.rfind("["), 0)]
    return key


def _describe(
    error: ErrorDetails, tree: Any, driven: Mapping[str, Any], origins: Mapping[str, str]
) -> str:
    path, value = _walk(tree, error["loc"], error["type"] == "missing")
    below = error.get("ctx", {}).get("path", "") if error["type"] in (_OWN, _UNREAD) else ""
    key = path_text((*path, below) if below else tuple(path))
    shown_key = origin(key, origins)
    if error["type"] == "missing":
        return f"{shown_key}: required, but missing"
    scalar = not below and not isinstance(value, (Mapping, list, tuple)) and value is not None
    shown = f" = {value!r}" if scalar else ""
    if key in driven and error["type"] == "int_type":
        why = "it fixes a count, an identity or the shape of an array"
        return f"{shown_key}: takes no driver ({why})"
    text = error["msg"].replace("Input should be", "must be")
    text = text.replace("Tuple should have", "must have").replace(" after validation", "")
    text = text.replace("a valid tuple", "a list of values")
    text = _MAPPING.sub("a mapping", text)
    if error["type"] == "union_tag_invalid":
        allowed = [tag.strip().strip("'") for tag in error["ctx"]["expected_tags"].split(",")]
        text = f"no kind '{error['ctx']['tag']}'{nearest(error['ctx']['tag'], allowed)}"
    elif error["type"] == "union_tag_not_found":
        # ctx has the name of the key, or of the function that reads it.
        needed = error["ctx"]["discriminator"].strip("'_()")
        text = f"needs the key '{needed}'"
    inside = any(key == name or key.startswith((f"{name}.", f"{name}[")) for name in driven)
    where = " (a value or limit of its driver)" if inside else ""
    return f"{shown_key or '(top level)'}{shown}: {text}{where}"


def _causes(details: Sequence[ErrorDetails]) -> list[ErrorDetails]:
    """Without those of lists that are too short because their items are wrong."""
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


def from_validation(
    error: ValidationError,
    tree: Any,
    source: str,
    driven: Mapping[str, Any] | None = None,
    origins: Mapping[str, str] | None = None,
) -> ConfigError:
    """A pydantic error in the words of the configuration file.

    origins: key paths of the tree -> those of the file, where it was translated.
    """
    details = _causes(error.errors())
    lines = [_describe(detail, tree, driven or {}, origins or {}) for detail in details]
    text = f"{source}:\n" + "\n".join(f"  {line}" for line in dict.fromkeys(lines))
    result = ConfigError(text)
    result.unread = unread(error, tree)
    return result
