"""BOP's image-wise format in tar shards, as the BOP toolkit's reader of WebDataset expects it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np

from perilune.document.references import MASKS
from perilune.export.writers.bop import camera_record, pose_entry
from perilune.export.writers.bop_files import encode_depth, scale_of
from perilune.export.writers.bop_labels import decode_runs, info_entry, run_lengths
from perilune.export.writers.bop_model_files import model_files
from perilune.export.writers.bop_source import bop_models, camera_entry, refuse_unfit
from perilune.export.writers.files import json_text
from perilune.export.writers.formats.base import (
    Array,
    Encoded,
    Files,
    Format,
    Frame,
    Info,
    PackReader,
    Record,
)
from perilune.export.writers.formats.channels import COLOR, Channel
from perilune.export.writers.formats.info import spacecraft
from perilune.export.writers.formats.pixels import from_png, png
from perilune.export.writers.formats.tars import open_tar, write_tar
from perilune.simulation import Simulation

_ORIGINS = "origins_m"


def _json(value: Any) -> bytes:
    return json.dumps(value, sort_keys=True, allow_nan=False).encode("utf-8")


def _poses(info: Info, record: Record) -> list[dict[str, Any]]:
    """Entries of gt.json."""
    origins = {int(k): np.array(origin) for k, origin in info[_ORIGINS].items()}
    meta = record["meta"]
    out = []
    for row in record["objects"]:
        name = row["name"]
        rows = [(at["row"], at["objects"][name]) for at in meta.get("rows", ())]
        out.append(pose_entry(row, origins, meta["articulation"].get(name), rows))
    return out


def _member(record: Record, suffix: str) -> str:
    """Name of a member of a frame."""
    names: list[str] = [name for name in record["files"] if name.endswith(f".{suffix}")]
    (name,) = names
    return name


def _masks(record: Record, read: Callable[[str], bytes], suffix: str) -> list[Array]:
    """(H, W) masks of all objects, from run lengths."""
    codes = json.loads(read(_member(record, suffix)))
    height, width = record["camera"]["height"], record["camera"]["width"]
    return [decode_runs(codes[str(k)]["counts"], (height, width)) for k in range(len(codes))]


class BopWebDataset(Format):
    """Pictures, poses and masks in millimetres, as in scene folders."""

    name = "bop-webdataset"
    doc = "BOP's image-wise format in tar shards of --chunk-size frames, and models"
    layout = (
        "`shard-CCCCCC.tar` with `SSSSSS_IIIIII.rgb.png`, `.depth.png`, `.camera.json`, "
        "`.gt.json`, `.gt_info.json`, `.mask.json` and `.mask_visib.json` (RLE), "
        "`key_to_shard.json`, `camera.json`, `models/`, `models_eval/`; scene S and image I are "
        "the quotient and the rest of the frame over the chunk size; lengths are millimetres"
    )
    reader = "bop_toolkit_lib.dataset.bop_webdataset, webdataset"
    needs = ("picture", "depth", "instance", "objects", MASKS)
    pack_name = "shard-{chunk:06d}.tar"

    def holds(self, channel: Channel) -> bool:
        """What BOP defines."""
        return channel.name in (*COLOR, "depth", "instance", MASKS)

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """Origins of the models, which poses refer to."""
        refuse_unfit(sim)
        origins = {str(k): model.center_m.tolist() for k, model in bop_models(sim).items()}
        return {_ORIGINS: origins}

    def begin(self, sim: Simulation, info: Info) -> Files:
        """Models and the nominal camera."""
        camera = json_text(camera_entry(sim)).encode("utf-8")
        return {"camera.json": camera, **model_files(bop_models(sim))}

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The members of an image."""
        arrays, sample = frame.arrays, frame.sample
        scene_id, im_id = divmod(frame.index, info["chunk_size"])
        key = f"{scene_id:06d}_{im_id:06d}"
        ids = np.array([row["instance_id"] for row in frame.record["objects"]])
        crafts = len(spacecraft(info))
        scale_mm = scale_of(arrays["depth"], arrays["instance"], ids, crafts)
        depth = encode_depth(arrays["depth"], scale_mm)
        gt = _poses(info, frame.record)
        gt_info, whole, seen = [], {}, {}
        for k, row in enumerate(frame.record["objects"]):
            mask = arrays[MASKS][k] != 0
            gt_info.append(info_entry(row, mask, depth > 0))
            whole[str(k)] = run_lengths(mask)
            seen[str(k)] = run_lengths(arrays["instance"] == row["instance_id"])
        members = {
            "rgb.png": png(arrays[info["picture"]]),
            "depth.png": png(depth),
            "camera.json": _json(camera_record(sample, scale_mm)),
            "gt.json": _json(gt),
            "gt_info.json": _json(gt_info),
            "mask.json": _json(whole),
            "mask_visib.json": _json(seen),
        }
        return Encoded({f"{key}.{suffix}": data for suffix, data in members.items()})

    def finish(
        self, info: Info, records: Callable[[], Iterator[Record]]
    ) -> Iterator[tuple[str, Iterable[bytes]]]:
        """Key of each image -> number of its shard."""
        size = info["chunk_size"]
        keys = {
            f"{record['index'] // size:06d}_{record['index'] % size:06d}": record["index"] // size
            for record in records()
        }
        yield "key_to_shard.json", [(json.dumps(keys, indent=0) + "\n").encode("utf-8")]

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """The picture and the silhouettes."""
        picture = from_png(read(_member(record, "rgb.png")))
        masks = _masks(record, read, "mask.json")
        return {info["picture"]: picture, MASKS: np.array(masks).reshape(-1, *picture.shape[:2])}

    def faults(
        self, info: Info, record: Record, arrays: Mapping[str, Array], read: Callable[[str], bytes]
    ) -> Iterator[str]:
        """Poses, counts and visible masks that are not those of the record."""
        told = {key: json.loads(read(_member(record, f"{key}.json"))) for key in ("gt", "camera")}
        if told["gt"] != json.loads(_json(_poses(info, record))):
            yield "gt.json does not have the poses of its record"
        K = np.ravel(record["camera"]["K"]).tolist()
        if told["camera"]["cam_K"] != K:
            yield "camera.json does not have the intrinsics of its record"
        seen = _masks(record, read, "mask_visib.json")
        if np.sum(seen, axis=0, dtype=np.int64).max(initial=0) > 1:
            yield "mask_visib.json has pixels of several objects"
        infos = json.loads(read(_member(record, "gt_info.json")))
        depth = from_png(read(_member(record, "depth.png")))
        rows = zip(record["objects"], infos, arrays[MASKS], seen, strict=True)
        for row, stated, whole, visible in rows:
            if (visible & ~whole).any():
                yield f"object '{row['name']}': is seen outside of its mask"
            if np.count_nonzero(visible) != row["px_count_visib"]:
                yield f"object '{row['name']}': mask_visib.json does not have the pixels seen"
            if stated != info_entry(row, whole, depth > 0):
                yield f"object '{row['name']}': gt_info.json is not that of its masks"

    def pack(self, info: Info, path: Path, members: Iterable[tuple[str, bytes]]) -> None:
        """A tar file."""
        write_tar(path, members)

    def unpack(self, path: Path) -> AbstractContextManager[PackReader]:
        """Opens a tar file."""
        return open_tar(path)
