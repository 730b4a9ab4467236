"""Samples as torch tensors. Needs torch (the extra `torch`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch.utils import data

from perilune.sample import Sample

Item = dict[str, Any]

_CLASSES = ("semantic", "part", "instance")
_PLANES_FIRST = ("masks",)


def _channel(name: str, array: NDArray[Any], chw: bool) -> torch.Tensor:
    if chw and array.ndim == 3 and name not in _PLANES_FIRST:
        array = np.ascontiguousarray(array.transpose(2, 0, 1))
    if name in _CLASSES:
        array = array.astype(np.int64)
    elif array.dtype == np.uint16:  # which torch can hardly do anything with
        array = array.astype(np.int32)
    return torch.from_numpy(array)


def _objects(rows: NDArray[Any], count: int, dtype: torch.dtype) -> dict[str, torch.Tensor]:
    """A mapping of tensors (count, ...); rows without an object are zero."""
    found: dict[str, torch.Tensor] = {}
    for name in rows.dtype.names or ():
        field = rows[name]
        kind = dtype if field.dtype.kind == "f" else torch.int64
        table = torch.zeros((count, *field.shape[1:]), dtype=kind)
        table[: len(rows)] = torch.from_numpy(np.ascontiguousarray(field)).to(kind)
        found[name] = table
    found["valid"] = torch.arange(count) < len(rows)
    return found


def tensors(
    sample: Sample,
    *,
    chw: bool = True,
    max_objects: int | None = None,
    dtype: torch.dtype = torch.float32,
) -> Item:
    """Converts a sample to the mapping of tensors that perilune.torch describes.

    chw: images as (channels, height, width). max_objects: number of rows of the objects' tensors
    (default: the number of spacecraft). dtype: type of K and of floating-point values of objects.
    R_w2c and t_w2c are always float64, because float32 is off by metres at the distance of the
    Moon. Raises ValueError for more than max_objects objects."""
    camera = sample.camera
    item: Item = {name: _channel(name, array, chw) for name, array in sample.items()}
    item["K"] = torch.tensor(camera.K, dtype=dtype)
    item["R_w2c"] = torch.tensor(camera.R_w2c, dtype=torch.float64)
    item["t_w2c"] = torch.tensor(camera.t_w2c, dtype=torch.float64)
    item["index"] = torch.tensor(sample.meta["index"], dtype=torch.int64)
    if camera.sensor is not None:
        item["sensor"] = camera.sensor
    if sample.has_objects:
        count = len(sample.objects) if max_objects is None else max_objects
        if len(sample.objects) > count:
            text = f"frame {sample.meta['index']} has {len(sample.objects)} objects"
            raise ValueError(f"max_objects = {max_objects}: {text}")
        item["objects"] = _objects(sample.objects, count, dtype)
    return item


def stacked(samples: Sequence[Sample]) -> Item:
    """A batch of samples: perilune.collate with tensors=True, in full precision."""
    most = max(len(s.objects) if s.has_objects else 0 for s in samples)
    items = [tensors(s, chw=False, max_objects=most, dtype=torch.float64) for s in samples]
    batch: Item = data.default_collate(items)
    return batch
