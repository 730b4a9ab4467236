"""From a graph to boxes with rows, and links between rows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from perilune import _core
from perilune.document.document import Document
from perilune.drivers import path_text
from perilune.materials.drivers import driven, sections
from perilune.materials.graph import links, reached, surface_of

_SHOWN = 4
"""Largest number of rows of a table, and of values of a choice, to show."""


@dataclass(frozen=True)
class Row:
    """A line of a box."""

    text: str
    value: str = ""
    socket: str | None = None
    """Its type (scalar, vector, color), if a link can start or end here."""
    output: bool = False
    color: tuple[float, float, float] | None = None
    """Linear RGB of a constant colour."""
    driver: bool = False
    """Whether it describes a driver."""


@dataclass
class Box:
    """A node."""

    name: str
    kind: str
    type: str
    """surface, or the type of its first output."""
    driver: bool
    """Whether a driver drives it by its name."""
    reached: bool
    """Whether the surface depends on it."""
    rows: list[Row] = field(default_factory=list)


@dataclass(frozen=True)
class Link:
    """A link from a row of a box to a row of another; type: that of its start."""

    source: str
    source_row: int
    target: str
    target_row: int
    type: str


def read(document: Document, name: str, owner: str | None) -> tuple[list[Box], list[Link]]:
    """The boxes of an entry of `materials` on an object, and the links."""
    config = document.config
    material = config.materials[name]
    by_name = {node.node: (key, value) for node, key, value in driven(config, name, owner)}
    of_surface = reached(material, surface_of(f"materials.{name}", material))
    boxes: list[Box] = []
    for node, raw in material.nodes.items():
        kind = _core.NODES[raw["type"]]
        first = "surface" if kind["surface"] else str(kind["outputs"][0]["type"])
        box = Box(node, raw["type"], first, node in by_name, node in of_surface)
        box.rows += [Row(row["name"], "", row["type"], True) for row in kind["outputs"]]
        box.rows += list(_constants(kind, raw))
        if node in by_name:
            key, value = by_name[node]
            (socket,) = kind["inputs"]
            box.rows += _driver_rows(document, key, value, socket["type"])
            box.rows += _section_rows(document, name, owner, key)
        else:
            where = ("materials", name, "nodes", node)
            for socket in kind["inputs"]:
                if raw.get(socket["name"]) is not None:
                    box.rows += _input(document, where, socket, raw[socket["name"]])
        boxes.append(box)
    return boxes, list(_links(boxes, material.nodes))


def _links(boxes: Sequence[Box], nodes: Mapping[str, Mapping[str, Any]]) -> Iterator[Link]:
    by_name = {box.name: box for box in boxes}
    for target in boxes:
        for key, (source, output) in links(nodes[target.name]).items():
            rows = by_name[source].rows
            start = next(k for k, row in enumerate(rows) if row.output and output in ("", row.text))
            inputs = (k for k, row in enumerate(target.rows) if row.socket and not row.output)
            end = next(k for k in inputs if target.rows[k].text == key)
            yield Link(source, start, target.name, end, rows[start].socket or "")


def _constants(kind: Mapping[str, Any], raw: Mapping[str, Any]) -> Iterator[Row]:
    """Values fixed when the graph is made; choices even if they have their default."""
    for row in kind["constants"]:
        value = raw.get(row["name"])
        if row["type"] == "choice":
            yield Row(row["name"], str(value or row["choices"][int(row["default"])]))
        elif row["type"] == "numbers" and value is not None:
            yield Row(row["name"], f"{len(value)} rows")
            for entry in value[:_SHOWN]:
                color = tuple(entry[1:4]) if len(entry) == 4 else None
                yield Row("", text_of(entry), color=color)
        elif value is not None:
            yield Row(row["name"], text_of(value))


def _input(
    document: Document, where: tuple[str, ...], socket: Mapping[str, Any], value: Any
) -> Iterator[Row]:
    name, kind = socket["name"], socket["type"]
    if isinstance(value, str):
        yield Row(name, "", kind)
        return
    rows = [row for row in document.drivers if row.path[:5] == (*where, name)]
    yield Row(name, text_of(value), kind, color=_color(kind, value), driver=bool(rows))
    for row in rows:
        part = path_text(row.path[5:])
        for text, shown in _told(_raw(document, row.path)):
            yield Row(f"  {part} {text}" if part else f"  {text}", shown, driver=True)


def _color(kind: str, value: Any) -> tuple[float, float, float] | None:
    if kind != "color":
        return None
    x, y, z = value if isinstance(value, (list, tuple)) else (value,) * 3
    return (float(x), float(y), float(z))


# --- drivers -------------------------------------------------------------------------------------


def _raw(document: Document, path: Sequence[str | int]) -> Any:
    found: Any = document.tree
    for part in path:
        found = found[part]
    return found


def _driver_rows(document: Document, key: str, value: Any, kind: str) -> Iterator[Row]:
    """Rows for the entry at a key path: its driver, or its fixed value."""
    color = _color(kind, value)
    rows = [row for row in document.drivers if row.name == key or row.name.startswith(f"{key}[")]
    if not rows:
        yield Row("value", text_of(value), color=color, driver=True)
    for row in rows:
        part = path_text(row.path[len(key.split(".")) :])
        for text, shown in _told(_raw(document, row.path)):
            yield Row(f"{part} {text}".strip(), shown, driver=True, color=color)
            color = None


def _section_rows(document: Document, name: str, owner: str | None, key: str) -> Iterator[Row]:
    """Settings of the entry's section for all its drivers, and its key path."""
    for at, section in sections(document.config, name, owner):
        if section is not None and key.startswith(f"{at}.drivers."):
            for setting in ("jitter_strength", "step_interval"):
                value = getattr(section, setting)
                if value is not None:
                    yield Row(setting.replace("_", " "), text_of(value), driver=True)
            if at != f"materials.{name}.drivers":
                yield Row(f"by {at}", driver=True)
            return


def _told(raw: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Text of a driver's keys and values."""
    for key, value in raw.items():
        if key == "clip_min":
            yield "clip", f"{text_of(value)} to {text_of(raw.get('clip_max'))}"
        elif key == "uniform":
            yield "uniform", f"{text_of(value[0])} to {text_of(value[1])}"
        elif key == "choice":
            shown = ", ".join(text_of(item) for item in value[:_SHOWN])
            yield "one of", shown + (", ..." if len(value) > _SHOWN else "")
        elif key not in ("clip_max", "params"):
            words = {"jitter_variance": "variance", "log_variance": "log variance"}
            yield words.get(key, key), text_of(value)


def text_of(value: Any) -> str:
    """A short text for a value."""
    if isinstance(value, bool) or not isinstance(value, (int, float, list, tuple)):
        return str(value)
    if isinstance(value, (int, float)):
        return f"{value:.4g}"
    return "[" + ", ".join(text_of(item) for item in value) + "]"
