"""Writes the model folders of a BOP dataset, if they are not there yet."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from perilune.export.writers.bop_eval import evaluation_model
from perilune.export.writers.bop_models import (
    EVAL,
    MODELS,
    MODELS_INFO,
    PARTS,
    BopModel,
    model_info,
    ply_bytes,
)
from perilune.export.writers.files import json_by_id, load_object, write_bytes
from perilune.export.writers.whole import is_whole

Models = Mapping[int, BopModel]


@dataclass(frozen=True)
class _Folder:
    """Content of a folder."""

    name: str
    numbers: tuple[int, ...]
    make: Callable[[], Models]
    extra: Mapping[int, dict[str, Any]]
    """Keys of models_info.json in addition to those of all models."""
    exact: bool
    """Whether existing models are compared, because poses refer to their frame."""


def _folders(models: Models) -> list[_Folder]:
    """All required folders. Moving parts are numbered through all objects."""
    pieces: dict[int, BopModel] = {}
    extra: dict[int, dict[str, Any]] = {}
    for obj_id in sorted(models):
        for chain, piece in models[obj_id].pieces():
            number = len(pieces) + 1
            pieces[number], extra[number] = piece, {"obj_id": obj_id, "nodes": list(chain)}

    def coarse() -> Models:
        return {obj_id: evaluation_model(model) for obj_id, model in models.items()}

    found = [_Folder(MODELS, tuple(models), lambda: models, {}, True)]
    if pieces:
        found.insert(0, _Folder(PARTS, tuple(pieces), lambda: pieces, extra, True))
    if models:
        found.insert(0, _Folder(EVAL, tuple(models), coarse, {}, False))
    return found


def _ply(folder: Path, number: int) -> Path:
    return folder / f"obj_{number:06d}.ply"


def _is_there(root: Path, wanted: _Folder) -> bool:
    """Whether a folder is complete; ValueError if its models are not those of the simulation."""
    folder = root / wanted.name
    told = load_object(folder / MODELS_INFO)
    whole = is_whole(folder / MODELS_INFO) and set(told) == set(map(str, wanted.numbers))
    for number in wanted.numbers if whole else ():
        path = _ply(folder, number)
        if not is_whole(path):
            whole = False
        elif wanted.exact and path.read_bytes() != b"".join(ply_bytes(wanted.make()[number])):
            raise ValueError(
                f"{path}: is not the model of this configuration, as this version of Perilune "
                "writes it; use another folder, so that all frames are of one model"
            )
    return whole


def complete_models(root: Path, models: Models) -> None:
    """Writes missing or damaged folders of models: each PLY, then models_info.json.

    ValueError for a folder with other models. Moving parts are in the frame of their object's model
    at rest; a part moves with the first of its `nodes` that the `articulation` of an instance
    names. Evaluation models have the frame of the models."""
    for wanted in _folders(models):
        if _is_there(root, wanted):
            continue
        (root / wanted.name).mkdir(parents=True, exist_ok=True)
        for name, parts in _files(wanted):
            write_bytes(root / name, parts)


def _files(wanted: _Folder) -> Iterator[tuple[str, Iterable[bytes]]]:
    """Path and content of the files of a folder, the list of its models last."""
    rows = wanted.make()
    for number, model in sorted(rows.items()):
        yield _ply(Path(wanted.name), number).as_posix(), ply_bytes(model)
    infos = {k: {**model_info(row), **wanted.extra.get(k, {})} for k, row in rows.items()}
    yield f"{wanted.name}/{MODELS_INFO}", [json_by_id(infos).encode("utf-8")]


def model_files(models: Models) -> dict[str, bytes]:
    """Path -> content of all files of models."""
    folders = [_files(wanted) for wanted in _folders(models)]
    return {name: b"".join(parts) for files in folders for name, parts in files}
