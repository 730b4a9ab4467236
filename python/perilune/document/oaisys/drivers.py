"""`material_drivers`: for the graphs on a mesh, or, at the top of the file, for all graphs.

Graphs use Perilune's keys: `materials` at the top of the file, and keys of a mesh that assign them:
`materials`, uses as in a spacecraft, or `material` of a body, a name. Graphs in the extras of a
model's materials are driven too."""

from __future__ import annotations

from typing import Any

from perilune.document.oaisys.files import ModelFile, has_graphs
from perilune.document.oaisys.node import Node

_KEY = "material_drivers"
_NUMBERS = ("clip_min", "clip_max", "ideal", "jitter_variance")


def read(owner: Node, why_not: str | None, ours: str = _KEY) -> dict[str, Any]:
    """The section below a mesh, a material or the file, for our key path; empty if there is none.

    why_not: reason to warn that it is not applied."""
    if not owner.has(_KEY):
        return {}
    section = owner.child(_KEY)
    named = section.child("drivers")
    found: dict[str, Any] = {"drivers": {name: _driver(named.child(name)) for name in named.raw}}
    if section.has("jitter_strength"):
        found["jitter_strength"] = section.number("jitter_strength")
    if section.has("step_interval"):
        found["step_interval"] = section.whole("step_interval", smallest=1)
    if why_not is not None:
        for name in named.raw:
            owner.notes.warn(named.where(name), f"not applied: {why_not}")
        return {}
    owner.comes(ours, _KEY)
    for name in named.raw:
        named.comes(f"{ours}.drivers.{name}", name)
    return found


def _driver(node: Node) -> dict[str, Any]:
    low, high, ideal, variance = (node.number(key) for key in _NUMBERS)
    if low > high:
        node.fail("clip_min", f"{low:g} is above clip_max = {high:g}")
    if not low <= ideal <= high:
        node.fail("ideal", f"{ideal:g} is outside [clip_min, clip_max] = [{low:g}, {high:g}]")
    if variance < 0.0:
        node.fail("jitter_variance", f"must not be negative: {variance:g}")
    found = dict(zip(_NUMBERS, (low, high, ideal, variance), strict=True))
    # A key of ours: a file of OAISYS has none for it.
    return {**found, "truncated": True} if node.flag("truncated", False) else found


def read_graphs(root: Node, tree: dict[str, Any]) -> None:
    """Perilune's `materials`, and the drivers of all of them."""
    if root.has("materials"):
        tree["materials"] = root.get("materials")
        root.comes("materials", "materials")
    section = read(root, None if root.has("materials") else "the file has no `materials`")
    if section:
        tree[_KEY] = section


def read_mesh(
    owners: tuple[Node, ...], entry: dict[str, Any], ours: str, file: ModelFile, is_body: bool
) -> None:
    """Graphs of a mesh, with their drivers and those of its model's graphs; keys are in any of
    `owners`."""
    key = "material" if is_body else "materials"
    for owner in owners:
        if owner.has(key):
            entry[key] = owner.get(key)
            owner.comes(f"{ours}.{key}", key)
    if is_body and key in entry:
        entry["material_mode"] = "wrap"  # around the picture, or the colour, that the mesh has
    why: str | None = None
    driven = any(owner.has(_KEY) for owner in owners)
    if driven and key not in entry and (is_body or not has_graphs(file)):
        why = f"no graph is on the mesh; its `{key}` may put one there"
    for owner in owners:
        section = read(owner, why, f"{ours}.{_KEY}")
        if section:
            entry[_KEY] = section
