"""A frame as plain data, for other renderers: geometry, materials, sun and camera.

Everything is relative to the camera, in OpenCV's axes (x right, y down, z forward) and metres, with
linear colours. Needs NumPy alone, as Blender's Python reads it too.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass
class Image:
    """Pixels (H, W) or (H, W, 3), first row at v = 1; `value` times what they hold is the input."""

    pixels: Array  # uint8 of sRGB or of 255ths, or float32
    srgb: bool = False
    factor: tuple[float, ...] = (1.0,)
    nearest: bool = False

    def linear(self) -> Array:
        """(H, W, channels) float32."""
        values = self.pixels.astype(np.float32)
        if self.pixels.dtype == np.uint8:
            values /= np.float32(255.0)
        if self.srgb:
            low = values <= 0.04045
            values = np.where(low, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)
        values = values if values.ndim == 3 else values[..., np.newaxis]
        return (values * np.asarray(self.factor, dtype=np.float32)).astype(np.float32)


Input = tuple[float, ...] | Image
"""Of a material: a constant or a texture."""


@dataclass
class Material:
    """glTF's metallic-roughness, or Lambert's law where `lambert`."""

    name: str
    color: Input
    roughness: Input = (1.0,)
    metallic: Input = (0.0,)
    emission: Input = (0.0, 0.0, 0.0)
    normal: Image | None = None  # unit vectors of tangent space, 0..1
    lambert: bool = False
    double_sided: bool = True
    waves: float | None = None  # of open water: Beckmann's alpha; its index is WATER, black below


WATER = 1.34


@dataclass
class Gas:
    """Air about a ball, scattering by Rayleigh's law, that thins out by e over `height_m`."""

    centre: tuple[float, ...]  # camera axes, m
    radius_m: float
    top_m: float
    height_m: float
    scattering_per_m: tuple[float, ...]  # at the ground
    orders: int | None  # how often light is scattered at most; None: any number of times


@dataclass
class Mesh:
    name: str
    material: int
    positions: Array  # (V, 3) float64
    normals: Array  # (V, 3)
    indices: Array  # (T, 3)
    uv: Array | None = None  # (V, 2), v upwards


@dataclass
class Scene:
    camera: dict[str, Any]  # width, height, focal_px (2,), centre_px (2,); pixel centres are whole
    sun: dict[str, Any]  # direction (3,), distance_m, radius_rad, irradiance at the camera
    max_bounces: int
    white_radiance: float
    materials: list[Material] = field(default_factory=list)
    meshes: list[Mesh] = field(default_factory=list)
    air: list[Gas] = field(default_factory=list)

    def save(self, folder: Path) -> None:
        """Writes scene.json and arrays.npz."""
        arrays: dict[str, Array] = {}

        def put(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: put(item) for key, item in value.items()}
            if isinstance(value, (list, tuple)):
                return [put(item) for item in value]
            if isinstance(value, np.ndarray):
                name = f"a{len(arrays)}"
                arrays[name] = value
                return {"array": name}
            return value

        folder.mkdir(parents=True, exist_ok=True)
        # asdict would copy every array
        document = put(
            {
                **vars(self),
                "materials": [_fields(m) for m in self.materials],
                "meshes": [vars(mesh) for mesh in self.meshes],
                "air": [vars(gas) for gas in self.air],
            }
        )
        (folder / "scene.json").write_text(json.dumps(document, indent=1))
        np.savez(folder / "arrays.npz", **arrays)


def _fields(material: Material) -> dict[str, Any]:
    return {
        key: {"image": vars(value)} if isinstance(value, Image) else value
        for key, value in vars(material).items()
    }


def load(folder: Path) -> Scene:
    """What `Scene.save` wrote."""
    arrays = np.load(folder / "arrays.npz")

    def get(value: Any) -> Any:
        if isinstance(value, dict):
            if set(value) == {"array"}:
                return arrays[value["array"]]
            if set(value) == {"image"}:
                return Image(**get(value["image"]))
            return {key: get(item) for key, item in value.items()}
        if isinstance(value, list):
            return tuple(get(item) for item in value)
        return value

    document = get(json.loads((folder / "scene.json").read_text()))
    document["materials"] = [Material(**row) for row in document["materials"]]
    document["meshes"] = [Mesh(**row) for row in document["meshes"]]
    document["air"] = [Gas(**row) for row in document["air"]]
    return Scene(**document)
