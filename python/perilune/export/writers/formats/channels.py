"""What the channels of a dataset are: the one place that formats learn of a new channel from."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from perilune import _core
from perilune.document.references import HIERARCHY, KEYPOINTS, MASKS, OBJECTS
from perilune.export.writers.bop_channels import TABLES
from perilune.export.writers.scans import is_scan, scan_doc, scan_names
from perilune.frame.craters import bodies_with
from perilune.frame.request import channel_layout
from perilune.simulation import Simulation

IMAGE, STACK, TABLE = "image", "masks", "table"
"""Kinds of channels: a value, or some, a pixel; a mask for each object; rows with named fields."""
COLOR = ("rgb", "sensor_rgb")
"""Channels that are pictures in 8 bits."""


@dataclass(frozen=True)
class Channel:
    """A channel of a dataset, as dataset_info.json has it."""

    name: str
    kind: str
    dtype: str
    """NumPy name of the type of its values; "table" for rows with named fields."""
    components: int | None = 0
    """Values a pixel; 0: a plain image; None: differs between sensors."""
    unit: str = ""
    doc: str = ""

    @property
    def is_integer(self) -> bool:
        """Whether its values are integers."""
        return self.kind == STACK or (self.kind == IMAGE and np.dtype(self.dtype).kind in "iub")

    def entry(self) -> dict[str, Any]:
        """Entry in dataset_info.json."""
        return {key: value for key, value in asdict(self).items() if key != "name"}


def _image(sim: Simulation, name: str, row: Any) -> Channel:
    counts, dtypes = set(), set()
    for camera in sim.config.cameras.values():
        shape, dtype = channel_layout(sim.config.model_copy(update={"camera": camera}), name)
        counts.add(shape[2] if len(shape) == 3 else 0)
        dtypes.add(dtype.name)
    components = counts.pop() if len(counts) == 1 else None
    return Channel(name, IMAGE, dtypes.pop(), components, row["unit"], row["doc"])


def described(sim: Simulation, names: list[str]) -> dict[str, Channel]:
    """Channels by name, in the core's order, and the tables that go with them."""
    rows = {row["name"]: row for row in _core.CHANNELS}
    found = {name: _image(sim, name, row) for name, row in rows.items() if name in names}
    if OBJECTS in names:
        doc = "pose, boxes and visibility of each object"
        found[OBJECTS] = Channel(OBJECTS, TABLE, "table", 0, "", doc)
    if KEYPOINTS in names:
        doc = "keypoints of spacecraft and landmarks of bodies"
        found[KEYPOINTS] = Channel(KEYPOINTS, TABLE, "table", 0, "", doc)
    if HIERARCHY in names:
        doc = "pose, boxes and visibility of spacecraft, their nodes and parts, as a tree"
        found[HIERARCHY] = Channel(HIERARCHY, TABLE, "table", 0, "", doc)
    if MASKS in names:
        doc = "whole silhouette of each object"
        found[MASKS] = Channel(MASKS, STACK, "bool", 0, "", doc)
    for name in filter(is_scan, names):
        found[name] = Channel(name, TABLE, "table", 0, "", scan_doc(name))
    for table, (channel, *_) in TABLES.items():
        if channel in found and bodies_with(sim.config, table):
            found[table] = Channel(table, TABLE, "table", 0, "", f"{table} of the frame")
    return found


def asked_channels(sim: Simulation) -> tuple[list[str], bool]:
    """The channels of the configuration, and whether it states them."""
    render = sim.config.render
    return list(render.channels), "channels" in render.model_fields_set


def asked_scans(sim: Simulation) -> list[str]:
    """The tables of measurements that the configuration asks for."""
    return scan_names(sim.config, sim.document.source)
