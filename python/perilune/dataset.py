"""Frames for training loops: a map-style Dataset, an endless Stream, and batches. No torch here."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.sample import Sample
from perilune.simulation import ConfigSource, Simulation, default_threads
from perilune.simulation import open as open_simulation
from perilune.workers import torch_worker as _torch_worker

Array = NDArray[Any]
Transform = Callable[[Sample], Any]

_STATE_VERSION = 1


def _simulation(config: ConfigSource | Simulation, seed: int | None) -> Simulation:
    if not isinstance(config, Simulation):
        return open_simulation(config, seed)
    if seed is not None and seed != config.config.seed:
        raise ValueError("seed: open the simulation with it (perilune.open(config, seed=...))")
    return config


def _threads(threads: int | None) -> int:
    """As asked; else this worker's share of the processors."""
    return threads if threads is not None else max(1, default_threads() // _torch_worker()[1])


class Dataset:
    """`length` frames by index, from `start` on: a torch Dataset without importing torch.

    transform: called with each Sample; what it returns is the item.
    """

    def __init__(
        self,
        config: ConfigSource | Simulation,
        length: int,
        seed: int | None = None,
        *,
        start: int = 0,
        channels: Sequence[str] | None = None,
        transform: Transform | None = None,
        threads: int | None = None,
    ) -> None:
        if length < 0 or start < 0:
            raise ValueError(f"length = {length}, start = {start}: must not be negative")
        self.simulation = _simulation(config, seed)
        self.start = start
        self.channels = channels
        self.transform = transform
        self.threads = threads
        self._length = length

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, index: int) -> Any:
        position = index + self._length if index < 0 else index
        if not 0 <= position < self._length:
            raise IndexError(f"index {index} of a dataset of {self._length} frames")
        sample = self.simulation.frame(self.start + position, self.channels, _threads(self.threads))
        return sample if self.transform is None else self.transform(sample)


class Stream:
    """Endless frames start, start + 1, ...; resumable, and split over shards and workers.

    shard = (k, n): every n-th frame from start + k on. Under torch's DataLoader each worker takes
    its share of that, so that no frame comes twice. `state_dict` counts the frames that this stream
    has yielded in this process; `load_state_dict` goes on after them. In a DataLoader with workers
    the streams that count are the workers' copies: give the batches' own count as `start` then, or
    use torchdata's StatefulDataLoader, which asks every worker.
    """

    def __init__(
        self,
        config: ConfigSource | Simulation,
        seed: int | None = None,
        *,
        start: int = 0,
        shard: tuple[int, int] = (0, 1),
        channels: Sequence[str] | None = None,
        transform: Transform | None = None,
        threads: int | None = None,
    ) -> None:
        part, count = shard
        if start < 0 or not 0 <= part < count:
            raise ValueError(f"start = {start}, shard = {shard}: must be start >= 0, 0 <= k < n")
        self.simulation = _simulation(config, seed)
        self.start = start
        self.shard = shard
        self.channels = channels
        self.transform = transform
        self.threads = threads
        self._yielded = 0
        _register_with_torch()

    def __iter__(self) -> Iterator[Any]:
        worker, workers = _torch_worker()
        part, count = self.shard
        first, stride = self.start + part + count * worker, count * workers
        while True:
            index = first + stride * self._yielded
            sample = self.simulation.frame(index, self.channels, _threads(self.threads))
            item = sample if self.transform is None else self.transform(sample)
            self._yielded += 1
            yield item

    def state_dict(self) -> dict[str, int]:
        """Where the stream stands, as plain numbers."""
        return {
            "version": _STATE_VERSION,
            "seed": self.simulation.config.seed,
            "start": self.start,
            "shard": self.shard[0],
            "shards": self.shard[1],
            "yielded": self._yielded,
        }

    def load_state_dict(self, state: Mapping[str, int]) -> None:
        """Goes on where `state` stands; refuses that of another seed, start or shard."""
        mine = self.state_dict()
        for key, value in mine.items():
            if key != "yielded" and state.get(key) != value:
                raise ValueError(f"state of another stream: {key} is {state.get(key)}, not {value}")
        self._yielded = int(state["yielded"])


def _register_with_torch() -> None:
    """Lets torch's DataLoader see a Stream as iterable-style, if torch is there at all."""
    data = sys.modules.get("torch.utils.data")
    if data is not None:
        data.IterableDataset.register(Stream)


def _check_same_size(first: Sample, other: Sample) -> None:
    a, b = first.camera, other.camera
    if (a.width, a.height) != (b.width, b.height):
        raise ValueError(
            f"collate: images of {a.width} x {a.height} (sensor {a.sensor}) and of "
            f"{b.width} x {b.height} (sensor {b.sensor}) do not stack; batch each sensor by itself"
        )


def collate(samples: Sequence[Sample], tensors: bool = False) -> dict[str, Any]:
    """A batch: every channel stacked to (N, ...), with K, R_w2c, t_w2c, index and objects.

    Where there are sensors, `sensor` lists their names; all of a batch must have one size.
    objects: a list of structured arrays, as frames may hold different numbers. tensors: the stacked
    arrays as torch tensors. A DataLoader's collate_fn: functools.partial(collate, tensors=True).
    """
    if not samples:
        raise ValueError("collate: no samples")
    first = samples[0]
    for sample in samples:
        if set(sample) != set(first):
            raise ValueError("collate: the samples hold different channels")
        _check_same_size(first, sample)
    batch: dict[str, Any] = {name: np.stack([s[name] for s in samples]) for name in first}
    batch["K"] = np.stack([s.camera.K for s in samples])
    batch["R_w2c"] = np.stack([s.camera.R_w2c for s in samples])
    batch["t_w2c"] = np.stack([s.camera.t_w2c for s in samples])
    batch["index"] = np.array([s.meta["index"] for s in samples], dtype=np.int64)
    if tensors:
        import torch

        batch = {name: torch.from_numpy(array) for name, array in batch.items()}
    if any(s.camera.sensor is not None for s in samples):
        batch["sensor"] = [s.camera.sensor for s in samples]
    if first.has_objects:
        batch["objects"] = [s.objects for s in samples]
    return batch
