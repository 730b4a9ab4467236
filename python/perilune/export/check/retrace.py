"""Casts rays at the models of a dataset in the poses of its labels: what must be visible."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.export.check import rows
from perilune.export.check.ply import Mesh
from perilune.export.check.records import ModelInfo, PartInfo, Pose
from perilune.frame.request import object_dtype

F64 = NDArray[np.float64]
Mask = NDArray[np.bool_]

_M_PER_MM = 1e-3
_CAMERA = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
_SUN_M = [0.0, 0.0, -1.5e11]
"""Behind the camera; labels need no light."""
ELLIPSOID, TERRAIN = "ellipsoid", "terrain"
_KEPT = 16
"""Number of scenes to cache; most datasets need one."""


@dataclass(frozen=True)
class Shapes:
    """The models of a dataset as geometry for rays."""

    meshes: Mapping[int, Mesh | None]
    infos: Mapping[int, ModelInfo]
    parts: Mapping[int, Sequence[tuple[PartInfo, Mesh]]] = field(default_factory=dict)
    """Moving parts of articulated objects, by object."""

    def of(self, pose: Pose, cut: bool) -> tuple[F64, NDArray[np.int32]]:
        """(vertices (V, 3) in mm, faces (F, 3)) of an instance, with its parts in their poses.

        cut: include the faces of which alpha leaves only a part."""
        parts = self.parts.get(pose.obj_id) if pose.articulation else None
        if not parts:
            mesh, info = self.meshes[pose.obj_id], self.infos[pose.obj_id]
            assert mesh is not None
            return mesh.points, _uncut(mesh, info, cut)
        points, faces, count = [], [], 0
        for info, mesh in parts:
            motion = _motion(pose, info.nodes)
            points.append(mesh.points @ motion[:3, :3].T + motion[:3, 3])
            turned = np.linalg.det(motion[:3, :3]) < 0.0
            corners = _uncut(mesh, info, cut)
            faces.append((corners[:, ::-1] if turned else corners) + count)
            count += len(mesh.points)
        return np.concatenate(points), np.concatenate(faces)

    def is_cut(self, poses: Sequence[Pose]) -> bool:
        """Whether alpha cuts faces of one of the instances in part."""
        return any(self.infos[pose.obj_id].faces_cut_in_part for pose in poses)

    def is_body(self, pose: Pose) -> bool:
        """Whether an instance is a body."""
        return pose.obj_id in self.infos and self.infos[pose.obj_id].surface is not None

    def is_smooth(self, pose: Pose) -> bool:
        """Whether it is an ellipsoid, which rays meet in closed form."""
        return pose.obj_id in self.infos and self.infos[pose.obj_id].surface == ELLIPSOID

    def is_coarse(self, pose: Pose) -> bool:
        """Whether its model is only about what is seen."""
        return pose.obj_id in self.infos and self.infos[pose.obj_id].surface == TERRAIN

    def radii_m(self, pose: Pose) -> F64:
        """(3,): semi-axes of an ellipsoid, half of its model's box."""
        info = self.infos[pose.obj_id]
        return 0.5 * _M_PER_MM * np.array([info.size_x, info.size_y, info.size_z])

    def why_not(self, poses: Sequence[Pose]) -> str | None:
        """Reason why the poses cannot be traced."""
        if any(self.meshes.get(pose.obj_id) is None for pose in poses):
            return "a model is of no use"
        if any(pose.rows and pose.articulation for pose in poses):
            return "parts move from row to row"
        if any(pose.articulation and pose.obj_id not in self.parts for pose in poses):
            return "parts move, but models_parts/ has none of the object"
        return None


def _motion(pose: Pose, nodes: Sequence[str]) -> F64:
    motions = pose.articulation or {}
    named = [node for node in nodes if node in motions]
    return np.reshape(motions[named[0]], (4, 4)) if named else np.eye(4)


def _uncut(mesh: Mesh, info: ModelInfo, cut: bool) -> NDArray[np.int32]:
    """The faces, on request without those at the end that alpha cuts."""
    return mesh.faces if cut else mesh.faces[: len(mesh.faces) - info.faces_cut_in_part]


@dataclass(frozen=True)
class Traced:
    """First hits of rays through pixel centres with the models; nothing else occludes them."""

    masks: Mask  # (instances, height, width), each alone
    front: NDArray[np.int32]  # (height, width), index of the nearest instance, -1: none
    depth_mm: F64  # (height, width), of it
    rows: NDArray[Any]  # (instances,), of Sample.objects


class Tracer:
    """Traces images of one size; caches acceleration structures of models without moving parts."""

    def __init__(self, shapes: Shapes, size: tuple[int, int]) -> None:
        self.shapes = shapes
        self.size = size
        self._kept: dict[tuple[Any, ...], _core.Renderer] = {}

    def trace(self, K: F64, poses: Sequence[Pose], cut: bool = True) -> Traced:
        """cut: include the faces of which alpha leaves only a part, as if opaque."""
        smooth = [self.shapes.is_smooth(pose) for pose in poses]
        order = np.argsort(smooth, kind="stable")  # meshes, then ellipsoids
        back = np.argsort(order)
        width, height = self.size
        count = len(poses)
        out: dict[str, NDArray[Any]] = {
            "instance": np.empty((height, width), dtype=np.int32),
            "depth": np.empty((height, width), dtype=np.float32),
            "masks": np.empty((count, height, width), dtype=np.uint8),
            "objects": np.empty(count, dtype=object_dtype()),
        }
        meshes = [poses[k] for k in order if not smooth[k]]
        bodies = [poses[k] for k in order if smooth[k]]
        request = _request(K, self.size, meshes, bodies)
        request["body_radii"] = np.array([self.shapes.radii_m(p) for p in bodies]).reshape(-1, 3)
        if any(pose.rows for pose in poses):
            request["motion"] = _rolling(meshes, bodies, height)
        self._renderer(poses, cut).render(request, out, 1)
        depth_mm = out["depth"].astype(np.float64) / _M_PER_MM
        masks = out["masks"][back] != 0
        return Traced(masks, out["instance"] - 1, depth_mm, out["objects"][back])

    def _renderer(self, poses: Sequence[Pose], cut: bool) -> _core.Renderer:
        moving = any(pose.articulation for pose in poses)
        key = (cut, *(pose.obj_id for pose in poses))
        if not moving and key in self._kept:
            return self._kept[key]
        scene = _core.Scene(1)
        models: dict[int, _core.Model] = {}
        for k, pose in enumerate(poses):
            if self.shapes.is_smooth(pose):
                _add_ellipsoid(scene, k, pose)
                continue
            if pose.articulation or pose.obj_id not in models:
                points, faces = self.shapes.of(pose, cut)
                models[pose.obj_id] = _core.Model.of_mesh(
                    f"obj_{pose.obj_id:06d}",
                    np.ascontiguousarray(points, dtype=np.float32),
                    np.ascontiguousarray(faces, dtype=np.uint32),
                    True,
                )
            scene.add_object(
                name=str(k),
                model=models[pose.obj_id],
                offset=np.zeros(3),
                obj_id=pose.obj_id,
                instance_id=k + 1,
                part_ids=np.ones(1, dtype=np.int32),
                class_ids=np.ones((1, 1), dtype=np.uint16),
            )
        renderer = _core.Renderer(scene)
        if not moving:
            if len(self._kept) >= _KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = renderer
        return renderer


def _add_ellipsoid(scene: _core.Scene, k: int, pose: Pose) -> None:
    """Instance k as a body."""
    scene.add_body(
        name=str(k),
        map=None,
        map_center_lon_rad=0.0,
        reflectance="lambert",
        instance_id=k + 1,
        part_id=1,
        class_ids=np.ones(1, dtype=np.uint16),
        regolith_map=None,
        air=None,
        obj_id=max(pose.obj_id, 1),
    )


def _keys(poses: Sequence[Pose], places: F64) -> F64:
    """(poses, places, 7): poses at rows."""
    found = np.empty((len(poses), len(places), 7))
    for k, pose in enumerate(poses):
        R, t = rows.at_rows(pose, places)
        found[k, :, :3] = _M_PER_MM * t
        found[k, :, 3:] = [rotations.from_matrix(matrix) for matrix in R]
    return found


def _rolling(meshes: Sequence[Pose], bodies: Sequence[Pose], height: int) -> dict[str, Any]:
    """Keys at every row; if their number is even, also between rows."""
    places = np.linspace(0.0, height - 1.0, height if height % 2 else 2 * height - 1)
    return {
        "times": (0.0, 1.0, False),
        "camera": np.tile(_CAMERA, (len(places), 1)),
        "objects": _keys(meshes, places),
        "bodies": _keys(bodies, places),
        "sun": np.tile(_SUN_M, (len(places), 1)),
        "movers": np.empty((len(places), 0, 3, 4)),
    }


def _placed(poses: Sequence[Pose]) -> F64:
    """(poses, 2, 7) in the axes of the camera."""
    found = np.empty((len(poses), 2, 7))
    for k, pose in enumerate(poses):
        found[k, :, :3] = np.multiply(pose.cam_t_m2c, _M_PER_MM)
        found[k, :, 3:] = rotations.from_matrix(np.reshape(pose.cam_R_m2c, (3, 3)))
    return found


def _request(
    K: F64, size: tuple[int, int], meshes: Sequence[Pose], bodies: Sequence[Pose]
) -> _core.FrameRequest:
    """Request for a pinhole camera at the origin, whose axes the poses refer to."""
    none = np.zeros((len(bodies), 3))
    return {
        "seed": 0,
        "index": 0,
        "width": size[0],
        "height": size[1],
        "K": K,
        "camera_pose": np.tile(_CAMERA, (2, 1)),
        "object_poses": _placed(meshes),
        "object_scale": np.full(len(meshes), _M_PER_MM),
        "body_poses": _placed(bodies),
        "body_radii": none,
        "body_albedo": none,
        "body_emission": none,
        "sun_position": np.array(_SUN_M),
        "sun_radius": 7e8,
        "sun_irradiance": 1361.0,
        "quality": {
            "samples": 1,
            "max_bounces": 0,
            "volume_steps": 1,
            "texture_filter": 1,
            "tolerance_dn": 0.0,
            "force_on": [],
            "force_off": [],
        },
        "exposure": {"mode": "fixed", "white_radiance": 1.0, "percentile": 99.0, "key": 0.5},
        "amodal": True,
    }
