"""passParams of meshes: ids of classes."""

from __future__ import annotations

from typing import Any

from perilune.config.oaisys.node import Node
from perilune.config.oaisys.scene import Scene

_LARGEST = 65535


def _levels(node: Node) -> list[int]:
    """The ids of a mesh, coarsest first; only its first label, as OAISYS does for meshes."""
    rows = node.get("labelIDVec", [])
    row = rows[0] if isinstance(rows, list) and rows else []
    if not isinstance(rows, list) or not isinstance(row, list):
        node.fail("labelIDVec", "must be [[level 0, level 1, ...]]")
    if not all(type(value) is int for value in row):
        node.fail("labelIDVec[0]", f"must be whole numbers, not {row!r}")
    if len(rows) > 1:
        node.notes.warn(node.where("labelIDVec"), "only the first list is applied")
    return list(row)


def read(meshes: list[tuple[str, Node]], scene: Scene) -> dict[str, Any]:
    """The finest level becomes the id of the mesh's class; equal ids make one class."""
    ids: dict[str, int] = {}
    for name, params in meshes:
        passes = params.child("passParams")
        for key in ("rgb", "instance_label"):
            passes.child(key)
        label = passes.child("semantic_label")
        levels = _levels(label)
        if not levels:
            continue
        where = label.where("labelIDVec")
        if len(levels) > 1:
            text = f"only the finest of its levels is applied, {levels[-1]}, as the class's id"
            scene.notes.warn(where, text)
        entry = scene.tree[scene.things[name].section][name]
        number = levels[-1]
        if not 1 <= number <= _LARGEST:
            text = f"not applied: an id is 1 to {_LARGEST} (0 is the background), not {number}"
            scene.notes.warn(where, text)
            continue
        same = next((other for other, value in ids.items() if value == number), None)
        if same is not None:
            entry["class"] = same
        elif ids.get(entry["class"], number) != number:
            entry["class"] = name
        ids[entry["class"]] = number
        label.comes("labels.ids.object", "labelIDVec")
    return {"ids": {"object": ids}} if ids else {}
