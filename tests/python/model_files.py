"""Copies of our small satellite whose materials have extras."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

SATELLITE = Path(__file__).parents[2] / "assets" / "models" / "smallsat.glb"


def changed_glb(path: Path, change: Callable[[dict[str, Any]], None]) -> Path:
    """The satellite with its JSON changed, written to `path`."""
    data = SATELLITE.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + length])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + data[20 + length :]
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def with_graphs(path: Path, **graphs: Any) -> Path:
    """The satellite with graphs in the materials of these names."""

    def change(tree: dict[str, Any]) -> None:
        for material in tree["materials"]:
            if material["name"] in graphs:
                material["extras"] = {"perilune_graph": graphs[material["name"]], "mine": 1}

    return changed_glb(path, change)
