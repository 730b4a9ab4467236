"""A scene as Mitsuba 3 sees it.

Materials are its `principled`: GGX without what goes from facet to facet, Disney's diffuse base.
Its `roughplastic` is farther from the others: rough, it loses a third of the light. Everything is
two-sided.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from . import gas
from .scene import WATER, Array, Image, Input, Material, Mesh, Scene


def write_ply(path: Path, mesh: Mesh) -> str:
    """Binary, with normals and uv."""
    columns = [mesh.positions, mesh.normals]
    names = ["x", "y", "z", "nx", "ny", "nz"]
    if mesh.uv is not None:
        columns.append(mesh.uv)
        names += ["u", "v"]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(mesh.positions)}"]
    head += [f"property float {name}" for name in names]
    head += [f"element face {len(mesh.indices)}", "property list uchar int vertex_indices"]
    faces = np.empty(len(mesh.indices), dtype=[("n", "u1"), ("corners", "<i4", 3)])
    faces["n"], faces["corners"] = 3, mesh.indices
    with path.open("wb") as file:
        file.write(("\n".join([*head, "end_header"]) + "\n").encode())
        file.write(np.hstack(columns).astype("<f4").tobytes())
        file.write(faces.tobytes())
    return str(path)


def _texture(mitsuba: Any, image: Image, pixels: Array | None = None) -> dict[str, Any]:
    values = image.linear() if pixels is None else pixels
    return {
        "type": "bitmap",
        "bitmap": mitsuba.Bitmap(np.ascontiguousarray(values[::-1])),  # its v runs downwards
        "raw": True,
        "filter_type": "nearest" if image.nearest else "bilinear",
        "wrap_mode": "repeat",
    }


def _rgb(mitsuba: Any, value: Input) -> dict[str, Any]:
    if isinstance(value, Image):
        return _texture(mitsuba, value)
    return {"type": "rgb", "value": [float(v) for v in value]}


def _number(mitsuba: Any, value: Input) -> Any:
    return _texture(mitsuba, value) if isinstance(value, Image) else float(value[0])


def bsdf(mitsuba: Any, material: Material) -> dict[str, Any]:
    """Of one material."""
    if material.lambert:
        out = {"type": "diffuse", "reflectance": _rgb(mitsuba, material.color)}
        return {"type": "twosided", "bsdf": out}
    if material.waves is not None:
        return {
            "type": "roughplastic",
            "distribution": "beckmann",
            "alpha": material.waves,
            "int_ior": WATER,
            "ext_ior": 1.0,
            "diffuse_reflectance": {"type": "rgb", "value": 0.0},
        }
    out = {
        "type": "principled",
        "base_color": _rgb(mitsuba, material.color),
        "roughness": _number(mitsuba, material.roughness),
        "metallic": _number(mitsuba, material.metallic),
        "eta": 1.5,
    }
    if material.normal is not None:
        pixels = _texture(mitsuba, material.normal)
        out = {"type": "normalmap", "normalmap": pixels, "bsdf": out}
    return {"type": "twosided", "bsdf": out}


def _sensor(mitsuba: Any, camera: dict[str, Any], samples: int) -> dict[str, Any]:
    width, height = camera["width"], camera["height"]
    transform = mitsuba.ScalarTransform4f
    fx, fy = camera["focal_px"]
    if abs(fx - fy) > 1e-6 * fx:
        raise ValueError("Mitsuba's pixels are square")
    cx, cy = camera["centre_px"]
    return {
        "type": "perspective",
        "fov_axis": "x",
        "fov": math.degrees(2.0 * math.atan(0.5 * width / fx)),
        "principal_point_offset_x": (cx - 0.5 * (width - 1)) / width,
        "principal_point_offset_y": (cy - 0.5 * (height - 1)) / height,
        "near_clip": 0.01,
        "far_clip": 1e12,
        "to_world": transform().look_at(origin=[0, 0, 0], target=[0, 0, 1], up=[0, -1, 0]),
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "rfilter": {"type": "box"},
            "component_format": "float32",
            "pixel_format": "rgb",
        },
        "sampler": {"type": "independent", "sample_count": samples},
    }


def sun_disc(mitsuba: Any, sun: dict[str, Any]) -> dict[str, Any]:
    """A disc across the direction to it, as far away as the Sun."""
    direction, radius = np.array(sun["direction"]), sun["radius_rad"]
    place = sun["distance_m"] * direction
    up = np.eye(3)[np.argmin(np.abs(direction))]
    transform = mitsuba.ScalarTransform4f
    size = sun["distance_m"] * math.tan(radius)
    to_world = transform().look_at(origin=list(place), target=[0, 0, 0], up=list(up))
    radiance = sun["irradiance"] / (math.pi * math.sin(radius) ** 2)
    return {
        "type": "disk",
        "to_world": to_world @ transform().scale(size),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": radiance}},
    }


def describe(mitsuba: Any, scene: Scene, samples: int, folder: Path) -> dict[str, Any]:
    """What `mitsuba.load_dict` takes; meshes are written to the folder."""
    out: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": scene.max_bounces + 2, "rr_depth": 1000},
        "sensor": _sensor(mitsuba, scene.camera, samples),
        "sun": sun_disc(mitsuba, scene.sun),
    }
    if scene.air:
        out["integrator"] = gas.integrator(scene.air)
    for i, air in enumerate(scene.air):
        out |= gas.described(mitsuba, air, i)
    for i, material in enumerate(scene.materials):
        out[f"material{i}"] = bsdf(mitsuba, material) | {"id": f"material{i}"}
    for i, mesh in enumerate(scene.meshes):
        shape: dict[str, Any] = {
            "type": "ply",
            "filename": write_ply(folder / f"{i}.ply", mesh),
            "bsdf": {"type": "ref", "id": f"material{mesh.material}"},
        }
        glow = scene.materials[mesh.material].emission
        if isinstance(glow, Image) or any(glow):
            shape["emitter"] = {"type": "area", "radiance": _rgb(mitsuba, glow)}
        out[f"mesh{i}"] = shape
    return out


def render(scene: Scene, samples: int, seeds: list[int], folder: Path) -> Array:
    """(runs, H, W, 3) radiance, a run for each seed."""
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    loaded = mitsuba.load_dict(describe(mitsuba, scene, samples, folder))
    return np.stack([np.array(mitsuba.render(loaded, seed=seed))[..., :3] for seed in seeds])
