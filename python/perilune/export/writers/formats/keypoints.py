"""Keypoints of spacecraft, for formats whose keypoints belong to a class."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from perilune.config.errors import ConfigError
from perilune.document.references import KEYPOINTS
from perilune.export.writers.formats.base import Frame, Info
from perilune.frame.labels import object_class
from perilune.simulation import Simulation

OF_CLASSES = "keypoints_of_classes"
"""Key of dataset_info.json: class -> names of the keypoints of its spacecraft."""


@dataclass(frozen=True)
class Keypoints:
    """Keypoints of an object."""

    pixels: list[tuple[float, float]]
    visibility: list[int]
    """0: not in the picture; 1: hidden; 2: seen (COCO's v)."""

    def rows(self) -> Iterable[tuple[float, float, int]]:
        """x, y, visibility; 0, 0, 0 for what is not in the picture."""
        for (x, y), v in zip(self.pixels, self.visibility, strict=True):
            yield (x, y, v) if v else (0, 0, 0)

    def coco(self) -> dict[str, Any]:
        """Keys of a COCO annotation."""
        return {
            "keypoints": [number for row in self.rows() for number in row],
            "num_keypoints": sum(v > 0 for v in self.visibility),
        }


def keypoints_of(frame: Frame) -> Mapping[str, Keypoints]:
    """Object -> its keypoints; empty if the frame has none."""
    found: dict[str, Keypoints] = {}
    for row in frame.arrays.get(KEYPOINTS, ()):
        own = found.setdefault(str(row["object"]), Keypoints([], []))
        own.pixels.append((float(row["xy"][0]), float(row["xy"][1])))
        own.visibility.append(int(row["visible"]))
    return found


def of_classes(fmt: str, sim: Simulation) -> dict[str, Any]:
    """The key of dataset_info.json. ConfigError for spacecraft of one class with other keypoints:
    names belong to the class."""
    found: dict[str, list[str]] = {}
    first: dict[str, str] = {}
    for name in sim.config.objects:
        craft = sim.config.spacecraft.get(name)
        entry = craft or sim.config.bodies[name]
        key = f"{'bodies' if craft is None else 'spacecraft'}.{name}"
        own, known = list(sim.keypoint_names.get(name, ())), object_class(name, entry)
        if own != found.setdefault(known, own):
            raise ConfigError(
                f"{sim.document.source}: format '{fmt}': {first[known]} and "
                f"{key} have the class '{known}' but other keypoints; give each a "
                "`class` of its own"
            )
        first.setdefault(known, key)
    return {OF_CLASSES: {known: names for known, names in found.items() if names}}


def keypoint_names(info: Info, class_name: str) -> list[str]:
    """Names of the keypoints of a class; empty if it has none, or they are not in the dataset."""
    return list(info[OF_CLASSES].get(class_name, ())) if KEYPOINTS in info["channels"] else []
