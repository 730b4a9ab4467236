"""Values of the nodes `OAISYS_NAME` and `driver:NAME` of graphs, and checks of their drivers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from perilune.config.errors import nearest
from perilune.config.materials import DriverSection, Material, driver_name
from perilune.config.schema import Config
from perilune.materials.graph import has_drawn, reached, surface_of

VALUE_OF = {"value": "value", "color": "color"}
"""Kinds of nodes that a driver may drive -> the input with their value."""


@dataclass(frozen=True)
class Node:
    """A node that is named after a driver."""

    name: str
    """NAME, without the prefix."""
    node: str
    input: str


_crawled: dict[int, tuple[Mapping[str, Any], list[Node]]] = {}
"""Cache: identity of a graph's nodes -> the nodes and the driver nodes in them. Frames share parts
of the tree without drivers."""
_KEPT = 64


def crawl(material: Material) -> list[Node]:
    """All driver nodes of a graph, in its order."""
    kept = _crawled.get(id(material.nodes))
    if kept is not None and kept[0] is material.nodes:
        return kept[1]
    while len(_crawled) >= _KEPT:
        _crawled.pop(next(iter(_crawled)), None)
    rows = _crawl(material)
    _crawled[id(material.nodes)] = material.nodes, rows
    return rows


def _crawl(material: Material) -> list[Node]:
    rows = []
    for node, raw in material.nodes.items():
        name, kind = driver_name(node), raw.get("type")
        if name is not None and isinstance(kind, str) and kind in VALUE_OF:
            rows.append(Node(name, node, VALUE_OF[kind]))
    return rows


def drivers_of(config: Config, name: str, owner: str | None) -> list[DriverSection | None]:
    """All sections that may drive an entry of `materials`; the first takes precedence.

    owner: the spacecraft, body or volume that it is on."""
    material = config.materials[name]
    if owner is None:
        return [material.drivers, config.material_drivers]
    entities = next(part for part in _owners(config).values() if owner in part)
    own = material.instances.get(owner)
    return [own, material.drivers, entities[owner].material_drivers, config.material_drivers]


def _owners(config: Config) -> dict[str, Mapping[str, Any]]:
    """Section -> its entries, which may have graphs."""
    return {"spacecraft": config.spacecraft, "bodies": config.bodies, "volumes": config.volumes}


def sections(
    config: Config, name: str, owner: str | None
) -> Iterator[tuple[str, DriverSection | None]]:
    """(key path, section) of all sections that may drive an entry of `materials`."""
    return zip(_keys(config, name, owner), drivers_of(config, name, owner), strict=True)


def _keys(config: Config, name: str, owner: str | None) -> list[str]:
    """Key path of each of `drivers_of`."""
    shared = [f"materials.{name}.drivers", "material_drivers"]
    if owner is None:
        return shared
    kind = next(kind for kind, part in _owners(config).items() if owner in part)
    of_owner = f"{kind}.{owner}.material_drivers"
    return [f"materials.{name}.instances.{owner}", shared[0], of_owner, shared[1]]


def driven(config: Config, name: str, owner: str | None) -> Iterator[tuple[Node, str, Any]]:
    """(node, key path of the entry with its value, value) for an entry of `materials`."""
    rows = [(key, row) for key, row in sections(config, name, owner) if row is not None]
    for node in crawl(config.materials[name]):
        for key, section in rows:
            if node.name in section.drivers:
                yield node, f"{key}.drivers.{node.name}", section.drivers[node.name]
                break


def given_by_drivers(config: Config, name: str, owner: str | None) -> dict[tuple[str, str], Any]:
    """(node, input) -> value, of the nodes of an entry of `materials` that drivers set."""
    # As `driven`, without key paths: every frame asks for every graph.
    rows = [row.drivers for row in drivers_of(config, name, owner) if row is not None]
    found: dict[tuple[str, str], Any] = {}
    for node in crawl(config.materials[name]) if rows else ():
        for values in rows:
            if node.name in values:
                found[node.node, node.input] = values[node.name]
                break
    return found


def applied(config: Config, name: str, owner: str | None = None) -> Material:
    """An entry of `materials` with the values of its driver nodes on an object."""
    material = config.materials[name]
    changed = {
        node.node: {**material.nodes[node.node], node.input: value}
        for node, _, value in driven(config, name, owner)
    }
    # Not compared with the present value: a drawn number varies even if its ideal is the same.
    return material.model_copy(update={"nodes": material.nodes | changed}) if changed else material


# --- checks --------------------------------------------------------------------------------------

Users: TypeAlias = Mapping[str, Sequence[str]]


def _places(config: Config, users: Users) -> Iterator[tuple[str, str | None]]:
    """(entry of materials, owner) of all graphs, including unused ones."""
    entities = (*config.spacecraft, *config.bodies, *config.volumes)
    for name, material in config.materials.items():
        owners: list[str | None] = [t for t in entities if name in users.get(t, ())]
        # What has values of its own may have used the graph before an override of its choice.
        others = [entity for entity in material.instances if entity in entities]
        yield from ((name, owner) for owner in (*(owners or [None]), *others))


def _entries(config: Config, users: Users) -> Iterator[tuple[str, str, list[str]]]:
    """(key path, NAME, possible names of its nodes) of all entries of all sections."""

    def of(
        key: str, section: DriverSection | None, graphs: Iterable[str]
    ) -> Iterator[tuple[str, str, list[str]]]:
        if section is not None:
            rows = [crawl(config.materials[name]) for name in graphs if name in config.materials]
            known = list(dict.fromkeys(node.name for row in rows for node in row))
            yield from ((f"{key}.drivers.{name}", name, known) for name in section.drivers)

    for name, material in config.materials.items():
        yield from of(f"materials.{name}.drivers", material.drivers, [name])
        for owner, section in material.instances.items():
            yield from of(f"materials.{name}.instances.{owner}", section, [name])
    for kind, entities in _owners(config).items():
        for owner, row in entities.items():
            key = f"{kind}.{owner}.material_drivers"
            yield from of(key, row.material_drivers, users.get(owner, []))
    yield from of("material_drivers", config.material_drivers, config.materials)


def _node_problem(raw: Mapping[str, Any], node: Node, value: Any) -> str | None:
    """Reason why a driver cannot give a node's value."""
    own = raw.get(node.input)
    if isinstance(own, str):
        return f"drives nothing: {node.input} of the node '{node.node}' is linked to '{own}'"
    if has_drawn(own):
        return f"drives nothing: {node.input} of the node '{node.node}' has a driver of its own"
    if raw["type"] == "value" and isinstance(value, (list, tuple)):
        return f"must be one number: '{node.node}' is a node 'value', not a 'color'"
    return None


def check_values(config: Config, users: Users) -> Iterator[str]:
    """Faults in the values that drivers give nodes.

    users: spacecraft or body -> the entries of materials that are, or may be, on it."""
    for name, owner in _places(config, users):
        nodes = config.materials[name].nodes
        for node, key, value in driven(config, name, owner):
            problem = _node_problem(nodes[node.node], node, value)
            if problem is not None:
                yield f"{key}: {problem}"


def check_use(config: Config, users: Users) -> Iterator[str]:
    """Entries of sections of drivers that affect no surface. users: see check_values."""
    used: set[str] = set()
    reaching: set[str] = set()
    of_surface = {
        name: reached(material, surface_of(f"materials.{name}", material))
        for name, material in config.materials.items()
    }
    for name, owner in _places(config, users):
        for node, key, _ in driven(config, name, owner):
            used.add(key)
            if node.node in of_surface[name]:
                reaching.add(key)
    for key, name, known in _entries(config, users):
        if name not in known:
            nodes = f"no node 'OAISYS_{name}' or 'driver:{name}'"
            yield f"{key}: drives nothing: {nodes}{nearest(name, known)}"
        elif key not in used:
            yield f"{key}: drives nothing: other drivers come before it, or no graph is there"
        elif key not in reaching:
            yield f"{key}: drives nothing: no surface depends on the node"
