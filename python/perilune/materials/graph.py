"""Compiles material graphs from the configuration to the core's description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.config.errors import nearest
from perilune.config.materials import Material
from perilune.drivers import Drawn
from perilune.materials.images import Images, image_of

F64 = NDArray[np.float64]
_Input: TypeAlias = tuple[str, int, int, float, float, float]
_Constant: TypeAlias = tuple[float, NDArray[np.float32] | None, _core.Map | None]

_UNSET: _Input = ("unset", 0, 0, 0.0, 0.0, 0.0)
_TYPE = "type"
_CARRIER = "lambert"
"""Kind of surface of a graph of which one value alone is read."""


@dataclass(frozen=True)
class Graph:
    """A compiled graph, and the places of its parameters in the configuration."""

    core: _core.Graph
    parameters: tuple[tuple[str, str], ...]
    """(node, input) of each value that a driver gives."""


def build(
    name: str,
    material: Material,
    wrap: bool,
    images: Images | None,
    levels: Mapping[str, tuple[int, Mapping[str, int]]] | None = None,
) -> Graph:
    """Compiles an entry of `materials`. ValueError that names the key of any fault.

    Numbers drawn by drivers become parameters; all others are fixed. images: reads image files;
    None, for checking the graph alone, replaces them by white. levels: level of labels -> its place
    in `semantic`, and the ids of its classes; levels of the material that are missing there are
    checked, and left out."""
    key = f"materials.{name}"
    order = {node: k for k, node in enumerate(material.nodes)}
    surface = surface_of(key, material)
    parameters: list[tuple[str, str]] = []
    nodes = []
    for node, raw in material.nodes.items():
        where = f"{key}.nodes.{node}"
        kind = _kind(where, raw)
        inputs = []
        for socket in kind["inputs"]:
            value = raw.get(socket["name"])
            if has_drawn(value):
                _numbers(f"{where}.{socket['name']}", socket, value)
                inputs.append(("parameter", len(parameters), 0, 0.0, 0.0, 0.0))
                parameters.append((node, socket["name"]))
            else:
                inputs.append(_input(f"{where}.{socket['name']}", socket, value, order, material))
        constants = tuple(_constant(where, row, raw) for row in kind["constants"])
        if images is not None:
            constants = tuple(
                (0.0, None, images(image_of(where, raw))) if row["type"] == "image" else constant
                for row, constant in zip(kind["constants"], constants, strict=True)
            )
        nodes.append((node, str(raw[_TYPE]), tuple(inputs), constants))
    try:
        core = _core.Graph(tuple(nodes), order[surface], len(parameters), wrap)
        for level, row in material.labels.items():
            where = f"{key}.labels.{level}.value"
            value = _value_graph(where, row.value, nodes, order, material, len(parameters))
            if levels is not None and level in levels:
                index, ids = levels[level]
                ranges = np.array([*row.classes.values()], dtype=np.float64)
                numbers = np.array([ids[name] for name in row.classes], dtype=np.uint16)
                core.add_level(index, value, ranges, numbers)
    except ValueError as error:
        text = str(error)
        named = text.partition(".")[0] in order
        raise ValueError(f"{key}.nodes.{text}" if named else f"{key}: {text}") from None
    return Graph(core, tuple(parameters))


def _value_graph(
    where: str,
    value: str,
    nodes: Sequence[tuple[Any, ...]],
    order: Mapping[str, int],
    material: Material,
    parameters: int,
) -> _core.Graph:
    """The same nodes below a surface whose emission strength is the value of one of them."""
    kind = _core.NODES[_CARRIER]
    inputs = tuple(
        _input(where, socket, value, order, material)
        if socket["name"] == "emission_strength"
        else _UNSET
        for socket in kind["inputs"]
    )
    carrier = (where, _CARRIER, inputs, ())
    return _core.Graph((*nodes, carrier), len(nodes), parameters, False)


def values(
    graph: Graph, material: Material, given: Mapping[tuple[str, str], Any] | None = None
) -> F64:
    """(n, 3): parameters of a graph in the configuration of a frame."""
    return np.array(triples(graph, material, given or {}), dtype=np.float64).reshape(-1, 3)


def triples(
    graph: Graph, material: Material, given: Mapping[tuple[str, str], Any]
) -> list[tuple[float, float, float]]:
    """The rows of `values`."""
    own = material.nodes
    return [_triple(given[at] if at in given else own[at[0]][at[1]]) for at in graph.parameters]


def links(raw: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Input -> (node, output, or "" for its first) for each linked input of a node."""
    found = {}
    for socket in _kind_or_empty(raw).get("inputs", ()):
        value = raw.get(socket["name"])
        if isinstance(value, str):
            node, _, output = value.partition(".")
            found[socket["name"]] = (node, output)
    return found


def reached(material: Material, surface: str) -> set[str]:
    """Nodes that a surface depends on, including itself."""
    found: set[str] = set()
    waiting = [surface]
    while waiting:
        node = waiting.pop()
        if node not in found and node in material.nodes:
            found.add(node)
            waiting += [source for source, _ in links(material.nodes[node]).values()]
    return found


def surface_of(key: str, material: Material) -> str:
    """The surface node; ValueError if there is none, or more than one. key: its path."""
    known = [name for name, raw in material.nodes.items() if _kind_or_empty(raw).get("surface")]
    if material.surface is None:
        if len(known) != 1:
            kinds = ", ".join(name for name, kind in _core.NODES.items() if kind["surface"])
            raise ValueError(f"{key}: must have one surface ({kinds}), or say which: `surface`")
        return known[0]
    if material.surface not in known:
        near = nearest(material.surface, known)
        raise ValueError(f"{key}.surface: no surface '{material.surface}'{near}")
    return material.surface


def uses_own(material: Material) -> bool:
    """Whether a graph has a node that evaluates the object's own material."""
    return any(_kind_or_empty(raw).get("own") for raw in material.nodes.values())


def _kind_or_empty(raw: Mapping[str, Any]) -> Mapping[str, Any]:
    name = raw.get(_TYPE)
    return _core.NODES.get(name, {}) if isinstance(name, str) else {}


def _kind(where: str, raw: Mapping[str, Any]) -> Mapping[str, Any]:
    """The table's row for a node's kind; its keys are checked."""
    if _TYPE not in raw:
        raise ValueError(f"{where}.{_TYPE}: required, but missing{nearest('', _core.NODES)}")
    kind = _kind_or_empty(raw)
    if not kind:
        near = nearest(raw[_TYPE], _core.NODES)
        raise ValueError(f"{where}.{_TYPE}: no kind of node {raw[_TYPE]!r}{near}")
    allowed = [row["name"] for row in (*kind["inputs"], *kind["constants"])]
    for name in raw:
        if name not in allowed and name != _TYPE:
            near = nearest(name, allowed)
            raise ValueError(f"{where}.{name}: unknown key of a node '{raw[_TYPE]}'{near}")
    return kind


def has_drawn(value: Any) -> bool:
    """Whether a value or one of its components comes from a driver."""
    items = value if isinstance(value, (list, tuple)) else [value]
    return any(isinstance(item, Drawn) for item in items)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and np.isfinite(value)


def _triple(value: Any) -> tuple[float, float, float]:
    if isinstance(value, (list, tuple)):
        x, y, z = value
        return (float(x), float(y), float(z))
    return (float(value),) * 3


def _numbers(where: str, socket: Mapping[str, Any], value: Any) -> tuple[float, float, float]:
    if isinstance(value, (list, tuple)):
        good = socket["type"] != "scalar" and len(value) == 3 and all(map(_is_number, value))
    else:
        good = _is_number(value)
    if not good:
        what = "a number" if socket["type"] == "scalar" else "a number, three numbers"
        raise ValueError(f"{where}: must be {what} or the name of a node, not {value!r}")
    return _triple(value)


def _input(
    where: str,
    socket: Mapping[str, Any],
    value: Any,
    order: Mapping[str, int],
    material: Material,
) -> _Input:
    if value is None:
        return _UNSET
    if not isinstance(value, str):
        return ("constant", 0, 0, *_numbers(where, socket, value))
    node, _, output = value.partition(".")
    if node not in order:
        raise ValueError(f"{where}: no node '{node}'{nearest(node, order)}")
    outputs = [row["name"] for row in _kind(where, material.nodes[node])["outputs"]]
    if not outputs:
        raise ValueError(f"{where}: '{node}' is a surface, which has no output")
    output = output or outputs[0]
    if output not in outputs:
        raise ValueError(f"{where}: '{node}' has no output '{output}'{nearest(output, outputs)}")
    return ("link", order[node], outputs.index(output), 0.0, 0.0, 0.0)


def _constant(where: str, row: Mapping[str, Any], raw: Mapping[str, Any]) -> _Constant:
    name = row["name"]
    value = raw.get(name)
    where = f"{where}.{name}"
    if value is None:
        if row["type"] == "numbers" or np.isnan(row["default"]):
            raise ValueError(f"{where}: required, but missing")
        return (float(row["default"]), None, None)
    if has_drawn(value):
        raise ValueError(f"{where}: takes no driver: it is fixed when the scene is built")
    if row["type"] == "image":
        if not isinstance(value, str) or not value:
            raise ValueError(f"{where}: must be the path of an image, not {value!r}")
        return (0.0, None, None)
    if row["type"] == "choice":
        if value not in row["choices"]:
            raise ValueError(f"{where}: no '{value}'{nearest(value, row['choices'])}")
        return (float(row["choices"].index(value)), None, None)
    if row["type"] == "numbers":
        return (0.0, _table(where, value, row["columns"]), None)
    if isinstance(value, bool):
        value = int(value)
    if not _is_number(value) or not row["low"] <= value <= row["high"]:
        limits = f"{row['low']:g} to {row['high']:g}"
        raise ValueError(f"{where}: must be a number from {limits}, not {value!r}")
    return (float(value), None, None)


def _table(where: str, value: Any, columns: int) -> NDArray[np.float32]:
    rows = value if isinstance(value, (list, tuple)) else []
    for k, row in enumerate(rows):
        good = isinstance(row, (list, tuple)) and len(row) == columns
        if not good or has_drawn(row) or not all(map(_is_number, row)):
            raise ValueError(f"{where}[{k}]: must be {columns} numbers, not {row!r}")
    if not rows:
        raise ValueError(f"{where}: must be rows of {columns} numbers")
    return np.array(rows, dtype=np.float32).ravel()
