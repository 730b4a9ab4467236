"""Channels in addition to BOP's: a folder each in every scene, with names of the ids.

A channel of ids of craters or rocks has their table beside it: NPY, an array with named fields.
Integers with up to three layers are PNG with the ids as values: 8 bit if all fit, else 16 bit. Two
or three layers are red, green and blue, 8 bit; blue is 0 for two. All others are NPY with the array
of the sample."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.camera import bands
from perilune.document.references import HIERARCHY, MASKS, OBJECTS, SENSOR_PICTURES
from perilune.export.writers.bop_files import RGB_FOLDER
from perilune.export.writers.files import PNG_LEVEL, npy_parts, write_bytes
from perilune.export.writers.scans import scan_names
from perilune.export.writers.shown import main_picture
from perilune.frame.craters import bodies_with
from perilune.frame.labels import VALUES
from perilune.frame.request import channel_layout
from perilune.simulation import Simulation

Array = NDArray[Any]

PNG, NPY = "png", "npy"
_LARGEST_8, _LARGEST_16 = 255, 65535
_OF_BOP = {"rgb", "depth", OBJECTS, MASKS}
"""Channels that a BOP dataset always has."""
TABLES = {"craters": ("crater_id", "position"), "rocks": ("rock_id",)}
"""Table of an image -> the channel that it is written with, and others that it takes."""
_NAMED = ("semantic", "part", "instance")
"""Channels of ids that the taxonomy names. Those of rocks are too large for PNG."""


@dataclass(frozen=True)
class ChannelFiles:
    """File format of a channel."""

    suffix: str
    """png or npy."""
    dtype: str
    """NumPy name of the type of the values in the file; "table": an array with named fields."""
    components: int | None
    """Values per pixel; 0: a plain image; None: differs between sensors."""

    def entry(self) -> dict[str, Any]:
        """Entry in dataset_info.json."""
        return {"components": self.components, "dtype": self.dtype, "file": self.suffix}

    def write(self, path: Path, array: Array) -> None:
        """Writes a sample's channel, completely or not at all. Recording the image flushes it to
        the disk."""
        if self.suffix == NPY:
            write_bytes(path, npy_parts(array), sync=False)
        else:
            _core.png_write(str(path), self.picture(array), PNG_LEVEL)

    def picture(self, array: Array) -> Array:
        """The pixels of the PNG of a sample's channel."""
        values = array.astype(self.dtype)
        layers = values.shape[2] if values.ndim == 3 else 0
        if layers == 1:
            return np.ascontiguousarray(values[:, :, 0])
        if layers == 2:
            return np.concatenate([values, np.zeros_like(values[:, :, :1])], axis=2)
        return values


def pictures(sim: Simulation) -> dict[str, str]:
    """Folder -> channel of the images other than labels, by the configuration's channels.

    `rgb`, the folder for training, holds `sensor_rgb` if that is requested and `rgb` is not. Other
    channels of the sensor have a folder of their own name."""
    asked = sim.config.render.channels
    main = main_picture(sim)
    others = [name for name in SENSOR_PICTURES if name in asked and name != main]
    shown = {RGB_FOLDER: main} | {name: name for name in others}
    return {folder: name for folder, name in shown.items() if name != "raw" or not _planes(sim)}


def channel_files(sim: Simulation) -> dict[str, ChannelFiles]:
    """Channel, which is also its folder -> file format, for channels in addition to BOP's, in the
    core's order.

    These are the channels in render.channels that are neither BOP's nor in `pictures`; none if the
    configuration leaves render.channels at its default."""
    render = sim.config.render
    if "channels" not in render.model_fields_set:
        return {}
    held = _OF_BOP | set(pictures(sim).values())
    names = [row["name"] for row in _core.CHANNELS]
    found = {
        name: _files_of(sim, name) for name in names if name in render.channels and name not in held
    }
    if HIERARCHY in render.channels:
        found[HIERARCHY] = ChannelFiles(NPY, "table", 0)
    for table, (channel, *_) in TABLES.items():
        if channel in found and bodies_with(sim.config, table):
            found[table] = ChannelFiles(NPY, "table", 0)
    return found


def scan_files(sim: Simulation) -> dict[str, ChannelFiles]:
    """The same for the tables of render.scans."""
    names = scan_names(sim.config, sim.document.source)
    return {name: ChannelFiles(NPY, "table", 0) for name in names}


def label_names(sim: Simulation, channels: Iterable[str]) -> dict[str, Any]:
    """Names of the ids of written channels: {"instance": {"0": "background", ..}, "part": ..,
    "semantic": [{"level": "kind", "names": {..}}, ..]}."""

    def names_of(channel: str) -> dict[str, str]:
        return {str(number): name for number, name in sim.taxonomy.names(channel).items()}

    found: dict[str, Any] = {}
    for channel in channels:
        if channel == "semantic":
            levels = sim.taxonomy.levels
            found[channel] = [{"level": level, "names": names_of(level)} for level in levels]
        elif channel in ("instance", "coverage_instance", "part"):
            found[channel] = names_of(channel)
        elif channel in VALUES:
            found[channel] = {str(value): name for value, name in VALUES[channel].items()}
    return found


def _planes(sim: Simulation) -> bool:
    return any(bands.has_planes(camera) for camera in sim.config.cameras.values())


def _largest_id(sim: Simulation, name: str) -> int:
    taxonomy = sim.taxonomy
    channels = taxonomy.levels if name == "semantic" else (name,)
    return max(max(taxonomy.names(channel)) for channel in channels)


def _files_of(sim: Simulation, name: str) -> ChannelFiles:
    config = sim.config
    counts = set()
    for camera in config.cameras.values():
        shape, dtype = channel_layout(config.model_copy(update={"camera": camera}), name)
        counts.add(shape[2] if len(shape) == 3 else 0)
    components = counts.pop() if len(counts) == 1 else None
    if dtype == np.uint8 and name not in SENSOR_PICTURES and components == 0:
        return ChannelFiles(PNG, dtype.name, 0)
    if name in _NAMED and components in range(4):
        largest = _largest_id(sim, name)
        if largest <= _LARGEST_8:
            return ChannelFiles(PNG, "uint8", 0 if components == 1 else 3 if components else 0)
        if largest <= _LARGEST_16 and components in (0, 1):
            return ChannelFiles(PNG, "uint16", 0)
    return ChannelFiles(NPY, dtype.name, components)
