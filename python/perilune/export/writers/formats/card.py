"""The card of a dataset in a folder: its content, its size, and how it was made."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from perilune.export.writers.files import CARD_FILE, write_other_text
from perilune.export.writers.formats import record as records
from perilune.export.writers.formats.base import Format, Info
from perilune.export.writers.formats.info import channels_of


@dataclass
class _Row:
    frames: int = 0
    seen: int = 0
    pixels: int = 0


@dataclass
class _Summary:
    frames: int = 0
    sizes: dict[tuple[int, int], int] = field(default_factory=dict)
    objects: dict[str, _Row] = field(default_factory=dict)


def _summary(found: Iterator[Mapping[str, Any]]) -> _Summary:
    total = _Summary()
    for record in found:
        total.frames += 1
        size = (record["camera"]["width"], record["camera"]["height"])
        total.sizes[size] = total.sizes.get(size, 0) + 1
        for row in record.get("objects", ()):
            own = total.objects.setdefault(row["name"], _Row())
            own.frames += 1
            own.seen += row["px_count_visib"] > 0
            own.pixels += row["px_count_visib"]
    return total


def _channel_lines(info: Info) -> Iterable[str]:
    yield "| channel | values | unit | what it is |"
    yield "| --- | --- | --- | --- |"
    for name, channel in channels_of(info).items():
        count = f" x {channel.components}" if channel.components else ""
        yield f"| `{name}` | {channel.dtype}{count} | {channel.unit} | {channel.doc} |"


def _object_lines(total: _Summary) -> Iterable[str]:
    if not total.objects:
        return
    yield ""
    yield "| object | frames in which it is seen | mean visible pixels there |"
    yield "| --- | --- | --- |"
    for name, row in total.objects.items():
        yield f"| {name} | {row.seen} of {row.frames} | {row.pixels / max(row.seen, 1):.1f} |"


def card_text(fmt: Format, info: Info, found: Iterator[Mapping[str, Any]]) -> tuple[str, int]:
    """The text, and the number of frames."""
    total = _summary(found)
    sizes = ", ".join(f"{n} of {w} x {h} pixels" for (w, h), n in sorted(total.sizes.items()))
    lines = [
        f"# {info['dataset_name']}",
        "",
        *([info["description"], ""] if info["description"] else []),
        f"Synthetic images made by Perilune, in the format `{fmt.name}`: {fmt.doc}.",
        "Lengths are in metres, camera axes are OpenCV's, pixel centres are integers, unless the "
        "format says otherwise.",
        "",
        f"* split: {info['split']}",
        f"* frames: {sizes}",
        f"* files: {fmt.layout}",
        f"* read by: {fmt.reader}",
        f"* `{records.FOLDER}/NNNNNN.json`: camera, date, Sun, states, poses and effects of each "
        "frame, and the sums of its files",
        "",
        *_channel_lines(info),
        *_object_lines(total),
        "",
        f"Configuration `{info['config_name']}` (SHA-256 of its content {info['config_sha256']}; "
        f"`config.json` has it whole), seed {info['seed']}; `dataset_info.json` holds versions, "
        "names of ids, and the hashes of models and maps.",
    ]
    return "\n".join(lines) + "\n", total.frames


def write_card(fmt: Format, root: Path, info: Info) -> int:
    """Writes the card, the last file of a dataset; returns the number of frames."""
    text, count = card_text(fmt, info, records.records(root))
    write_other_text(root / CARD_FILE, text)
    return count
