"""Compares the labels of an image with ray hits on the models in the given poses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.check.records import Info, Pose
from perilune.export.check.retrace import Traced, Tracer
from perilune.export.writers.bop_files import GT_FILE, INFO_FILE, LARGEST_DEPTH, SceneFolder

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]
Need = Callable[[bool, Path, str], None]

FEW, OF_OUTLINE = 2, 0.005
"""Number of pixels, and fraction of the outline's, that may differ: centres within rounding of an
edge."""
_OF_DEPTHS = 0.002
"""Fraction of the pixels whose depth may differ: surfaces seen edge-on."""
_DEPTH = 4e-6
"""Relative error of depth in single precision, in addition to half a step."""


def outline(mask: Mask) -> int:
    """Pixels of a mask with a neighbour outside of it."""
    inner = mask.copy()
    inner[1:] &= mask[:-1]
    inner[:-1] &= mask[1:]
    inner[:, 1:] &= mask[:, :-1]
    inner[:, :-1] &= mask[:, 1:]
    return int(np.count_nonzero(mask & ~inner))


class RetracedImage:
    """The comparison of one image."""

    def __init__(
        self,
        need: Need,
        scene: SceneFolder,
        im_id: int,
        poses: Sequence[Pose],
        infos: Sequence[Info],
        numbers: Sequence[int],
    ) -> None:
        """need: records faults: (holds, file, reason). numbers: of the instances."""
        self.need = need
        self.scene = scene
        self.im_id = im_id
        self.poses = poses
        self.infos = infos
        self.numbers = numbers

    def compare(
        self,
        tracer: Tracer,
        K: F64,
        masks: Sequence[Mask],
        visible: Sequence[Mask],
        depth_mm: F64 | None,
        step_mm: float,
    ) -> None:
        """masks, visible: those of all instances. depth_mm: (height, width), 0 where there is
        none."""
        whole = tracer.trace(K, self.poses)
        least = (
            tracer.trace(K, self.poses, cut=False) if tracer.shapes.is_cut(self.poses) else whole
        )
        for k in range(len(self.poses)):
            edge = outline(whole.masks[k])
            few = FEW + int(OF_OUTLINE * edge)
            self._mask(k, masks[k], whole.masks[k], least.masks[k], few)
            self._front(k, visible[k], whole, least, few, depth_mm, LARGEST_DEPTH * step_mm)
            self._counts(k, whole.rows[k], least.rows[k], edge, least is whole)
            if depth_mm is not None and least is whole:
                self._depth(k, visible[k] & (whole.front == k), whole.depth_mm, depth_mm, step_mm)

    def _mask(self, k: int, mask: Mask, most: Mask, least: Mask, few: int) -> None:
        path = self.scene.mask(self.im_id, self.numbers[k])
        more, fewer = int(np.count_nonzero(mask & ~most)), int(np.count_nonzero(least & ~mask))
        reason = (
            f"{more} pixels more and {fewer} fewer than rays meet of the model in the pose of "
            f"{GT_FILE}; {few} may differ"
        )
        self.need(more + fewer <= few, path, reason)

    def _front(
        self,
        k: int,
        seen: Mask,
        whole: Traced,
        least: Traced,
        few: int,
        depth_mm: F64 | None,
        farthest_mm: float,
    ) -> None:
        """An instance is visible where rays hit it first, unless a body is in front."""
        path = self.scene.mask_visib(self.im_id, self.numbers[k])
        behind = int(np.count_nonzero(seen & (whole.front != k) & ~self._maybe(k, whole, least)))
        reason = f"at {behind} pixels rays meet another instance or none first; {few} may differ"
        self.need(behind <= few, path, reason)
        if depth_mm is None:
            return
        unseen = ~seen & (least.front == k)
        # What hides it is nearer. Beyond spacecraft depth may end before it.
        hidden = (depth_mm > 0.0) & (depth_mm < least.depth_mm * (1.0 + _DEPTH))
        hidden |= (depth_mm == 0.0) & (least.depth_mm > farthest_mm)
        lost = int(np.count_nonzero(unseen & ~hidden))
        reason = (
            f"{lost} pixels fewer than rays meet of the instance, and by depth/ nothing is in "
            f"front; {few} may differ"
        )
        self.need(lost <= few, path, reason)

    @staticmethod
    def _maybe(k: int, whole: Traced, least: Traced) -> Mask | bool:
        """Pixels where alpha decides which instance is visible."""
        return False if least is whole else whole.masks[k] & (whole.front != least.front)

    def _counts(self, k: int, most: Any, least: Any, edge: int, sure: bool) -> None:
        """Counts of the whole silhouette, also outside the image and for hidden instances."""
        path, info, who = (
            self.scene.folder / INFO_FILE,
            self.infos[k],
            f"instance {self.numbers[k]}",
        )
        high, low = int(most["px_count_all"]), int(least["px_count_all"])
        box = [int(value) for value in most["bbox_obj"]]
        few = FEW + int(OF_OUTLINE * max(edge, 2 * (box[2] + box[3])))
        found = info.px_count_all
        reason = (
            f"image {self.im_id}: {who}: px_count_all is {found}, rays meet {high} pixels of the "
            f"model; {few} may differ"
        )
        self.need(low - few <= found <= high + few, path, reason)
        if info.px_count_visib == 0 or not sure:
            return
        ends = [box[0], box[1], box[0] + box[2], box[1] + box[3]]
        x, y, w, h = info.bbox_obj
        off = max(abs(a - b) for a, b in zip(ends, [x, y, x + w, y + h], strict=True))
        reason = f"image {self.im_id}: {who}: bbox_obj is {info.bbox_obj}, of the model it is {box}"
        self.need(off <= 1 or most["px_count_all"] <= few, path, reason)

    def _depth(self, k: int, where: Mask, traced: F64, found: F64, step_mm: float) -> None:
        path = self.scene.depth(self.im_id)
        where = where & (found > 0.0)  # bodies may be farther than depth goes
        off = np.abs(found[where] - traced[where])
        wrong = off > 0.51 * step_mm + _DEPTH * traced[where]
        count, few = int(np.count_nonzero(wrong)), FEW + int(_OF_DEPTHS * off.size)
        reason = (
            f"instance {self.numbers[k]}: at {count} of {off.size} visible pixels up to "
            f"{float(off.max(initial=0.0)):.3g} mm off the model in the pose of {GT_FILE}; "
            f"{few} may be"
        )
        self.need(count <= few, path, reason)
