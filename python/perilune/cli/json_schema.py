"""The configuration's types as JSON Schema (2020-12), with drivers where values may vary.

The loader checks what the schema cannot express: names that refer to other entries, keys of which
exactly one is allowed. Whatever the schema refuses the loader refuses too, with two exceptions: a
driver in place of a section's `kind` (choose among whole sections instead) and a driver for a name
in a list of names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaMode, JsonSchemaValue
from pydantic_core import PydanticCustomError, core_schema

from perilune import _core
from perilune.config.docs import described
from perilune.config.schema import Config
from perilune.document.references import channel_names
from perilune.drivers import Drawn

_VARIES = "x-perilune-varies"
"""Marks, while the schema is made, a number that a driver may replace."""

_DRAWS: dict[str, Any] = {
    "interval": {"type": "integer", "minimum": 1, "description": "Steps between draws."},
    "strength": {"type": "number", "minimum": 0, "description": "Factor on the variance."},
    "group": {"type": "string", "description": "A name of drivers.groups."},
}


def _distribution(description: str, needed: dict[str, Any], **optional: Any) -> dict[str, Any]:
    return {
        "description": description,
        "type": "object",
        "properties": {**needed, **optional, **_DRAWS},
        "required": list(needed),
        "additionalProperties": False,
    }


def _distributions(value: dict[str, Any], variance: dict[str, Any]) -> list[dict[str, Any]]:
    """Schemas of the drivers of numbers, or of lists of numbers."""
    limits = {"clip_min": value, "clip_max": value}
    jointly = {"jointly": {"type": "boolean", "description": "One draw for all of a list."}}
    truncated = {
        "type": "boolean",
        "description": "Drawn from within the limits, which would pile up what is clipped.",
    }
    two = {"type": "array", "items": value, "minItems": 2, "maxItems": 2}
    return [
        _distribution(
            "ideal + N(0, jitter_variance * strength), clipped.",
            {"ideal": value, "jitter_variance": variance, **limits},
            truncated=truncated,
            **jointly,
        ),
        _distribution(
            "Uniform between two limits.",
            {"uniform": {**two, "description": "[low, high]."}},
            **jointly,
        ),
        _distribution(
            "median * exp(N(0, log_variance * strength)), clipped.",
            {"median": value, "log_variance": variance, **limits},
            truncated=truncated,
            **jointly,
        ),
    ]


_NUMBER: dict[str, Any] = {"type": "number"}
_VARIANCE: dict[str, Any] = {"type": "number", "minimum": 0}
_FREE: list[dict[str, Any]] = [
    _distribution(
        "One of several values; the first is the ideal one.",
        {"choice": {"type": "array", "minItems": 1}},
        weights={"type": "array", "items": {"type": "number", "minimum": 0}},
    ),
    _distribution(
        "What a function of the user's draws.",
        {"hook": {"type": "string", "description": "module:function."}, "ideal": {}},
        clip_min={},
        clip_max={},
        params={"type": "object"},
    ),
]


def _or_list(number: dict[str, Any]) -> dict[str, Any]:
    return {"anyOf": [number, {"type": "array", "items": number, "minItems": 1}]}


_DRIVERS: dict[str, dict[str, Any]] = {
    "Driver": {
        "title": "Driver",
        "description": "A number that varies.",
        "anyOf": [*_distributions(_NUMBER, _VARIANCE), *_FREE],
    },
    "ListDriver": {
        "title": "ListDriver",
        "description": "A list of numbers that varies.",
        "anyOf": [*_distributions(_or_list(_NUMBER), _or_list(_VARIANCE)), *_FREE],
    },
    "AnyDriver": {
        "title": "AnyDriver",
        "description": "A name, a section or another value that varies.",
        "anyOf": _FREE,
    },
}


def _takes(function: Any, value: Any) -> Any:
    """Result of a validator for a value; None if it refuses."""
    try:
        return function(value)
    except PydanticCustomError:
        return None


class _Generator(GenerateJsonSchema):
    """Tests what the validators that run before a type accept."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._fixed = 0

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        found = super().model_schema(schema)
        section = schema["cls"]
        texts = described(section)
        for name, field in section.model_fields.items():
            entry = found.get("properties", {}).get(field.alias or name)
            if entry is not None and name in texts:
                entry["description"] = texts[name]
        return found

    def float_schema(self, schema: core_schema.FloatSchema) -> JsonSchemaValue:
        found = super().float_schema(schema)
        return found if self._fixed else {**found, _VARIES: True}

    def function_before_schema(
        self, schema: core_schema.BeforeValidatorFunctionSchema
    ) -> JsonSchemaValue:
        function = schema["function"]["function"]
        if schema["schema"]["type"] in ("model", "model-fields", "definition-ref"):
            found = super().function_before_schema(schema)
            # A name may stand for a section.
            named = isinstance(_takes(function, "name"), Mapping)
            return {"anyOf": [{"type": "string"}, found]} if named else found
        refuses = _takes(function, Drawn(1.0)) is None
        self._fixed += refuses
        try:
            found = super().function_before_schema(schema)
        finally:
            self._fixed -= refuses
        spread = _takes(function, 1.0)
        if isinstance(spread, tuple) and found.get("type") == "array":
            # A number stands for all items of the list.
            item = found["prefixItems"][0] if "prefixItems" in found else found["items"]
            return {"anyOf": [item, found]}
        return found


def _or(node: dict[str, Any], driver: str) -> dict[str, Any]:
    """A node or a driver."""
    words = ("title", "description", "default")
    outer = {key: node.pop(key) for key in words if key in node}
    return {**outer, "anyOf": [node, {"$ref": f"#/$defs/{driver}"}]}


def _holds_driver(node: Any) -> bool:
    """Whether a driver may replace the node itself."""
    return node.get("$ref") in [f"#/$defs/{name}" for name in _DRIVERS] or any(
        _holds_driver(part) for part in node.get("anyOf", [])
    )


def _or_any(node: Any) -> Any:
    """The value of a key, or a driver of any values; counts and kinds take none."""
    parts = node.get("anyOf", [node]) if isinstance(node, dict) else []
    fixed = any("const" in part or part.get("type") == "integer" for part in parts)
    if not parts or node == {} or fixed or _holds_driver(node):
        return node
    return _or(node, "AnyDriver")


def _with_drivers(node: Any) -> Any:
    if isinstance(node, list):
        return [_with_drivers(item) for item in node]
    if not isinstance(node, dict):
        return node
    node = {key: _with_drivers(value) for key, value in node.items()}
    if node.pop(_VARIES, False):
        return _or(node, "Driver")
    items = [*node.get("prefixItems", []), node.get("items", {})]
    if node.get("type") == "array" and any(_holds_driver(item) for item in items):
        return _or(node, "ListDriver")
    if "properties" in node and node.get("title") not in _UNDRIVEN:
        rows = node["properties"].items()
        node["properties"] = {key: _or_any(value) for key, value in rows}
    if node.get("additionalProperties"):
        node["additionalProperties"] = _or_any(node["additionalProperties"])
    return node


_UNDRIVEN = ("Drivers", "DriverGroup", "Labels", "GroundLabels", "Hazard")
"""Sections without drivers."""


def _name_choices(definitions: dict[str, Any]) -> None:
    """Names of the core's tables, so that editors can offer them."""
    bodies = sorted(name for name in _core.BODIES if name != "sun")
    effects = [row["name"] for row in _core.EFFECTS]

    def restrict(section: str, key: str, names: list[str]) -> None:
        found = definitions[section]["properties"][key]
        for part in (found, *found.get("anyOf", [])):
            target = part.get("items", part)
            if target.get("type") == "string":
                target["enum"] = names

    restrict("Body", "kind", [*bodies, "ellipsoid"])
    restrict("Body", "ephemeris", bodies)
    restrict("Body", "reflectance", [row["name"] for row in _core.REFLECTANCES])
    restrict("Render", "force_on", effects)
    restrict("Render", "force_off", effects)
    restrict("Render", "channels", channel_names())


def config_schema() -> dict[str, Any]:
    """The schema of a whole configuration."""
    mode: JsonSchemaMode = "validation"
    schema = Config.model_json_schema(by_alias=True, schema_generator=_Generator, mode=mode)
    _name_choices(schema["$defs"])
    schema = _with_drivers(schema)
    schema["$defs"] |= _DRIVERS
    # The name may be left out of the file, and `$schema` is not a key of a configuration.
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
