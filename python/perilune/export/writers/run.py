"""Renders frames once for several datasets, and writes them beside the rendering."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from perilune.export.writers.begin import as_range, check_folder, check_simulation, check_split
from perilune.export.writers.lock import locked
from perilune.export.writers.queue import WriteQueue
from perilune.export.writers.scans import scans
from perilune.export.writers.shards import Note, Shard, check_frames, shard_chunks
from perilune.export.writers.shown import main_picture
from perilune.export.writers.table import Progress, WriteReport
from perilune.sample import Sample
from perilune.simulation import Simulation

Tables = Mapping[str, NDArray[Any]]
DEFAULT_CHUNK = 1000
"""Frames of a chunk, unless another number is asked for."""
NEXT = "next picture"
"""Stands among tables for the main picture of the frame after this one."""


class Dataset(Protocol):
    """A dataset that is being written: one format in one folder.

    The folder is locked as long as it exists. Calls come in this order: `find`; for each chunk
    `begin`, `write` for each of its frames in `missing`, from several threads, and `end`; and in
    the end `finish`, unless a shard is written."""

    @property
    def root(self) -> Path:
        """Its folder."""
        ...

    @property
    def channels(self) -> Sequence[str]:
        """Channels that it needs of a frame."""
        ...

    @property
    def tables(self) -> Sequence[str]:
        """Tables of the ground that it needs of a frame; maybe NEXT."""
        ...

    def find(self, images_of: Mapping[int, Mapping[int, int]], chunk_size: int) -> None:
        """Looks which of the frames (chunk -> place in it -> frame) are there and intact."""
        ...

    def missing(self, chunk: int) -> Iterable[int]:
        """Frames of a chunk to be written: asked for and not there, or damaged."""
        ...

    def begin(self, chunk: int) -> None:
        """Prepares the folder of a chunk."""
        ...

    def write(self, index: int, sample: Sample, tables: Tables) -> None:
        """Writes a frame of the chunk that was begun."""
        ...

    def end(self, chunk: int) -> None:
        """Completes a chunk whose frames are written."""
        ...

    def reopen(self) -> None:
        """Removes files that become outdated when more frames are written."""
        ...

    def finish(self) -> None:
        """Writes what summarises all chunks."""
        ...


@dataclass(frozen=True)
class Begun:
    """A folder for a dataset, not opened yet."""

    sim: Simulation
    root: Path
    chunk_size: int
    split: str
    held: ExitStack
    scenes: Sequence[int] | None
    """Chunks to be locked; None: all."""

    def lock(self) -> None:
        """Locks the folder, which must exist."""
        self.held.enter_context(locked(self.root, self.scenes))


class Opener(Protocol):
    """Opens a dataset in two steps, so that what one of several formats refuses leaves no folder of
    the others: it refuses, and returns what makes the folder, calls `lock`, and writes to it."""

    def __call__(self, begun: Begun) -> Callable[[], Dataset]: ...


def tables_of(
    sim: Simulation, sample: Sample, names: Sequence[str], threads: int | None = None
) -> dict[str, NDArray[Any]]:
    """Tables of the ground, and measurements, of a frame by name."""
    found = scans(sim, sample, names, threads)
    ground = [name for name in names if name not in found]
    every = sim.ground_tables(sample) if ground else {}
    return {**found, **{name: every[name] for name in ground}}


class _Frames:
    """Renders frames with the channels of all datasets."""

    def __init__(self, sim: Simulation, datasets: Sequence[Dataset], threads: int | None) -> None:
        self._sim, self._threads = sim, threads
        self._channels = list(dict.fromkeys(name for each in datasets for name in each.channels))
        tables = dict.fromkeys(name for each in datasets for name in each.tables)
        self._tables = [name for name in tables if name != NEXT]
        self._pairs = NEXT in tables
        self._kept: Sample | None = None
        """The frame that came next to the last one."""

    def _frame(self, index: int) -> Sample:
        kept = self._kept
        if kept is not None and kept.meta["index"] == index:
            return kept
        return self._sim.frame(index, channels=self._channels, threads=self._threads)

    def __call__(self, index: int) -> tuple[Sample, Tables]:
        sample = self._frame(index)
        tables = tables_of(self._sim, sample, self._tables, self._threads)
        if self._pairs:
            follows = self._sim.timeline.beside(index, 1)
            # The last frame of a scene has no flow, and stands beside itself.
            self._kept = sample if follows is None else self._frame(follows)
            tables[NEXT] = self._kept[main_picture(self._sim)]
        return sample, tables


def _write_chunk(chunk: int, datasets: Sequence[Dataset], frames: _Frames, told: _Told) -> None:
    """Writes the missing frames of a chunk to the datasets that lack them."""
    wanted = [frozenset(each.missing(chunk)) for each in datasets]
    for each in datasets:
        each.begin(chunk)
    with WriteQueue() as queue:
        for index in sorted(frozenset().union(*wanted)):
            # Here, and not in the task: simulations are not for several threads.
            sample, tables = frames(index)
            lacking = [each for each, own in zip(datasets, wanted, strict=True) if index in own]

            def task(
                index: int = index,
                sample: Sample = sample,
                tables: Tables = tables,
                lacking: Sequence[Dataset] = lacking,
            ) -> None:
                for each in lacking:
                    each.write(index, sample, tables)

            told.advance(queue.put(task))
        told.advance(queue.drain())
    for each in datasets:
        each.end(chunk)


class _Told:
    """The progress of a run."""

    def __init__(self, progress: Progress | None, kept: int, total: int) -> None:
        self._progress, self.kept, self._total = progress, kept, total
        self.written = 0
        self.advance(0)

    def advance(self, written: int) -> None:
        self.written += written
        if self._progress is not None:
            self._progress(self.written + self.kept, self._total)


def write_datasets(
    sim: Simulation,
    frames: range | Sequence[int],
    openers: Sequence[tuple[str | Path, Opener]],
    *,
    chunk_size: int = DEFAULT_CHUNK,
    threads: int | None = None,
    split: str = "train",
    shard: Shard | None = None,
    progress: Progress | None = None,
) -> WriteReport:
    """Writes the same frames to several folders (each with its format) in one pass of rendering.

    The report's folder is the first one; a frame counts as written if any of them lacked it."""
    check_simulation(sim)
    frames = as_range(frames)
    check_frames(frames, chunk_size, shard or (0, 1))
    check_split(split)
    roots = [check_folder(out) for out, _ in openers]
    images_of = shard_chunks(frames, chunk_size, shard or (0, 1))
    scenes = None if shard is None else list(images_of)
    with ExitStack() as held:
        accepted = [
            opener(Begun(sim, root, chunk_size, split, held, scenes))
            for root, (_, opener) in zip(roots, openers, strict=True)
        ]
        datasets = [begin() for begin in accepted]
        kept, total = _look(datasets, images_of, chunk_size)
        for each in datasets:
            if shard is not None:
                Note(frames, shard).write(each.root)
            if kept < total or shard is not None:
                each.reopen()
        told = _Told(progress, kept, total)
        rendered = _Frames(sim, datasets, threads)
        for chunk in images_of:
            _write_chunk(chunk, datasets, rendered, told)
        for each in datasets:
            if shard is None:
                each.finish()
    return WriteReport(roots[0], told.written, told.kept)


def _look(
    datasets: Sequence[Dataset], images_of: Mapping[int, Mapping[int, int]], chunk_size: int
) -> tuple[int, int]:
    """Number of frames that all datasets have, and number of frames."""
    for each in datasets:
        each.find(images_of, chunk_size)
    kept = total = 0
    for chunk, images in images_of.items():
        lacking = frozenset().union(*(each.missing(chunk) for each in datasets))
        every = lacking | set(images.values())
        total += len(every)
        kept += len(every - lacking)
    return kept, total
