"""Dataset, Stream and batches; torch's DataLoader is stood in for by what they rely on of it."""

from __future__ import annotations

import itertools
import pickle
import sys
import types
from abc import ABC
from collections.abc import Mapping

import numpy as np
import pytest

import perilune
from perilune import dataset

TINY = {"camera.width": 16, "camera.height": 12, "render.samples": 1}
CHANNELS = ["rgb", "depth", "objects"]


@pytest.fixture(scope="module")
def sim(request):
    return perilune.open(request.config.rootpath / "tests/python/scene.yaml", overrides=TINY)


def indices(stream, count):
    return [sample.meta["index"] for sample in itertools.islice(stream, count)]


def same(a, b):
    return all((a[name] == b[name]).all() for name in a) and set(a) == set(b)


def test_dataset(sim):
    frames = perilune.Dataset(sim, length=5, start=2, channels=CHANNELS)
    assert len(frames) == 5
    assert [frames[i].meta["index"] for i in (0, 4, -1, -5)] == [2, 6, 6, 2]
    assert same(frames[1], sim.frame(3, channels=CHANNELS))
    for index in (5, -6):
        with pytest.raises(IndexError, match=f"index {index} of a dataset of 5"):
            frames[index]
    assert [s.meta["index"] for s in frames] == [2, 3, 4, 5, 6]  # the old iteration protocol
    again = pickle.loads(pickle.dumps(frames))
    assert same(again[0], frames[0])


def test_dataset_opens_configurations(request):
    path = request.config.rootpath / "tests/python/scene.yaml"
    assert perilune.Dataset(path, 3, seed=11).simulation.config.seed == 11
    assert perilune.Dataset(str(path), 3).simulation.config.seed == 7


def test_transform(sim):
    means = perilune.Dataset(
        sim, 3, channels=["depth"], transform=lambda s: float(s["depth"].max())
    )
    assert means[1] == float(sim[1]["depth"].max())


def test_stream(sim):
    stream = perilune.Stream(sim, start=3, channels=CHANNELS)
    first = next(iter(stream))
    assert first.meta["index"] == 3
    assert same(first, sim.frame(3, channels=CHANNELS))
    assert indices(stream, 3) == [4, 5, 6]  # goes on where it stands


@pytest.mark.parametrize("count", [1, 2, 3])
def test_shards_cover_every_frame_once(sim, count):
    streams = [
        perilune.Stream(sim, start=5, shard=(k, count), channels=["depth"]) for k in range(count)
    ]
    found = [index for stream in streams for index in indices(stream, 12 // count)]
    assert sorted(found) == list(range(5, 17))


def test_stream_resumes(sim):
    stream = perilune.Stream(sim, start=1, shard=(1, 2), channels=["depth"])
    assert indices(stream, 3) == [2, 4, 6]
    state = pickle.loads(pickle.dumps(stream.state_dict()))
    resumed = perilune.Stream(sim, start=1, shard=(1, 2), channels=["depth"])
    resumed.load_state_dict(state)
    assert indices(resumed, 2) == indices(stream, 2) == [8, 10]
    for other in (
        perilune.Stream(sim, start=2, shard=(1, 2)),
        perilune.Stream(sim, start=1, shard=(0, 2)),
        perilune.Stream(sim, start=1),
    ):
        with pytest.raises(ValueError, match="state of another stream"):
            other.load_state_dict(state)


class FakeIterableDataset(ABC):  # noqa: B024 (stands for torch's, whose metaclass is ABCMeta too)
    pass


@pytest.fixture
def fake_torch(monkeypatch):
    """A torch.utils.data with a settable worker, as DataLoader gives it to its workers."""
    data = types.ModuleType("torch.utils.data")
    data.info = None
    data.get_worker_info = lambda: data.info
    data.IterableDataset = FakeIterableDataset
    monkeypatch.setitem(sys.modules, "torch.utils.data", data)
    return data


def test_workers_share_the_frames(sim, fake_torch):
    found = []
    for worker in range(3):
        for part in range(2):
            fake_torch.info = types.SimpleNamespace(id=worker, num_workers=3)
            stream = perilune.Stream(sim, start=4, shard=(part, 2), channels=["depth"])
            assert isinstance(stream, FakeIterableDataset)
            found += indices(stream, 2)
    assert sorted(found) == list(range(4, 16))


def test_workers_share_the_processors(monkeypatch, fake_torch):
    monkeypatch.setattr(dataset, "default_threads", lambda: 8)
    assert dataset._threads(None) == 8
    fake_torch.info = types.SimpleNamespace(id=0, num_workers=3)
    assert dataset._threads(None) == 2
    assert dataset._threads(5) == 5


def test_collate(sim):
    samples = [sim.frame(i, channels=CHANNELS) for i in range(3)]
    batch = perilune.collate(samples)
    assert batch["rgb"].shape == (3, 12, 16, 3)
    assert (batch["depth"][2] == samples[2]["depth"]).all()
    assert batch["K"].shape == batch["R_w2c"].shape == (3, 3, 3)
    assert batch["t_w2c"].shape == (3, 3)
    assert batch["index"].tolist() == [0, 1, 2]
    assert [len(rows) for rows in batch["objects"]] == [1, 1, 1]
    assert "objects" not in perilune.collate([sim.frame(0, channels=["rgb"])])
    with pytest.raises(ValueError, match="no samples"):
        perilune.collate([])
    with pytest.raises(ValueError, match="different channels"):
        perilune.collate([samples[0], sim.frame(0, channels=["rgb"])])


@pytest.mark.parametrize("arguments", [{"start": -1}, {"shard": (2, 2)}, {"shard": (0, 0)}])
def test_faulty_streams(sim, arguments):
    with pytest.raises(ValueError, match="must be"):
        perilune.Stream(sim, **arguments)


def test_seed_of_an_open_simulation_cannot_be_changed(sim):
    with pytest.raises(ValueError, match=r"perilune\.open\(config, seed=\.\.\.\)"):
        perilune.Stream(sim, seed=99)


def test_sample_is_a_mapping(sim):
    sample = sim[0]
    assert isinstance(sample, Mapping)
    assert dict(sample)["rgb"] is sample["rgb"]
    assert len(sample) == len(list(sample))
    assert np.isfinite(sample["depth"]).all()
