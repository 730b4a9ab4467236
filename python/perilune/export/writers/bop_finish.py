"""The last step of a dataset: targets and card, from its scenes on the disk."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from perilune.export.writers.bop_card import ObjectRow, Summary, card
from perilune.export.writers.bop_files import GT_FILE, INFO_FILE, SceneFolder
from perilune.export.writers.bop_labels import LEAST_VISIBLE
from perilune.export.writers.bop_models import FOLDERS, MODELS, MODELS_INFO, PARTS
from perilune.export.writers.files import (
    CARD_FILE,
    SOURCE_FILE,
    json_rows,
    remove_temporary,
    write_other_text,
)
from perilune.export.writers.shards import drop_notes

LOCALISATION = "test_targets_bop19.json"
DETECTION = "test_targets_bop24.json"


def scene_folders(split: Path) -> dict[int, Path]:
    """Scene id -> folder, in order."""
    if not split.is_dir():
        return {}
    return {int(path.name): path for path in sorted(split.iterdir()) if path.name.isdecimal()}


def _read(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


Instances = list[tuple[dict[str, Any], dict[str, Any]]]
"""The entries of scene_gt and scene_gt_info of one image, side by side."""


def images_of(folder: Path) -> Iterator[tuple[int, Instances]]:
    """Image id and instances of every image of a scene, which must be complete."""
    if not SceneFolder(folder).is_complete():
        raise ValueError(f"{folder}: is not finished; render its frames again")
    gts, infos = _read(folder / GT_FILE), _read(folder / INFO_FILE)
    for key in sorted(gts, key=int):
        yield int(key), list(zip(gts[key], infos[key], strict=True))


def _add(found: Summary, scene_id: int, im_id: int, instances: Instances) -> None:
    found.images += 1
    found.detection.append({"im_id": im_id, "scene_id": scene_id})
    found.empty += not any(info["px_count_visib"] for _, info in instances)
    targets: dict[int, int] = {}
    for gt, info in instances:
        row = found.objects.setdefault(gt["obj_id"], ObjectRow())
        row.instances += 1
        row.pixels += info["px_count_visib"]
        row.visib_fract += info["visib_fract"]
        if info["visib_fract"] >= LEAST_VISIBLE:
            row.visible += 1
            targets[gt["obj_id"]] = targets.get(gt["obj_id"], 0) + 1
    for obj_id, count in targets.items():
        target = {"im_id": im_id, "inst_count": count, "obj_id": obj_id, "scene_id": scene_id}
        found.localisation.append(target)


def summary(split: Path) -> Summary:
    """Reads the labels of every scene of a split; each must be complete."""
    found = Summary()
    for scene_id, folder in scene_folders(split).items():
        found.scenes += 1
        for im_id, instances in images_of(folder):
            _add(found, scene_id, im_id, instances)
    return found


def target_files(split: str, found: Summary) -> dict[str, str]:
    """Name -> text of the targets; only for a test split."""
    if split.split("_")[0] != "test":
        return {}
    return {
        LOCALISATION: json_rows(found.localisation) + "\n",
        DETECTION: json_rows(found.detection) + "\n",
    }


def closing_texts(root: Path, found: Summary) -> dict[str, str]:
    """Name -> text of the files that summarise the scenes of a dataset."""
    info, camera = _read(root / SOURCE_FILE), _read(root / "camera.json")
    models = _read(root / MODELS / MODELS_INFO)
    parts = (root / PARTS / MODELS_INFO).is_file()
    return {
        **target_files(info["split"], found),
        CARD_FILE: card(info, camera, models, parts, found),
    }


def finish(root: Path) -> Summary:
    """Writes the targets, then the card. Only for the holder of the whole folder's lock."""
    for folder in (root, *(root / name for name in FOLDERS)):
        remove_temporary(folder)
    found = summary(root / _read(root / SOURCE_FILE)["split"])
    for name, text in closing_texts(root, found).items():
        write_other_text(root / name, text)
    drop_notes(root)
    return found


def reopen(root: Path) -> None:
    """Removes files that become outdated when more scenes are written."""
    for name in (CARD_FILE, LOCALISATION, DETECTION):
        (root / name).unlink(missing_ok=True)
