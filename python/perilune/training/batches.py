"""Batches of samples, in NumPy and through torch's collate. torch is imported only on demand."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from perilune.sample import Sample


def _check(samples: Sequence[Sample]) -> None:
    """ValueError for samples that cannot be stacked."""
    if not samples:
        raise ValueError("collate: no samples")
    for k, sample in enumerate(samples):
        if not isinstance(sample, Sample):
            raise TypeError(f"collate: samples[{k}]: must be a perilune.Sample, not {sample!r:.60}")
    first = samples[0]
    for sample in samples:
        if set(sample) != set(first) or sample.has_objects != first.has_objects:
            raise ValueError("collate: the samples hold different channels")
        a, b = first.camera, sample.camera
        if (a.width, a.height) != (b.width, b.height):
            raise ValueError(
                f"collate: images of {a.width} x {a.height} (sensor {a.sensor}) and of "
                f"{b.width} x {b.height} (sensor {b.sensor}) do not stack; batch each sensor by "
                "itself"
            )


def collate(samples: Sequence[Sample], tensors: bool = False) -> dict[str, Any]:
    """Makes a batch: every channel stacked to (N, ...), with K, R_w2c, t_w2c, index and objects.

    K: (N, 3, 3), pixels. R_w2c (N, 3, 3) and t_w2c (N, 3), m: p_camera = R_w2c p_root + t_w2c.
    index: (N,) int64. With sensors, `sensor` lists their names; all images of a batch must have one
    size. objects: a list of structured arrays, one row per spacecraft, because frames may hold
    different numbers.

    tensors: returns torch tensors (perilune.torch.tensors) instead: labels as int64, and `objects`
    as a mapping of tensors (N, most objects, ...), padded with zeros, where `valid` marks the
    objects. Images stay (N, height, width, channels). As a DataLoader's collate_fn:
    functools.partial(perilune.collate, tensors=True); torch's own collate does the same with
    samples."""
    _check(samples)
    first = samples[0]
    if tensors:
        from perilune.training.tensors import stacked

        return stacked(samples)
    batch: dict[str, Any] = {name: np.stack([s[name] for s in samples]) for name in first}
    batch["K"] = np.stack([s.camera.K for s in samples])
    batch["R_w2c"] = np.stack([s.camera.R_w2c for s in samples])
    batch["t_w2c"] = np.stack([s.camera.t_w2c for s in samples])
    batch["index"] = np.array([s.meta["index"] for s in samples], dtype=np.int64)
    if any(s.camera.sensor is not None for s in samples):
        batch["sensor"] = [s.camera.sensor for s in samples]
    if first.has_objects:
        batch["objects"] = [s.objects for s in samples]
    return batch


def tell_torch() -> None:
    """Registers samples, with their objects, with torch's default collate, if torch is imported."""
    module = sys.modules.get("torch.utils.data._utils.collate")
    known = getattr(module, "default_collate_fn_map", None)
    if known is not None and Sample not in known:
        known[Sample] = _collate_for_torch


def _collate_for_torch(batch: Sequence[Sample], *, collate_fn_map: Any = None) -> dict[str, Any]:
    return collate(batch, tensors=True)
