"""Entries of BOP's JSON files for the instances of one image, from the renderer's own masks.

The two files define boxes differently: scene_gt_info has w = x_max - x_min on a canvas three times
the size of the image; COCO has w = x_max - x_min + 1 inside the image."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]

NO_BOX = [-1, -1, -1, -1]
"""Both boxes of an instance without a visible pixel."""
LEAST_VISIBLE = 0.1
"""Visible fraction below which COCO's evaluation ignores an instance, and it is no target."""
DATE = "2000-01-01 00:00:00"
"""Every time stamp, so that the same dataset has the same bytes."""


def extent(mask: Mask) -> tuple[int, int, int, int] | None:
    """Smallest and largest column and row with a pixel: x0, y0, x1, y1, inclusive."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    if columns.size == 0:
        return None
    return int(columns[0]), int(rows[0]), int(columns[-1]), int(rows[-1])


def coco_box(mask: Mask) -> list[int]:
    """[x, y, w, h] of a mask that is not empty, including the last pixel."""
    found = extent(mask)
    if found is None:
        raise ValueError("coco_box: the mask is empty")
    x0, y0, x1, y1 = found
    return [x0, y0, x1 - x0 + 1, y1 - y0 + 1]


def run_lengths(mask: Mask) -> dict[str, list[int]]:
    """COCO's uncompressed run lengths: down the columns, starting with the background (or 0)."""
    pixels = mask.T.ravel()
    turns = np.flatnonzero(pixels[1:] != pixels[:-1]) + 1
    counts = np.diff(np.concatenate([[0], turns, [pixels.size]])).tolist()
    if pixels[0]:
        counts.insert(0, 0)
    return {"counts": counts, "size": list(mask.shape)}


def decode_runs(counts: Iterable[int], size: tuple[int, int]) -> Mask:
    """The mask of run lengths; ValueError if they do not fill it."""
    runs = np.fromiter(counts, dtype=np.int64)
    height, width = size
    if runs.sum() != height * width or (runs < 0).any():
        raise ValueError(f"its runs add up to {runs.sum()}, not {height} x {width} pixels")
    values = np.arange(runs.size) % 2 == 1
    return np.ascontiguousarray(np.repeat(values, runs).reshape(width, height).T)


def info_entry(row: Any, mask: Mask, has_depth: Mask) -> dict[str, Any]:
    """One entry of scene_gt_info.json. row: the object's label; has_depth: of the depth image."""
    seen = int(row["px_count_visib"]) > 0
    return {
        "bbox_obj": [int(value) for value in row["bbox_obj"]] if seen else NO_BOX,
        "bbox_visib": [int(value) for value in row["bbox_visib"]] if seen else NO_BOX,
        "px_count_all": int(row["px_count_all"]),
        "px_count_valid": int(np.count_nonzero(mask & has_depth)),
        "px_count_visib": int(row["px_count_visib"]),
        "visib_fract": float(row["visib_fract"]),
    }


def annotation(
    im_id: int, obj_id: int, mask: Mask, visible: Mask, visib_fract: float
) -> dict[str, Any]:
    """One entry of COCO's annotations, without its id. The box is that of the whole silhouette."""
    height, width = mask.shape
    return {
        "area": int(np.count_nonzero(visible)),
        "bbox": coco_box(mask),
        "category_id": obj_id,
        "height": height,
        "ignore": visib_fract < LEAST_VISIBLE,
        "image_id": im_id,
        "iscrowd": 0,
        "segmentation": run_lengths(visible),
        "width": width,
    }


@dataclass(frozen=True)
class CocoHeader:
    """Content common to the COCO files of all scenes of a dataset."""

    dataset: str
    """Name of the dataset: lower-case letters and digits."""
    split: str
    obj_ids: tuple[int, ...]
    width: int
    height: int

    def file(self, annotations: Mapping[int, list[dict[str, Any]]]) -> dict[str, Any]:
        """The COCO object of a scene. annotations: image id -> its entries, without ids."""
        im_ids = sorted(annotations)
        entries = [entry for im_id in im_ids for entry in annotations[im_id]]
        return {
            "annotations": [{"id": k, **entry} for k, entry in enumerate(entries, start=1)],
            "categories": [
                {"id": obj_id, "name": str(obj_id), "supercategory": self.dataset}
                for obj_id in sorted(self.obj_ids)
            ],
            "images": [self._image(im_id) for im_id in im_ids],
            "info": {
                "contributor": "",
                "date_created": DATE,
                "description": f"{self.dataset}_{self.split}",
                "url": "",
                "version": "1.0",
                "year": int(DATE[:4]),
            },
            "licenses": [],
        }

    def _image(self, im_id: int) -> dict[str, Any]:
        return {
            "coco_url": "",
            "date_captured": DATE,
            "file_name": f"rgb/{im_id:06d}.png",
            "flickr_url": "",
            "height": self.height,
            "id": im_id,
            "license": 1,
            "width": self.width,
        }
