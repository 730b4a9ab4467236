"""COCO: detection, instance segmentation, panoptic, parts, and keypoints where a frame has them."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from perilune.document.references import HIERARCHY, KEYPOINTS, MASKS
from perilune.export.writers.bop_labels import DATE
from perilune.export.writers.formats.base import (
    Array,
    Encoded,
    Format,
    Frame,
    Info,
    Record,
)
from perilune.export.writers.formats.channels import COLOR, Channel
from perilune.export.writers.formats.info import objects
from perilune.export.writers.formats.keypoints import keypoint_names, keypoints_of, of_classes
from perilune.export.writers.formats.pixels import from_png, png
from perilune.export.writers.formats.segments import Segment, segments
from perilune.simulation import Simulation

_MOST = 100_000
"""Ids of annotations: the frame's index times this, and its number in the frame."""


def _annotation(index: int, number: int, category: int, segment: Segment) -> dict[str, Any]:
    return {
        "id": index * _MOST + number,
        "image_id": index,
        "category_id": category,
        "area": segment.area,
        "bbox": list(segment.box),
        "iscrowd": 0,
        "segmentation": segment.rle(),
    }


def categories(
    rows: Iterable[Mapping[str, Any]], supercategory: str | None = None
) -> list[dict[str, Any]]:
    """COCO's categories of rows with a class, each once, by id. supercategory: default the kind."""
    named = {row["class_id"]: (row["class"], supercategory or row["kind"]) for row in rows}
    return [
        {"id": number, "name": named[number][0], "supercategory": named[number][1]}
        for number in sorted(named)
    ]


def panoptic_rgb(ids: Array) -> Array:
    """Ids as panopticapi reads them: id = R + 256 G + 65536 B."""
    return np.stack([(ids >> shift) & 255 for shift in (0, 8, 16)], axis=2).astype(np.uint8)


class Coco(Format):
    """Annotations of the visible pixels of every object: spacecraft, and bodies with `annotate`."""

    name = "coco"
    doc = "COCO: detection, instance and panoptic segmentation, parts, keypoints"
    layout = (
        "`SPLIT/NNNNNN.png`, `panoptic_SPLIT/NNNNNN.png`, and in `annotations/` "
        "`instances_SPLIT.json` (boxes, RLE and keypoints of objects; boxes are of visible "
        "pixels, `bbox_amodal` of whole silhouettes), `panoptic_SPLIT.json` (spacecraft and "
        "bodies), `parts_SPLIT.json` (with `part`), `hierarchy_SPLIT.json` (with `hierarchy`); "
        "categories are the classes of the level `object`, of parts those of the level `part`"
    )
    reader = "pycocotools, panopticapi, Detectron2, MMDetection, torchvision"
    needs = ("picture", "instance", "objects")

    def holds(self, channel: Channel) -> bool:
        """Pictures, and what annotations tell."""
        return channel.name in (*COLOR, "instance", "part", MASKS, KEYPOINTS, HIERARCHY)

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """Names of keypoints."""
        return of_classes(self.name, sim)

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The picture and its panoptic ids; annotations for `finish`."""
        split, found = info["split"], segments(frame.arrays["instance"])
        files = {
            f"{split}/{frame.key}.png": png(frame.arrays[info["picture"]]),
            f"panoptic_{split}/{frame.key}.png": png(panoptic_rgb(frame.arrays["instance"])),
        }
        labels = {
            "instances": self._instances(info, frame, found),
            "panoptic": self._panoptic(info, found),
        }
        if "part" in frame.arrays:
            labels["parts"] = self._parts(info, frame)
        if HIERARCHY in frame.arrays:
            labels[HIERARCHY] = self._hierarchy(info, frame)
        return Encoded(files, labels)

    def _instances(self, info: Info, frame: Frame, found: Mapping[int, Segment]) -> list[Any]:
        classes = {row["name"]: row["class_id"] for row in objects(info)}
        points = keypoints_of(frame)
        rows = []
        for number, row in enumerate(frame.record["objects"], start=1):
            segment = found.get(row["instance_id"])
            if segment is None:
                continue
            entry = _annotation(frame.index, number, classes[row["name"]], segment)
            x, y, w, h = row["bbox_obj"]
            entry |= {
                "object": row["name"],
                "instance_id": row["instance_id"],
                "visib_fract": row["visib_fract"],
                "bbox_amodal": [x, y, w + 1, h + 1],  # rows count from first to last pixel
                "R_m2c": row["R_m2c"],
                "t_m2c": row["t_m2c"],
            }
            if row["name"] in points:
                entry |= points[row["name"]].coco()
            rows.append(entry)
        return rows

    def _panoptic(self, info: Info, found: Mapping[int, Segment]) -> list[Any]:
        classes = {row["id"]: row["class_id"] for row in info["taxonomy"]["instances"]}
        return [
            {
                "id": number,
                "category_id": classes[number],
                "area": segment.area,
                "bbox": list(segment.box),
                "iscrowd": 0,
            }
            for number, segment in found.items()
        ]

    def _parts(self, info: Info, frame: Frame) -> list[Any]:
        owners = {row["name"]: row["id"] for row in objects(info)}
        known = {row["id"]: row for row in info["taxonomy"]["parts"] if row["owner"] in owners}
        rows = []
        for number, segment in segments(frame.arrays["part"]).items():
            if number in known:
                part = known[number]
                entry = _annotation(frame.index, number, part["class_id"], segment)
                entry |= {
                    "part": part["name"],
                    "object": part["owner"],
                    "instance_id": owners[part["owner"]],
                }
                rows.append(entry)
        return rows

    def _hierarchy(self, info: Info, frame: Frame) -> list[Any]:
        """Annotations of the rows that are seen; `bbox` is of what is seen, `parent` an `id`."""
        classes = {row["name"]: row["class_id"] for row in objects(info)}
        rows = []
        for row in frame.arrays[HIERARCHY]:
            if row["px_count_visib"] == 0:
                continue
            x, y, w, h = row["bbox_visib"].tolist()
            X, Y, W, H = row["bbox_obj"].tolist()
            first = frame.index * _MOST
            rows.append(
                {
                    "id": first + int(row["id"]),
                    "parent": first + int(row["parent"]) if row["parent"] else None,
                    "image_id": frame.index,
                    "category_id": classes[str(row["object"])],
                    "name": str(row["name"]),
                    "object": str(row["object"]),
                    "kind": str(row["kind"]),
                    "part_id": int(row["part_id"]),
                    "area": int(row["px_count_visib"]),
                    "bbox": [x, y, w + 1, h + 1],
                    "bbox_amodal": [X, Y, W + 1, H + 1],
                    "iscrowd": 0,
                    "visib_fract": float(row["visib_fract"]),
                    "R_m2c": row["R_m2c"].tolist(),
                    "t_m2c": row["t_m2c"].tolist(),
                }
            )
        return rows

    def finish(
        self, info: Info, records: Callable[[], Iterator[Record]]
    ) -> Iterator[tuple[str, Iterable[bytes]]]:
        """The files of annotations, written as they are read: there may be many frames."""
        split, taxonomy = info["split"], info["taxonomy"]
        things = categories(objects(info))
        for row in things:
            if names := keypoint_names(info, row["name"]):
                row |= {"keypoints": names, "skeleton": []}
        yield (
            f"annotations/instances_{split}.json",
            _text(info, records, "instances", things, _flat),
        )
        kinds = ("spacecraft", "body")
        every = [
            {**row, "isthing": 1}
            for kind in kinds
            for row in categories([r for r in taxonomy["instances"] if r["kind"] == kind], kind)
        ]
        unique = {row["id"]: row for row in reversed(every)}
        panoptic = [unique[number] for number in sorted(unique)]
        yield (
            f"annotations/panoptic_{split}.json",
            _text(info, records, "panoptic", panoptic, _by_image),
        )
        if HIERARCHY in info["channels"]:
            yield (
                f"annotations/hierarchy_{split}.json",
                _text(info, records, HIERARCHY, things, _flat),
            )
        if "part" in info["channels"]:
            owners = {row["name"] for row in objects(info)}
            parts = [row for row in taxonomy["parts"] if row["owner"] in owners]
            yield (
                f"annotations/parts_{split}.json",
                _text(info, records, "parts", categories(parts, "part"), _flat),
            )

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """The picture and the instances."""
        split, key = info["split"], f"{record['index']:06d}"
        ids = from_png(read(f"panoptic_{split}/{key}.png")).astype(np.int32)
        return {
            info["picture"]: from_png(read(f"{split}/{key}.png")),
            "instance": ids[:, :, 0] | ids[:, :, 1] << 8 | ids[:, :, 2] << 16,
        }

    def faults(
        self, info: Info, record: Record, arrays: Mapping[str, Array], read: Callable[[str], bytes]
    ) -> Iterator[str]:
        """Annotations that do not agree with the pixels of the panoptic picture."""
        found = segments(arrays["instance"])
        labels = record["labels"]
        if labels["panoptic"] != self._panoptic(info, found):
            yield "its panoptic segments are not those of its picture"
        for row in labels["instances"]:
            segment = found.get(row["instance_id"])
            same = segment is not None and (
                row["bbox"] == list(segment.box)
                and row["area"] == segment.area
                and row["segmentation"] == segment.rle()
            )
            if not same:
                yield f"object '{row['object']}': its annotation is not about its pixels"


def _flat(record: Record, name: str) -> list[Any]:
    rows: list[Any] = record["labels"][name]
    return rows


def _by_image(record: Record, name: str) -> list[Any]:
    file = f"{record['index']:06d}.png"
    rows = record["labels"][name]
    return [{"image_id": record["index"], "file_name": file, "segments_info": rows}]


def _image(info: Info, record: Record) -> dict[str, Any]:
    camera, meta = record["camera"], record["meta"]
    return {
        "id": record["index"],
        "file_name": f"{record['index']:06d}.png",
        "width": camera["width"],
        "height": camera["height"],
        "date_captured": DATE,
        "license": 1,
        "camera": camera,
        "sun": meta["sun"],
        "time_utc": meta["time_utc"],
    }


def _text(
    info: Info,
    records: Callable[[], Iterator[Record]],
    name: str,
    categories: list[dict[str, Any]],
    rows: Callable[[Record, str], list[Any]],
) -> Iterator[bytes]:
    """A COCO file, a piece at a time. name: of the labels in records."""
    head = {
        "info": {
            "contributor": "",
            "date_created": DATE,
            "description": f"{info['dataset_name']}_{info['split']}: {info['description']}",
            "url": "",
            "version": "1.0",
            "year": int(DATE[:4]),
        },
        "licenses": [{"id": 1, "name": "", "url": ""}],
        "categories": categories,
    }
    for key, value in head.items():
        yield f'{"{" if key == "info" else ","}\n"{key}": {json.dumps(value)}'.encode()
    for key, of in (
        ("images", lambda record: [_image(info, record)]),
        ("annotations", lambda record: rows(record, name)),
    ):
        yield f',\n"{key}": ['.encode()
        comma = "\n"
        for record in records():
            for row in of(record):
                yield f"{comma}{json.dumps(row, sort_keys=True)}".encode()
                comma = ",\n"
        yield b"\n]"
    yield b"\n}\n"
