"""Keypoints of a frame, for the formats that have them.

No channel gives keypoints yet: `KEYPOINTS` is the name that they will have. Everything that formats
ask of them is here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from perilune.export.writers.formats.base import Frame, Info

KEYPOINTS = "keypoints"


@dataclass(frozen=True)
class Keypoints:
    """Keypoints of an object."""

    pixels: list[tuple[float, float]]
    visibility: list[int]
    """0: not in the picture; 1: hidden; 2: seen (COCO's v)."""

    def coco(self) -> dict[str, Any]:
        """Keys of a COCO annotation."""
        rows = [
            [x, y, v] if v else [0, 0, 0]
            for (x, y), v in zip(self.pixels, self.visibility, strict=True)
        ]
        return {
            "keypoints": [number for row in rows for number in row],
            "num_keypoints": sum(v > 0 for v in self.visibility),
        }


def keypoints_of(frame: Frame) -> Mapping[str, Keypoints]:
    """Object -> its keypoints; empty if the frame has none."""
    return {}


def keypoint_names(info: Info) -> list[str]:
    """Names of the keypoints of every object; empty if there are none."""
    return list(info.get(KEYPOINTS, ()))
