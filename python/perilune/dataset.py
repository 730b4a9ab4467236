"""Frames for training loops: a map-style Dataset and an endless Stream, without torch."""

from __future__ import annotations

import multiprocessing
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from perilune.base.arguments import whole
from perilune.base.processors import default_threads
from perilune.base.workers import in_torch_worker, torch_worker
from perilune.opening import ConfigSource, open as open_simulation
from perilune.sample import Sample
from perilune.training.ahead import Ahead
from perilune.training.batches import collate, tell_torch
from perilune.training.ledger import Ledger
from perilune.training.schedule import Change, Schedule

if TYPE_CHECKING:
    from perilune.simulation import Simulation

__all__ = ["Dataset", "Stream", "collate"]

Transform = Callable[[Sample], Any]

_STATE_VERSION = 2


def _simulation(config: ConfigSource | Simulation, seed: int | None) -> Simulation:
    from perilune.simulation import Simulation  # here, so that the names of this module load fast

    if not isinstance(config, Simulation):
        return open_simulation(config, seed)
    if seed is not None and seed != config.config.seed:
        raise ValueError("seed: open the simulation with it (perilune.open(config, seed=...))")
    return config


def _threads(threads: int | None) -> int:
    """The given number; default: this worker's part of the processors."""
    workers = torch_worker()[1]
    return threads if threads is not None else max(1, default_threads() // workers)


class _Frames:
    """Base of Dataset and Stream: a simulation and the changes made to it.

    Copies in the workers of a DataLoader read the changes from a ledger; other copies, such as
    pickled ones, have a ledger of their own."""

    def __init__(
        self,
        config: ConfigSource | Simulation,
        seed: int | None,
        channels: Sequence[str] | None,
        transform: Transform | None,
        threads: int | None,
    ) -> None:
        self.simulation = _simulation(config, seed)
        self.channels = channels
        self.transform = transform
        self.threads = threads
        self._schedule = Schedule(self.simulation)
        self._keep(Ledger())
        self._came_from: str | None = None
        """Path of the ledger of the original, if this is a pickled copy."""
        self._pid = os.getpid()
        tell_torch()

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_ledger": None, "_schedule": self.changes}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        self.__dict__.update(state)
        self._came_from, self._pid = self._path, os.getpid()
        carried, self._schedule = self._schedule, Schedule(self.simulation)
        self._keep(Ledger())
        with self._shared().held():
            self._shared().append({"changes": carried})

    def _keep(self, ledger: Ledger) -> None:
        self._ledger, self._path, self._seen = ledger, ledger.path, 0

    def _shared(self) -> Ledger:
        """The ledger: that of the process that started this worker, or its own."""
        if self._came_from is not None and in_torch_worker():
            # Pickled into a worker that was spawned. A fork has its parent's ledger already.
            given = Ledger(self._came_from)
            if self._pid == os.getpid() and given.is_there():
                self._schedule = Schedule(self.simulation)
                self._keep(given)
            self._came_from = None
        return self._ledger

    def _follow(self, ledger: Ledger) -> None:
        """Applies changes made meanwhile; the ledger must be held."""
        for row in ledger.rows[self._seen :]:
            if "changes" in row:
                self._schedule = Schedule(self.simulation, [(at, c) for at, c in row["changes"]])
            elif "set" in row:
                self._schedule.add(row["at"], row["set"], known=True)
        self._seen = len(ledger.rows)

    @property
    def changes(self) -> list[Change]:
        """(first index, {key path: value}) of the changes made by `set`."""
        ledger = self._shared()
        with ledger.held():
            self._follow(ledger)
        return list(self._schedule.changes)

    def _set(self, ledger: Ledger, at: int, change: Mapping[str, Any]) -> None:
        """Adds a change; the ledger must be held."""
        if in_torch_worker():
            raise RuntimeError("set: call it in the process that made the loader, not in a worker")
        self._schedule.add(at, change)
        ledger.append({"at": at, "set": dict(change)})
        self._seen = len(ledger.rows)

    def _task(self, index: int) -> Callable[[], Any]:
        """Makes an item, with the changes that are known now."""
        tell_torch()
        return partial(self._made, self._schedule.simulation(index), index)

    def _made(self, simulation: Simulation, index: int) -> Any:
        sample = simulation.frame(index, self.channels, _threads(self.threads))
        return sample if self.transform is None else self.transform(sample)


def _plain(changes: Mapping[str, Any] | None, dotted: Mapping[str, Any]) -> dict[str, Any]:
    """The changes as JSON can hold them. ValueError if there are none."""
    from perilune.document.loader import plain_tree

    found = plain_tree({**(changes or {}), **dotted}, "set")
    if not found:
        raise ValueError("set: no change; give key paths and values, as {'drivers.strength': 0.5}")
    return found


class Dataset(_Frames):
    """A map-style dataset of `length` frames from index `start` on; it does not import torch.

    Items are Samples; perilune.torch.Dataset gives tensors. An item is the same frame, to the bit,
    in any epoch, order and worker.

    channels: names of the channels to compute (default: render.channels). transform: called with
    each Sample; its result is the item. threads: number of threads per frame (default: the
    processors, shared among the workers)."""

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
        length, start = whole("length", length, 0), whole("start", start, 0)
        super().__init__(config, seed, channels, transform, threads)
        self.start = start
        self._length = length

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, index: int) -> Any:
        position = index + self._length if index < 0 else index
        if not 0 <= position < self._length:
            raise IndexError(f"index {index} of a dataset of {self._length} frames")
        ledger = self._shared()
        with ledger.held():
            self._follow(ledger)
        return self._task(self.start + position)()

    def set(self, changes: Mapping[str, Any] | None = None, at: int = 0, **dotted: Any) -> None:
        """Changes the configuration of all frames made from now on whose index
        (Sample.meta["index"]) is `at` or more, in all workers, including persistent ones.

        changes, dotted: key path -> value, such as {"drivers.strength": 0.5}. Between epochs no
        frame is in progress, so the whole next epoch has the change. Within an epoch, batches that
        workers have already begun do not have it; `meta["overrides"]` of each sample records its
        changes. Raises ConfigError for a faulty change and then changes nothing."""
        given, ledger = _plain(changes, dotted), self._shared()
        with ledger.held():
            self._follow(ledger)
            self._set(ledger, at, given)

    def state_dict(self) -> dict[str, Any]:
        """The changes made by `set`, as plain values. The position within an epoch belongs to the
        sampler."""
        return {
            "version": _STATE_VERSION,
            "seed": self.simulation.config.seed,
            "start": self.start,
            "changes": [[at, dict(change)] for at, change in self.changes],
        }

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Replaces the changes by those of `state`. ValueError for a state of another seed or
        start; ConfigError if the changes do not fit the configuration."""
        mine = {"seed": self.simulation.config.seed, "start": self.start}
        _check_state(mine, state)
        _restore(self, state.get("changes", ()))


def _check_state(mine: Mapping[str, Any], state: Mapping[str, Any]) -> None:
    for key, value in mine.items():
        if state.get(key) != value:
            raise ValueError(f"state of another stream: {key} is {state.get(key)}, not {value}")


def _restore(frames: _Frames, changes: Sequence[Sequence[Any]]) -> None:
    """Replaces the changes, after checking the new ones."""
    schedule = Schedule(frames.simulation)
    for at, change in changes:
        schedule.add(at, change)
    ledger = frames._shared()
    with ledger.held():
        ledger.append({"changes": schedule.changes})
        frames._follow(ledger)


class Stream(_Frames):
    """Endless frames start, start + 1, ...; resumable, and split over shards and workers.

    Items are Samples; perilune.torch.IterableDataset gives tensors. A stream never starts over:
    another `iter`, or another epoch of a DataLoader, continues with new frames.

    shard = (k, n): every n-th frame from start + k on, for process k of n in distributed training.
    Positions count the frames of the shard: position 0 is frame start + k, position 1 is start + k
    + n.

    Under torch's DataLoader with W workers, worker w takes positions w, w + W, w + 2 W, ...; with
    `batch_size` B it takes B at a time, so a loader of that batch size yields all frames in order
    for any number of workers. No frame is repeated.

    perilune.torch.StreamLoader and torchdata's StatefulDataLoader count the batches that were
    handed out, so resuming or a second epoch skips no frame. torch's own DataLoader does not report
    this: a second epoch continues after the last frame that any worker has begun, and skips what
    workers had prepared when the first epoch was interrupted.

    prefetch: number of frames that are made ahead, on a thread of their own, while the loop works
    with the one it has; 0: each is made when the loop asks for it. The thread also calls
    `transform` and the functions of the configuration. Frames do not depend on it. It is for loops
    without a DataLoader's workers, which make batches ahead by themselves.

    channels, transform, threads: as for Dataset."""

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
    ) -> None:
        start = whole("start", start, 0)
        if not isinstance(shard, (tuple, list)) or len(shard) != 2:
            raise TypeError(f"shard = {shard!r}: must be (k, n), the k-th of n parts, k from 0")
        shard = part, count = whole("shard[0]", shard[0]), whole("shard[1]", shard[1])
        if not 0 <= part < count:
            raise ValueError(f"shard = {shard}: must be (k, n) with 0 <= k < n")
        batch_size = whole("batch_size", batch_size, 1)
        super().__init__(config, seed, channels, transform, threads)
        self.start = start
        self.shard = shard
        self.batch_size = batch_size
        self.prefetch = whole("prefetch", prefetch, 0)
        self._first = 0
        """Position at which this stream, or this worker's pass over it, begins."""
        self._taken = 0
        """Frames that this process has handed out since then."""
        self._loaded = False
        """Whether this worker has received a state, which defines the start of its next pass."""
        self._passes = 0
        """Number of passes that this worker has begun."""
        self._loop: int | None = None
        """Number of the StreamLoader loop for which workers are being created."""
        _register_with_torch()

    @property  # type: ignore[misc]
    def __class__(self) -> type:
        """The type that isinstance sees. DataLoader asks for it; a stream created before torch was
        imported is registered with torch then."""
        _register_with_torch()
        return type(self)

    def __iter__(self) -> Iterator[Any]:
        if self.prefetch > 0 and in_torch_worker():
            raise ValueError(
                f"prefetch = {self.prefetch}: leave it out in workers; the loader's own "
                "prefetch_factor says how many batches each of them makes ahead"
            )
        mark = self._begin_pass()
        with Ahead[Any](self.prefetch) as ahead:
            while True:
                item = ahead.take(self._position_after, partial(self._begin, mark))
                self._taken += 1
                yield item

    def _position_after(self, frames: int) -> int:
        """The position of a frame of this pass; frames: how many are handed out before it, from now
        on."""
        worker, workers = torch_worker()
        block, place = divmod(self._taken + frames, self.batch_size)
        return self._first + self.batch_size * (worker + workers * block) + place

    def _begin(self, mark: dict[str, Any] | None, position: int) -> Callable[[], Any]:
        """Counts a frame as begun, and returns what makes it."""
        ledger = self._shared()
        with ledger.held():
            self._follow(ledger)
            if mark is None or _last_mark(ledger) is mark:
                ledger.begun = max(ledger.begun, position + 1)
        return self._task(self._index(position))

    def _index(self, position: int) -> int:
        part, count = self.shard
        return self.start + part + count * position

    def _begin_pass(self) -> dict[str, Any] | None:
        """Determines where a pass begins; returns its line in the ledger if a worker makes the
        pass."""
        if not in_torch_worker():
            self._first, self._taken = self.position, 0
            return None
        ledger = self._shared()
        with ledger.held():
            key, value = ("loop", self._loop) if self._loop is not None else ("pass", _family())
            name = value + self._passes if isinstance(value, int) else f"{value}:{self._passes}"
            self._passes += 1
            mark = next((row for row in ledger.rows if row.get(key) == name), None)
            if mark is None:
                ledger.append({key: name, "first": ledger.begun})
                mark = ledger.rows[-1]
        if not self._loaded:
            self._first, self._taken = mark["first"], 0
        self._loaded = False
        return mark

    @property
    def position(self) -> int:
        """Number of frames of the shard that were handed out.

        With workers of torch's own DataLoader: number of frames that they have begun."""
        own = self._first + self._taken
        ledger = self._shared()
        with ledger.held():
            if "pass" in (_last_mark(ledger) or {}) and not in_torch_worker():
                return max(own, ledger.begun)
        return own

    def go_to(self, position: int, loop: bool = False) -> int:
        """For loaders: sets the next position and returns it.

        loop: workers created from now on begin there; persistent ones begin their next pass
        there."""
        ledger = self._shared()
        with ledger.held():
            self._loop = None
            row = {"go_to": position}
            if loop:
                self._loop = sum("loop" in other for other in ledger.rows)
                row = {"loop": self._loop, "first": position}
            ledger.append(row)
            ledger.begun = position
        self.handed_out(position)
        return position

    def handed_out(self, position: int) -> None:
        """For loaders: reports that the user has all frames before a position."""
        self._first, self._taken = position, 0

    def set(
        self, changes: Mapping[str, Any] | None = None, at: int | None = None, **dotted: Any
    ) -> int:
        """Changes the configuration from a frame on, in all workers; returns that frame's index.

        changes, dotted: key path -> value or driver, such as {"drivers.strength": 0.5}. at: index
        of the first frame with the changes (default: the first one that no worker has begun). Each
        frame thus remains a function of configuration, changes, seed and index; the changes are
        recorded in `meta["overrides"]` and in `state_dict`.

        Raises ValueError if a frame from `at` on has been begun, and ConfigError for a faulty
        change; then nothing is changed."""
        given, own = _plain(changes, dotted), self._first + self._taken
        ledger = self._shared()
        with ledger.held():
            self._follow(ledger)
            earliest = self._index(max(own, ledger.begun))
            if at is not None and at < earliest:
                text = f"frames before {earliest} are made or being made"
                raise ValueError(f"set: at = {at}: {text}; the earliest is {earliest}")
            at = earliest if at is None else at
            self._set(ledger, at, given)
        return at

    def state_dict(self) -> dict[str, Any]:
        """The stream's position and the changes made by `set`, as plain values.

        position: number of frames of the shard handed out. In a worker, where torchdata's loader
        asks, it is the start of the worker's pass, and `taken` is the number of frames that this
        worker has made since."""
        worker, workers = torch_worker()
        position, taken = (self.position, 0) if workers == 1 else (self._first, self._taken)
        self._follow_now()
        return {
            "version": _STATE_VERSION,
            "seed": self.simulation.config.seed,
            "start": self.start,
            "shard": self.shard[0],
            "shards": self.shard[1],
            "position": position,
            "taken": taken,
            "worker": worker,
            "workers": workers,
            "batch_size": self.batch_size,
            "changes": [[n, dict(c)] for n, c in self._schedule.from_on(self._index(position))],
        }

    def _follow_now(self) -> None:
        ledger = self._shared()
        with ledger.held():
            self._follow(ledger)

    def load_state_dict(self, state: Mapping[str, Any]) -> None:
        """Continues from `state`, with its changes. Refuses a state of another seed, start or
        shard, and a worker's state in another worker."""
        mine = self.state_dict()
        fixed: tuple[str, ...] = ("seed", "start", "shard", "shards")
        position = state.get("position", state.get("yielded"))  # yielded: of version 1
        if state.get("workers", 1) > 1 or mine["workers"] > 1:
            fixed += ("worker", "workers", "batch_size")
        _check_state({key: mine[key] for key in fixed}, state)
        if position is None:
            raise ValueError("state of another stream: it has no position")
        if not in_torch_worker():
            _restore(self, state.get("changes", ()))
            self.go_to(int(position) + int(state.get("taken", 0)))
            return
        if not self.changes:  # the process that made the loader knows better, if it knows
            _restore(self, state.get("changes", ()))
        self._first, self._taken = int(position), int(state.get("taken", 0))
        self._loaded = True


def _last_mark(ledger: Ledger) -> dict[str, Any] | None:
    """The last position recorded for the stream."""
    marks = ("loop", "pass", "go_to")
    rows = (row for row in reversed(ledger.rows) if any(key in row for key in marks))
    return next(rows, None)


def _family() -> str:
    """A name common to the workers of one loader and to no other loader of its process; these
    workers are processes with consecutive numbers."""
    name, (worker, _) = multiprocessing.current_process().name, torch_worker()
    found = re.fullmatch(r"(.*?)(\d+)", name)
    return name if found is None else f"{found[1]}{int(found[2]) - worker}"


def _register_with_torch() -> None:
    """Makes torch's DataLoader treat a Stream as iterable-style, if torch is imported."""
    data = sys.modules.get("torch.utils.data")
    iterable = getattr(data, "IterableDataset", None)
    if iterable is not None:
        iterable.register(Stream)
