"""A small world of the core alone, and values that run code of their own when the core reads them.

Everything that the core takes from Python may be such a value: a number that is an object with
`__float__`, an array that is one with `__array__`, a mapping with `__getitem__` of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from perilune import _core

SATELLITE = Path(__file__).parents[2] / "assets" / "models" / "smallsat.glb"
SIZE = 24
Action = Callable[[], object]


def graph() -> _core.Graph:
    """A plain surface whose colour is a value that each frame gives."""
    sockets = len(_core.NODES["lambert"]["inputs"])
    color = ("parameter", 0, 0, 0.0, 0.0, 0.0)
    unset = ("unset", 0, 0, 0.0, 0.0, 0.0)
    node = ("surface", "lambert", (color, *[unset] * (sockets - 1)), ())
    return _core.Graph((node,), 0, 1, True)


def add_satellite(scene: _core.Scene, model: _core.Model, **changes: Any) -> int:
    parts = len(model.parts)
    given: dict[str, Any] = {
        "name": "sat",
        "model": model,
        "offset": np.zeros(3),
        "obj_id": 1,
        "instance_id": 2,
        "part_ids": np.ones(parts, np.int32),
        "class_ids": np.ones((parts, 1), np.uint16),
    }
    return scene.add_object(**given | changes)


def add_moon(scene: _core.Scene, **changes: Any) -> int:
    given: dict[str, Any] = {
        "name": "moon",
        "map": None,
        "map_center_lon_rad": 0.0,
        "reflectance": "lambert",
        "instance_id": 1,
        "part_id": 1,
        "class_ids": np.ones(1, np.uint16),
        "regolith_map": None,
        "air": None,
    }
    return scene.add_body(**given | changes)


def stars(count: int = 40) -> _core.Stars:
    """Around the direction that the camera looks in."""
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(count, 3)) * 0.2 + [0.0, 0.0, 1.0]
    return _core.Stars(
        directions / np.linalg.norm(directions, axis=1, keepdims=True),
        np.full((count, 3), 1e-3),
        np.full(count, 1.0),
        np.arange(count, dtype=np.int64),
    )


def sensor(kernel: np.ndarray, flat: np.ndarray) -> dict[str, Any]:
    return {
        "f_number": 4.0, "plane_pupil": False, "transmission": 0.9,
        "psf": {"core": "measured", "sigma_px": 0.0, "wings": 0.0, "wing_radius_px": 1.0,
                "wing_beta": 2.0},
        "kernel": kernel, "lens_flare": None, "pixel_m": 5e-6, "mosaic": "mono",
        "quantum_efficiency": (1.0, 1.0, 1.0), "band_share": (0.3, 0.3, 0.3),
        "wavelength_m": (6e-7, 5e-7, 4e-7), "exposure_s": 1e-3, "auto_time": None,
        "vignetting": 0.0, "vignetting_profile": np.array([[0.0, 1.0], [1.0, 0.5]]),
        "flat_field": flat, "serial": 3, "prnu": 0.0, "dark_current": 0.0,
        "dark_nonuniform": 0.0, "hot_pixels": 0.0, "hot_current": 0.0, "dead_pixels": 0.0,
        "ray_flux": 0.0, "ray_electrons_per_m": 0.0, "ray_depth_m": 0.0, "full_well": 1e4,
        "drain": 0.0, "shift_s": 0.0, "read_noise": 0.0, "column_noise": 0.0, "gain": 1.0,
        "black_level": 0.0, "bits": 12, "compression": None,
    }  # fmt: skip


class World:
    """A satellite before a body, seen along z from the root's origin, with everything that a frame
    may borrow from its request: graphs, stars, volumes, images of a sensor, keys of motion."""

    def __init__(self) -> None:
        self.model = _core.Model(str(SATELLITE))
        self.scene = _core.Scene(1)
        add_moon(self.scene)
        add_satellite(self.scene, self.model)
        self.graphed = np.zeros(self.model.triangle_count, np.int32)
        self.scene.set_materials(0, (graph(),), self.graphed)
        self.renderer = _core.Renderer(self.scene)

    def request(self, z_m: float = 12.0) -> dict[str, Any]:
        camera = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        craft = np.array([0.0, 0.0, z_m, 0.5, 0.5, 0.5, 0.5])
        moon = np.array([0.0, 400.0, 2000.0, 1.0, 0.0, 0.0, 0.0])
        return {
            "seed": 1, "index": 0, "width": SIZE, "height": SIZE,
            "K": np.array([[SIZE, 0.0, SIZE / 2], [0.0, SIZE, SIZE / 2], [0.0, 0.0, 1.0]]),
            "lens": ("brown_conrady", np.array([0.01, *[0.0] * 7])),
            "focus": (0.01, 10.0),
            "camera_pose": np.stack([camera, camera]),
            "motion": {"times": (0.01, 0.0, False), "camera": np.stack([camera] * 3),
                       "objects": np.stack([[craft] * 3]), "bodies": np.stack([[moon] * 3]),
                       "sun": np.array([[1.5e11, 0.0, -1.5e11]] * 3)},
            "object_poses": np.stack([[craft, craft]]), "object_scale": np.ones(1),
            "graph_parameters": np.full((1, 3), 0.5),
            "body_poses": np.stack([[moon, moon]]), "body_radii": np.full((1, 3), 300.0),
            "body_albedo": np.full((1, 3), 0.3), "body_emission": np.zeros((1, 3)),
            "body_clouds": [None],
            "body_ground": np.array([[0.0, 0.0, 0.0, *[math.nan] * 3, 0.0, 0.0, 0.0, 0.0]]),
            "sun_position": np.array([1.5e11, 0.0, -1.5e11]), "sun_radius": 7e8,
            "sun_irradiance": 1361.0, "sun_wavelengths": np.array([0.6, 0.5, 0.4]),
            "quality": {"samples": 2, "max_bounces": 1, "texture_filter": 1, "volume_steps": 4,
                        "tolerance_dn": 0.5, "force_on": ["stars"],
                        "force_off": ["multiple_scattering"]},
            "exposure": {"mode": "fixed", "white_radiance": 200.0, "percentile": 99.0, "key": 0.8},
            "sky": {"stars": stars(), "beta": np.zeros(3), "backdrop": None},
            "volumes": [{"name": "mist", "shape": "ellipsoid", "size_m": (1.0, 1.0, 1.0),
                         "parent": 0, "pose": (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
                         "extinction_per_m": (0.1, 0.1, 0.1), "albedo": (0.5, 0.5, 0.5),
                         "emission": (0.0, 0.0, 0.0), "g": 0.0, "core_m": 0.0,
                         "graph": graph(), "parameters": np.full((1, 3), 0.1)}],
            "sensor": sensor(np.full((5, 5), 0.04), np.ones((8, 8), np.float32)),
            "amodal": True,
        }  # fmt: skip

    def outputs(self) -> dict[str, np.ndarray]:
        return {
            "rgb": np.zeros((SIZE, SIZE, 3), np.uint8),
            "raw": np.zeros((SIZE, SIZE), np.uint16),
            "normal": np.zeros((SIZE, SIZE, 3), np.float32),
            "instance": np.zeros((SIZE, SIZE), np.int32),
            "masks": np.zeros((1, SIZE, SIZE), np.uint8),
            "objects": np.zeros(1, np.dtype(list(_core.OBJECT_LABEL))),
        }


class Number:
    """A number that runs an action when it is read."""

    def __init__(self, value: float, action: Action) -> None:
        self.value, self.action = value, action

    def __float__(self) -> float:
        self.action()
        return float(self.value)

    def __index__(self) -> int:
        self.action()
        return int(self.value)

    def __bool__(self) -> bool:
        self.action()
        return bool(self.value)


class Array:
    """An array likewise; it hands out the very array that it holds."""

    def __init__(self, value: Any, action: Action) -> None:
        self.value, self.action = value, action

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        self.action()
        return np.asarray(self.value, dtype)

    def __len__(self) -> int:
        self.action()
        return len(self.value)

    def __getitem__(self, index: Any) -> Any:
        self.action()
        return self.value[index]


class Buffer:
    """An array whose buffer runs an action when it is let go of."""

    def __init__(self, value: Any, action: Action) -> None:
        self.value = np.ascontiguousarray(value)
        self.action = action

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        return np.asarray(_Owner(self.value, self.action))

    def __len__(self) -> int:
        return len(self.value)


class _Owner:
    """What the array borrows from; dies with the array."""

    def __init__(self, value: np.ndarray, action: Action) -> None:
        self.value, self.action = value, action
        self.__array_interface__ = value.__array_interface__

    def __del__(self) -> None:
        self.action()


class Mapping(dict):  # type: ignore[type-arg]
    """A dict that runs an action whenever it is asked."""

    action: Action = staticmethod(lambda: None)

    def __getitem__(self, key: Any) -> Any:
        self.action()
        return super().__getitem__(key)

    def keys(self) -> Any:
        self.action()
        return super().keys()

    def items(self) -> Any:
        self.action()
        return super().items()

    def __len__(self) -> int:
        self.action()
        return super().__len__()
