"""`perilune parts`: the parts of a model, for writing the sections `parts` and `part_classes`."""

from __future__ import annotations

import json
import warnings
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import Any

import numpy as np

from perilune import _core
from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, open_simulation, whole_number
from perilune.cli.text_table import text_table
from perilune.config.errors import ModelWarning, nearest
from perilune.config.parts import Parts
from perilune.frame.labels import part_class
from perilune.spacecraft.model_files import FOREIGN, SUFFIXES, read_model
from perilune.spacecraft.parts import PartEntry, PartExtent, Partition, extents, partition

_MODELS = (*SUFFIXES, *FOREIGN)
_COLUMNS = ("part", "material", "triangles", "min", "max", "class")
_NODE_COLUMNS = ("node", "below", "triangles", "animations")
_RIGHT = {"triangles"}


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    parser.epilog = "CONFIG may also be a model file (.glb, .gltf); then no classes are shown."
    parser.add_argument("--spacecraft", metavar="NAME", help="only this entry (default: all)")
    parser.add_argument(
        "--split",
        choices=("primitive", "node", "component", "none"),
        help="divide like this, without boxes, instead of as in the configuration",
    )
    parser.add_argument(
        "--merge-below",
        type=whole_number(0),
        default=0,
        metavar="N",
        help="with --split component: pieces with fewer triangles form one part",
    )
    parser.add_argument(
        "--nodes",
        action="store_true",
        help="list nodes and animations instead, for `articulation` and `animation`",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _asked(args: Namespace, stated: Parts) -> Parts:
    if args.split is None and args.merge_below:
        raise ValueError("--merge-below: goes with --split component")
    if args.split is None:
        return stated
    return Parts.model_validate({"split": args.split, "merge_below": args.merge_below})


def _row(entry: PartEntry, size: PartExtent, class_name: str | None) -> dict[str, Any]:
    return {
        "part": entry.name,
        "material": entry.material,
        "triangles": size.triangles,
        "min": size.low.tolist() if size.triangles else None,
        "max": size.high.tolist() if size.triangles else None,
        **({} if class_name is None else {"class": class_name}),
    }


def _rows(
    model: _core.Model, cut: Partition, classes: Sequence[str] | None
) -> list[dict[str, Any]]:
    sizes = extents(model, cut)
    names = [None] * len(sizes) if classes is None else classes
    return [_row(*row) for row in zip(cut.entries, sizes, names, strict=True)]


def _node_rows(model: _core.Model) -> list[dict[str, Any]]:
    """Nodes with their own triangles, and the animations that move them."""
    nodes, owner = model.nodes, [part["node"] for part in model.parts]
    counts = np.bincount(model.mesh()["triangle_part"], minlength=len(owner))
    own = [0] * len(nodes)
    for count, at in zip(counts, owner, strict=True):
        if at >= 0:
            own[at] += int(count)
    return [
        {
            "node": node["name"],
            "below": nodes[node["parent"]]["name"] if node["parent"] >= 0 else None,
            "triangles": own[i],
            "animations": [row["name"] for row in model.animations if i in row["nodes"]],
        }
        for i, node in enumerate(nodes)
    ]


def _of_model(args: Namespace) -> dict[str, list[dict[str, Any]]]:
    model = read_model(args.config)
    for line in model.warnings:
        warnings.warn(f"{args.config}: {line}", ModelWarning, stacklevel=2)
    if args.nodes:
        return {args.config: _node_rows(model)}
    return {args.config: _rows(model, partition(model, _asked(args, Parts())), None)}


def _of_config(args: Namespace) -> dict[str, list[dict[str, Any]]]:
    sim = open_simulation(args)
    crafts = sim.config.spacecraft
    if args.spacecraft is not None and args.spacecraft not in crafts:
        raise ValueError(f"no spacecraft '{args.spacecraft}'{nearest(args.spacecraft, crafts)}")
    result = {}
    for name in crafts if args.spacecraft is None else [args.spacecraft]:
        model, settings = sim.models[name].model, _asked(args, crafts[name].parts)
        if args.nodes:
            result[name] = _node_rows(model)
            continue
        cut = partition(model, settings, f"{args.config}:\n  spacecraft.{name}.parts")
        classes = [part_class(sim.config, crafts[name], entry) for entry in cut.entries]
        result[name] = _rows(model, cut, classes)
    return result


def _cell(value: Any) -> str:
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        return ", ".join(value) or "-"
    if isinstance(value, list):
        return "[" + ", ".join(f"{np.float64(number):.4g}" for number in value) + "]"
    return "-" if value is None else str(value)


def _table(rows: Sequence[dict[str, Any]]) -> str:
    columns = _NODE_COLUMNS if rows and "node" in rows[0] else _COLUMNS
    names = [name for name in columns if not rows or name in rows[0]]
    cells = [[_cell(row[name]) for name in names] for row in rows]
    return text_table(names, cells, [name for name in names if name in _RIGHT])


def _run(args: Namespace) -> int:
    found = (_of_model if args.config.lower().endswith(_MODELS) else _of_config)(args)
    if args.json:
        print(json.dumps(found, indent=2))
        return OK
    what = "nodes" if args.nodes else "parts"
    blocks = [f"{name}: {len(rows)} {what}\n{_table(rows)}" for name, rows in found.items()]
    print("\n\n".join(blocks) if blocks else "no spacecraft")
    return OK


PARTS = Command("parts", "lists the parts of models, their sizes and classes", _configure, _run)
