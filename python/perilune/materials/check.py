"""Checks the material graphs of a configuration."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from perilune.config.body import Body
from perilune.config.errors import nearest
from perilune.config.materials import Material
from perilune.config.schema import Config
from perilune.drivers import Found, KeyPath, path_text
from perilune.materials import drivers
from perilune.materials.graph import build, surface_of, uses_own

_PLACES = (
    ("materials", None, "drivers", "drivers", None),
    ("materials", None, "instances", None, "drivers", None),
    ("spacecraft", None, "material_drivers", "drivers", None),
    ("bodies", None, "material_drivers", "drivers", None),
    ("volumes", None, "material_drivers", "drivers", None),
    ("material_drivers", "drivers", None),
)
"""Key paths of values in sections of drivers; None is any name."""


def _is_in_section(path: KeyPath) -> bool:
    return any(
        len(path) >= len(place)
        and all(key is None or key == part for key, part in zip(place, path, strict=False))
        for place in _PLACES
    )


def is_choice(path: KeyPath) -> bool:
    """Whether a driver at this path changes the material assignment."""
    uses = path[0] == "spacecraft" and path[2:3] == ("materials",)
    one = path[0] in ("bodies", "volumes")
    return uses or (one and path[2:3] in (("material",), ("material_mode",)))


def is_drawn(row: Found) -> bool:
    """Whether a user's function returns a whole entry of `materials`."""
    return row.path[:1] == ("materials",) and len(row.path) == 2 and row.kind.name == "hook"


def _is_of_graphs(path: KeyPath) -> bool:
    key = path[2:3] if path[0] in ("spacecraft", "bodies", "volumes") else path[:1]
    return key in (("materials",), ("material_drivers",))


def _has_alpha(material: Material) -> bool:
    try:
        return "alpha" in material.nodes[surface_of("", material)]
    except ValueError:
        return False  # reported elsewhere


def _unused(name: str, body: Body, material: Material) -> Iterator[str]:
    """Keys of a body that its graph overrides."""
    used = {"emission_w_m2_sr", "albedo", "color_map"} if uses_own(material) else set()
    for key in ("color_map", "albedo", "emission_w_m2_sr", "reflectance"):
        if key in body.model_fields_set - used:
            why = f"the material '{body.material}' replaces it"
            yield f"bodies.{name}.{key}: {why}; `material_mode: wrap` keeps what that does not give"


def check(config: Config, found: Sequence[Found], checked: Config | None = None) -> Iterator[str]:
    """Faults in the graphs of a configuration, whether they are used or not.

    found: the drivers of the configuration. checked: the same configuration with other values of
    them, without faults; unchanged parts are not checked again."""
    if checked is not None:
        changed = {
            name: material
            for name, material in config.materials.items()
            if name not in checked.materials or material.nodes != checked.materials[name].nodes
        }
        for name, material in changed.items():
            try:
                build(name, material, False, None)
            except ValueError as error:
                yield str(error)
        yield from _missing(config)
        yield from drivers.check_values(config, users(config, found))
        return
    varies: set[KeyPath] = set()
    for name, material in config.materials.items():
        try:
            for node, key in build(name, material, False, None).parameters:
                varies.add(("materials", name, "nodes", node, key))
        except ValueError as error:
            yield str(error)
    yield from _missing(config)
    yield from drivers.check_values(config, users(config, found))
    yield from drivers.check_use(config, users(config, found))
    drawn = {row.path for row in found if is_drawn(row)}
    for name, volume in config.volumes.items():
        if ("materials", volume.material) in drawn:
            text = f"'{volume.material}' is drawn by a hook, which volumes do not take"
            yield f"volumes.{name}.material: {text}"
    for path in (row.path for row in found):
        if not _is_of_graphs(path) or is_choice(path) or _is_in_section(path) or path in drawn:
            continue
        if path[:5] not in varies:
            text = "takes no driver: in a graph numbers of inputs alone vary from frame to frame"
            if len(path) < 5:
                text += "; the `use` of a spacecraft's materials may be a choice of whole graphs"
            yield f"{path_text(path)}: {text}"


def _missing(config: Config) -> Iterator[str]:
    """Uses of missing or unsuitable graphs, and keys that graphs override."""
    for key, owner, use in _uses(config):
        if use not in config.materials:
            yield f"{key}: no entry named '{use}'{nearest(use, config.materials)}"
        elif owner in config.bodies and _has_alpha(config.materials[use]):
            yield f"{key}: '{use}' has an alpha, but there are no holes in bodies"
        elif owner in config.volumes and uses_own(config.materials[use]):
            yield f"{key}: '{use}' asks for a model's own material, which a volume does not have"
        elif owner in config.bodies and config.bodies[owner].is_replaced:
            yield from _unused(owner, config.bodies[owner], config.materials[use])


def _uses(config: Config) -> Iterator[tuple[str, str, str]]:
    """(key path, spacecraft, body or volume, entry of materials) of all uses."""
    for name, body in config.bodies.items():
        if body.material is not None:
            yield f"bodies.{name}.material", name, body.material
    for name, volume in config.volumes.items():
        if volume.material is not None:
            yield f"volumes.{name}.material", name, volume.material
    for name, craft in config.spacecraft.items():
        for k, use in enumerate(craft.materials):
            yield f"spacecraft.{name}.materials[{k}].use", name, use.use


def users(config: Config, found: Sequence[Found]) -> dict[str, list[str]]:
    """Spacecraft, body or volume -> the entries of materials that are, or may be, on it."""
    found_on: dict[str, list[str]] = {}
    for _, owner, use in _uses(config):
        found_on.setdefault(owner, []).append(use)
    for row in found:
        if is_choice(row.path):
            offered = [use for value in row.distribution.limits.values() for use in _offered(value)]
            found_on.setdefault(str(row.path[1]), []).extend(offered)
    return found_on


def _offered(value: Any) -> Iterator[str]:
    """Names of graphs in the options of a choice: a name, a use, or a list of uses."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        yield from _offered(value.get("use"))
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield from _offered(item)
