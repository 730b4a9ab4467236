"""Checks a written dataset against itself and its configuration: files, labels, images, models,
targets."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from perilune.export.check.findings import Finding, Report
from perilune.export.check.folder import check_folder
from perilune.export.check.models import check_shapes
from perilune.export.check.pictures import PictureCheck
from perilune.export.check.records import Camera, Source, read_json
from perilune.export.check.remake import compare_with_config
from perilune.export.check.retrace import Tracer
from perilune.export.check.scene import check_scene
from perilune.export.writers.bop_files import RGB_FOLDER
from perilune.export.writers.bop_finish import DETECTION, LOCALISATION, closing_texts, summary
from perilune.export.writers.bop_models import FOLDERS
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import CARD_FILE, SOURCE_FILE
from perilune.export.writers.formats.opened import FORMAT_KEY, format_folders, known_format
from perilune.export.writers.formats.tables import FORMATS
from perilune.export.writers.lock import LOCK_FILE, writing_process
from perilune.export.writers.shards import NOTES

__all__ = ["RERENDERED", "Finding", "Report", "check", "check_bop"]

RERENDERED = 8
"""Default number of images that are rendered in full for a comparison of colour."""

_ROOT_FILES = {"camera.json", CONFIG_FILE, SOURCE_FILE, CARD_FILE}


def _scenes(report: Report, split: Path) -> list[Path]:
    """The scene folders; readers expect every name in a split's folder to be a number."""
    if not split.is_dir():
        report.add(split, "is missing")
        return []
    folders = []
    for path in sorted(split.iterdir()):
        named = path.is_dir() and len(path.name) == 6 and path.name.isdecimal()
        if report.need(named, path, "is no scene folder (six digits)"):
            folders.append(path)
    report.need(bool(folders), split, "holds no scene")
    return folders


def _of_lock(folder: Path) -> str:
    pid = writing_process(folder)
    if pid is None:
        return "is left of a run that was stopped: the same command finishes it"
    return f"{f'process {pid}' if pid else 'another process'} is writing to the dataset"


def _check_layout(report: Report, split: str) -> None:
    known = {*_ROOT_FILES, *FOLDERS, split, LOCALISATION, DETECTION, NOTES}
    for path in sorted(report.folder.iterdir()):
        if path.name == LOCK_FILE:
            report.add(path, _of_lock(report.folder))
        else:
            report.need(path.name in known, path, "is not part of the dataset")
    if (report.folder / NOTES).exists():
        report.add(report.folder / NOTES, "shards are not merged: run `perilune merge` on them")


def _check_summary(report: Report, source: Source) -> None:
    """Compares card and targets with the scenes; only if the scenes are good."""
    root = report.folder
    found = summary(root / source.split)
    texts = closing_texts(root, found)
    for name, text in texts.items():
        path = root / name
        if not path.is_file():
            report.add(path, "is missing: the dataset is not finished")
        elif path.read_text(encoding="utf-8") != text:
            report.add(path, "does not agree with the scenes")
    for name in sorted({LOCALISATION, DETECTION} - set(texts)):
        report.need(not (root / name).exists(), root / name, "only a test split has targets")


def check_bop(
    folder: str | Path,
    progress: Callable[[int, int], None] | None = None,
    *,
    rerender: int | None = RERENDERED,
    base: str | Path | None = None,
    alone: bool = False,
) -> Report:
    """Checks a BOP dataset that `write_bop` has written, and returns a Report of its findings.

    progress: called with (images done, images). rerender: number of images to render in full for a
    comparison of colour; None: all. base: folder that relative paths of the configuration refer to,
    if it is no longer the one recorded in the dataset. alone: checks the dataset only against
    itself, without its configuration."""
    report = Report(Path(folder))
    if not report.folder.is_dir():
        raise FileNotFoundError(f"{folder}: no such folder")
    source = read_json(report, report.folder / SOURCE_FILE, TypeAdapter(Source))
    camera = read_json(report, report.folder / "camera.json", TypeAdapter(Camera))
    shapes = check_shapes(report)
    if source is None or camera is None:
        return report
    _check_layout(report, source.split)
    folders = _scenes(report, report.folder / source.split)
    total = sum(len(list((path / RGB_FOLDER).glob("*.png"))) for path in folders)
    total *= 1 if alone else 2
    done = 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(min(done, total), total)

    tracer = Tracer(shapes, (camera.width, camera.height))
    for path in folders:
        check_scene(report, path, source, tracer, step)
    if not report.findings:
        _check_summary(report, source)
    where = None if base is None else Path(base)
    if alone or not compare_with_config(report, source, folders, rerender, where, step):
        pictures = PictureCheck(report)
        for path in folders:
            pictures.scene(path)
    return report


def check(
    folder: str | Path,
    progress: Callable[[int, int], None] | None = None,
    *,
    rerender: int | None = RERENDERED,
    base: str | Path | None = None,
    alone: bool = False,
) -> list[Report]:
    """Checks a dataset of any format, or each of several in one folder: a Report each.

    Arguments are those of check_bop; rerender counts frames that are compared to the byte."""
    root = Path(folder)
    if not root.is_dir():
        raise FileNotFoundError(f"{folder}: no such folder")
    reports = []
    for name in format_folders(root):
        own = root / name
        try:
            info = json.loads((own / SOURCE_FILE).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            info = {}  # reported by the check
        if not isinstance(info, dict) or FORMAT_KEY not in info:
            options: dict[str, Any] = {"rerender": rerender, "base": base, "alone": alone}
            reports.append(check_bop(own, progress, **options))
            continue
        fmt = FORMATS[known_format(own, info)]
        where = None if base is None else Path(base)
        reports.append(check_folder(fmt, own, info, progress, rerender, where, alone))
    return reports
