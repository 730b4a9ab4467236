"""passParams of meshes: ids of classes."""

from __future__ import annotations

from typing import Any

from perilune.document.oaisys.node import Node
from perilune.document.oaisys.scene import Scene

_LARGEST = 65535


def _levels(node: Node) -> list[int]:
    """The ids of a mesh, coarsest first; only its first label is used, as in OAISYS."""
    rows = node.get("labelIDVec", [])
    row = rows[0] if isinstance(rows, list) and rows else []
    if not isinstance(rows, list) or not isinstance(row, list):
        node.fail("labelIDVec", "must be [[level 0, level 1, ...]]")
    if not all(type(value) is int for value in row):
        node.fail("labelIDVec[0]", f"must be whole numbers, not {row!r}")
    if len(rows) > 1:
        node.notes.warn(node.where("labelIDVec"), "only the first list is applied")
    return list(row)


def _class_of(entry: dict[str, Any], name: str, number: int, ids: dict[str, int]) -> str:
    """The class of objects with an id: that of the first mesh with it."""
    same = next((other for other, value in ids.items() if value == number), None)
    if same is not None:
        return same
    own = str(entry["class"])
    return name if ids.get(own, number) != number else own


def _level(depth: int) -> str:
    return f"level_{depth}"


def read(meshes: list[tuple[str, Node]], scene: Scene) -> dict[str, Any]:
    """Turns ids into classes; equal ids of a level give one class.

    A single level is that of objects. Of several, `semantic` has all in the order of the file,
    coarsest first, with the finest as the level `object`; then `part` and `kind`."""
    rows: list[tuple[str, Node, list[int]]] = []
    for name, params in meshes:
        passes = params.child("passParams")
        for key in ("rgb", "instance_label"):
            passes.child(key)
        label = passes.child("semantic_label")
        levels = _levels(label)
        if levels:
            rows.append((name, label, levels))
    depth = max((len(levels) for _, _, levels in rows), default=0)
    coarse = [_level(k) for k in range(depth - 1)]
    ids: dict[str, dict[str, int]] = {name: {} for name in (*coarse, "object")}
    for name, label, levels in rows:
        where = label.where("labelIDVec")
        if len(levels) < depth:
            text = f"has {len(levels)} of {depth} levels; the last stands for the finer ones"
            scene.notes.warn(where, text)
        entry = scene.tree[scene.entities[name].section][name]
        for k, level in enumerate(ids):
            number = levels[min(k, len(levels) - 1)]
            if not 1 <= number <= _LARGEST:
                place = f"{where}[0][{k}]"
                text = f"not applied: an id is 1 to {_LARGEST} (0 is the background), not {number}"
                scene.notes.warn(place, text)
            elif level == "object":
                entry["class"] = _class_of(entry, name, number, ids[level])
                ids[level][entry["class"]] = number
                label.comes("labels.ids.object", "labelIDVec")
            else:
                entry.setdefault("classes", {})[level] = f"class_{number}"
                ids[level][f"class_{number}"] = number
    found: dict[str, Any] = {"ids": {level: row for level, row in ids.items() if row}}
    shown = [level for level in coarse if ids[level]]
    if shown:
        found["levels"] = [*shown, "object", "part", "kind"]
    return found if found["ids"] else {}
