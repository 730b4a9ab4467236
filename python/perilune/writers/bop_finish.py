"""The last step of a dataset, made from its scenes as they lie on disk: targets and card."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from perilune.writers.bop_files import GT_FILE, INFO_FILE, SceneFolder, json_rows, write_text
from perilune.writers.bop_labels import LEAST_VISIBLE
from perilune.writers.bop_shards import NOTES

SOURCE_FILE = "dataset_info.json"
CARD_FILE = "dataset_info.md"
"""Written last: a dataset without it is not finished."""
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


@dataclass
class _Object:
    """What the card says of one model."""

    instances: int = 0
    visible: int = 0
    pixels: int = 0
    visib_fract: float = 0.0


@dataclass
class Summary:
    """Everything that targets and card need of the scenes."""

    scenes: int = 0
    images: int = 0
    objects: dict[int, _Object] = field(default_factory=dict)
    localisation: list[dict[str, int]] = field(default_factory=list)
    detection: list[dict[str, int]] = field(default_factory=list)

    def add(self, scene_id: int, im_id: int, instances: Instances) -> None:
        self.images += 1
        self.detection.append({"im_id": im_id, "scene_id": scene_id})
        targets: dict[int, int] = {}
        for gt, info in instances:
            row = self.objects.setdefault(gt["obj_id"], _Object())
            row.instances += 1
            row.pixels += info["px_count_visib"]
            row.visib_fract += info["visib_fract"]
            if info["visib_fract"] >= LEAST_VISIBLE:
                row.visible += 1
                targets[gt["obj_id"]] = targets.get(gt["obj_id"], 0) + 1
        for obj_id, count in targets.items():
            target = {"im_id": im_id, "inst_count": count, "obj_id": obj_id, "scene_id": scene_id}
            self.localisation.append(target)


def summary(split: Path) -> Summary:
    """Reads the labels of every scene of a split; each must be complete."""
    found = Summary()
    for scene_id, folder in scene_folders(split).items():
        found.scenes += 1
        for im_id, instances in images_of(folder):
            found.add(scene_id, im_id, instances)
    return found


def target_files(split: str, found: Summary) -> dict[str, str]:
    """Name -> text of the targets; only a test split has some."""
    if split.split("_")[0] != "test":
        return {}
    return {
        LOCALISATION: json_rows(found.localisation) + "\n",
        DETECTION: json_rows(found.detection) + "\n",
    }


_SHOWN = {
    "rgb": "the colours as they are",
    "sensor_rgb": "as the sensor's electronics show them",
    "raw": "digital numbers of the sensor, 16 bit",
}
"""Channel -> what the card says of it."""


def _picture_lines(pictures: Mapping[str, str]) -> list[str]:
    return [f"* `{folder}/`: {_SHOWN[channel]}" for folder, channel in pictures.items()]


def _sensor_lines(sensors: list[dict[str, Any]]) -> list[str]:
    if not sensors:
        return []
    told = [
        f"{row['name']} (every {row['trigger_interval']} steps)"
        if row["trigger_interval"] > 1
        else str(row["name"])
        for row in sensors
    ]
    return [f"* sensors, one after the other in every step: {', '.join(told)}"]


def card(info: Mapping[str, Any], camera: Mapping[str, Any], found: Summary) -> str:
    """The dataset card: what it shows, how much of it, and how it was made."""
    lines = [
        f"# {info['dataset_name']}",
        "",
        *([info["description"], ""] if info["description"] else []),
        "Synthetic images made by Perilune, in the BOP format: colour, depth, masks, poses.",
        "Lengths are in millimetres, camera axes are OpenCV's, pixel centres are integers.",
        "",
        f"* split: {info['split']}",
        f"* scenes: {found.scenes} of up to {info['chunk_size']} images",
        f"* images: {found.images} of {camera['width']} x {camera['height']} pixels",
        *_sensor_lines(info.get("sensors", [])),
        *_picture_lines(info.get("pictures", {})),
        "",
        f"| obj_id | instances | of which {LEAST_VISIBLE:.0%} visible | mean visible fraction "
        "| mean visible pixels |",
        "| --- | --- | --- | --- | --- |",
    ]
    for obj_id, row in sorted(found.objects.items()):
        count = max(row.instances, 1)
        lines.append(
            f"| {obj_id} | {row.instances} | {row.visible} | {row.visib_fract / count:.3f} "
            f"| {row.pixels / count:.1f} |"
        )
    lines += [
        "",
        f"Configuration `{info['config_name']}` (SHA-256 of its content "
        f"{info['config_sha256']}), seed {info['seed']}; `{SOURCE_FILE}` holds versions and the "
        "hashes of models and maps. Planets are no annotated objects. Depth beyond the farthest "
        "annotated surface may be 0. Labels are those of the ray through a pixel's centre.",
    ]
    return "\n".join(lines) + "\n"


def finish(root: Path) -> Summary:
    """Writes the targets, then the card."""
    info, camera = _read(root / SOURCE_FILE), _read(root / "camera.json")
    found = summary(root / info["split"])
    for name, text in target_files(info["split"], found).items():
        write_text(root / name, text)
    write_text(root / CARD_FILE, card(info, camera, found))
    shutil.rmtree(root / NOTES, ignore_errors=True)
    return found


def reopen(root: Path) -> None:
    """Takes away what would no longer be true when more scenes are written."""
    for name in (CARD_FILE, LOCALISATION, DETECTION):
        (root / name).unlink(missing_ok=True)
