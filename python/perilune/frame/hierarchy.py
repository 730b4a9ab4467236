"""Instances in a hierarchy: spacecraft, the nodes of their models, and parts, with a label each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.spacecraft.articulation import Rig
from perilune.spacecraft.parts import Partition

F64 = NDArray[np.float64]
Array = NDArray[Any]

SPACECRAFT, NODE, PART = "spacecraft", "node", "part"
"""Kinds of rows."""
_TOLD = (
    "visib_fract",
    "bbox_visib",
    "bbox_obj",
    "px_count_visib",
    "px_count_all",
    "px_count_valid",
)
"""Fields that are those of the core's labels."""


@dataclass(frozen=True)
class _Row:
    """A row but for what a frame says of it."""

    name: str
    kind: str
    parent: int
    """Number of the row above, from 0 on; -1: none."""
    part: int
    """Number of the part among those of the spacecraft; -1: it is none."""
    node: int
    """Node of the model whose frame the row has; -1: that of the spacecraft."""
    parts: NDArray[np.uint8]
    """(parts,): 1 for those that belong to it."""


def _above(parents: Sequence[int], node: int) -> list[int]:
    """A node and all above it, the root first."""
    chain: list[int] = []
    while node >= 0:
        chain.insert(0, node)
        node = parents[node]
    return chain


def _common(chains: Sequence[Sequence[int]]) -> int:
    """The lowest node that all chains have; -1 without one."""
    found = -1
    for level in zip(*chains, strict=False):
        if len(set(level)) > 1:
            break
        found = level[0]
    return found


def _node_of_parts(model: _core.Model, cut: Partition) -> list[int]:
    """The lowest node above all triangles of each part."""
    own, parents = model.parts, [row["parent"] for row in model.nodes]
    chains = [_above(parents, row["node"]) for row in own]
    if cut.triangle_part is None:
        return [chain[-1] if chain else -1 for chain in chains]
    of = np.stack([cut.triangle_part.astype(np.int64),
                   model.mesh()["triangle_part"].astype(np.int64)], axis=1)  # fmt: skip
    pairs = np.unique(of, axis=0)
    return [
        _common([chains[number] for number in pairs[pairs[:, 0] == part, 1]])
        for part in range(len(cut.entries))
    ]


def _rows(name: str, model: _core.Model, cut: Partition) -> list[_Row]:
    """The rows of a spacecraft, a row before those below it."""
    count = len(cut.entries)
    nodes, lowest = model.nodes, _node_of_parts(model, cut)
    parents = [row["parent"] for row in nodes]
    below: dict[int, list[int]] = {}
    for part, node in enumerate(lowest):
        for at in _above(parents, node):
            below.setdefault(at, []).append(part)

    def flags(parts: Sequence[int]) -> NDArray[np.uint8]:
        return np.isin(np.arange(count), parts).astype(np.uint8)

    rows = [_Row(name, SPACECRAFT, -1, -1, -1, np.ones(count, dtype=np.uint8))]
    number: dict[int, int] = {}

    def add(node: int, parent: int) -> None:
        """A node and what is below it. One that has no part has no row."""
        number[node] = len(rows)
        rows.append(_Row(nodes[node]["name"], NODE, parent, -1, node, flags(below[node])))
        for child in range(len(nodes)):
            if parents[child] == node and child in below:
                add(child, number[node])

    for node in range(len(nodes)):
        if parents[node] < 0 and node in below:
            add(node, 0)
    for part, entry in enumerate(cut.entries):
        node = lowest[part]
        rows.append(_Row(entry.name, PART, number.get(node, 0), part, node, flags([part])))
    return rows


class Hierarchy:
    """All rows of a configuration, spacecraft by spacecraft."""

    def __init__(
        self,
        models: Mapping[str, Any],
        partitions: Mapping[str, Partition],
        rigs: Mapping[str, Rig],
        instances: Mapping[str, int],
        parts: Mapping[str, Sequence[Any]],
    ) -> None:
        """models: perilune.frame.handles.ObjectModel. instances: name -> id. parts: spacecraft ->
        its perilune.frame.labels.Part."""
        self._models, self._rigs = models, rigs
        self._rows = [
            (owner, row)
            for owner, model in models.items()
            for row in _rows(owner, model.model, partitions[owner])
        ]
        texts = [[row.name for _, row in self._rows], [owner for owner, _ in self._rows]]
        wide = [max((len(text) for text in column), default=1) for column in texts]
        labels = {name: (name, *rest) for name, *rest in _core.OBJECT_LABEL}
        kind = [
            ("id", "<i4"),
            ("parent", "<i4"),
            ("name", f"U{wide[0]}"),
            ("object", f"U{wide[1]}"),
            ("kind", "U10"),
            ("instance_id", "<i4"),
            ("part_id", "<i4"),
            *(labels[name] for name in ("R_m2c", "t_m2c", *_TOLD)),
        ]
        self._named = np.zeros(len(self._rows), np.dtype(kind))
        first: dict[str, int] = {}
        for number, (owner, row) in enumerate(self._rows, start=1):
            out = self._named[number - 1]
            start = first.setdefault(owner, number)
            out["id"], out["parent"] = number, 0 if row.parent < 0 else start + row.parent
            out["name"], out["object"], out["kind"] = row.name, owner, row.kind
            out["instance_id"] = instances[owner]
            out["part_id"] = 0 if row.part < 0 else parts[owner][row.part].id

    def request(self) -> tuple[NDArray[np.int32], NDArray[np.uint8]]:
        """What the core is asked: the spacecraft of each row, and flags of its parts."""
        order = {name: k for k, name in enumerate(self._models)}
        objects = np.array([order[owner] for owner, _ in self._rows], dtype=np.int32)
        none = [np.zeros(0, dtype=np.uint8)]
        return objects, np.concatenate([*none, *(row.parts for _, row in self._rows)])

    def empty(self, dtype: np.dtype[Any]) -> Array:
        """An array for the core's labels."""
        return np.zeros(len(self._rows), dtype)

    def table(self, found: Array, scales: Mapping[str, float], moved: Mapping[str, Any]) -> Array:
        """The rows of Sample.hierarchy. found: of the core. scales: metres per model unit. moved:
        as `articulation` of Sample.meta."""
        out = self._named.copy()
        for name in _TOLD:
            out[name] = found[name]
        for k, (owner, row) in enumerate(self._rows):
            R, t = found[k]["R_m2c"], found[k]["t_m2c"]
            motion, origin = self._frame(owner, row.node, scales[owner], moved.get(owner, {}))
            out[k]["R_m2c"] = R @ motion[:3, :3]
            out[k]["t_m2c"] = R @ (motion[:3, :3] @ origin + motion[:3, 3]) + t
        return out

    def _frame(
        self, owner: str, node: int, scale: float, moved: Mapping[str, Any]
    ) -> tuple[F64, F64]:
        """The motion (4, 4) of a node, and its origin (3,) at rest, m, in the object's frame."""
        model, rig = self._models[owner], self._rigs.get(owner)
        if node < 0:
            return np.eye(4), np.zeros(3)
        origin = (np.array(model.model.nodes[node]["origin"]) - model.offset) * scale
        names = {} if rig is None else dict(zip(rig.core.nodes, rig.nodes, strict=True))
        nodes = model.model.nodes
        at = node
        while at >= 0 and at not in names:
            at = nodes[at]["parent"]
        motion = np.eye(4) if at < 0 else np.array(moved[names[at]]["motion"])
        return motion, origin if np.isfinite(origin).all() else np.zeros(3)
