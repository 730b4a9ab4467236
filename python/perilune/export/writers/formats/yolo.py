"""Ultralytics' YOLO: boxes, or polygons, of visible pixels, in fractions of the picture's size."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any, ClassVar

import numpy as np

from perilune.config.errors import ConfigError
from perilune.export.writers.formats.base import (
    Array,
    Encoded,
    Files,
    Format,
    Frame,
    Info,
    Record,
)
from perilune.export.writers.formats.channels import COLOR, Channel
from perilune.export.writers.formats.info import objects
from perilune.export.writers.formats.keypoints import Keypoints, keypoints_of
from perilune.export.writers.formats.pixels import from_png, png
from perilune.export.writers.formats.segments import Segment, segments
from perilune.simulation import Simulation


def class_numbers(info: Info) -> dict[str, int]:
    """Class -> its number, from 0 on, in the order of ids."""
    named = {row["class_id"]: row["class"] for row in objects(info)}
    return {named[number]: k for k, number in enumerate(sorted(named))}


def _number(value: float) -> str:
    return f"{value:.9g}"


def box_text(segment: Segment) -> str:
    """Centre, width and height of a box: pixel i covers [i, i + 1] of the picture's width."""
    (x, y, w, h), (height, width) = segment.box, segment.size
    shares = ((x + 0.5 * w) / width, (y + 0.5 * h) / height, w / width, h / height)
    return " ".join(map(_number, shares))


class Yolo(Format):
    """Boxes for detectors."""

    name = "yolo"
    doc = "Ultralytics YOLO: boxes of objects"
    layout = (
        "`images/SPLIT/NNNNNN.png`, `labels/SPLIT/NNNNNN.txt` (a line for each object that is "
        "seen: class, centre, width, height, as fractions of the picture), `data.yaml`"
    )
    reader = "Ultralytics"
    needs: ClassVar[tuple[str, ...]] = ("picture", "instance", "objects")

    def holds(self, channel: Channel) -> bool:
        """Pictures and instances."""
        return channel.name in (*COLOR, "instance")

    def begin(self, sim: Simulation, info: Info) -> Files:
        """data.yaml: JSON is YAML, and says texts as they are."""
        folder = f"images/{info['split']}"
        names = {str(k): name for name, k in class_numbers(info).items()}
        rows = {"path": ".", "train": folder, "val": folder, "names": names, **self.more(info)}
        text = "".join(f"{key}: {json.dumps(value)}\n" for key, value in rows.items())
        return {"data.yaml": text.encode("utf-8")}

    def more(self, info: Info) -> dict[str, Any]:
        """Further keys of data.yaml."""
        return {}

    def line(self, info: Info, segment: Segment, points: Keypoints | None) -> str:
        """What follows the class of an object."""
        return box_text(segment)

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The picture and its lines."""
        split, numbers = info["split"], class_numbers(info)
        classes = {row["name"]: numbers[row["class"]] for row in objects(info)}
        found, points = segments(frame.arrays["instance"]), keypoints_of(frame)
        lines = [
            f"{classes[row['name']]} "
            f"{self.line(info, found[row['instance_id']], points.get(row['name']))}\n"
            for row in frame.record["objects"]
            if row["instance_id"] in found
        ]
        return Encoded(
            {
                f"images/{split}/{frame.key}.png": png(frame.arrays[info["picture"]]),
                f"labels/{split}/{frame.key}.txt": "".join(lines).encode("ascii"),
            }
        )

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """The picture."""
        split, key = info["split"], f"{record['index']:06d}"
        return {info["picture"]: from_png(read(f"images/{split}/{key}.png"))}

    def faults(
        self, info: Info, record: Record, arrays: Mapping[str, Array], read: Callable[[str], bytes]
    ) -> Iterator[str]:
        """Lines that are none, and boxes that are not those of the objects that are seen."""
        name = f"labels/{info['split']}/{record['index']:06d}.txt"
        seen = [row for row in record["objects"] if row["px_count_visib"] > 0]
        lines = list(self.rows(read(name)))
        if len(lines) != len(seen):
            yield f"{name} has {len(lines)} lines, {len(seen)} objects are seen"
            return
        size = np.array([record["camera"]["width"], record["camera"]["height"]])
        for row, line in zip(seen, lines, strict=True):
            shares = line[1:]
            if line[0] not in range(len(class_numbers(info))):
                yield f"object '{row['name']}': {name} has the unknown class {line[0]:g}"
            inside = self.shares(shares)
            if not ((inside >= 0) & (inside <= 1)).all():
                yield f"object '{row['name']}': {name} has numbers outside of [0, 1]"
            x, y, w, h = row["bbox_visib"]
            stated = np.array([x, y, x + w + 1, y + h + 1])
            if np.abs(self.bounds(shares, size) - stated).max() > 0.01:
                yield f"object '{row['name']}': {name} is not about its pixels"

    def shares(self, numbers: Array) -> Array:
        """Those of a line's numbers that are fractions of the picture."""
        return numbers

    def bounds(self, shares: Array, size: Array) -> Array:
        """Left, top, right, bottom, pixels, that a line tells of."""
        centre, extent = shares[:2] * size, shares[2:4] * size
        return np.concatenate([centre - 0.5 * extent, centre + 0.5 * extent])

    @staticmethod
    def rows(data: bytes) -> Iterator[Array]:
        """Numbers of each line."""
        for line in data.decode("ascii").splitlines():
            yield np.array([float(word) for word in line.split()])


class YoloSegment(Yolo):
    """Polygons for instance segmentation."""

    name = "yolo-segment"
    doc = "Ultralytics YOLO: polygons of objects (needs perilune[yolo])"
    layout = Yolo.layout.replace(
        "class, centre, width, height", "class, outline through the pixels of its border"
    )

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """Nothing, if there is OpenCV."""
        try:
            import cv2  # noqa: F401
        except ImportError:
            text = "format 'yolo-segment': needs OpenCV: pip install 'perilune[yolo]'"
            raise ConfigError(text) from None
        return {}

    def line(self, info: Info, segment: Segment, points: Keypoints | None) -> str:
        """Outlines of all pieces, one after the other, as YOLO joins them. Holes are filled."""
        height, width = segment.size
        corners = np.concatenate(outlines(segment))
        shares = (corners + 0.5) / (width, height)
        return " ".join(map(_number, shares.ravel().tolist()))

    def bounds(self, shares: Array, size: Array) -> Array:
        """Those of the outline's pixels."""
        corners = shares.reshape(-1, 2) * size
        return np.concatenate([corners.min(axis=0) - 0.5, corners.max(axis=0) + 0.5])


def outlines(segment: Segment) -> list[Array]:
    """Corners (n, 2) of each piece of a mask, column and row of pixels; three or more."""
    import cv2

    x, y, w, h = segment.box
    mask = segment.mask()[y : y + h, x : x + w].astype(np.uint8)
    found, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE, offset=(x, y))
    pieces = [np.asarray(piece, dtype=np.float64).reshape(-1, 2) for piece in found]
    # A pixel or a line has fewer corners than a polygon needs.
    return [
        p if len(p) > 2 else np.concatenate([p, np.repeat(p[-1:], 3 - len(p), 0)]) for p in pieces
    ]
