"""Checks one image of a dataset: its files against each other, its labels and the models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.export.check import rows
from perilune.export.check.findings import Report
from perilune.export.check.models import rotation_fault
from perilune.export.check.ply import Mesh
from perilune.export.check.png import GREY8, GREY16, RGB8, Kind, PngError, read_png
from perilune.export.check.records import Annotation, Info, Pose, PoseRow, SceneCamera
from perilune.export.check.retrace import Tracer
from perilune.export.check.retraced import RetracedImage
from perilune.export.writers.bop_files import (
    CAMERA_FILE,
    COCO_FILE,
    GT_FILE,
    INFO_FILE,
    LARGEST_DEPTH,
    SceneFolder,
    depth_scale_mm,
)
from perilune.export.writers.bop_labels import (
    LEAST_VISIBLE,
    NO_BOX,
    Mask,
    coco_box,
    decode_runs,
    extent,
)

F64 = NDArray[np.float64]

_FRACTION = 1e-9
_PIXELS = 0.02
"""Largest distance of a pixel's centre from the projected model: rounding of single precision."""
_ROW_PIXELS = 0.1
"""The same for poses of some rows under a rolling shutter."""
_BETWEEN = 7
"""Number of positions to test between two of these rows."""
_DEPTH = 2e-6
"""Relative error of depth in single precision, and of its inputs."""
_SURFACE = 1e-5
"""The same for the model's vertices, relative to its size."""
_COARSE = 1.0 / 400.0
"""The same for a model whose cells are up to 1/20 of it: relief within a cell is a part of that."""
_DIRECTIONS = 16


@dataclass
class ImageLabels:
    """Entries of the JSON files for one image."""

    camera: SceneCamera
    poses: list[Pose]
    infos: list[Info]
    annotations: list[Annotation]


class ImageCheck:
    """The checks of one image; `run` runs them all."""

    def __init__(
        self,
        report: Report,
        scene: SceneFolder,
        im_id: int,
        labels: ImageLabels,
        meshes: Mapping[int, Mesh | None],
        size: tuple[int, int],
        tracer: Tracer,
    ) -> None:
        self.tracer = tracer
        self.report = report
        self.scene = scene
        self.im_id = im_id
        self.labels = labels
        self.meshes = meshes
        self.size = size
        self.K: F64 = np.reshape(labels.camera.cam_K, (3, 3))

    def run(self) -> None:
        self._camera()
        for name in self.scene.pictures:
            kind = GREY16 if name == "raw" else RGB8
            self._png(self.scene.picture(self.im_id, name), kind)
        depth = self._png(self.scene.depth(self.im_id), GREY16)
        taken = np.zeros((self.size[1], self.size[0]), dtype=bool)
        crafts, bodies = np.zeros_like(taken), np.zeros_like(taken)
        annotations = iter(self.labels.annotations)
        whole: list[Mask] = []
        seen: list[Mask] = []
        for gt_id, (pose, info) in enumerate(
            zip(self.labels.poses, self.labels.infos, strict=True)
        ):
            self.report.instances += 1
            entry = next(annotations, None) if info.px_count_visib > 0 else None
            mask_path = self.scene.mask(self.im_id, gt_id)
            visible_path = self.scene.mask_visib(self.im_id, gt_id)
            mask, visible = self._mask(mask_path), self._mask(visible_path)
            self._pose(gt_id, pose)
            if mask is None or visible is None:
                continue
            outside = np.count_nonzero(visible & ~mask)
            self._need(outside == 0, visible_path, f"{outside} pixels are not in mask/")
            twice = np.count_nonzero(visible & taken)
            self._need(twice == 0, visible_path, f"{twice} pixels are another instance's too")
            taken |= visible
            (bodies if self.tracer.shapes.is_body(pose) else crafts)[visible] = True
            whole.append(mask)
            seen.append(visible)
            self._info(gt_id, info, mask, visible, depth)
            self._annotation(gt_id, entry, pose, info, mask, visible)
            self._projection(gt_id, pose, info, mask)
            if depth is not None:
                self._surface(gt_id, pose, visible, depth)
        self._need(next(annotations, None) is None, self._file(COCO_FILE), "too many annotations")
        if depth is not None:
            self._depth_scale(depth, crafts if crafts.any() else bodies)
        if seen and len(seen) == len(self.labels.poses):
            self._retrace(whole, seen, depth)

    def _retrace(self, masks: list[Mask], seen: list[Mask], depth: NDArray[Any] | None) -> None:
        """Compares the labels with rays cast at the models."""
        shapes, scale = self.tracer.shapes, self.labels.camera.depth_scale
        fine = [k for k, pose in enumerate(self.labels.poses) if not shapes.is_coarse(pose)]
        poses = [self.labels.poses[k] for k in fine]
        infos = [self.labels.infos[k] for k in fine]
        masks, seen = [masks[k] for k in fine], [seen[k] for k in fine]
        why = shapes.why_not(poses)
        if why is not None:
            self.report.note(f"models were not traced in some images for comparison: {why}")
            return
        depth_mm = None if depth is None else depth.astype(np.float64) * scale
        image = RetracedImage(self._need_plain, self.scene, self.im_id, poses, infos, fine)
        try:
            image.compare(self.tracer, self.K, masks, seen, depth_mm, scale)
        except (ValueError, np.linalg.LinAlgError) as error:
            self._need(False, self._file(GT_FILE), f"models cannot be traced: {error}")

    # Where and what: every fault of a JSON file names the image and the instance.

    def _file(self, name: str) -> Path:
        return self.scene.folder / name

    def _need(self, holds: bool, path: Path, reason: str) -> None:
        named = path.suffix == ".png"
        self.report.need(holds, path, reason if named else f"image {self.im_id}: {reason}")

    def _need_plain(self, holds: bool, path: Path, reason: str) -> None:
        self.report.need(holds, path, reason)

    def _png(self, path: Path, kind: Kind) -> NDArray[Any] | None:
        try:
            return read_png(path, kind, self.size)
        except FileNotFoundError:
            pass  # reported by the comparison of folder and labels
        except (OSError, PngError) as error:
            self.report.add(path, str(error))
        return None

    def _mask(self, path: Path) -> Mask | None:
        values = self._png(path, GREY8)
        if values is None:
            return None
        other = np.count_nonzero((values != 0) & (values != 255))
        self._need(other == 0, path, f"{other} pixels are neither 0 nor 255")
        return np.asarray(values != 0)

    def _camera(self) -> None:
        path, camera = self._file(CAMERA_FILE), self.labels.camera
        K = self.K
        upper = K[1, 0] == 0.0 and K[2].tolist() == [0.0, 0.0, 1.0]
        good = upper and K[0, 0] > 0.0 and K[1, 1] > 0.0
        self._need(good, path, "cam_K must be [fx s cx 0 fy cy 0 0 1] with fx, fy > 0")
        fault = rotation_fault(np.reshape(camera.cam_R_w2c, (3, 3)))
        self._need(fault is None, path, f"cam_R_w2c {fault}")

    def _pose(self, gt_id: int, pose: Pose) -> None:
        path = self._file(GT_FILE)
        fault = rotation_fault(np.reshape(pose.cam_R_m2c, (3, 3)))
        self._need(fault is None, path, f"instance {gt_id}: cam_R_m2c {fault}")
        for at in pose.rows or ():
            fault = rotation_fault(np.reshape(at.cam_R_m2c, (3, 3)))
            self._need(fault is None, path, f"instance {gt_id}: row {at.row}: cam_R_m2c {fault}")
        wrong = rows.fault(pose, self.size[1])
        self._need(wrong is None, path, f"instance {gt_id}: {wrong}")
        known = pose.obj_id in self.meshes
        self._need(known, path, f"instance {gt_id}: obj_id {pose.obj_id} is not in models/")

    def _info(
        self,
        gt_id: int,
        info: Info,
        mask: Mask,
        visible: Mask,
        depth: NDArray[Any] | None,
    ) -> None:
        path, who = self._file(INFO_FILE), f"instance {gt_id}"
        inside, seen = int(np.count_nonzero(mask)), int(np.count_nonzero(visible))

        def equal(name: str, value: object) -> None:
            stated = getattr(info, name)
            self._need(stated == value, path, f"{who}: {name} is {stated}, the masks say {value}")

        equal("px_count_visib", seen)
        if depth is not None:
            equal("px_count_valid", int(np.count_nonzero(mask & (depth != 0))))
        fraction = seen / info.px_count_all if info.px_count_all else 0.0
        close = abs(info.visib_fract - fraction) <= _FRACTION
        self._need(close, path, f"{who}: visib_fract is {info.visib_fract}, not {fraction}")
        few = info.px_count_all >= inside
        self._need(few, path, f"{who}: px_count_all is {info.px_count_all} < {inside} of mask/")
        if seen == 0:
            equal("bbox_visib", NO_BOX)
            equal("bbox_obj", NO_BOX)
            return
        equal("bbox_visib", _bop_box(visible))
        self._whole_box(who, info, mask, inside)

    def _whole_box(self, who: str, info: Info, mask: Mask, inside: int) -> None:
        """Compares bbox_obj with the mask, as far as it is inside the image."""
        path, (width, height) = self._file(INFO_FILE), self.size
        x, y, w, h = info.bbox_obj
        cut = x < 0 or y < 0 or x + w >= width or y + h >= height
        if not cut:
            truth = _bop_box(mask)
            same = info.bbox_obj == truth
            self._need(same, path, f"{who}: bbox_obj is {info.bbox_obj}, mask/ says {truth}")
            count = info.px_count_all == inside
            reason = f"{who}: px_count_all is {info.px_count_all}, mask/ has {inside} and is whole"
            self._need(count, path, reason)
            return
        canvas = -width <= x and -height <= y and x + w < 2 * width and y + h < 2 * height
        self._need(canvas, path, f"{who}: bbox_obj {info.bbox_obj} exceeds three times the image")
        found = extent(mask)
        holds = found is not None and (
            x <= found[0] and y <= found[1] and found[2] <= x + w and found[3] <= y + h
        )
        self._need(holds, path, f"{who}: bbox_obj {info.bbox_obj} does not hold mask/")
        fits = inside < info.px_count_all <= (w + 1) * (h + 1)
        reason = f"{who}: px_count_all {info.px_count_all} does not go with bbox_obj and mask/"
        self._need(fits, path, reason)

    def _annotation(
        self,
        gt_id: int,
        entry: Annotation | None,
        pose: Pose,
        info: Info,
        mask: Mask,
        visible: Mask,
    ) -> None:
        path, who = self._file(COCO_FILE), f"instance {gt_id}"
        if info.px_count_visib == 0:
            return
        if entry is None:
            self._need(False, path, f"{who}: has visible pixels, but no annotation")
            return
        expected = {
            "area": int(np.count_nonzero(visible)),
            "bbox": coco_box(mask) if mask.any() else NO_BOX,
            "category_id": pose.obj_id,
            "height": self.size[1],
            "ignore": info.visib_fract < LEAST_VISIBLE,
            "width": self.size[0],
        }
        for name, value in expected.items():
            stated = getattr(entry, name)
            self._need(stated == value, path, f"{who}: {name} is {stated}, must be {value}")
        try:
            if entry.segmentation.size != [self.size[1], self.size[0]]:
                raise ValueError(f"its size is {entry.segmentation.size}, must be height, width")
            decoded = decode_runs(entry.segmentation.counts, (self.size[1], self.size[0]))
        except ValueError as error:
            self._need(False, path, f"{who}: segmentation: {error}")
            return
        wrong = np.count_nonzero(decoded != visible)
        reason = f"{who}: segmentation differs from mask_visib/ at {wrong} pixels"
        self._need(wrong == 0, path, reason)

    @staticmethod
    def _outline(mesh: Mesh, pose: Pose | PoseRow) -> F64:
        """Points whose convex hull contains the model: with moving parts, the whole model at rest
        and at every position of a part."""
        points = [mesh.outline]
        for values in (pose.articulation or {}).values():
            motion = np.reshape(values, (4, 4))
            points.append(mesh.outline @ motion[:3, :3].T + motion[:3, 3])
        return np.concatenate(points)

    def _between_rows(self, mesh: Mesh, pose: Pose) -> list[F64]:
        """Points of the model between given rows, because rotation leaves the hull of both."""
        placed = []
        for first, last in pairwise(pose.rows or ()):
            places = np.linspace(first.row, last.row, _BETWEEN + 2)[1:-1]
            outlines = [self._outline(mesh, at) for at in (first, last)]
            for R, t in zip(*rows.at_rows(pose, places), strict=True):
                placed += [R @ outline.T + t[:, None] for outline in outlines]
        return placed

    def _projection(self, gt_id: int, pose: Pose, info: Info, mask: Mask) -> None:
        """Checks that the convex hull of the model's projection contains the mask and bbox_obj."""
        mesh = self.meshes.get(pose.obj_id)
        shapes = self.tracer.shapes
        if mesh is None or shapes.is_smooth(pose) or shapes.is_coarse(pose):
            return  # vertices do not enclose it
        path, who = self._file(GT_FILE), f"instance {gt_id}"
        placed = []
        for at in rows.stated(pose):
            R, t = rows.matrices(at)
            placed.append(R @ self._outline(mesh, at).T + t[:, None])
        placed += self._between_rows(mesh, pose)
        slack = _ROW_PIXELS if pose.rows else _PIXELS
        points = self.K @ np.concatenate(placed, axis=1)
        if points[2].min() <= 0.0:
            behind = points[2].max() <= 0.0 and bool(mask.any())
            self._need(not behind, path, f"{who}: lies behind the camera, but mask/ is not empty")
            return
        pixels = points[:2] / points[2]
        if info.bbox_obj != NO_BOX:
            x, y, w, h = info.bbox_obj
            low, high = pixels.min(axis=1) - slack, pixels.max(axis=1) + slack
            inside = low[0] <= x and low[1] <= y and x + w <= high[0] and y + h <= high[1]
            self._need(inside, path, f"{who}: bbox_obj is not inside the projected model")
        lines, columns = np.nonzero(mask)
        if lines.size == 0:
            return
        angles = np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
        axes = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        model, seen = axes @ pixels, axes @ np.stack([columns, lines])
        over = max(
            float((seen.max(axis=1) - model.max(axis=1)).max()),
            float((model.min(axis=1) - seen.min(axis=1)).max()),
        )
        reason = f"{who}: mask/ reaches {over:.3g} pixels beyond the projected model"
        self._need(over <= slack, path, reason)

    def _surface(self, gt_id: int, pose: Pose, visible: Mask, depth: NDArray[Any]) -> None:
        """Checks that depth at visible pixels lies in the model's box, in the model's frame."""
        path = self.scene.depth(self.im_id)
        lines, columns = np.nonzero(visible)
        steps = depth[lines, columns].astype(np.float64)
        none = np.count_nonzero(steps == 0.0)
        body = self.tracer.shapes.is_body(pose)  # may be farther than depth goes
        told = f"instance {gt_id}: {none} visible pixels have no depth"
        self._need(none == 0 or body, path, told)
        mesh = self.meshes.get(pose.obj_id)
        if mesh is None or lines.size == 0 or none > 0:
            return
        scale = self.labels.camera.depth_scale
        pixels = np.stack([columns, lines, np.ones_like(lines)], axis=1).astype(np.float64)
        rays = np.linalg.solve(self.K, pixels.T).T
        points = rays * (steps * scale)[:, None]
        R, t = rows.at_rows(pose, lines)
        local = np.einsum("ni,nij->nj", points - t, R)
        outline = np.concatenate([self._outline(mesh, at) for at in rows.stated(pose)])
        low, high = outline.min(axis=0), outline.max(axis=0)
        slack = (0.5 * scale + _DEPTH * steps * scale) * np.linalg.norm(rays, axis=1)
        part = _COARSE if self.tracer.shapes.is_coarse(pose) else _SURFACE
        slack += part * float(np.linalg.norm(high - low))
        slack += _DEPTH * np.linalg.norm(t, axis=1)
        off = np.maximum(low - local, local - high).max(axis=1)
        wrong = off > slack
        reason = (
            f"instance {gt_id}: depth at {np.count_nonzero(wrong)} visible pixels lies up to "
            f"{float(off.max()):.3g} mm outside the model's box"
        )
        self._need(not wrong.any(), path, reason)

    def _depth_scale(self, depth: NDArray[Any], annotated: Mask) -> None:
        """Checks that the scale is the finest that covers the farthest annotated surface."""
        path, scale = self._file(CAMERA_FILE), self.labels.camera.depth_scale
        measured = depth[annotated] if annotated.any() else depth
        steps = int(measured.max(initial=0))
        low, high = (max(steps - 0.5, 0.0) * scale, (steps + 0.5) * scale)
        allowed = {depth_scale_mm(low), depth_scale_mm(min(high, LARGEST_DEPTH * scale))}
        nearest = min(allowed, key=lambda value: abs(value - scale))
        fits = min(allowed) <= scale <= max(allowed)
        self._need(fits, path, f"depth_scale is {scale:g}, the depth asks for {nearest:g}")
        beyond = np.count_nonzero(depth > LARGEST_DEPTH)
        reason = f"{beyond} pixels are {LARGEST_DEPTH + 1}, which stands for saturation"
        self._need(beyond == 0, self.scene.depth(self.im_id), reason)


def _bop_box(mask: Mask) -> list[int]:
    """[x, y, w, h] by scene_gt_info's convention: last pixel minus first."""
    found = extent(mask)
    if found is None:
        return NO_BOX
    return [found[0], found[1], found[2] - found[0], found[3] - found[1]]
