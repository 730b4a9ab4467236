"""Ultralytics' YOLO with keypoints."""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune.config.errors import ConfigError
from perilune.document.references import KEYPOINTS
from perilune.export.writers.formats.base import Array, Info
from perilune.export.writers.formats.channels import Channel
from perilune.export.writers.formats.keypoints import (
    OF_CLASSES,
    Keypoints,
    keypoint_names,
    of_classes,
)
from perilune.export.writers.formats.segments import Segment
from perilune.export.writers.formats.yolo import Yolo, class_numbers
from perilune.simulation import Simulation


class YoloPose(Yolo):
    """Boxes and keypoints."""

    name = "yolo-pose"
    doc = "Ultralytics YOLO: boxes and keypoints of objects"
    layout = Yolo.layout.replace("width, height,", "width, height, x, y, visibility of keypoints,")
    needs = (*Yolo.needs, KEYPOINTS)

    def holds(self, channel: Channel) -> bool:
        """Pictures, instances and keypoints."""
        return super().holds(channel) or channel.name == KEYPOINTS

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """Names of keypoints. ConfigError without any."""
        found = of_classes(self.name, sim)
        if not found[OF_CLASSES]:
            raise ConfigError(
                f"{sim.document.source}: format '{self.name}': no spacecraft has `keypoints`, "
                "and no annotated body `landmarks`"
            )
        return found

    def more(self, info: Info) -> dict[str, Any]:
        """Shape and names of keypoints."""
        names = {str(k): keypoint_names(info, name) for name, k in class_numbers(info).items()}
        return {"kpt_shape": [_most(info), 3], "kpt_names": names}

    def line(self, info: Info, segment: Segment, points: Keypoints | None) -> str:
        """Box and keypoints: 0 0 0 for those that are not in the picture, and for those that the
        class lacks, since YOLO has one number of keypoints for all classes."""
        height, width = segment.size
        words = [super().line(info, segment, points)]
        for x, y, v in () if points is None else points.rows():
            at = ((x + 0.5) / width, (y + 0.5) / height) if v else (0.0, 0.0)
            words.append(f"{at[0]:.9g} {at[1]:.9g} {v}")
        return " ".join(words + ["0 0 0"] * (1 + _most(info) - len(words)))

    def shares(self, numbers: Array) -> Array:
        """All but visibilities."""
        return np.concatenate([numbers[:4], numbers[4:].reshape(-1, 3)[:, :2].ravel()])


def _most(info: Info) -> int:
    """Largest number of keypoints of a class."""
    return max(len(keypoint_names(info, name)) for name in class_numbers(info))
