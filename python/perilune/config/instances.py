"""Drivers that each spacecraft draws by itself: `per: instance` becomes a section a spacecraft."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping
from typing import Any

from perilune.config.materials import driver_name

Tree = dict[str, Any]


def spread(tree: Tree) -> None:
    """Puts copies of the sections that say `per: instance` where each spacecraft has its own.

    What `materials.X.drivers` holds goes to `materials.X.instances.S` of the spacecraft that use X,
    what the top level holds to `spacecraft.S.material_drivers` of those with such a node. Entries
    that are there already stay. As draws are keyed by the key path, each spacecraft then draws for
    itself, and what it drew is recorded and replayed by a name of its own. What is on no spacecraft
    stays where it is; what is malformed is left to the validation.
    """
    crafts, materials = _mapping(tree, "spacecraft"), _mapping(tree, "materials")
    for name, material in materials.items():
        if _is_per_instance(material):
            _to_instances(name, material, crafts)
    if _is_per_instance(tree, "material_drivers"):
        _to_spacecraft(tree, materials, crafts)


def _to_instances(name: str, material: Tree, crafts: Mapping[str, Any]) -> None:
    users = [craft for craft, raw in crafts.items() if name in _used(raw)]
    instances = material.setdefault("instances", {})
    if users and isinstance(instances, dict):
        section = material.pop("drivers")
        for craft in users:
            _copy(section, instances, craft, section["drivers"])


def _to_spacecraft(tree: Tree, materials: Mapping[str, Any], crafts: Mapping[str, Any]) -> None:
    section = tree["material_drivers"]
    gone: set[str] = set()
    for raw in crafts.values():
        nodes = (_mapping(_mapping(materials, use), "nodes") for use in _used(raw))
        named = {driver_name(node) for row in nodes for node in row}
        names = [name for name in section["drivers"] if name in named]
        if names:
            _copy(section, raw, "material_drivers", names)
            gone.update(names)
    section["drivers"] = {k: v for k, v in section["drivers"].items() if k not in gone}
    if not section["drivers"]:
        del tree["material_drivers"]


def _mapping(tree: Any, key: str) -> Mapping[str, Any]:
    found = tree.get(key) if isinstance(tree, Mapping) else None
    return found if isinstance(found, Mapping) else {}


def _is_per_instance(owner: Any, key: str = "drivers") -> bool:
    section = _mapping(owner, key)
    return section.get("per") == "instance" and bool(_mapping(section, "drivers"))


def _used(craft: Any) -> list[str]:
    """Names of the graphs that are, or may be, on a spacecraft."""
    uses = craft.get("materials") if isinstance(craft, Mapping) else None
    names: list[str] = []
    for use in uses if isinstance(uses, list) else ():
        given = use.get("use") if isinstance(use, Mapping) else None
        choices = given.get("choice") if isinstance(given, Mapping) else [given]
        names += [name for name in choices or () if isinstance(name, str)]
    return names


def _copy(section: Mapping[str, Any], owner: Tree, key: str, names: Iterable[str]) -> None:
    """Adds to the section at a key of `owner` what it has not got."""
    drivers = {name: section["drivers"][name] for name in names}
    added = copy.deepcopy({**section, "drivers": drivers})
    del added["per"]
    own = owner.get(key)
    if isinstance(own, dict):
        drivers = {**added["drivers"], **_mapping(own, "drivers")}
        added = {**added, **own, "drivers": drivers}
    owner[key] = added
