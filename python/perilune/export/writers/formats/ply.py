"""PLY: clouds of points of LiDARs and of pixels, as tools for point clouds read them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from perilune.config.errors import ConfigError
from perilune.export.writers.formats.base import Array, Encoded, Format, Frame, Info, Record
from perilune.export.writers.formats.channels import Channel
from perilune.export.writers.scans import LIDAR, POINTS, is_cloud
from perilune.simulation import Simulation

_TYPES = {"f4": "float", "f8": "double", "i4": "int", "u4": "uint", "u2": "ushort", "u1": "uchar"}
_TYPES |= {"i2": "short", "i1": "char"}
"""NumPy type -> PLY's; wider integers become doubles."""
_PLACES = ("x", "y", "z")
_NORMAL = ("nx", "ny", "nz")
_COLOUR = ("red", "green", "blue")


def _columns(table: Array, levels: list[str]) -> Iterator[tuple[str, Array]]:
    """Properties of a cloud: place first, in camera axes or those of the LiDAR; then all fields,
    vectors by component."""
    names = table.dtype.names or ()
    if POINTS_FIELD in names:
        place = table[POINTS_FIELD]
    else:
        place = table["range_m"][:, np.newaxis] * table["sensor_direction"]
    for k, axis in enumerate(_PLACES):
        yield axis, place[:, k].astype(np.float32)
    for name in names:
        column = table[name]
        if name == POINTS_FIELD:
            continue
        if column.ndim == 1:
            yield name, column
            continue
        given = {"normal": _NORMAL, "rgb": _COLOUR, "semantic": [f"semantic_{v}" for v in levels]}
        parts = given.get(name, [f"{name}_{axis}" for axis in _PLACES])
        for k, part in enumerate(parts):
            yield part, column[:, k]


POINTS_FIELD = "camera_m"
"""Field of the table `points` with the places in camera axes."""


def _ascii(text: str) -> str:
    """A property's name: one word of ASCII."""
    return "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in text)


def encode_cloud(table: Array, levels: list[str], comment: str) -> bytes:
    """A table of points as binary PLY, little endian."""
    columns = [(_ascii(name), column) for name, column in _columns(table, levels)]
    kinds = []
    for name, column in columns:
        code = column.dtype.str[1:]
        kinds.append((name, f"<{code}" if code in _TYPES else "<f8"))
    rows = np.empty(len(table), dtype=np.dtype(kinds))
    for (name, _), (_, column) in zip(kinds, columns, strict=True):
        rows[name] = column
    head = ["ply", "format binary_little_endian 1.0", f"comment {comment}"]
    head.append(f"element vertex {len(rows)}")
    head += [f"property {_TYPES[kind[1:]]} {name}" for name, kind in kinds]
    return "\n".join([*head, "end_header"]).encode("ascii") + b"\n" + rows.tobytes()


def decode_cloud(data: bytes) -> Array:
    """The properties of a cloud that `encode_cloud` has written; ValueError for a damaged file."""
    head, mark, body = data.partition(b"end_header\n")
    words = [line.split() for line in head.decode("ascii").splitlines()]
    codes = {name: f"<{code}" for code, name in _TYPES.items()}
    counts = [int(line[2]) for line in words if line[:2] == ["element", "vertex"]]
    kinds = [(line[2], codes[line[1]]) for line in words if line[0] == "property"]
    if not mark or len(counts) != 1 or len(body) != counts[0] * np.dtype(kinds).itemsize:
        raise ValueError("is no PLY of points, or cut")
    return np.frombuffer(body, dtype=np.dtype(kinds))


class Ply(Format):
    """A file a cloud."""

    name = "ply"
    doc = "PLY: a cloud of points for each LiDAR and for the pixels (render.scans)"
    layout = (
        "`lidar_NAME/NNNNNN.ply` and `points/NNNNNN.ply`: binary, little endian; x, y, z are "
        "metres in the axes of the LiDAR as each beam leaves, or of the camera, then all fields "
        "of the tables, vectors by component, `semantic_LEVEL` for each level"
    )
    reader = "plyfile, Open3D, CloudCompare, MeshLab, PCL"
    needs = ("objects",)

    def holds(self, channel: Channel) -> bool:
        """Points."""
        return is_cloud(channel.name)

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """The levels of `semantic`."""
        if not {LIDAR, POINTS} & set(sim.config.render.scans):
            raise ConfigError(
                f"{sim.document.source}: render.scans: the format 'ply' holds clouds of points; "
                "name `points` or `lidar`"
            )
        return {"levels": list(sim.config.labels.levels)}

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The clouds."""
        axes = {name: "camera" if name == POINTS else "sensor" for name in frame.arrays}
        return Encoded(
            {
                f"{name}/{frame.key}.ply": encode_cloud(
                    table, info["levels"], f"metres, {axes[name]} axes: x right, y down, z forward"
                )
                for name, table in frame.arrays.items()
                if is_cloud(name)
            }
        )

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """Tables with the properties of the files for fields."""
        return {name.split("/")[0]: decode_cloud(read(name)) for name in record["files"]}
