"""Checks one scene folder: its JSON files against each other and against the files beside them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from pydantic import TypeAdapter

from perilune.base.timeline import Timeline
from perilune.export.check.beside import fault
from perilune.export.check.findings import Report
from perilune.export.check.frames import check_frames
from perilune.export.check.image import ImageCheck, ImageLabels
from perilune.export.check.records import (
    Annotation,
    Coco,
    Info,
    Pose,
    SceneCamera,
    Source,
    by_id,
    read_json,
)
from perilune.export.check.retrace import Tracer
from perilune.export.writers.bop_files import (
    CAMERA_FILE,
    COCO_FILE,
    GT_FILE,
    INFO_FILE,
    RGB_FOLDER,
    SceneFolder,
)
from perilune.export.writers.bop_labels import CocoHeader
from perilune.export.writers.files import PARTIAL

_FREE = {"aux"}
"""Folders in which a scene may keep files outside the format."""

Step = Callable[[], None]


def _same_images(report: Report, folder: Path, tables: Mapping[str, Mapping[str, object]]) -> bool:
    """Checks that all tables have the same images, in numerical order."""
    first = list(tables[CAMERA_FILE])
    report.need(first == sorted(first, key=int), folder / CAMERA_FILE, "ids are out of order")
    good = True
    for name, table in tables.items():
        missing = sorted(set(first) - set(table), key=int)
        more = sorted(set(table) - set(first), key=int)
        good &= report.need(not missing, folder / name, f"lacks images {', '.join(missing)}")
        reason = f"has images {', '.join(more)}, which {CAMERA_FILE} lacks"
        good &= report.need(not more, folder / name, reason)
        ordered = list(table) == sorted(table, key=int)
        report.need(name == CAMERA_FILE or ordered, folder / name, "ids are out of order")
    return good


def _check_files(report: Report, scene: SceneFolder, poses: Mapping[str, list[Pose]]) -> None:
    """Checks that exactly the files that the labels require are there."""
    folder = scene.folder
    wanted = set(scene.json_files)
    for key, instances in poses.items():
        wanted |= scene.files_of(int(key), len(instances))
    present = set()
    for path in folder.iterdir():
        if path.name in scene.image_folders and path.is_dir():
            present |= {f"{path.name}/{entry.name}" for entry in path.iterdir()}
        elif path.name not in _FREE:
            present.add(path.name)
    for name in sorted(wanted - present - set(scene.json_files)):
        report.add(folder / name, "is missing")
    for name in sorted(present - wanted):
        report.add(folder / name, "is not part of the dataset")


def _check_coco(
    report: Report, path: Path, coco: Coco, header: CocoHeader
) -> dict[int, list[Annotation]]:
    """Checks the COCO file except for the annotations' contents; returns these by image."""
    im_ids = [image.id for image in coco.images]
    report.need(len(set(im_ids)) == len(im_ids), path, "an image occurs twice")
    expected = header.file({im_id: [] for im_id in im_ids})
    for name in ("categories", "images"):
        for k, (entry, truth) in enumerate(zip(getattr(coco, name), expected[name], strict=False)):
            for key, value in truth.items():
                stated = getattr(entry, key)
                reason = f"{name}[{k}].{key} is {stated!r}, must be {value!r}"
                report.need(stated == value, path, reason)
        count = len(getattr(coco, name)) == len(expected[name])
        report.need(count, path, f"must have {len(expected[name])} {name}")
    for key, value in expected["info"].items():
        stated = getattr(coco.info, key)
        report.need(stated == value, path, f"info.{key} is {stated!r}, must be {value!r}")
    reason = f"licenses are {coco.licenses}, must be {expected['licenses']}"
    report.need(coco.licenses == expected["licenses"], path, reason)
    found: dict[int, list[Annotation]] = {im_id: [] for im_id in im_ids}
    for place, entry in enumerate(coco.annotations, start=1):
        report.need(entry.id == place, path, f"annotation {place} has id {entry.id}")
        if report.need(entry.image_id in found, path, f"annotation {place} is of no image"):
            found[entry.image_id].append(entry)
    return found


def _check_sensors(
    report: Report, folder: Path, source: Source, cameras: Mapping[str, SceneCamera]
) -> None:
    """Checks that each image comes from the sensor whose turn it is."""
    timeline = Timeline(1, {row.name: row.trigger_interval for row in source.sensors})
    first = int(folder.name) * source.chunk_size
    for key, camera in cameras.items():
        truth = timeline.at(first + int(key)).sensor
        reason = f"image {key}: sensor is {camera.sensor!r}, must be {truth!r}"
        report.need(camera.sensor == truth, folder / CAMERA_FILE, reason)


def check_scene(
    report: Report,
    folder: Path,
    source: Source,
    tracer: Tracer,
    step: Step,
) -> None:
    """All checks of a scene. tracer: of the models. step: called after each image."""
    meshes, size = tracer.shapes.meshes, tracer.size
    report.scenes += 1
    if (folder / PARTIAL).exists():
        report.add(folder, "is not finished: the same `perilune render` command continues it")
        return
    cameras = read_json(report, folder / CAMERA_FILE, by_id(SceneCamera))
    poses = read_json(report, folder / GT_FILE, by_id(list[Pose]))
    infos = read_json(report, folder / INFO_FILE, by_id(list[Info]))
    coco = read_json(report, folder / COCO_FILE, TypeAdapter(Coco))
    if cameras is None or poses is None or infos is None or coco is None:
        return
    beside = {name: channel.file for name, channel in source.channels.items()}
    points = source.keypoints is not None
    scene = SceneFolder(folder, source.pictures or (RGB_FOLDER,), beside, points)
    _check_files(report, scene, poses)
    header = CocoHeader(source.dataset_name, source.split, tuple(meshes), *size)
    annotations = _check_coco(report, folder / COCO_FILE, coco, header)
    listed = {str(im_id): entries for im_id, entries in annotations.items()}
    tables = {CAMERA_FILE: cameras, GT_FILE: poses, INFO_FILE: infos, COCO_FILE: listed}
    if not _same_images(report, folder, tables):
        return
    most = max(map(int, cameras), default=0)
    reason = f"image {most} is beyond the chunk size, {source.chunk_size}"
    report.need(most < source.chunk_size, folder / CAMERA_FILE, reason)
    _check_sensors(report, folder, source, cameras)
    check_frames(report, folder, source, cameras, size)
    for key, camera in cameras.items():
        report.images += 1
        labels = ImageLabels(camera, poses[key], infos[key], listed[key])
        counts = f"image {key}: {len(infos[key])} entries, {GT_FILE} has {len(poses[key])}"
        if report.need(len(infos[key]) == len(poses[key]), folder / INFO_FILE, counts):
            ImageCheck(report, scene, int(key), labels, meshes, size, tracer).run()
        for name, channel in source.channels.items():
            path = scene.channel(int(key), name)
            if wrong := fault(path, channel, size):
                report.add(path, wrong)
        step()
