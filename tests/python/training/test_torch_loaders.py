"""The real DataLoader: every frame once, in order, however it is run, stopped and resumed."""

from __future__ import annotations

import itertools
import pickle
import subprocess
import sys

import pytest
import torch
from torch.utils import data
from torchdata import stateful_dataloader

import perilune
import perilune.torch as with_torch


def stream_of(sim, **options):
    return with_torch.IterableDataset(sim, channels=["depth"], **options)


def taken(loader, count):
    """Frames of the next batches."""
    return [i for batch in itertools.islice(loader, count) for i in batch["index"].tolist()]


WAYS = [
    {"num_workers": 0},
    {"num_workers": 1},
    {"num_workers": 2},
    {"num_workers": 2, "persistent_workers": True},
    {"num_workers": 2, "multiprocessing_context": "spawn", "persistent_workers": True},
]


def name(way):
    return "-".join(str(value) for value in way.values())


@pytest.mark.parametrize("way", WAYS, ids=name)
def test_loops_go_on(sim, way):
    """Loops that are broken off: the next one begins with the frame after the last batch."""
    loader = with_torch.StreamLoader(stream_of(sim, start=3), 2, **way)
    assert isinstance(loader.dataset, data.IterableDataset)
    found = []
    for loop in range(3):
        for step, batch in enumerate(loader):
            found += batch["index"].tolist()
            if step == loop:
                break
    assert found == list(range(3, 15))


def test_streams_that_prefetch(sim):
    """In a loader without workers frames are those of any stream; one with workers refuses it."""
    loader = with_torch.StreamLoader(stream_of(sim, start=3, prefetch=3), 2)
    assert taken(loader, 2) + taken(loader, 1) == list(range(3, 9))
    assert loader.state_dict()["position"] == 6
    with pytest.raises(ValueError, match="prefetch = 3: leave it out of the stream of a loader"):
        with_torch.StreamLoader(stream_of(sim, prefetch=3), 2, num_workers=1)


@pytest.mark.parametrize("way", WAYS[:-1], ids=name)
def test_plain_loaders_repeat_nothing(sim, way):
    """torch's own DataLoader; what workers had prepared when a loop was broken off is left out."""
    loader = data.DataLoader(stream_of(sim, batch_size=2), batch_size=2, **way)
    first, second = taken(loader, 3), taken(loader, 3)
    assert first == list(range(6))
    assert second == list(range(second[0], second[0] + 6))
    most = 6 + 2 * (2 + 1) * way["num_workers"]  # prefetch_factor, and the batch at hand
    assert 6 <= second[0] <= most


def test_unknown_batch_sizes(sim):
    """A stream that is not told the loader's batch size: another order, each frame once."""
    found = taken(data.DataLoader(stream_of(sim), batch_size=2, num_workers=2), 4)
    assert found == [0, 2, 1, 3, 4, 6, 5, 7]


@pytest.mark.parametrize("way", WAYS[:3:2], ids=name)
def test_resuming_in_the_middle(sim, way):
    """A state goes through a file, into another number of workers and another batch size."""
    loader = with_torch.StreamLoader(stream_of(sim), 2, **way)
    batches = iter(loader)
    first = taken(batches, 3)
    state = pickle.loads(pickle.dumps(loader.state_dict()))
    assert state["position"] == 6
    rest = taken(batches, 2)
    again = with_torch.StreamLoader(stream_of(sim), 1, num_workers=1)
    again.load_state_dict(state)
    assert first + taken(again, 4) == first + rest == list(range(10))
    with pytest.raises(ValueError, match="state of another stream: start is 0, not 1"):
        with_torch.StreamLoader(stream_of(sim, start=1)).load_state_dict(state)


def test_frames_are_those_of_the_simulation(sim):
    loader = with_torch.StreamLoader(
        with_torch.IterableDataset(sim, channels=["rgb", "depth"]), 3, num_workers=2
    )
    for batch in itertools.islice(loader, 2):
        for row, index in enumerate(batch["index"].tolist()):
            sample = sim.frame(index, ["rgb", "depth"])
            assert (batch["rgb"][row].numpy() == sample["rgb"].transpose(2, 0, 1)).all()
            assert (batch["depth"][row].numpy() == sample["depth"]).all()


def test_shards_of_distributed_training(sim):
    """Two processes with two workers each: every frame once, and each resumes by itself."""
    loaders = [
        with_torch.StreamLoader(stream_of(sim, shard=(k, 2)), 2, num_workers=2) for k in range(2)
    ]
    found = [taken(loader, 2) for loader in loaders]
    assert found == [[0, 2, 4, 6], [1, 3, 5, 7]]
    again = with_torch.StreamLoader(stream_of(sim, shard=(1, 2)), 2)
    again.load_state_dict(loaders[1].state_dict())
    assert taken(again, 1) == [9, 11]


DIES = """
import json, os, signal, sys
from pathlib import Path
import perilune, perilune.torch as with_torch

died, kept = Path({folder!r}) / "died", Path({folder!r}) / "state.json"

def dies(item):
    if int(item["index"]) == 5 and not died.exists():
        died.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return item

sim = perilune.open({path!r}, overrides={{"camera.width": 16, "camera.height": 12}})
stream = with_torch.IterableDataset(sim, channels=["depth"], transform=dies)
loader = with_torch.StreamLoader(stream, 2, num_workers=2)
if kept.exists():
    loader.load_state_dict(json.loads(kept.read_text()))
for step, batch in zip(range(4), loader):
    print(*batch["index"].tolist(), flush=True)
    kept.write_text(json.dumps(loader.state_dict()))
"""


def test_a_worker_that_dies(scene_file, tmp_path):
    """The program ends with torch's error; started again it goes on after the last batch, and no
    lock or half a line is left."""
    code = DIES.format(folder=str(tmp_path), path=str(scene_file))
    first, second = (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
        for _ in range(2)
    )
    assert first.returncode != 0
    assert second.returncode == 0, second.stderr
    found = [int(word) for word in (first.stdout + second.stdout).split()]
    assert found == list(range(len(found)))
    assert len(found) >= 8


def test_refusals(sim):
    with pytest.raises(TypeError, match=r"StreamLoader: takes a perilune\.torch.IterableDataset"):
        with_torch.StreamLoader(with_torch.Dataset(sim, 3))
    with pytest.raises(ValueError, match="in_order=False"):
        with_torch.StreamLoader(stream_of(sim), in_order=False)
    with pytest.raises(ValueError, match="batch_size = 0: must be 1 or more"):
        stream_of(sim, batch_size=0)


def test_no_file_is_left(sim, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    loader = with_torch.StreamLoader(stream_of(sim), 2, num_workers=2)
    taken(loader, 2)
    assert len(list(tmp_path.glob("*.ledger"))) == 1
    again = pickle.loads(pickle.dumps(loader.dataset))
    assert next(iter(again))["index"] == 4
    del loader, again
    assert list(tmp_path.glob("*.ledger")) == []


def shuffled(frames, **options):
    generator = torch.Generator().manual_seed(1)
    loader = data.DataLoader(frames, batch_size=2, shuffle=True, generator=generator, **options)
    return [i for batch in loader for i in batch["index"].tolist()]


def test_epochs_of_a_dataset(sim):
    frames = with_torch.Dataset(sim, 6, channels=["depth"])
    orders = [shuffled(frames, num_workers=workers) for workers in (0, 2)]
    assert orders[0] == orders[1] != sorted(orders[0])
    assert sorted(orders[0]) == list(range(6))


@pytest.mark.parametrize("kind", [with_torch.IterableDataset, perilune.Stream])
def test_torchdata(sim, kind):
    """Its loader asks each worker for its state; exact with any batch size that the stream has."""

    def loader():
        stream = kind(sim, channels=["depth"])
        return stateful_dataloader.StatefulDataLoader(stream, batch_size=2, num_workers=2)

    first = loader()
    batches = iter(first)
    found = taken(batches, 3)
    state = pickle.loads(pickle.dumps(first.state_dict()))
    rest = taken(batches, 5)
    second = loader()
    second.load_state_dict(state)
    assert taken(second, 5) == rest
    assert sorted(found + rest) == list(range(16))
