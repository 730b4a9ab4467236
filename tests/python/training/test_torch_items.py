"""Items and batches of the real torch: what its own collate makes of samples and of our tensors."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import torch
from torch.utils import data

import perilune
import perilune.torch as with_torch

CHANNELS = ["rgb", "depth", "semantic", "part", "instance", "masks", "objects"]


def test_items(sim):
    frames = with_torch.Dataset(sim, 3, channels=CHANNELS)
    assert isinstance(frames, data.Dataset)
    item, sample = frames[1], sim.frame(1, CHANNELS)
    assert item["rgb"].shape == (3, 12, 16)
    assert (item["rgb"].numpy() == sample["rgb"].transpose(2, 0, 1)).all()
    assert item["masks"].shape == (1, 12, 16)
    for name in ("semantic", "part", "instance"):
        assert item[name].dtype == torch.int64
    levels = len(sim.config.labels.levels)
    assert item["semantic"].shape == (levels, 12, 16)
    colours = torch.rand(int(item["semantic"].max()) + 1, 3)
    assert colours[item["semantic"][0]].shape == (12, 16, 3)  # what an index is for
    row = sample.objects[0]
    assert np.allclose(item["objects"]["R_m2c"][0], row["R_m2c"], atol=1e-6)
    assert item["objects"]["R_m2c"].dtype == item["K"].dtype == torch.float32
    assert item["t_w2c"].dtype == torch.float64
    assert (item["t_w2c"].numpy() == sample.camera.t_w2c).all()
    assert item["objects"]["bbox_visib"][0].tolist() == row["bbox_visib"].tolist()
    assert int(item["index"]) == 1


def test_options(sim):
    item = with_torch.Dataset(
        sim, 1, channels=["rgb", "objects"], chw=False, max_objects=4, dtype=torch.float64
    )[0]
    assert item["rgb"].shape == (12, 16, 3)
    assert item["objects"]["valid"].tolist() == [True, False, False, False]
    assert item["objects"]["t_m2c"].shape == (4, 3)
    assert (item["objects"]["t_m2c"][1:] == 0).all()
    assert item["objects"]["t_m2c"].dtype == torch.float64
    with pytest.raises(ValueError, match="max_objects = 0: frame 0 has 1 objects"):
        with_torch.Dataset(sim, 1, channels=["objects"], max_objects=0)[0]
    raw = {"camera.sensor": {"preset": "imx174"}}
    dark = sim.with_overrides(raw)
    assert with_torch.tensors(dark.frame(0, ["raw"]))["raw"].dtype == torch.int32


def test_transform_gets_tensors(sim):
    frames = with_torch.Dataset(sim, 1, channels=["rgb"], transform=lambda item: item["rgb"] / 255)
    assert frames[0].dtype == torch.float32


@pytest.mark.parametrize("workers", [0, 2])
def test_default_collate_keeps_objects(sim, workers):
    """Of samples, and of tensors."""
    samples = perilune.Dataset(sim, 4, channels=CHANNELS)
    items = with_torch.Dataset(sim, 4, channels=CHANNELS, chw=False, dtype=torch.float64)
    batches = [
        next(iter(data.DataLoader(frames, batch_size=4, num_workers=workers)))
        for frames in (samples, items)
    ]
    for batch in batches:
        assert batch["rgb"].shape == (4, 12, 16, 3)
        assert batch["objects"]["R_m2c"].shape == (4, 1, 3, 3)
        assert batch["objects"]["valid"].all()
        assert batch["semantic"].dtype == torch.int64
        assert batch["index"].tolist() == [0, 1, 2, 3]
    assert set(batches[0]) == set(batches[1])
    for name, tensor in batches[0].items():
        if name != "objects":
            assert torch.equal(tensor, batches[1][name])
    assert (batches[0]["rgb"][3].numpy() == sim[3]["rgb"]).all()


def test_collate_as_tensors(sim):
    """Poses are tensors; rows that are no objects are said to be none."""
    samples = [sim.frame(i, CHANNELS) for i in range(2)]
    batch = perilune.collate(samples, tensors=True)
    assert batch["objects"]["t_m2c"].shape == (2, 1, 3)
    assert batch["semantic"].dtype == torch.int64
    plain = perilune.collate(samples)
    assert (batch["rgb"].numpy() == plain["rgb"]).all()
    assert (batch["t_w2c"].numpy() == plain["t_w2c"]).all()
    fewer = sim.frame(2, CHANNELS)
    fewer._objects = fewer.objects[:0]
    batch = perilune.collate([*samples, fewer], tensors=True)
    assert batch["objects"]["valid"].tolist() == [[True], [True], [False]]
    with pytest.raises(ValueError, match="different channels"):
        perilune.collate([samples[0], sim.frame(0, [n for n in CHANNELS if n != "objects"])])


def test_memory_can_be_pinned(sim):
    """Without a GPU torch warns and leaves it; what is pinned must be made of tensors and lists."""
    from torch.utils.data._utils import pin_memory

    seen = []

    class Pinned(torch.Tensor):
        @classmethod
        def __torch_function__(cls, function, types, args=(), kwargs=None):
            if function is torch.Tensor.pin_memory:
                seen.append(tuple(args[0].shape))
                return args[0]
            return super().__torch_function__(function, types, args, kwargs or {})

    batch = perilune.collate([sim.frame(i, CHANNELS) for i in range(2)], tensors=True)
    wrapped = {
        name: {n: t.as_subclass(Pinned) for n, t in value.items()}
        if isinstance(value, dict)
        else value.as_subclass(Pinned)
        for name, value in batch.items()
    }
    pin_memory.pin_memory(wrapped)
    assert len(seen) == len(batch) - 1 + len(batch["objects"])


STREAM_FIRST = """
import sys, perilune
stream = perilune.Stream(perilune.open({path!r}, overrides={tiny!r}), channels=["depth"])
assert "torch" not in sys.modules
import torch
from torch.utils.data import DataLoader, IterableDataset
loader = DataLoader(stream, batch_size=2)
print([batch["index"].tolist() for batch, _ in zip(loader, range(2))])
assert isinstance(stream, IterableDataset)
"""


def test_a_stream_that_is_older_than_torch(scene_file):
    tiny = {"camera.width": 16, "camera.height": 12}
    code = STREAM_FIRST.format(path=str(scene_file), tiny=tiny)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "[[0, 1], [2, 3]]"
