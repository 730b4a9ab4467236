"""Checks the arguments of writers, and that the folder is free for the dataset."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from perilune.base.arguments import whole
from perilune.drivers import path_text
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import SOURCE_FILE

_SHOWN_CHANGES = 5
_SHOWN = 60
_SPLIT = re.compile(r"[a-z0-9]+(_[a-z0-9]+)?")


def check_simulation(sim: Any) -> None:
    """TypeError for an object that is no simulation, such as the path of a configuration."""
    if not hasattr(sim, "document"):  # what stands for a simulation, as a proxy, is one
        given = f"'{sim}'" if isinstance(sim, (str, Path)) else f"{sim!r:.60}"
        raise TypeError(
            f"sim: must be a perilune.Simulation, as perilune.open('scene.yaml') gives, not {given}"
        )


def as_range(frames: Any) -> range:
    """The frames as a range, also from a list or an array of evenly spaced, ascending indices.

    TypeError for other types, ValueError for indices that are not evenly spaced."""
    if isinstance(frames, range):
        return frames
    if isinstance(frames, np.ndarray):
        frames = frames.tolist()
    if isinstance(frames, (str, bytes)) or not isinstance(frames, Sequence):
        text = "must be a range such as range(1000), or a list of evenly rising indices"
        raise TypeError(f"frames: {text}, not {_described(frames)}")
    numbers = [whole(f"frames[{k}]", value) for k, value in enumerate(frames)]
    if len(numbers) < 2:
        return range(numbers[0], numbers[0] + 1) if numbers else range(0)
    step = numbers[1] - numbers[0]
    found = range(numbers[0], numbers[-1] + (1 if step > 0 else -1), step) if step else range(0)
    if list(found) != numbers or step < 0:
        at = next((k for k, n in enumerate(numbers[1:], 1) if n - numbers[k - 1] != step), 1)
        raise ValueError(
            f"frames[{at}] = {numbers[at]}: indices must rise evenly, as those of a range do; "
            "others take several calls, each with a folder of its own"
        )
    return found


def _described(value: Any) -> str:
    return f"the number {value}" if isinstance(value, int) else f"a {type(value).__name__}"


def check_split(split: str) -> None:
    """ValueError for a name that is none of a split: it is part of files' names."""
    if not _SPLIT.fullmatch(split):
        raise ValueError(
            f"split: {split!r} must be lower-case letters and digits, with one '_' before a type"
        )


def check_folder(out: Any) -> Path:
    """The dataset's folder; ValueError if it holds anything else than a dataset of ours."""
    if not isinstance(out, (str, Path)):
        raise TypeError(f"out: must be the path of a folder, not {type(out).__name__} {out!r:.60}")
    root = Path(out)
    if not root.is_dir() or (root / SOURCE_FILE).exists():
        return root
    foreign = sorted(
        path.name
        for path in root.iterdir()
        if not path.name.startswith(".") and not path.name.endswith((".tmp", ".lock"))
    )
    if foreign:
        more = f" and {len(foreign) - 1} more" if len(foreign) > 1 else ""
        raise ValueError(
            f"{root}: holds {foreign[0]}{more}, and no {SOURCE_FILE}: it is no dataset of "
            "Perilune; use an empty or a new folder"
        )
    return root


def changed_keys(root: Path, tree: Mapping[str, Any]) -> str:
    """Keys in which a configuration differs from that of a dataset; empty if that is lost."""
    try:
        kept = json.loads((root / CONFIG_FILE).read_text(encoding="utf-8"))["tree"]
    except (OSError, ValueError, KeyError, TypeError):
        return ""
    found = list(_changes(kept, json.loads(json.dumps(tree)), ()))
    shown = "; ".join(found[:_SHOWN_CHANGES])
    more = len(found) - _SHOWN_CHANGES
    return f"{shown} and {more} more" if more > 0 else shown


def _changes(old: Any, new: Any, path: tuple[str | int, ...]) -> Iterator[str]:
    if isinstance(old, dict) and new is _ABSENT:
        new = {}
    if isinstance(new, dict) and old is _ABSENT:
        old = {}
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys((*old, *new)):
            if (*path, key) != ("seed",):
                yield from _changes(old.get(key, _ABSENT), new.get(key, _ABSENT), (*path, key))
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for k, (before, now) in enumerate(zip(old, new, strict=True)):
            yield from _changes(before, now, (*path, k))
    elif old != new and not (old is new is _ABSENT):
        yield f"{path_text(path)} was {_short(old)}, here {_short(new)}"


_ABSENT = object()


def _short(value: Any) -> str:
    text = "not given" if value is _ABSENT else json.dumps(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
