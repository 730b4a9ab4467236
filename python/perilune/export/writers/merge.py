"""Joins the shards of a BOP dataset after checking them, then writes targets and card."""

from __future__ import annotations

import logging
import os
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from perilune.export.writers.bop_files import CAMERA_FILE, SceneFolder
from perilune.export.writers.bop_finish import finish, reopen, scene_folders
from perilune.export.writers.bop_models import FOLDERS
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import (
    CARD_FILE,
    SOURCE_FILE,
    load_object,
    make_folder,
    sync_files,
    sync_folder,
    write_bytes,
)
from perilune.export.writers.lock import in_use, locked, writing_process
from perilune.export.writers.shards import Note, chunks, read_notes, shard_chunks
from perilune.export.writers.whole import is_whole

_log = logging.getLogger(__name__)

_STAGE = ".merge"
_SHOWN = 8


@dataclass(frozen=True)
class MergeReport:
    """Result of a merge."""

    folder: Path
    scenes: int
    images: int


def _source(folder: Path) -> dict[str, Any]:
    path = folder / SOURCE_FILE
    if not path.is_file():
        raise FileNotFoundError(f"{folder}: is no dataset (it has no {SOURCE_FILE})")
    value = load_object(path)
    if not {"split", "chunk_size"} <= set(value):
        raise ValueError(f"{path}: is not what `perilune render` writes")
    return value


def check_one_source(folders: Sequence[Path]) -> dict[str, Any]:
    """Checks that all folders hold parts of one dataset; returns the first one's description of
    it."""
    first = _source(folders[0])
    for folder in folders[1:]:
        other = _source(folder)
        for key in sorted({*first, *other} - {"versions"}):
            if first.get(key) != other.get(key):
                raise ValueError(
                    f"{folder}: is of another dataset than {folders[0]}: {key} is "
                    f"{other.get(key)!r} there and {first.get(key)!r} here"
                )
        if first.get("versions") != other.get("versions"):
            _log.warning("%s: was made with other versions than %s", folder, folders[0])
    return first


def _check_shared_files(folders: Sequence[Path]) -> None:
    """Checks that camera and models are identical in all folders."""
    for folder in folders[1:]:
        for name in ("camera.json", "models/models_info.json"):
            if (folder / name).read_bytes() != (folders[0] / name).read_bytes():
                raise ValueError(f"{folder / name}: differs from that of {folders[0]}")
    for folder in folders:
        for path in sorted(path for name in FOLDERS for path in (folder / name).glob("*.ply")):
            if not is_whole(path):
                raise ValueError(f"{path}: is damaged; run the command of its shard again")


def _found_scenes(folders: Sequence[Path], split: str) -> dict[int, Path]:
    """Scene id -> folder; a scene may be in two folders only if it is identical."""
    found: dict[int, Path] = {}
    for folder in folders:
        for scene_id, path in scene_folders(folder / split).items():
            other = found.setdefault(scene_id, path)
            if other != path and _labels(other) != _labels(path):
                raise ValueError(
                    f"{path}: is another scene than {other}; parts of a dataset are split "
                    "at scene folders (--shard does so)"
                )
    return found


def _labels(scene: Path) -> list[bytes]:
    return [file.read_bytes() for file in sorted(scene.glob("*.json"))]


def check_shards(folders: Sequence[Path], notes: Sequence[Note]) -> None:
    """Checks that every shard of every frame range has left its note."""
    parts: dict[tuple[range, int], set[int]] = {}
    for note in notes:
        parts.setdefault((note.frames, note.shard[1]), set()).add(note.shard[0])
    for (frames, count), seen in parts.items():
        missing = [f"{k}/{count}" for k in range(count) if k not in seen]
        if missing:
            shown = ", ".join(missing[:_SHOWN]) + (", ..." if len(missing) > _SHOWN else "")
            raise ValueError(
                f"{', '.join(map(str, folders))}: of the shards of frames {frames.start}:"
                f"{frames.stop}{f':{frames.step}' if frames.step != 1 else ''}, {shown} "
                f"{'is' if len(missing) == 1 else 'are'} missing"
            )


def whose(note: Note, chunk_size: int, scene_id: int) -> str:
    count = note.shard[1]
    for part in range(count):
        if scene_id in shard_chunks(note.frames, chunk_size, (part, count)):
            return f"--shard {part}/{count}"
    return "the whole"


def _check_complete(
    folders: Sequence[Path], notes: Sequence[Note], found: Mapping[int, Path], chunk_size: int
) -> None:
    """Checks that every frame of the shards exists, in a finished scene."""
    for scene_id, path in found.items():
        if not SceneFolder(path).is_complete():
            who = whose(notes[0], chunk_size, scene_id) if notes else "the same command"
            raise ValueError(f"{path}: is not finished; run {who} again")
    for note in notes:
        for scene_id, images in chunks(note.frames, chunk_size).items():
            folder = found.get(scene_id)
            there = load_object(folder / CAMERA_FILE) if folder is not None else {}
            missing = [im_id for im_id in images if str(im_id) not in there]
            if missing:
                where = folder or folders[0]
                raise ValueError(
                    f"{where}: image {missing[0]} of scene {scene_id} (frame "
                    f"{images[missing[0]]}) is missing; run "
                    f"{whose(note, chunk_size, scene_id)} again"
                )


def _copy(source: str, target: str) -> None:
    """Links the file where the disk allows it, else copies it: files are only ever replaced
    whole."""
    try:
        os.link(source, target)
    except OSError:
        shutil.copyfile(source, target)
        sync_files([Path(target)])


def _copy_folder(source: Path, target: Path, stage: Path) -> None:
    """Copies a folder completely, or leaves nothing under its name."""
    if target.exists():
        return
    shutil.rmtree(stage, ignore_errors=True)
    shutil.copytree(source, stage, copy_function=_copy)
    target.parent.mkdir(parents=True, exist_ok=True)
    stage.rename(target)
    sync_folder(target.parent)


def _gather(first: Path, scenes: Iterable[tuple[int, Path]], root: Path, split: str) -> None:
    """Collects the scenes and the shards' common files in one folder."""
    if (root / SOURCE_FILE).is_file():
        check_one_source([first, root])  # an earlier merge, interrupted or of fewer frames
    reopen(root)
    shutil.rmtree(root / _STAGE, ignore_errors=True)
    for name in (SOURCE_FILE, CONFIG_FILE, "camera.json"):
        if not (root / name).exists():
            write_bytes(root / name, [(first / name).read_bytes()])
    for name in FOLDERS:
        if (first / name).exists():
            _copy_folder(first / name, root / name, root / _STAGE)
    for scene_id, path in scenes:
        _copy_folder(path, root / split / f"{scene_id:06d}", root / _STAGE)


def merge_bop(folders: Sequence[str | Path], out: str | Path | None = None) -> MergeReport:
    """Joins shards to a dataset that is identical to that of a single run.

    folders: those that `write_bop(..., shard=...)` has written to, each with one or more shards, or
    whole datasets of other frames. out: folder of the dataset; None completes the only folder in
    place. Files are linked where the disk allows it, else copied.

    Raises ValueError if shards, scenes or images are missing, or if the folders do not belong
    together."""
    roots = [Path(folder) for folder in dict.fromkeys(map(str, folders))]
    if out is None and len(roots) != 1:
        raise ValueError(f"{len(roots)} folders to merge: --out must say where to")
    source = check_one_source(roots)
    for root in roots:
        if (pid := writing_process(root)) is not None:
            raise in_use(root, pid)
    _check_shared_files(roots)
    split, chunk_size = str(source["split"]), int(source["chunk_size"])
    notes = [note for root in roots for note in read_notes(root)]
    for root in roots:
        if not read_notes(root) and not (root / CARD_FILE).is_file():
            raise ValueError(f"{root}: is not finished; run its `perilune render` command again")
    check_shards(roots, notes)
    found = _found_scenes(roots, split)
    _check_complete(roots, notes, found, chunk_size)
    target = roots[0] if out is None else Path(out)
    make_folder(target)
    with locked(target):
        if target not in roots or len(roots) > 1:
            _gather(roots[0], sorted(found.items()), target, split)
        summary = finish(target)
    return MergeReport(target, summary.scenes, summary.images)
