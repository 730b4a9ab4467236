"""The configuration's types as JSON Schema (2020-12), with drivers where numbers may vary.

What the schema cannot say (a name that refers to another entry, keys of which exactly one is given)
the loader checks; what the schema refuses, the loader refuses too.
"""

from __future__ import annotations

from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaMode, JsonSchemaValue
from pydantic_core import PydanticCustomError, core_schema

from perilune import _core
from perilune.config.references import channel_names
from perilune.config.schema import Config
from perilune.drivers import Drawn

_VARIES = "x-perilune-varies"
"""Marks, while the schema is made, a number in whose place a driver may stand."""

_DRAWS: dict[str, Any] = {
    "interval": {"type": "integer", "minimum": 1, "description": "Steps between draws."},
    "strength": {"type": "number", "minimum": 0, "description": "Factor on the variance."},
}
_NORMAL: dict[str, Any] = {
    "description": "ideal + N(0, jitter_variance * strength), clipped.",
    "type": "object",
    "properties": {
        "ideal": {"type": "number"},
        "jitter_variance": {"type": "number", "minimum": 0},
        "clip_min": {"type": "number"},
        "clip_max": {"type": "number"},
        **_DRAWS,
    },
    "required": ["ideal", "jitter_variance", "clip_min", "clip_max"],
    "additionalProperties": False,
}
_UNIFORM: dict[str, Any] = {
    "description": "Uniform between two limits.",
    "type": "object",
    "properties": {
        "uniform": {
            "type": "array",
            "items": {"type": "number"},
            "minItems": 2,
            "maxItems": 2,
            "description": "[low, high].",
        },
        **_DRAWS,
    },
    "required": ["uniform"],
    "additionalProperties": False,
}
_DRIVER: dict[str, Any] = {
    "title": "Driver",
    "description": "A number that varies.",
    "anyOf": [_NORMAL, _UNIFORM],
}


def _takes(function: Any, value: Any) -> Any:
    """What a validator makes of a value; None if it refuses."""
    try:
        return function(value)
    except PydanticCustomError:
        return None


class _Generator(GenerateJsonSchema):
    """Asks the validators that run before a type what they let through."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._fixed = 0

    def float_schema(self, schema: core_schema.FloatSchema) -> JsonSchemaValue:
        found = super().float_schema(schema)
        return found if self._fixed else {**found, _VARIES: True}

    def function_before_schema(
        self, schema: core_schema.BeforeValidatorFunctionSchema
    ) -> JsonSchemaValue:
        function = schema["function"]["function"]
        if schema["schema"]["type"] in ("model", "model-fields", "definition-ref"):
            return super().function_before_schema(schema)
        refuses = _takes(function, Drawn(1.0)) is None
        self._fixed += refuses
        try:
            found = super().function_before_schema(schema)
        finally:
            self._fixed -= refuses
        spread = _takes(function, 1.0)
        if isinstance(spread, tuple) and found.get("type") == "array":
            # A number stands for all items of the list.
            return {"anyOf": [found["prefixItems"][0], found]}
        return found


def _with_drivers(node: Any) -> Any:
    if isinstance(node, list):
        return [_with_drivers(item) for item in node]
    if not isinstance(node, dict):
        return node
    node = {key: _with_drivers(value) for key, value in node.items()}
    if not node.pop(_VARIES, False):
        return node
    words = ("title", "description", "default")
    outer = {key: node.pop(key) for key in words if key in node}
    return {**outer, "anyOf": [node, {"$ref": "#/$defs/Driver"}]}


def _name_choices(definitions: dict[str, Any]) -> None:
    """The names of the core's tables, so that editors can offer them."""
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
    schema = _with_drivers(schema)
    schema["$defs"]["Driver"] = _DRIVER
    _name_choices(schema["$defs"])
    # The name may be left out of the file, and `$schema` is not a key of a configuration.
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
