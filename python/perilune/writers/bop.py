"""Writes frames of a simulation as a BOP dataset: resumable, repeatable to the byte."""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.sample import Sample
from perilune.simulation import Simulation
from perilune.writers.bop_files import (
    MM_PER_M,
    Record,
    SceneFolder,
    depth_scale_mm,
    encode_depth,
    json_text,
    write_text,
)
from perilune.writers.bop_models import write_models
from perilune.writers.bop_source import bop_models, camera_entry, dataset_info
from perilune.writers.queue import WriteQueue
from perilune.writers.table import Progress, WriteReport

F64 = NDArray[np.float64]

_log = logging.getLogger(__name__)

CHANNELS = ("rgb", "depth", "instance", "objects")
"""What is rendered for a frame."""
DEFAULT_CHUNK = 1000
_SPLIT = re.compile(r"[a-z0-9]+(_[a-z0-9]+)?")
_PNG_LEVEL = 6
_MASK_ON = np.uint8(255)


def image_record(sample: Sample, origins_m: Mapping[int, F64], scale_mm: float) -> Record:
    """The JSON entries of a frame: camera, depth scale and the pose of every instance, in mm."""
    gt = []
    for row in sample.objects:
        rotation = np.asarray(row["R_m2c"], dtype=np.float64)
        # The origin of the BOP model lies at `origins_m` in the object's frame.
        origin_m = row["t_m2c"] + rotation @ origins_m[int(row["obj_id"])]
        gt.append(
            {
                "cam_R_m2c": rotation.ravel().tolist(),
                "cam_t_m2c": (origin_m * MM_PER_M).tolist(),
                "obj_id": int(row["obj_id"]),
            }
        )
    camera = {
        "cam_K": np.asarray(sample.camera.K, dtype=np.float64).ravel().tolist(),
        "cam_R_w2c": np.asarray(sample.camera.R_w2c, dtype=np.float64).ravel().tolist(),
        "cam_t_w2c": (np.asarray(sample.camera.t_w2c) * MM_PER_M).tolist(),
        "depth_scale": scale_mm,
    }
    return Record(camera, gt)


def write_image(
    folder: SceneFolder, im_id: int, sample: Sample, origins_m: Mapping[int, F64]
) -> Record:
    """Writes the files of one frame into its scene folder, the record of it last."""
    depth_m, instance = sample["depth"], sample["instance"]
    ids = sample.objects["instance_id"]
    annotated = np.isin(instance, ids)
    z_max_mm = float(depth_m[annotated].max(initial=0.0)) * MM_PER_M
    scale_mm = depth_scale_mm(z_max_mm)
    _core.png_write(str(folder.rgb(im_id)), sample["rgb"], _PNG_LEVEL)
    _core.png_write(str(folder.depth(im_id)), encode_depth(depth_m, scale_mm), _PNG_LEVEL)
    for gt_id, instance_id in enumerate(ids):
        mask = np.where(instance == instance_id, _MASK_ON, np.uint8(0))
        _core.png_write(str(folder.mask_visib(im_id, gt_id)), mask, _PNG_LEVEL)
    record = image_record(sample, origins_m, scale_mm)
    folder.keep(im_id, record)
    return record


@dataclass
class _Job:
    """One call of write_bop: what is written where, and how far it is."""

    sim: Simulation
    split_folder: Path
    origins_m: Mapping[int, F64]
    threads: int | None
    total: int
    progress: Progress | None
    written: int = 0
    kept: int = 0

    def advance(self, written: int = 0, kept: int = 0) -> None:
        self.written += written
        self.kept += kept
        if self.progress is not None:
            self.progress(self.written + self.kept, self.total)

    def write_chunk(self, scene_id: int, images: Mapping[int, int]) -> None:
        """Writes the images (image id -> frame index) of one scene that are not there yet."""
        folder = SceneFolder(self.split_folder / f"{scene_id:06d}")
        records = folder.finished()
        missing = [im_id for im_id in images if im_id not in records]
        if missing or folder.listed() != records:
            folder.prepare()
            self._render(folder, {im_id: images[im_id] for im_id in missing}, records)
            folder.complete(records)

    def _render(
        self, folder: SceneFolder, images: Mapping[int, int], records: dict[int, Record]
    ) -> None:
        with WriteQueue() as queue:
            for im_id, index in images.items():
                sample = self.sim.frame(index, channels=CHANNELS, threads=self.threads)

                def task(im_id: int = im_id, sample: Sample = sample) -> None:
                    records[im_id] = write_image(folder, im_id, sample, self.origins_m)

                self.advance(written=queue.put(task))
            self.advance(written=queue.drain())


def _chunks(frames: range, chunk_size: int) -> dict[int, dict[int, int]]:
    """Scene id -> image id -> frame index; a pure function, so workers can share the frames."""
    chunks: dict[int, dict[int, int]] = {}
    for index in sorted(frames):
        scene_id, im_id = divmod(index, chunk_size)
        chunks.setdefault(scene_id, {})[im_id] = index
    return chunks


def _check_arguments(frames: range, chunk_size: int, split: str) -> None:
    if len(frames) == 0 or min(frames) < 0:
        raise ValueError(f"frames: {frames} must hold at least one index and none below 0")
    if not 1 <= chunk_size <= 1_000_000:
        raise ValueError(f"chunk_size: {chunk_size} must be in 1..1000000 (ids have six digits)")
    if max(frames) // chunk_size > 999_999:
        raise ValueError(f"frames: {max(frames)} needs a scene id above 999999; use larger chunks")
    if not _SPLIT.fullmatch(split):
        raise ValueError(
            f"split: {split!r} must be lower-case letters and digits, with one '_' before a type"
        )


def _check_same_source(path: Path, info: dict[str, Any]) -> bool:
    """True if the folder belongs to this very source, False if it is new; otherwise an error."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return False
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ValueError(
            f"{path}: is not JSON ({error}); remove it or use another folder"
        ) from error
    for key in sorted({*info, *found} - {"versions"}):
        if found.get(key) != info.get(key):
            raise ValueError(
                f"{path.parent}: holds a dataset with another {key} ({found.get(key)!r}, here "
                f"{info.get(key)!r}); use another folder, or remove this one"
            )
    if found.get("versions") != info.get("versions"):
        _log.warning("%s: was begun with other versions: %s", path.parent, found.get("versions"))
    return True


def write_bop(
    sim: Simulation,
    frames: range,
    out: str | Path,
    *,
    chunk_size: int = DEFAULT_CHUNK,
    threads: int | None = None,
    split: str = "train",
    progress: Progress | None = None,
) -> WriteReport:
    """Writes `frames` as a BOP dataset: images, depth, visible masks, poses, models.

    Frame i is image i % chunk_size of scene i // chunk_size. What an earlier call has finished is
    kept, so an interrupted or extended dataset is continued by calling this again; the same call
    gives the same bytes. Images are PNG, hence the split is named `train`: the BOP toolkit looks
    for JPEG in `train_pbr`. The toolkit also wants the folder's own name without `_` and `-`.

    Depth is stored for all surfaces up to the farthest annotated one; beyond it may be 0.

    Raises OSError if a file cannot be written (finished frames stay valid), ValueError if the
    folder belongs to another configuration, seed or chunk size.
    """
    _check_arguments(frames, chunk_size, split)
    root = Path(out)
    models = bop_models(sim)
    info = dataset_info(sim, chunk_size, split)
    root.mkdir(parents=True, exist_ok=True)
    if not _check_same_source(root / "dataset_info.json", info):
        write_text(root / "dataset_info.json", json_text(info))
    write_text(root / "camera.json", json_text(camera_entry(sim)))
    if not (root / "models" / "models_info.json").exists():
        write_models(root / "models", models)
    origins_m = {obj_id: model.center_m for obj_id, model in models.items()}
    job = _Job(sim, root / split, origins_m, threads, len(frames), progress)
    chunks = _chunks(frames, chunk_size)
    for scene_id, images in chunks.items():
        done = SceneFolder(job.split_folder / f"{scene_id:06d}").finished()
        job.advance(kept=sum(im_id in done for im_id in images))
    for scene_id, images in chunks.items():
        job.write_chunk(scene_id, images)
    return WriteReport(root, job.written, job.kept)
