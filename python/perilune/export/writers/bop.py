"""Writes frames of a simulation as a BOP dataset: resumable and reproducible to the byte."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.document.references import HIERARCHY, KEYPOINTS
from perilune.export.writers.bop_channels import (
    TABLES,
    ChannelFiles,
    channel_files,
    pictures,
    scan_files,
)
from perilune.export.writers.bop_files import (
    MM_PER_M,
    Record,
    SceneFolder,
    encode_depth,
    scale_of,
)
from perilune.export.writers.bop_finish import finish, reopen
from perilune.export.writers.bop_labels import CocoHeader, Mask, annotation, info_entry
from perilune.export.writers.bop_model_files import complete_models
from perilune.export.writers.bop_models import BopModel
from perilune.export.writers.bop_source import (
    bop_models,
    camera_entry,
    dataset_info,
    dataset_name,
    nominal_camera,
    refuse_unfit,
)
from perilune.export.writers.config_file import CONFIG_FILE, config_entry, config_text
from perilune.export.writers.files import (
    PNG_LEVEL,
    SOURCE_FILE,
    json_text,
    make_folder,
    write_other_text,
    write_text,
)
from perilune.export.writers.formats.record import plain, record_of
from perilune.export.writers.run import DEFAULT_CHUNK, Begun, tables_of, write_datasets
from perilune.export.writers.same_source import check_same_source, refuse_other_source
from perilune.export.writers.scans import channels_of_scan, is_scan
from perilune.export.writers.shards import Shard
from perilune.export.writers.table import Progress, WriteReport
from perilune.sample import Sample
from perilune.simulation import Simulation

F64 = NDArray[np.float64]

_log = logging.getLogger(__name__)

LABELS = ("depth", "instance", "objects", "masks")
"""Channels rendered for a frame in addition to its pictures."""
_MASK_ON = np.uint8(255)


def _motion_entry(motion: F64, origin_m: F64) -> list[float]:
    """Converts a motion (4, 4) in the object's frame, m, to one in the BOP model's frame, mm, row
    by row."""
    motion = np.asarray(motion, dtype=np.float64)  # of a record, a list
    moved = motion.copy()
    moved[:3, 3] = MM_PER_M * (motion[:3, :3] @ origin_m + motion[:3, 3] - origin_m)
    return [float(value) for value in moved.ravel()]


def _placed(R_m2c: F64, t_m2c: F64, origin_m: F64, moving: Mapping[str, F64]) -> dict[str, Any]:
    """Keys of a pose. origin_m: origin of the BOP model in the object's frame. moving: node ->
    motion."""
    rotation = np.asarray(R_m2c, dtype=np.float64)
    moved = {name: _motion_entry(motion, origin_m) for name, motion in moving.items()}
    return {
        **({"articulation": moved} if moved else {}),
        "cam_R_m2c": rotation.ravel().tolist(),
        "cam_t_m2c": ((t_m2c + rotation @ origin_m) * MM_PER_M).tolist(),
    }


def pose_entry(
    row: Any,
    origins_m: Mapping[int, F64],
    moving: Mapping[str, Any] | None = None,
    rows: Sequence[tuple[int, Mapping[str, Any]]] = (),
) -> dict[str, Any]:
    """One entry of scene_gt.json, from an object's label.

    moving: motions of an articulated object, as in Sample.meta. rows: poses of this object by row
    under a rolling shutter, as in Sample.meta. Readers ignore the keys `articulation` and
    `rows`."""
    origin_m = origins_m[int(row["obj_id"])]
    motions = {name: node["motion"] for name, node in (moving or {}).items()}
    by_row = [
        {
            "row": number,
            **_placed(at["R_m2c"], at["t_m2c"], origin_m, at.get("articulation", {})),
        }
        for number, at in rows
    ]
    return {
        **_placed(row["R_m2c"], row["t_m2c"], origin_m, motions),
        **({"rows": by_row} if by_row else {}),
        "obj_id": int(row["obj_id"]),
    }


def _world_to_camera(R_w2c: F64, t_w2c: F64) -> dict[str, Any]:
    return {
        "cam_R_w2c": np.asarray(R_w2c, dtype=np.float64).ravel().tolist(),
        "cam_t_w2c": (np.asarray(t_w2c) * MM_PER_M).tolist(),
    }


def camera_record(sample: Sample, scale_mm: float) -> dict[str, Any]:
    """One entry of scene_camera.json; readers ignore the keys that BOP does not define.

    `frame` is what perilune.open(config, seed, replay=...) needs to render the image again."""
    sensor = sample.camera.sensor
    keys = ("drivers", "scene_drivers", "overrides")
    drawn = {key: sample.meta[key] for key in keys if sample.meta[key]}
    rows = [
        {"row": at["row"], **_world_to_camera(at["R_w2c"], at["t_w2c"])}
        for at in sample.meta.get("rows", ())
    ]
    return {
        **({} if sensor is None else {"sensor": sensor}),
        **({"frame": {"index": sample.meta["index"], "drivers": {}, **drawn}} if drawn else {}),
        "cam_K": np.asarray(sample.camera.K, dtype=np.float64).ravel().tolist(),
        **_world_to_camera(sample.camera.R_w2c, sample.camera.t_w2c),
        **({"rows": rows} if rows else {}),
        "depth_scale": scale_mm,
    }


def frame_entry(sample: Sample) -> dict[str, Any]:
    """One entry of scene_frames.json: index, camera and metadata, as in the records of other
    formats."""
    return record_of(sample, None)


def keypoint_rows(sample: Sample) -> list[dict[str, Any]]:
    """One entry of scene_keypoints.json: the rows of Sample.keypoints; null where a number is
    not finite."""
    names = sample.keypoints.dtype.names or ()
    columns = {name: sample.keypoints[name].tolist() for name in names}
    count = len(sample.keypoints)
    return [{name: plain(columns[name][k]) for name in names} for k in range(count)]


def _write_mask(path: Path, mask: Mask) -> None:
    _core.png_write(str(path), np.where(mask, _MASK_ON, np.uint8(0)), PNG_LEVEL)


def write_image(
    folder: SceneFolder,
    im_id: int,
    sample: Sample,
    names: Sequence[str],
    crafts: int,
    origins_m: Mapping[int, F64],
    pictures: Mapping[str, str],
    channels: Mapping[str, ChannelFiles],
    tables: Mapping[str, NDArray[Any]],
    keypoints: bool = False,
) -> Record:
    """Writes the files of one frame into its scene folder, its record last.

    names: objects in the order of the sample's; the first `crafts` are spacecraft. pictures: folder
    -> channel. channels: channels written in addition to BOP's. tables: those among them that are
    tables. keypoints: whether they are written."""
    depth_m, instance = sample["depth"], sample["instance"]
    scale_mm = scale_of(depth_m, instance, sample.objects["instance_id"], crafts)
    depth = encode_depth(depth_m, scale_mm)
    for name, channel in pictures.items():
        _core.png_write(str(folder.picture(im_id, name)), sample[channel], PNG_LEVEL)
    for name, files in channels.items():
        own = sample.hierarchy if name == HIERARCHY else None
        values = tables[name] if name in tables else sample[name] if own is None else own
        files.write(folder.channel(im_id, name), values)
    _core.png_write(str(folder.depth(im_id)), depth, PNG_LEVEL)
    points = keypoint_rows(sample) if keypoints else None
    record = Record(camera_record(sample, scale_mm), [], [], [], frame_entry(sample), points)
    moving = sample.meta["articulation"]
    for gt_id, (name, row) in enumerate(zip(names, sample.objects, strict=True)):
        mask, visible = sample["masks"][gt_id] != 0, instance == row["instance_id"]
        _write_mask(folder.mask(im_id, gt_id), mask)
        _write_mask(folder.mask_visib(im_id, gt_id), visible)
        info = info_entry(row, mask, depth > 0)
        rows = [(at["row"], at["objects"][name]) for at in sample.meta.get("rows", ())]
        record.gt.append(pose_entry(row, origins_m, moving.get(name), rows))
        record.gt_info.append(info)
        if info["px_count_visib"] > 0:
            obj_id, fraction = int(row["obj_id"]), info["visib_fract"]
            record.annotations.append(annotation(im_id, obj_id, mask, visible, fraction))
    folder.keep(im_id, record)
    return record


@dataclass
class Job:
    """A BOP dataset that is being written (see run.Dataset): its outputs."""

    sim: Simulation
    split_folder: Path
    origins_m: Mapping[int, F64]
    header: CocoHeader
    pictures: Mapping[str, str]
    """Folder -> channel."""
    beside: Mapping[str, ChannelFiles]
    """Channels written in addition to BOP's."""
    keypoints: bool = False
    """Whether the scenes have keypoints."""
    images_of: dict[int, dict[int, int]] = field(default_factory=dict)
    """Scene id -> image id -> frame index, for all images of the call."""
    _good: dict[int, set[int]] = field(default_factory=dict)
    """Scene id -> images that are complete."""
    _records: dict[int, dict[int, Record]] = field(default_factory=dict)
    """Scene id -> records of the images of the scene that is being written."""
    _chunk_size: int = DEFAULT_CHUNK

    @property
    def root(self) -> Path:
        """Folder of the dataset."""
        return self.split_folder.parent

    def folder(self, scene_id: int) -> SceneFolder:
        """Folder of a scene."""
        beside = {name: files.suffix for name, files in self.beside.items()}
        path = self.split_folder / f"{scene_id:06d}"
        return SceneFolder(path, self.pictures, beside, self.keypoints)

    @property
    def channels(self) -> list[str]:
        """Channels rendered for a frame."""
        plain = [name for name in self.beside if name not in TABLES and not is_scan(name)]
        of_tables = [name for table in self.tables for name in TABLES.get(table, ())]
        of_tables += [name for scan in self.tables for name in channels_of_scan(self.sim, scan)]
        points = [KEYPOINTS] if self.keypoints else []
        return list(dict.fromkeys((*self.pictures.values(), *LABELS, *plain, *of_tables, *points)))

    @property
    def tables(self) -> list[str]:
        """The tables that are written with a frame."""
        return [name for name in self.beside if name in TABLES or is_scan(name)]

    def write_image(
        self,
        folder: SceneFolder,
        im_id: int,
        sample: Sample,
        tables: Mapping[str, NDArray[Any]] | None = None,
    ) -> Record:
        """Writes the files of one frame into its scene folder, its record last. tables: those of
        the frame, if known."""
        names = list(self.sim.config.objects)
        if tables is None:
            tables = tables_of(self.sim, sample, self.tables)
        crafts = len(self.sim.config.spacecraft)
        return write_image(
            folder,
            im_id,
            sample,
            names,
            crafts,
            self.origins_m,
            self.pictures,
            self.beside,
            tables,
            self.keypoints,
        )

    def find(self, images_of: Mapping[int, Mapping[int, int]], chunk_size: int) -> None:
        """Finds the images (scene id -> image id -> frame index) that exist and are intact.

        Damaged images of these scenes are made again even if this call does not ask for them,
        because they could not be told from intact ones later."""
        self._chunk_size = chunk_size
        for scene_id, asked in images_of.items():
            folder = self.folder(scene_id)
            good = set(folder.finished())
            images = dict(asked)
            for im_id in sorted(set(folder.listed()) - good - set(images)):
                _log.warning("%s: image %d is damaged and made again", folder.folder, im_id)
                images[im_id] = scene_id * chunk_size + im_id
            self.images_of[scene_id], self._good[scene_id] = images, good

    def missing(self, chunk: int) -> list[int]:
        """Frames of a scene that are not complete."""
        good = self._good[chunk]
        return [index for im_id, index in self.images_of[chunk].items() if im_id not in good]

    def begin(self, chunk: int) -> None:
        """Prepares the folder of a scene that needs writing."""
        folder = self.folder(chunk)
        records = folder.finished(self._good[chunk])
        if self.missing(chunk) or not folder.is_complete() or folder.listed() != records:
            folder.prepare()
            self._records[chunk] = records

    def write(self, index: int, sample: Sample, tables: Mapping[str, NDArray[Any]]) -> None:
        """Writes one frame."""
        scene_id, im_id = divmod(index, self._chunk_size)
        own = {table: tables[table] for table in self.tables}
        record = self.write_image(self.folder(scene_id), im_id, sample, own)
        self._records[scene_id][im_id] = record

    def end(self, chunk: int) -> None:
        """Writes the JSON files of a scene."""
        records = self._records.pop(chunk, None)
        if records is not None:
            self.folder(chunk).complete(records, self.header)

    def reopen(self) -> None:
        """Removes files that become outdated when more scenes are written."""
        reopen(self.root)

    def finish(self) -> None:
        """Writes targets and card."""
        finish(self.root)


Source = tuple[dict[int, BopModel], dict[str, Any]]
"""Models by obj_id, and the description of a dataset."""


def _source(sim: Simulation, chunk_size: int, split: str) -> Source:
    """What a dataset of a simulation is made of; refuses what BOP cannot represent."""
    refuse_unfit(sim)
    models = bop_models(sim)
    if not models:
        _log.warning(
            "%s: spacecraft: there is none, and no body with annotate: true, so the dataset has no "
            "model, pose, mask or annotation; depth is that of the bodies",
            sim.document.source,
        )
    return models, dataset_info(sim, chunk_size, split)


def _write_source(
    sim: Simulation, root: Path, source: Source, begin: Callable[[], object] | None
) -> None:
    """Writes the description of the simulation; refuses the folder of another one."""
    models, info = source
    make_folder(root)  # when nothing but the disk can fail any more
    if begin is not None:
        begin()
    if not check_same_source(root / SOURCE_FILE, info, sim):
        write_text(root / SOURCE_FILE, json_text(info))
    write_other_text(root / CONFIG_FILE, config_text(config_entry(sim)))
    write_other_text(root / "camera.json", json_text(camera_entry(sim)))
    complete_models(root, models)


def _open(
    sim: Simulation, root: Path, split: str, source: Source, begin: Callable[[], object] | None
) -> Job:
    _write_source(sim, root, source, begin)
    models, _ = source
    origins_m = {obj_id: model.center_m for obj_id, model in models.items()}
    size = nominal_camera(sim)
    header = CocoHeader(dataset_name(sim), split, tuple(models), size.width, size.height)
    shown, beside = pictures(sim), {**channel_files(sim), **scan_files(sim)}
    keypoints = KEYPOINTS in sim.config.render.channels
    return Job(sim, root / split, origins_m, header, shown, beside, keypoints)


def open_job(sim: Simulation, root: Path, chunk_size: int, split: str) -> Job:
    """Writes all files outside the scenes, and returns the job that writes the scenes."""
    return _open(sim, root, split, _source(sim, chunk_size, split), None)


def open_bop(begun: Begun) -> Callable[[], Job]:
    """Opens a BOP dataset, for write_datasets."""
    sim, split = begun.sim, begun.split
    source = _source(sim, begun.chunk_size, split)
    refuse_other_source(begun.root / SOURCE_FILE, source[1], sim)
    return partial(_open, sim, begun.root, split, source, begun.lock)


def write_bop(
    sim: Simulation,
    frames: range | Sequence[int],
    out: str | Path,
    *,
    chunk_size: int = DEFAULT_CHUNK,
    threads: int | None = None,
    split: str = "train",
    shard: Shard | None = None,
    progress: Progress | None = None,
) -> WriteReport:
    """Writes `frames` as a BOP dataset: images, depth, masks, poses, COCO annotations, models.

    frames: a range, or indices with a constant positive step. Frame i is image i % chunk_size of
    scene i // chunk_size, whatever sensor takes it. With several sensors, scene_camera.json names
    each image's; all must have one size, because BOP has one size per split. Write sensors of other
    sizes to separate datasets: the override {"sensors.NAME": None} removes a sensor without moving
    the others.

    Calling it again continues an interrupted dataset or extends it: finished images are kept,
    damaged ones made again. This holds after ctrl-C, a kill or a power cut at any moment. The same
    call gives the same bytes. Only one process may write to a scene at a time.

    Images are PNG, hence the split is named `train`: the BOP toolkit expects JPEG in `train_pbr`.
    The toolkit also wants the folder's own name without `_` and `-`. A split named `test` gets
    target files.

    shard = (k, n): only the k-th of n runs of whole chunks, k from 0. Shards may be written to one
    folder or to several; `merge_bop` joins them.

    `rgb/` holds the channel `sensor_rgb` if render.channels has it and not `rgb`. With both,
    `sensor_rgb` has a folder of its own, and so has `raw` (16 bit). Depth is stored up to the
    farthest annotated surface, beyond which it may be 0; in images without an annotated surface,
    for everything visible. Other channels in render.channels have a folder each, see
    bop_channels.py. Under a rolling shutter, `rows` gives the poses row by row.

    Raises OSError if a file cannot be written (finished frames stay valid) or another process
    writes to the folder (perilune.writers.FolderInUseError), and ValueError if the folder belongs
    to another configuration, seed or chunk size, or holds anything else than a dataset."""
    return write_datasets(
        sim,
        frames,
        [(out, open_bop)],
        chunk_size=chunk_size,
        threads=threads,
        split=split,
        shard=shard,
        progress=progress,
    )
