"""A dataset in a folder that is being written, in any format: see run.Dataset.

A frame's files are written first, then its record. Formats that pack frames into one file a chunk
have the files of unfinished chunks below `.partial/`."""

from __future__ import annotations

import json
import logging
import shutil
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from perilune.document.references import OBJECTS, TABLES as SAMPLE_TABLES
from perilune.export.writers.bop_channels import TABLES
from perilune.export.writers.config_file import CONFIG_FILE, config_entry, config_text
from perilune.export.writers.files import (
    CARD_FILE,
    PARTIAL,
    SOURCE_FILE,
    json_text,
    make_folder,
    remove_temporary,
    sync_files,
    sync_folder,
    write_bytes,
    write_other_text,
    write_text,
)
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.base import Files, Format, Frame, Record
from perilune.export.writers.formats.card import write_card
from perilune.export.writers.formats.channels import asked_channels
from perilune.export.writers.formats.info import folder_info
from perilune.export.writers.formats.packs import Pack
from perilune.export.writers.run import NEXT, Begun, Dataset, Tables
from perilune.export.writers.same_source import check_same_source, refuse_other_source
from perilune.export.writers.scans import channels_of_scan, is_scan
from perilune.export.writers.shards import drop_notes
from perilune.sample import Sample
from perilune.simulation import Simulation

_log = logging.getLogger(__name__)

SUMS = "files"
"""Key of dataset_info.json with the sums of files beside the frames."""


@dataclass
class FolderDataset(Dataset):
    """One format in one folder."""

    fmt: Format
    sim: Simulation
    folder: Path
    info: Mapping[str, Any]
    _chunk_size: int = 1
    _missing: dict[int, list[int]] = field(default_factory=dict)
    _packs: dict[int, Pack] = field(default_factory=dict)

    @property
    def root(self) -> Path:
        """Folder of the dataset."""
        return self.folder

    @property
    def channels(self) -> list[str]:
        """Channels rendered for a frame."""
        return rendered_for(self.sim, self.info)

    @property
    def tables(self) -> list[str]:
        """Tables of the ground, measurements, and the next picture, as far as the format has
        them."""
        own = [name for name in self.info["channels"] if name in TABLES or is_scan(name)]
        return [*own, *([NEXT] if self.fmt.needs_next else [])]

    def find(self, images_of: Mapping[int, Mapping[int, int]], chunk_size: int) -> None:
        """Finds the frames that exist and are intact.

        Damaged frames of these chunks are made again even if they are not asked for, because
        nothing could tell them from intact ones later."""
        self._chunk_size = chunk_size
        there: dict[int, list[int]] = {}
        for path in records.paths(self.folder):
            there.setdefault(int(path.stem) // chunk_size, []).append(int(path.stem))
        for chunk, asked in images_of.items():
            found = there.get(chunk, [])
            if self.fmt.pack_name is None:
                good = {index for index in found if self._is_whole(index)}
            else:
                self._packs[chunk] = Pack(self.fmt, self.folder, chunk, self.info)
                good = self._packs[chunk].find(found)
            wanted = dict.fromkeys(asked.values())
            for index in sorted(set(found) - good - set(wanted)):
                _log.warning("%s: frame %d is damaged and made again", self.folder, index)
                wanted[index] = None
            self._missing[chunk] = [index for index in wanted if index not in good]

    def _is_whole(self, index: int) -> bool:
        record = records.read(records.path_of(self.folder, index))
        if record is None:
            return False
        try:
            return all(
                records.matches((self.folder / name).read_bytes(), stated)
                for name, stated in record["files"].items()
            )
        except OSError:
            return False

    def missing(self, chunk: int) -> list[int]:
        """Frames of a chunk to be written."""
        return self._missing[chunk]

    def begin(self, chunk: int) -> None:
        """Removes partial files of a killed run."""
        (self.folder / records.FOLDER).mkdir(exist_ok=True)
        for folder in _folders(self.folder):
            remove_temporary(folder)

    def write(self, index: int, sample: Sample, tables: Tables) -> None:
        """Writes the files of a frame, then its record."""
        base = record_for(self.sim, self.info, sample)
        encoded = self.fmt.encode(self.info, frame_of(self.info, sample, tables, base))
        pack = self._packs.get(index // self._chunk_size)
        where = self.folder if pack is None else pack.stage(index)
        written = []
        for name, data in encoded.files.items():
            path = where / name
            path.parent.mkdir(parents=True, exist_ok=True)
            write_bytes(path, [data], sync=False)
            written.append(path)
        sync_files(written)
        sums = {name: records.sums(data) for name, data in encoded.files.items()}
        labels = {} if encoded.labels is None else {"labels": encoded.labels}
        records.write(self.folder, {**base, **labels, "files": sums})

    def end(self, chunk: int) -> None:
        """Brings the names of a chunk's files to the disk; packs them."""
        if chunk in self._packs:
            frames = [path for path in records.paths(self.folder) if self._chunk_of(path) == chunk]
            self._packs[chunk].complete([int(path.stem) for path in frames])
        for folder in _folders(self.folder):
            sync_folder(folder)

    def _chunk_of(self, path: Path) -> int:
        return int(path.stem) // self._chunk_size

    def reopen(self) -> None:
        """Removes the card, which ends a dataset."""
        (self.folder / CARD_FILE).unlink(missing_ok=True)

    def finish(self) -> None:
        """Writes what summarises all frames, and the card."""
        finish_folder(self.fmt, self.folder)


def _folders(root: Path) -> Iterator[Path]:
    """The folder and those below it."""
    yield root
    for path in sorted(root.iterdir()):
        if path.is_dir() and path.name != PARTIAL:
            yield from _folders(path)


def rendered_for(sim: Simulation, info: Mapping[str, Any]) -> list[str]:
    """Channels rendered for a frame of a dataset: its own, and all that the configuration states,
    since metadata tell more where more is rendered: so a record does not depend on what other
    formats are written beside."""
    asked, stated = asked_channels(sim)
    own = [name for name in info["channels"] if name not in TABLES and not is_scan(name)]
    tables = [table for table in TABLES if table in info["channels"]]
    more = [name for table in tables for name in (*TABLES[table], "instance")]
    more += [name for scan in info["channels"] for name in channels_of_scan(sim, scan)]
    return list(dict.fromkeys([*own, *more, *(asked if stated else [])]))


def record_for(sim: Simulation, info: Mapping[str, Any], sample: Sample) -> dict[str, Any]:
    """The record of a frame of a dataset, without files."""
    with_objects = OBJECTS in info["channels"]
    return records.record_of(sample, list(sim.config.objects) if with_objects else None)


def frame_of(info: Mapping[str, Any], sample: Sample, tables: Tables, record: Record) -> Frame:
    """What a format gets of a sample."""
    arrays: dict[str, Any] = {}
    for name in info["channels"]:
        if name == OBJECTS:
            arrays[name] = sample.objects
        elif name in SAMPLE_TABLES:
            arrays[name] = getattr(sample, name)
        else:
            arrays[name] = tables[name] if name in tables else sample[name]
    return Frame(record["index"], arrays, record, sample, tables.get(NEXT))


def finish_folder(fmt: Format, root: Path) -> int:
    """Writes what summarises all frames, then the card; returns their number. Only for the holder
    of the whole folder's lock."""
    info = json.loads((root / SOURCE_FILE).read_text(encoding="utf-8"))
    for name, parts in fmt.finish(info, lambda: records.records(root)):
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, parts)
    for folder in _folders(root):
        remove_temporary(folder)
    if (root / PARTIAL).exists():
        shutil.rmtree(root / PARTIAL)
    count = write_card(fmt, root, info)
    drop_notes(root)
    return count


def open_folder(fmt: Format, begun: Begun) -> Callable[[], FolderDataset]:
    """Opens a dataset in a folder, for write_datasets."""
    sim = begun.sim
    info = folder_info(fmt, sim, begun.chunk_size, begun.split)
    beside = fmt.begin(sim, info)
    info[SUMS] = {name: records.sums(data) for name, data in beside.items()}
    refuse_other_source(begun.root / SOURCE_FILE, info, sim)
    return partial(_open, fmt, begun, info, beside)


def _open(fmt: Format, begun: Begun, info: dict[str, Any], beside: Files) -> FolderDataset:
    """Writes all files beside the frames."""
    sim, root = begun.sim, begun.root
    make_folder(root)
    begun.lock()
    remove_temporary(root)
    if not check_same_source(root / SOURCE_FILE, info, sim):
        write_text(root / SOURCE_FILE, json_text(info))
    write_other_text(root / CONFIG_FILE, config_text(config_entry(sim)))
    for name, data in beside.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not (path.is_file() and path.read_bytes() == data):
            write_bytes(path, [data])
    return FolderDataset(fmt, sim, root, info)
