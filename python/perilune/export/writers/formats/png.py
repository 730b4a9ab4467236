"""PNG: a folder a channel, colours and names of ids, 16 bits where they are needed."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from perilune.base.colors import id_colors
from perilune.document.references import MASKS, OBJECTS
from perilune.export.writers.bop_files import MM_PER_M, depth_scale_mm, encode_depth
from perilune.export.writers.formats.base import Array, Encoded, Files, Format, Frame, Info, Record
from perilune.export.writers.formats.channels import STACK, Channel
from perilune.export.writers.formats.pixels import IDS, fits_png, from_png, ids_image, png
from perilune.simulation import Simulation

_LENGTHS = ("depth", "range")
"""Channels of lengths, which are 16 bits in steps of a frame's own scale."""
_ON = np.uint8(255)
LEGEND = "legend.json"


def _levels(info: Info) -> list[tuple[str, Mapping[str, str]]]:
    """Folder and names of each level of `semantic`."""
    return [(f"semantic/{row['level']}", row["names"]) for row in info["labels"]["semantic"]]


class Png(Format):
    """Pictures of every channel that has values for a PNG."""

    name = "png"
    doc = "a folder of PNG a channel; ids with a palette and a legend, depth in 16 bits"
    layout = (
        "`CHANNEL/NNNNNN.png`; `semantic/LEVEL/`, and `masks/NNNNNN_KKK.png` for each object; "
        "ids below 256 have a palette, others 16 bits; `depth` and `range` are 16 bits, times "
        "`labels.metres_per_step` of the frame's record, 0 for nothing; `legend.json` names ids "
        "and their colours"
    )
    reader = "Pillow (OpenCV shows the colours of a palette, not its ids)"

    def holds(self, channel: Channel) -> bool:
        """Pictures and ids, masks, depth and range."""
        return fits_png(channel) or channel.kind == STACK or channel.name in (*IDS, *_LENGTHS)

    def begin(self, sim: Simulation, info: Info) -> Files:
        """The legend."""
        named = dict(info.get("labels", {}))
        if "semantic" in named:
            levels = named.pop("semantic")
            named |= {f"semantic/{row['level']}": row["names"] for row in levels}
        legend = {
            channel: {
                number: {"name": name, "rgb": id_colors(np.array([int(number)]))[0].tolist()}
                for number, name in names.items()
            }
            for channel, names in named.items()
        }
        return {LEGEND: (json.dumps(legend, indent=1, sort_keys=True) + "\n").encode("utf-8")}

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """A file a channel, a level and an object."""
        files: Files = {}
        steps: dict[str, float] = {}
        for name, array in frame.arrays.items():
            path = f"{name}/{frame.key}.png"
            if name == "semantic":
                for k, (folder, names) in enumerate(_levels(info)):
                    files[f"{folder}/{frame.key}.png"] = ids_image(array[:, :, k], names)
            elif name in IDS:
                files[path] = ids_image(array, info["labels"][name])
            elif name == MASKS:
                for k, mask in enumerate(array):
                    data = png(np.where(mask != 0, _ON, np.uint8(0)))
                    files[f"{name}/{frame.key}_{k:03d}.png"] = data
            elif name in _LENGTHS:
                files[path], steps[name] = _lengths(array)
            elif name != OBJECTS:
                files[path] = png(array)
        return Encoded(files, {"metres_per_step": steps} if steps else None)

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """Values of all files; depth and range in metres, rounded to their step."""
        key, found = f"{record['index']:06d}", {}
        for name in info["channels"]:
            path = f"{name}/{key}.png"
            if name == "semantic":
                layers = [from_png(read(f"{folder}/{key}.png")) for folder, _ in _levels(info)]
                found[name] = np.stack(layers, axis=2)
            elif name == MASKS:
                masks = [from_png(read(p)) != 0 for p in record["files"] if p.startswith("masks/")]
                size = (record["camera"]["height"], record["camera"]["width"])
                found[name] = np.stack(masks) if masks else np.zeros((0, *size), dtype=bool)
            elif name in _LENGTHS:
                step = record["labels"]["metres_per_step"][name]
                found[name] = from_png(read(path)) * step
            elif name != OBJECTS:
                found[name] = _layers(from_png(read(path)), info["channels"][name])
        return found


def _layers(values: Array, entry: Mapping[str, Any]) -> Array:
    """The layers of a channel; PNG has no two, and no array of one."""
    if entry["components"] == 1:
        return values[:, :, np.newaxis]
    return values[:, :, :2] if entry["components"] == 2 else values


def _lengths(array: Array) -> tuple[bytes, float]:
    """Lengths, m, as PNG, and the metres of a step. Of the background there are none; nor of what
    has no finite length."""
    known = array[np.isfinite(array)]
    scale_mm = depth_scale_mm(float(known.max(initial=0.0)) * MM_PER_M)
    return png(
        encode_depth(np.where(np.isfinite(array), array, 0.0), scale_mm)
    ), scale_mm / MM_PER_M
