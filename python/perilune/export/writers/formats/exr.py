"""OpenEXR: a file a frame with a layer a channel, in half, single precision or 32-bit integers."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar

import numpy as np

from perilune import _core
from perilune.document.references import MASKS, OBJECTS
from perilune.export.writers.formats.base import Array, Encoded, Format, Frame, Info, Record
from perilune.export.writers.formats.channels import IMAGE, STACK, Channel
from perilune.export.writers.formats.info import channels_of

_VECTORS = ("normal", "geometric_normal", "object_coords", "position")
_ONE = {"depth": "Z", "range": "Z"}
"""Component of channels with one value a pixel; others have V."""


def component_names(info: Info, name: str, count: int) -> list[str]:
    """Names of a channel's planes: LAYER.COMPONENT, as viewers group them."""
    if name == "radiance":
        return ["R", "G", "B"][:count]  # the picture that viewers show
    if name == "semantic":
        return [f"{name}.{row['level']}" for row in info["labels"][name]]
    if count == 0:
        return [f"{name}.{_ONE.get(name, 'V')}"]
    letters = "XYZ" if name in _VECTORS else "RGBA" if count in (3, 4) else ""
    return [f"{name}.{letters[k] if letters else k}" for k in range(count)]


def plane_type(dtype: str) -> Any:
    """Type of a channel's planes: that of all values without a loss; None if there is none."""
    kind = np.dtype(dtype)
    if kind in (np.float32, np.float16):
        return kind
    if kind in (np.uint8, np.bool_):
        return np.dtype(np.float16)  # holds whole numbers to 2048
    return np.dtype(np.uint32) if kind in (np.uint16, np.uint32, np.int32) else None


class Exr(Format):
    """All layers without a loss."""

    name = "exr"
    doc = "a multi-layer OpenEXR file a frame, without a loss"
    layout = (
        "`NNNNNN.exr`: `radiance` is R, G, B, other channels are layers (`depth.Z`, `normal.X`, "
        "`instance.V`, `semantic.LEVEL`, `masks.NAME`); values of 8 bits are half, larger ids "
        "32-bit unsigned, all else 32-bit floats; the header's `perilune` is the frame's record"
    )
    reader = "OpenEXR, and most viewers of pictures"
    floats: ClassVar[Any] = np.dtype(np.float32)

    def holds(self, channel: Channel) -> bool:
        """Images of at most 32 bits, and masks."""
        return channel.kind == STACK or (
            channel.kind == IMAGE and plane_type(channel.dtype) is not None
        )

    def planes(self, info: Info, frame: Frame) -> Iterator[tuple[str, Array]]:
        """Name and values of all planes."""
        for name, array in frame.arrays.items():
            if name == OBJECTS:
                continue
            if name == MASKS:
                names = [row["name"] for row in frame.record["objects"]]
                for of, mask in zip(names, array, strict=True):
                    yield f"{name}.{of}", (mask != 0).astype(np.float16)
                continue
            to = plane_type(array.dtype.name)
            to = self.floats if to == np.float32 else to
            with np.errstate(over="ignore"):  # half ends at 65504: beyond is infinite
                values = np.where(array < 0, 0, array) if to == np.uint32 else array
                planes = values.astype(to)
            if planes.ndim == 2:
                yield component_names(info, name, 0)[0], planes
                continue
            for k, plane in enumerate(component_names(info, name, planes.shape[2])):
                yield plane, planes[:, :, k]

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The file."""
        text = json.dumps(frame.record, sort_keys=True)
        data = _core.exr_encode(list(self.planes(info, frame)), text)
        return Encoded({f"{frame.key}.exr": data})

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """All channels; floats in the precision of the file, where half has its largest number
        for what is beyond."""
        (file,) = record["files"]
        planes = _core.exr_decode(read(file), file)
        found = {}
        for name, channel in channels_of(info).items():
            if channel.kind == STACK:
                size = (record["camera"]["height"], record["camera"]["width"])
                masks = [planes[f"{name}.{row['name']}"] != 0 for row in record["objects"]]
                found[name] = np.stack(masks) if masks else np.zeros((0, *size), dtype=bool)
            elif channel.kind == IMAGE:
                found[name] = _restored(planes, info, channel)
        return found


def _restored(planes: Mapping[str, Array], info: Info, channel: Channel) -> Array:
    """A channel from its planes."""
    count = channel.components
    if count is None:  # differs between sensors
        own = sum(plane.startswith(f"{channel.name}.") for plane in planes)
        plain = f"{channel.name}.V" in planes
        count = 0 if plain else own
    names = component_names(info, channel.name, count)
    values = planes[names[0]] if count == 0 else np.stack([planes[n] for n in names], axis=2)
    if channel.is_integer:
        return values.astype(channel.dtype)
    if values.dtype == np.float16:
        largest = np.finfo(np.float16).max
        return np.clip(values, -largest, largest)
    return values


class ExrHalf(Exr):
    """The same in half precision."""

    name = "exr-half"
    doc = "the same with all floats in half precision (11 bits, up to 65504)"
    layout = Exr.layout.replace("32-bit floats", "half, of which values beyond 65504 are infinite")
    floats = np.dtype(np.float16)
