"""Drivers drawn independently per object: expands `per: instance` into a section for each
object."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from perilune.config.materials import driver_name

Tree = dict[str, Any]


def spread(tree: Tree) -> None:
    """Copies the sections with `per: instance` to the own section of each object.

    Objects are spacecraft, bodies and volumes. `materials.X.drivers` is copied to
    `materials.X.instances.S` for the objects S that use X; the top level's drivers are copied to
    `material_drivers` of objects with such a node. Existing entries stay. Because draws are keyed
    by the key path, each object then draws independently, and its draws are recorded and replayed
    under a name of its own. Sections without an object stay where they are; malformed ones are left
    to the validation."""
    sections = ("spacecraft", "bodies", "volumes")
    entities = {name: raw for key in sections for name, raw in _mapping(tree, key).items()}
    materials = _mapping(tree, "materials")
    for name, material in materials.items():
        if _is_per_instance(material):
            _to_instances(name, material, entities)
    if _is_per_instance(tree, "material_drivers"):
        _to_entities(tree, materials, entities)


def _to_instances(name: str, material: Tree, entities: Mapping[str, Any]) -> None:
    users = [entity for entity, raw in entities.items() if name in _used(raw)]
    instances = material.setdefault("instances", {})
    if users and isinstance(instances, dict):
        section = material.pop("drivers")
        for entity in users:
            _copy(section, instances, entity, section["drivers"])


def _to_entities(tree: Tree, materials: Mapping[str, Any], entities: Mapping[str, Any]) -> None:
    section = tree["material_drivers"]
    gone: set[str] = set()
    for raw in entities.values():
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


def _used(entity: Any) -> list[str]:
    """Names of the graphs that are, or may be, on a spacecraft or a body."""
    if not isinstance(entity, Mapping):
        return []
    return list(_names(entity.get("materials", entity.get("material"))))


def _names(value: Any) -> Iterator[str]:
    """Names in a name, a use, a list of uses, or a choice of any of these."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        yield from _names(value.get("choice", value.get("use")))
    elif isinstance(value, list):
        for item in value:
            yield from _names(item)


def _copy(section: Mapping[str, Any], owner: Tree, key: str, names: Iterable[str]) -> None:
    """Adds missing entries to the section at a key of `owner`."""
    drivers = {name: section["drivers"][name] for name in names}
    added = copy.deepcopy({**section, "drivers": drivers})
    del added["per"]
    own = owner.get(key)
    if isinstance(own, dict):
        drivers = {**added["drivers"], **_mapping(own, "drivers")}
        added = {**added, **own, "drivers": drivers}
    owner[key] = added
