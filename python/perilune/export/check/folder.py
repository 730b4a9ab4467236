"""Checks datasets in folders, of any format: files, sums, arrays, and the configuration."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from perilune.export.check.findings import Report
from perilune.export.check.invariants import faults
from perilune.export.check.reopened import reopened
from perilune.export.writers.bop_channels import TABLES
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import CARD_FILE, PARTIAL, SOURCE_FILE
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.base import Format, PackReader
from perilune.export.writers.formats.card import card_text
from perilune.export.writers.formats.folder import SUMS, frame_of, record_for, rendered_for
from perilune.export.writers.formats.info import folder_info
from perilune.export.writers.formats.packs import CHUNKS, file_sums
from perilune.export.writers.lock import LOCK_FILE, writing_process
from perilune.export.writers.run import NEXT, tables_of
from perilune.export.writers.scans import is_scan
from perilune.export.writers.shards import NOTES
from perilune.simulation import Simulation

Step = Callable[[], None]
Read = Callable[[str], bytes]


class FolderCheck:
    """The check of one dataset."""

    def __init__(self, report: Report, fmt: Format, info: Mapping[str, Any]) -> None:
        self._report, self._fmt, self._info = report, fmt, info
        self._root = report.folder
        self._known = {SOURCE_FILE, CONFIG_FILE, CARD_FILE}
        self._records: dict[int, dict[str, Any]] = {}
        self._places: dict[tuple[Any, Any, int], dict[str, Any]] | None = None

    def run(self, rerender: int | None, base: Path | None, alone: bool, step: Step) -> None:
        """All checks. rerender: frames to render again; None: all."""
        self._beside()
        for path in records.paths(self._root):
            self._known.add(path.relative_to(self._root).as_posix())
            record = records.read(path)
            if self._report.need(record is not None, path, "is damaged"):
                self._records[int(path.stem)] = record or {}
        if self._fmt.pack_name is None:
            for index, record in self._records.items():
                self._frame(index, record, lambda name: (self._root / name).read_bytes())
                self._known.update(record["files"])
                step()
        else:
            self._packs(step)
        if not self._report.findings:
            self._closing()
        self._layout()
        if not alone:
            self._remake(rerender, base)

    def _beside(self) -> None:
        for name, stated in self._info[SUMS].items():
            path = self._root / name
            self._known.add(name)
            if not path.is_file():
                self._report.add(path, "is missing")
            elif records.sums(path.read_bytes()) != stated:
                self._report.add(path, f"is not the file that {SOURCE_FILE} states")

    def _packs(self, step: Step) -> None:
        size, name = int(self._info["chunk_size"]), self._fmt.pack_name
        assert name is not None
        for chunk in sorted({index // size for index in self._records}):
            path = self._root / name.format(chunk=chunk)
            note = self._root / CHUNKS / f"{chunk:06d}.json"
            self._known |= {p.relative_to(self._root).as_posix() for p in (path, note)}
            indices = [index for index in self._records if index // size == chunk]
            self._pack_note(path, note, indices)
            with ExitStack() as held:
                try:
                    reader: PackReader = held.enter_context(self._fmt.unpack(path))
                    self._members(path, reader, indices)
                except Exception as error:  # of damaged files, anything
                    self._report.add(path, f"cannot be opened: {error}")
                    continue
                for index in indices:
                    self._frame(index, self._records[index], reader.read)
                    step()

    def _pack_note(self, path: Path, note: Path, indices: list[int]) -> None:
        try:
            told = json.loads(note.read_text(encoding="utf-8"))
            good = told["frames"] == indices and told["file"] == file_sums(path)
        except (OSError, ValueError, KeyError):
            good = False
        self._report.need(good, path, f"is not the file that {CHUNKS}/{note.name} states")

    def _members(self, path: Path, reader: PackReader, indices: list[int]) -> None:
        named = {name for index in indices for name in self._records[index]["files"]}
        for name in sorted(set(reader.names()) - named):
            self._report.add(path, f"{name} is of no frame")

    def _frame(self, index: int, record: dict[str, Any], read: Read) -> None:
        """The files of a frame, and what they hold."""
        report = self._report
        report.images += 1
        report.instances += len(record.get("objects", ()))
        good = True
        for name, stated in record["files"].items():
            path = self._root / name if self._fmt.pack_name is None else self._frame_path(index)
            where = f"frame {index}: {name} " if self._fmt.pack_name is not None else ""
            try:
                same = records.matches(read(name), stated)
                good &= report.need(same, path, f"{where}is not the file that its record states")
            except Exception:  # missing, or damaged in any way
                report.add(path, f"{where}is missing or cannot be read")
                good = False
        if not good:
            return
        try:
            arrays = self._fmt.decode(self._info, record, read)
        except Exception as error:  # of a file that its record agrees with, anything
            report.add(self._frame_path(index), f"frame {index}: cannot be decoded: {error}")
            return
        for text in (
            *faults(self._info, record, arrays, lambda steps: self._beside_frame(record, steps)),
            *self._fmt.faults(self._info, record, arrays, read),
        ):
            report.add(self._frame_path(index), f"frame {index}: {text}")

    def _beside_frame(self, record: Mapping[str, Any], steps: int) -> Mapping[str, Any] | None:
        """The record of the same sensor in the same scene, some steps later."""
        if self._places is None:
            self._places = {_place(row): row for row in self._records.values()}
        sensor, scene, step = _place(record)
        return self._places.get((sensor, scene, step + steps))

    def _frame_path(self, index: int) -> Path:
        return records.path_of(self._root, index)

    def _closing(self) -> None:
        """Compares what summarises the frames with them."""

        def every() -> Iterator[dict[str, Any]]:
            return iter(self._records.values())

        for name, parts in self._fmt.finish(self._info, every):
            path = self._root / name
            self._known.add(name)
            if not path.is_file():
                self._report.add(path, "is missing: the dataset is not finished")
            elif path.read_bytes() != b"".join(parts):
                self._report.add(path, "does not agree with the frames")
        path, (text, _) = self._root / CARD_FILE, card_text(self._fmt, self._info, every())
        if not path.is_file():
            self._report.add(path, "is missing: the dataset is not finished")
        elif path.read_text(encoding="utf-8") != text:
            self._report.add(path, "does not agree with the frames")

    def _layout(self) -> None:
        """Files that belong to nothing."""
        summaries = {name for name, _ in self._fmt.finish(self._info, lambda: iter(()))}
        for path in sorted(self._root.rglob("*")):
            name = path.relative_to(self._root).as_posix()
            if name == LOCK_FILE:
                pid = writing_process(self._root)
                told = "is left of a run that was stopped: the same command finishes it"
                self._report.add(path, told if pid is None else f"process {pid} is writing")
            elif name in (PARTIAL, NOTES):
                told = "shards are not merged" if name == NOTES else "is not finished"
                self._report.add(path, f"{told}: run `perilune merge`, or the same command, again")
            elif path.is_file() and name.split("/")[0] not in (PARTIAL, NOTES):
                known = name in self._known or name in summaries
                self._report.need(known, path, "is not part of the dataset")

    def _remake(self, rerender: int | None, base: Path | None) -> None:
        """Renders frames again, evenly spread, and compares their files to the byte."""
        sim = reopened(self._report, base)
        if sim is None or not self._records:
            return
        made = folder_info(self._fmt, sim, self._info["chunk_size"], self._info["split"])
        made[SUMS] = {k: records.sums(v) for k, v in self._fmt.begin(sim, made).items()}
        if made["versions"] != self._info["versions"]:
            told = f"the dataset was made by {self._info['versions']}"
            self._report.note(f"frames were not made again for comparison: {told}")
            return
        path = self._root / SOURCE_FILE
        for key in sorted({*made, *self._info}):
            same = json.loads(json.dumps(made.get(key))) == self._info.get(key)
            self._report.need(same, path, f"{key} is not what the configuration makes")
        indices = sorted(self._records)
        count = len(indices) if rerender is None else min(rerender, len(indices))
        for k in range(count):
            self._compare(sim, indices[(2 * k + 1) * len(indices) // (2 * count)])
        told = f"{count} of {len(indices)} frames were rendered again (--rerender all: all)"
        self._report.note(told)

    def _compare(self, sim: Simulation, index: int) -> None:
        sample = sim.frame(index, channels=rendered_for(sim, self._info))
        own = [name for name in self._info["channels"] if name in TABLES or is_scan(name)]
        tables = tables_of(sim, sample, own)
        if self._fmt.needs_next:
            follows = sim.timeline.beside(index, 1)
            shown = self._info["picture"]
            tables[NEXT] = (sample if follows is None else sim.frame(follows, [shown]))[shown]
        base = record_for(sim, self._info, sample)
        encoded = self._fmt.encode(self._info, frame_of(self._info, sample, tables, base))
        found = self._records[index]
        path, told = self._frame_path(index), "is not what the configuration makes"
        for key, value in base.items():
            same = json.loads(json.dumps(value)) == found.get(key)
            self._report.need(same, path, f"frame {index}: {key} {told}")
        for name, data in encoded.files.items():
            same = records.sums(data) == found["files"].get(name)
            self._report.need(same, path, f"frame {index}: {name} {told}")
        labels = json.loads(json.dumps(encoded.labels))
        self._report.need(labels == found.get("labels"), path, f"frame {index}: labels {told}")


def _place(record: Mapping[str, Any]) -> tuple[Any, Any, int]:
    """Sensor, scene and step of a frame."""
    meta = record["meta"]
    return meta["sensor"], meta["scene"], int(meta["step"])


def check_folder(
    fmt: Format,
    root: Path,
    info: Mapping[str, Any],
    progress: Callable[[int, int], None] | None,
    rerender: int | None,
    base: Path | None,
    alone: bool,
) -> Report:
    """Checks a dataset of a format in a folder; see check_bop. info: its dataset_info.json."""
    report = Report(root)
    total, done = len(records.paths(root)), 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, total)

    FolderCheck(report, fmt, info).run(rerender, base, alone, step)
    return report
