"""Joins the shards of a dataset in a folder after checking them."""

from __future__ import annotations

import filecmp
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import (
    CARD_FILE,
    PARTIAL,
    SOURCE_FILE,
    TEMPORARY,
    load_object,
    make_folder,
    names_in,
    sync_files,
)
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.base import Format
from perilune.export.writers.formats.folder import SUMS, finish_folder
from perilune.export.writers.formats.packs import CHUNKS
from perilune.export.writers.lock import in_use, locked, writing_process
from perilune.export.writers.merge import (
    MergeReport,
    check_one_source,
    check_shards,
    whose,
)
from perilune.export.writers.shards import Note, chunks, read_notes

Found = dict[int, Path]
"""Frame -> folder that has it."""


def _frames(roots: Sequence[Path]) -> Found:
    """Where each frame is; a frame may be in two folders only if it is identical."""
    found: Found = {}
    for root in roots:
        for path in records.paths(root):
            other = found.setdefault(int(path.stem), root)
            theirs = records.path_of(other, int(path.stem))
            if other != root and theirs.read_bytes() != path.read_bytes():
                raise ValueError(f"{path}: is another frame than {theirs}")
    return found


def _check_complete(
    roots: Sequence[Path], notes: Sequence[Note], found: Found, chunk_size: int
) -> None:
    """Checks that every frame of the shards is there, and that its files are."""
    for note in notes:
        for chunk, images in chunks(note.frames, chunk_size).items():
            missing = [index for index in images.values() if index not in found]
            if missing:
                raise ValueError(
                    f"{roots[0]}: frame {missing[0]} is missing; run "
                    f"{whose(note, chunk_size, chunk)} again"
                )


def _pack_files(fmt: Format, root: Path, chunk_size: int, indices: list[int]) -> Iterator[str]:
    """The packed files of a folder and their notes; ValueError for one that is not finished."""
    assert fmt.pack_name is not None
    for chunk in sorted({index // chunk_size for index in indices}):
        own = [index for index in indices if index // chunk_size == chunk]
        note = load_object(root / CHUNKS / f"{chunk:06d}.json")
        name = fmt.pack_name.format(chunk=chunk)
        size = (root / name).stat().st_size if (root / name).is_file() else -1
        if note.get("frames") != own or note["file"]["bytes"] != size:
            raise ValueError(f"{root / name}: is not finished; run the command of its shard again")
        yield name
        yield f"{CHUNKS}/{chunk:06d}.json"


def _files(fmt: Format, root: Path, found: Found, chunk_size: int) -> Iterator[str]:
    """Names of the files of a folder's frames, each record behind the files that it names."""
    indices = sorted(index for index, where in found.items() if where == root)
    if fmt.pack_name is not None:
        yield from _pack_files(fmt, root, chunk_size, indices)
    for index in indices:
        path = records.path_of(root, index)
        record = records.read(path)
        if record is None:
            raise ValueError(f"{path}: is damaged; run the command of its shard again")
        for name, sums in record["files"].items() if fmt.pack_name is None else ():
            file = root / name
            if not file.is_file() or file.stat().st_size != sums["bytes"]:
                raise ValueError(f"{file}: is damaged; run the command of its shard again")
            yield name
        yield path.relative_to(root).as_posix()


def _place(source: Path, target: Path) -> None:
    """Links a file where the disk allows it, else copies it; completely or not at all."""
    if target.exists() and filecmp.cmp(source, target, shallow=False):
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f"{target.name}.{os.getpid()}{TEMPORARY}")
    temporary.unlink(missing_ok=True)
    try:
        os.link(source, temporary)
    except OSError:
        shutil.copyfile(source, temporary)
        sync_files([temporary])
    temporary.replace(target)
    temporary.unlink(missing_ok=True)  # two names of one file: then replacing does nothing


def merge_folders(
    fmt: Format, folders: Sequence[Path], out: Path | None, source: Mapping[str, Any]
) -> MergeReport:
    """Joins folders of one format; see merge_bop."""
    for root in folders:
        if (pid := writing_process(root)) is not None:
            raise in_use(root, pid)
    notes = [note for root in folders for note in read_notes(root)]
    for root in folders:
        if not read_notes(root) and not (root / CARD_FILE).is_file():
            raise ValueError(f"{root}: is not finished; run its `perilune render` command again")
        if names_in(root / PARTIAL):
            raise ValueError(f"{root}: is not finished; run its `perilune render` command again")
    check_shards(folders, notes)
    found, chunk_size = _frames(folders), int(source["chunk_size"])
    _check_complete(folders, notes, found, chunk_size)
    files = {root: list(_files(fmt, root, found, chunk_size)) for root in folders}
    target = folders[0] if out is None else out
    make_folder(target)
    with locked(target):
        (target / CARD_FILE).unlink(missing_ok=True)
        if target not in folders or len(folders) > 1:
            if (target / SOURCE_FILE).is_file():
                check_one_source([folders[0], target])
            for name in (SOURCE_FILE, CONFIG_FILE, *source[SUMS]):
                _place(folders[0] / name, target / name)
            for root, names in files.items():
                for name in names:
                    _place(root / name, target / name)
        count = finish_folder(fmt, target)
    return MergeReport(target, len({index // chunk_size for index in found}), count)
