"""Frames as torch tensors: a Dataset, an IterableDataset, and a loader that can be resumed.

Items are mappings of tensors that torch's own collate stacks:

    rgb, depth and so on       the channels of render.channels or `channels`; images as (channels,
                               height, width), or (height, width, channels) with chw=False
    semantic, part, instance   int64, because torch indexes with it; raw is int32
    K                          (3, 3), pixels, integer pixel centres
    R_w2c, t_w2c               (3, 3), (3,) float64, m: p_camera = R_w2c p_root + t_w2c
    index                      int64, the frame's index
    sensor                     the sensor's name, if the configuration has sensors
    objects                    a mapping of tensors, one row per spacecraft (names as in
                               Sample.objects: R_m2c, t_m2c, m, bbox_visib, ...), padded with zeros
                               to `max_objects` rows; `valid` (max_objects,) marks the objects

Needs torch (the extra `torch`)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import torch
from torch.utils import data

from perilune import dataset as plain
from perilune.opening import ConfigSource
from perilune.sample import Sample
from perilune.simulation import Simulation
from perilune.training.tensors import Item, stacked, tensors

__all__ = ["Dataset", "IterableDataset", "StreamLoader", "stacked", "tensors"]

Transform = Callable[[Item], Any]


class _AsTensors:
    """The transform of a dataset: from a sample to tensors, then the user's transform."""

    def __init__(self, options: Mapping[str, Any], then: Transform | None) -> None:
        self.options = options
        self.then = then

    def __call__(self, sample: Sample) -> Any:
        item = tensors(sample, **self.options)
        return item if self.then is None else self.then(item)


class Dataset(plain.Dataset, data.Dataset[Any]):
    """perilune.Dataset as a torch.utils.data.Dataset of mappings of tensors.

    chw, max_objects, dtype: see `tensors`. transform: called with each mapping; its result is the
    item. Other arguments are those of perilune.Dataset."""

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
        chw: bool = True,
        max_objects: int | None = None,
        dtype: torch.dtype = torch.float32,
    ) -> None:
        options = {"chw": chw, "max_objects": max_objects, "dtype": dtype}
        super().__init__(
            config,
            length,
            seed,
            start=start,
            channels=channels,
            transform=_AsTensors(options, transform),
            threads=threads,
        )


class IterableDataset(plain.Stream, data.IterableDataset[Any]):
    """perilune.Stream as a torch.utils.data.IterableDataset of mappings of tensors.

    chw, max_objects, dtype: see `tensors`. transform: called with each mapping; its result is the
    item. Other arguments are those of perilune.Stream, which documents how workers share frames and
    how to resume."""

    def __init__(
        self,
        config: ConfigSource | Simulation,
        seed: int | None = None,
        *,
        start: int = 0,
        shard: tuple[int, int] = (0, 1),
        batch_size: int = 1,
        prefetch: int = 0,
        channels: Sequence[str] | None = None,
        transform: Transform | None = None,
        threads: int | None = None,
        chw: bool = True,
        max_objects: int | None = None,
        dtype: torch.dtype = torch.float32,
    ) -> None:
        options = {"chw": chw, "max_objects": max_objects, "dtype": dtype}
        super().__init__(
            config,
            seed,
            start=start,
            shard=shard,
            batch_size=batch_size,
            prefetch=prefetch,
            channels=channels,
            transform=_AsTensors(options, transform),
            threads=threads,
        )


class StreamLoader(data.DataLoader[Any]):
    """A DataLoader for a stream (IterableDataset here, or perilune.Stream) that tracks its
    position.

    Batches come in the order of the frames, for any number of workers. Another `iter` continues
    with the frame after the last batch that was handed out; what workers had begun beyond it is
    made again. `state_dict` and `load_state_dict` are exact, and a state may be resumed with
    another number of workers or another batch size.

    options: as for torch.utils.data.DataLoader; in_order=False is refused."""

    def __init__(
        self,
        stream: plain.Stream,
        batch_size: int | None = 1,
        *,
        num_workers: int = 0,
        **options: Any,
    ) -> None:
        if not isinstance(stream, plain.Stream):
            raise TypeError(
                "StreamLoader: takes a perilune.torch.IterableDataset or perilune.Stream, not "
                f"{type(stream).__name__} (torch.utils.data.DataLoader takes a Dataset)"
            )
        if not options.get("in_order", True):
            raise ValueError("in_order=False: batches must come in order to be counted")
        if stream.prefetch > 0 and num_workers > 0:
            raise ValueError(
                f"prefetch = {stream.prefetch}: leave it out of the stream of a loader with "
                "workers, which make batches ahead (prefetch_factor)"
            )
        self._size = 1 if batch_size is None else batch_size
        stream.batch_size = self._size
        super().__init__(stream, batch_size=batch_size, num_workers=num_workers, **options)  # type: ignore[arg-type]

    @property
    def stream(self) -> plain.Stream:
        """The stream that it loads."""
        found = self.dataset
        assert isinstance(found, plain.Stream)
        return found

    def __iter__(self) -> Iterator[Any]:  # type: ignore[override]
        position = self.stream.go_to(self.stream.position, loop=True)
        try:
            for batch in super().__iter__():
                position += self._size
                self.stream.handed_out(position)
                yield batch
        finally:
            self.stream.go_to(position)

    def state_dict(self) -> dict[str, Any]:
        """State of the stream after the batches handed out; see Stream.state_dict."""
        return self.stream.state_dict()

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continues from `state`; see Stream.load_state_dict. Call it before a loop, not within."""
        self.stream.load_state_dict(state)
