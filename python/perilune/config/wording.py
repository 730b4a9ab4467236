"""Turns pydantic's errors into messages for the user of a configuration file."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from pydantic_core import ErrorDetails

from perilune.base.names import nearest
from perilune.drivers import KINDS

_SHOWN = 60
_QUOTED = re.compile(r"'([^']*)'")


def shown(value: Any) -> str:
    """A value shortened for an error message."""
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) >= 10**_SHOWN:
        return "a number of too many digits"
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 4]} ..."


def kind_of(value: Any) -> str:
    """Description of a value: `a list of 3 values`, `a mapping with the keys a, b`."""
    if isinstance(value, Mapping):
        keys = ", ".join(map(str, list(value)[:8])) or "(none)"
        return f"a mapping with the key{'' if len(value) == 1 else 's'} {keys}"
    if isinstance(value, (list, tuple)):
        return f"a list of {len(value)} value{'' if len(value) == 1 else 's'}"
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true or false"
    return "a text" if isinstance(value, str) else f"the number {shown(value)}"


def driver_keys() -> str:
    """Keys of each kind of numeric driver, as mappings."""
    forms = []
    for kind in KINDS:
        keys = [key for key in kind.keys if key not in ("jointly", "truncated", "params")]
        if kind.name != "truncated":
            forms.append(f"{{{', '.join(keys)}}}")
    return " or ".join(reversed(forms))


def _must_be(what: str) -> Callable[[Any], str]:
    def text(value: Any) -> str:
        if isinstance(value, Mapping) and "number" in what:
            return f"must be {what} or a driver, {driver_keys()}; not {kind_of(value)}"
        quoted = isinstance(value, str) and "number" in what and _is_number(value)
        how = " (take the quotes off)" if quoted else ""
        plain = isinstance(value, (int, float)) and not isinstance(value, bool)
        return f"must be {what}" if plain else f"must be {what}, not {kind_of(value)}{how}"

    return text


def _whole(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"must be a whole number, and takes no driver; not {kind_of(value)}"
    return _must_be("a whole number")(value)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


_TYPES: dict[str, Callable[[Any], str]] = {
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float", "int_parsing_size"), _whole),
    **dict.fromkeys(("float_type", "float_parsing", "finite_number"), _must_be("a finite number")),
    "string_type": _must_be("a text"),
    **dict.fromkeys(("bool_type", "bool_parsing"), _must_be("true or false")),
    **dict.fromkeys(("tuple_type", "list_type"), _must_be("a list of values")),
    **dict.fromkeys(
        ("dict_type", "model_type", "model_attributes_type", "dataclass_type", "mapping_type"),
        _must_be("a mapping of keys and values"),
    ),
    "none_required": _must_be("null"),
}


def wording(error: ErrorDetails, value: Any) -> str:
    """Message of an error; `value` is what the file has there."""
    kind, ctx = error["type"], error.get("ctx", {})
    bounded = kind.startswith(("less_than", "greater_than"))
    if bounded and isinstance(value, float) and not math.isfinite(value):
        return "must be a finite number"
    if kind in _TYPES:
        return _TYPES[kind](value)
    if kind == "literal_error":
        allowed = _QUOTED.findall(ctx["expected"])
        if isinstance(value, str) and allowed:
            return f"no such name{nearest(value, allowed)}"
        return f"must be {ctx['expected']}"
    if kind == "union_tag_invalid":
        allowed = [tag.strip().strip("'") for tag in ctx["expected_tags"].split(",")]
        return f"no kind '{ctx['tag']}'{nearest(ctx['tag'], allowed)}"
    if kind == "union_tag_not_found":
        # ctx has the name of the key, or of the function that reads it.
        return f"needs the key '{ctx['discriminator'].strip(_AROUND)}'"
    text = error["msg"].replace("Input should", "must").replace("Tuple should have", "must have")
    return text.replace(" after validation", "")


_AROUND = "'_()"
