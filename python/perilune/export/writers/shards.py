"""Divides a dataset's frames into chunks (scene folders), and chunks into shards."""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass
from pathlib import Path

from perilune.export.writers.files import json_text, write_text

Shard = tuple[int, int]
"""(k, n): the k-th of n parts, k from 0."""

NOTES = "shards"
"""Folder with notes of shards that are not merged yet."""
_OLD_NOTES = ".shards"
_IDS = 1_000_000


def chunks(frames: range, chunk_size: int) -> dict[int, dict[int, int]]:
    """Scene id -> image id -> frame index; a pure function, so workers can share the frames."""
    found: dict[int, dict[int, int]] = {}
    for index in sorted(frames):
        scene_id, im_id = divmod(index, chunk_size)
        found.setdefault(scene_id, {})[im_id] = index
    return found


def shard_chunks(frames: range, chunk_size: int, shard: Shard) -> dict[int, dict[int, int]]:
    """The chunks of one shard, which are consecutive; shards differ by at most one chunk."""
    part, count = shard
    every = list(chunks(frames, chunk_size).items())
    return dict(every[len(every) * part // count : len(every) * (part + 1) // count])


def check_frames(frames: range, chunk_size: int, shard: Shard) -> None:
    """ValueError for frames, a chunk size or a shard without valid scene and image ids."""
    if len(frames) == 0 or min(frames) < 0:
        raise ValueError(f"frames: {frames} must hold at least one index and none below 0")
    if not 1 <= chunk_size <= _IDS:
        raise ValueError(f"chunk_size: {chunk_size} must be in 1..{_IDS} (ids have six digits)")
    if max(frames) // chunk_size >= _IDS:
        raise ValueError(f"frames: {max(frames)} needs a scene id above 999999; use larger chunks")
    if not 0 <= shard[0] < shard[1]:
        raise ValueError(f"shard: {shard[0]}/{shard[1]} must be k/n with 0 <= k < n")


@dataclass(frozen=True)
class Note:
    """A shard's record for the merge: its frames and those of the whole."""

    frames: range
    shard: Shard

    def write(self, root: Path) -> None:
        """Writes the note to the dataset's folder, which shards may share."""
        (root / NOTES).mkdir(exist_ok=True)
        part, count = self.shard
        frames = [self.frames.start, self.frames.stop, self.frames.step]
        path = root / NOTES / f"{part}-of-{count}.json"
        write_text(path, json_text({"frames": frames, "shard": list(self.shard)}))


def read_notes(root: Path) -> list[Note]:
    """The notes of the shards that a folder holds."""
    notes = []
    for path in sorted((root / NOTES).glob("*.json")):
        try:
            value = json.loads(path.read_text(encoding="utf-8"))
            part, count = value["shard"]
            notes.append(Note(range(*value["frames"]), (int(part), int(count))))
        except (ValueError, TypeError, KeyError) as error:
            raise ValueError(f"{path}: is no note of a shard ({error})") from error
    return notes


def drop_notes(root: Path) -> None:
    """Removes the notes of shards. A part of them would stand for missing shards: they go at
    once."""
    shutil.rmtree(root / _OLD_NOTES, ignore_errors=True)
    if (root / NOTES).exists():
        (root / NOTES).rename(root / _OLD_NOTES)
        shutil.rmtree(root / _OLD_NOTES)
