"""The card of a dataset: its content, its size, and how it was made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from perilune.export.writers.bop_files import FRAMES_FILE, KEYPOINTS_FILE
from perilune.export.writers.bop_labels import LEAST_VISIBLE
from perilune.export.writers.config_file import CONFIG_FILE
from perilune.export.writers.files import SOURCE_FILE

_SHOWN = {
    "rgb": "the colours as they are",
    "sensor_rgb": "as the sensor's electronics show them",
    "raw": "digital numbers of the sensor, 16 bit",
}
"""Channel -> its description on the card."""
_ROLLING = (
    "The shutter rolls: labels of a row are of the middle of its exposure. Poses are of the middle "
    "of the frame; `rows`, in scene_gt.json and scene_camera.json, gives those of some rows, and "
    "between these things move straight and turn by the shorter way, in camera axes. A scene "
    "without `rows` in an image had nothing that moved."
)
_MODELS = (
    "Models are what is rendered, at rest. Triangles that are seen from both sides are there once "
    "for each: a renderer that culls back faces sees the same; without culling, backs are drawn "
    "that no image here shows, as those of closed hulls. Triangles of which their material's alpha "
    "leaves nothing are left out. Faces that alpha cuts in part, the last of a file, are there "
    "whole."
)
_PARTS = (
    "`models_parts/` holds the parts that move, in the frame of their object's model at rest. In "
    "an image a part is moved by the motion that `articulation` in scene_gt.json gives (4 x 4, mm, "
    "before the pose) of the first of the part's `nodes` that it names; by none, it stays."
)


@dataclass
class ObjectRow:
    """The card's row for a model."""

    instances: int = 0
    visible: int = 0
    pixels: int = 0
    visib_fract: float = 0.0


@dataclass
class Summary:
    """Data of the scenes for targets and card."""

    scenes: int = 0
    images: int = 0
    empty: int = 0
    """Number of images without a visible object."""
    objects: dict[int, ObjectRow] = field(default_factory=dict)
    localisation: list[dict[str, int]] = field(default_factory=list)
    detection: list[dict[str, int]] = field(default_factory=list)


def _picture_lines(info: Mapping[str, Any]) -> Iterable[str]:
    for folder, channel in info.get("pictures", {}).items():
        yield f"* `{folder}/`: {_SHOWN[channel]}"
    for name, row in info.get("channels", {}).items():
        count = row["components"]
        layers = f", {count} values a pixel" if count else ""
        names = f"; `{SOURCE_FILE}` names the ids" if name in info.get("labels", {}) else ""
        yield f"* `{name}/`: {row['file'].upper()}, {row['dtype']}{layers}{names}"


def _keypoint_lines(info: Mapping[str, Any]) -> list[str]:
    if "keypoints" not in info:
        return []
    count = sum(map(len, info["keypoints"].values()))
    return [f"* `{KEYPOINTS_FILE}` in each scene: {count} keypoints and landmarks"]


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


def _object_lines(found: Summary) -> Iterable[str]:
    yield (
        f"| obj_id | instances | of which {LEAST_VISIBLE:.0%} visible | mean visible fraction "
        "| mean visible pixels |"
    )
    yield "| --- | --- | --- | --- | --- |"
    for obj_id, row in sorted(found.objects.items()):
        count = max(row.instances, 1)
        yield (
            f"| {obj_id} | {row.instances} | {row.visible} | {row.visib_fract / count:.3f} "
            f"| {row.pixels / count:.1f} |"
        )


def _model_lines(models: Mapping[str, Mapping[str, Any]], parts: bool) -> list[str]:
    if not models:
        return ["There is no object: no model, pose or mask."]
    lines = [_MODELS, ""]
    keys = ("faces_one_sided", "faces_cut_in_part", "triangles_left_out")
    if any(row.get(key) for row in models.values() for key in keys):
        lines += ["| obj_id | one-sided faces | cut in part | triangles left out |"]
        lines += ["| --- | --- | --- | --- |"]
        for obj_id in sorted(models, key=int):
            counts = " | ".join(str(models[obj_id].get(key, 0)) for key in keys)
            lines.append(f"| {obj_id} | {counts} |")
        lines.append("")
    return [*lines, _PARTS] if parts else lines[:-1]


def card(
    info: Mapping[str, Any],
    camera: Mapping[str, Any],
    models: Mapping[str, Mapping[str, Any]],
    parts: bool,
    found: Summary,
) -> str:
    """The text. info, camera, models: the dataset's JSON files; parts: whether some parts move."""
    empty = [f"* images in which no object is seen: {found.empty}"] if found.empty else []
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
        *empty,
        *_sensor_lines(info.get("sensors", [])),
        *_picture_lines(info),
        f"* `{FRAMES_FILE}` in each scene: camera with its lens, date, Sun, states, exposure and "
        "effects of each image",
        *_keypoint_lines(info),
        "",
        *_object_lines(found),
        "",
        *_model_lines(models, parts),
        "",
        *([_ROLLING, ""] if info.get("rolling_shutter") else []),
        f"Configuration `{info['config_name']}` (SHA-256 of its content "
        f"{info['config_sha256']}; `{CONFIG_FILE}` has it whole), seed {info['seed']}; "
        f"`{SOURCE_FILE}` holds versions and the hashes of models and maps. Bodies are annotated "
        "where the configuration says so. Depth is that of everything seen up to the farthest "
        "spacecraft, and beyond it may be 0; in images without one it is that of the annotated "
        "bodies, or else of all that is seen. Labels are those of the ray through a pixel's "
        "centre.",
    ]
    return "\n".join(lines) + "\n"
