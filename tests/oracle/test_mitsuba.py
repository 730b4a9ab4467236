"""Images against Mitsuba 3: the same meshes, materials and lights, within the noise of both.

Each renderer makes RUNS images with different seeds; blocks of BLOCK x BLOCK pixels are compared by
Welch's t-test with Sidak's correction for their number, as Mitsuba's own tests do. What the two
define differently is left out: the sun is a direction, normals are flat, and the one glossy surface
is smooth and seen steeply enough that shadowing and multiple scattering of microfacets vanish, and
it has no light in its sky but what diffuse surfaces send (metal that lights metal is in
test_mitsuba_energy.py).
"""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from pathlib import Path

import mitsuba
import numpy as np
import pytest
from benchmarks.reference.by_mitsuba import write_ply
from benchmarks.reference.models import flat_normals, rectangle
from benchmarks.reference.scene import Mesh
from scipy import stats

from perilune import _core

WIDTH, HEIGHT, FOCAL = 64, 48, 70.0
RUNS, OUR_SAMPLES, THEIR_SAMPLES = 8, 64, 96  # a sample of ours costs three of theirs
BLOCK = 4
FALSE_ALARM = 0.001  # of one comparison, all blocks and bands together; seeds are fixed
SOLAR, AU = 1361.0, 149597870700.0
# Our samples of a pixel lie on one lattice in all runs: an edge through a pixel is off by up to
# n^(-3/4) = 0.04 of its step with 64 of them; a block, where pixels are off either way, by a
# twentieth of that. As a standard error, of the contrast in the block.
EDGE = 2e-3


@dataclass
class Shape:
    """Triangles in world coordinates (z up) with one material."""

    corners: np.ndarray  # (T, 3, 3), counter-clockwise from outside
    color: tuple[float, float, float]
    roughness: float | None = None  # None: Lambert; otherwise a metal that mirrors all light
    radiance: tuple[float, float, float] | None = None
    normals: np.ndarray | None = None  # (T, 3, 3); None: flat
    uvs: np.ndarray | None = None  # (T, 3, 2)
    gltf: dict | None = None  # material and Mitsuba's, instead of what the above make
    bsdf: dict | None = None


def cube(center, half, turn) -> np.ndarray:
    x = half * np.array([np.cos(turn), np.sin(turn), 0.0])
    y = half * np.array([-np.sin(turn), np.cos(turn), 0.0])
    z = np.array([0.0, 0.0, half])
    faces = [(x, y, z), (-x, z, y), (y, z, x), (-y, x, z), (z, x, y), (-z, y, x)]
    return np.concatenate([rectangle(center + n, a, b) for n, a, b in faces])


def ball(center, radius, rings=12, sectors=24) -> np.ndarray:
    theta, phi = np.meshgrid(
        np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, sectors + 1), indexing="ij"
    )
    p = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    p = np.asarray(center) + radius * p
    a, b, c, d = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
    lower = np.stack([a, b, c], -2)[:-1].reshape(-1, 3, 3)  # no slivers at the poles
    upper = np.stack([a, c, d], -2)[1:].reshape(-1, 3, 3)
    return np.concatenate([lower, upper])


GROUND = Shape(rectangle((0, 0, 0), (30, 0, 0), (0, 30, 0)), (0.6, 0.5, 0.4))
BOX = Shape(cube(np.array([-0.9, -0.6, 0.5]), 0.5, 0.5), (0.8, 0.3, 0.2))
BALL = Shape(ball((1.0, -0.9, 0.6), 0.6), (0.3, 0.5, 0.9))
MIRROR = Shape(rectangle((0, 1.5, 0.9), (2, 0, 0), (0, 0, 0.9)), (1.0, 1.0, 1.0), roughness=0.2)
BACKING = Shape(rectangle((0, 1.53, 0.92), (2.05, 0, 0), (0, 0, 0.92)), (0.1, 0.1, 0.1))
LAMP = Shape(
    rectangle((0.3, -1.0, 4.5), (0, 0.5, 0), (0.7, 0, 0)), (0.0, 0.0, 0.0), None, (900, 750, 300)
)
# To the sun; behind the mirror.
SUN = np.array([0.4, 0.7, 0.8]) / np.linalg.norm([0.4, 0.7, 0.8])
EYE, TARGET = np.array([0.5, -5.0, 4.2]), np.array([0.0, 0.0, 0.4])  # no horizon


def normals_of(shape: Shape) -> np.ndarray:
    return flat_normals(shape.corners) if shape.normals is None else shape.normals


# --- ours ----------------------------------------------------------------------------------------


def gltf_of(shapes: list[Shape], path: Path) -> Path:
    def y_up(v: np.ndarray) -> np.ndarray:
        v = v.reshape(-1, 3)
        return np.stack([v[:, 0], v[:, 2], -v[:, 1]], -1).astype(np.float32)

    document: dict = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": []}],
        "materials": [],
        "accessors": [],
        "bufferViews": [],
        "extensionsUsed": ["KHR_materials_specular", "KHR_materials_emissive_strength"],
    }
    blob = b""
    for i, shape in enumerate(shapes):
        arrays = [y_up(shape.corners), y_up(normals_of(shape))]
        attributes = {"POSITION": len(document["accessors"])}
        attributes["NORMAL"] = attributes["POSITION"] + 1
        if shape.uvs is not None:
            arrays.append(shape.uvs.reshape(-1, 2).astype(np.float32))
            attributes["TEXCOORD_0"] = attributes["POSITION"] + 2
        for values in arrays:
            view = {"buffer": 0, "byteOffset": len(blob), "byteLength": values.nbytes}
            document["bufferViews"].append(view)
            document["accessors"].append(
                {
                    "bufferView": len(document["bufferViews"]) - 1,
                    "componentType": 5126,
                    "count": len(values),
                    "type": f"VEC{values.shape[1]}",
                    "min": values.min(0).tolist(),
                    "max": values.max(0).tolist(),
                }
            )
            blob += values.tobytes()
        document["meshes"][0]["primitives"].append({"attributes": attributes, "material": i})
        document["materials"].append(gltf_material(shape))
    uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    document["buffers"] = [{"byteLength": len(blob), "uri": uri}]
    path.write_text(json.dumps(document))
    return path


def gltf_material(shape: Shape) -> dict:
    if shape.gltf is not None:
        return shape.gltf
    material: dict = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*shape.color, 1.0],
            "metallicFactor": 1.0,
            "roughnessFactor": shape.roughness or 1.0,
        },
        "doubleSided": shape.radiance is None,
    }
    if shape.roughness is None:
        material["pbrMetallicRoughness"]["metallicFactor"] = 0.0
        material["extensions"] = {"KHR_materials_specular": {"specularFactor": 0.0}}  # Lambert
    if shape.radiance is not None:
        strength = max(shape.radiance)
        material["emissiveFactor"] = [v / strength for v in shape.radiance]
        material.setdefault("extensions", {})["KHR_materials_emissive_strength"] = {
            "emissiveStrength": strength
        }
    return material


def quaternion(m: np.ndarray) -> list[float]:
    w = 0.5 * np.sqrt(max(0.0, 1.0 + np.trace(m)))
    return [w, *(np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / (4.0 * w))]


def camera_pose() -> np.ndarray:
    z = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    pose = np.array([*EYE, *quaternion(np.stack([x, np.cross(z, x), z], axis=1))])
    return np.stack([pose, pose])


def ours(
    shapes: list[Shape],
    irradiance: float,
    bounces: int,
    folder: Path,
    sun: np.ndarray = SUN,
    samples: int = OUR_SAMPLES,
) -> np.ndarray:
    """(RUNS, H, W, 3) radiance."""
    model = _core.Model(str(gltf_of(shapes, folder / "scene.gltf")))
    assert model.warnings == ()
    scene = _core.Scene(1)
    parts = len(model.parts)
    scene.add_object(
        name="scene",
        model=model,
        offset=np.zeros(3),
        obj_id=1,
        instance_id=1,
        part_ids=np.ones(parts, np.int32),
        class_ids=np.ones((parts, 1), np.uint16),
    )
    request: _core.FrameRequest = {
        "seed": 0,
        "index": 0,
        "width": WIDTH,
        "height": HEIGHT,
        "K": np.array([[FOCAL, 0, (WIDTH - 1) / 2], [0, FOCAL, (HEIGHT - 1) / 2], [0, 0, 1.0]]),
        "camera_pose": camera_pose(),
        "object_poses": np.array([[[0, 0, 0, 1.0, 0, 0, 0]] * 2]),
        "object_scale": np.ones(1),
        "body_poses": np.empty((0, 2, 7)),
        "body_radii": np.empty((0, 3)),
        "body_albedo": np.empty((0, 3)),
        "body_emission": np.empty((0, 3)),
        "sun_position": AU * sun,
        "sun_radius": 695700e3,
        "sun_irradiance": irradiance,
        "quality": {
            "samples": samples,
            "max_bounces": bounces,
            "texture_filter": 1,
            "tolerance_dn": 0.0,
            "force_on": ["antialiasing", "bounces", "cast_shadows", "emitters"],
            "force_off": ["soft_sun"],
        },
        "exposure": {"mode": "fixed", "white_radiance": 400.0, "percentile": 99.0, "key": 0.8},
    }
    renderer = _core.Renderer(scene)
    images = np.empty((RUNS, HEIGHT, WIDTH, 3), np.float32)
    for run in range(RUNS):
        request["index"] = run
        renderer.render(request, {"radiance": images[run]}, threads=2)
    return images.astype(np.float64)


# --- theirs --------------------------------------------------------------------------------------


def ply_of(shape: Shape, path: Path) -> str:
    uvs = None if shape.uvs is None else shape.uvs.reshape(-1, 2)
    indices = np.arange(3 * len(shape.corners)).reshape(-1, 3)
    normals = normals_of(shape).reshape(-1, 3)
    return write_ply(path, Mesh("", 0, shape.corners.reshape(-1, 3), normals, indices, uvs))


def mitsuba_shape(shape: Shape, path: Path) -> dict:
    rgb = {"type": "rgb", "value": list(shape.color)}
    bsdf: dict = {"type": "diffuse", "reflectance": rgb}
    if shape.roughness is not None:
        bsdf = {
            "type": "roughconductor",
            "material": "none",
            "distribution": "ggx",
            "alpha": shape.roughness**2,
        }
    bsdf = shape.bsdf or bsdf
    out = {"type": "ply", "filename": ply_of(shape, path), "face_normals": shape.normals is None}
    out["bsdf"] = bsdf if shape.radiance is not None else {"type": "twosided", "bsdf": bsdf}
    if shape.radiance is not None:
        radiance = {"type": "rgb", "value": [float(v) for v in shape.radiance]}
        out["emitter"] = {"type": "area", "radiance": radiance}
    return out


def theirs(
    shapes: list[Shape],
    irradiance: float,
    bounces: int,
    folder: Path,
    sun: np.ndarray = SUN,
    samples: int = THEIR_SAMPLES,
) -> np.ndarray:
    mitsuba.set_variant("scalar_rgb")
    transform = mitsuba.ScalarTransform4f
    scene: dict = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": bounces + 2},
        "sensor": {
            "type": "perspective",
            "fov_axis": "x",
            "fov": float(np.degrees(2.0 * np.arctan(0.5 * WIDTH / FOCAL))),
            "near_clip": 0.01,
            "to_world": transform().look_at(origin=list(EYE), target=list(TARGET), up=[0, 0, 1]),
            "film": {
                "type": "hdrfilm",
                "width": WIDTH,
                "height": HEIGHT,
                "rfilter": {"type": "box"},
                "component_format": "float32",
            },
            "sampler": {"type": "independent", "sample_count": samples},
        },
    }
    if irradiance > 0.0:
        scene["sun"] = {
            "type": "directional",
            "direction": list(-sun),
            "irradiance": {"type": "rgb", "value": irradiance},
        }
    for i, shape in enumerate(shapes):
        scene[f"shape{i}"] = mitsuba_shape(shape, folder / f"{i}.ply")
    loaded = mitsuba.load_dict(scene)
    return np.stack([np.array(mitsuba.render(loaded, seed=run))[..., :3] for run in range(RUNS)])


# --- the test ------------------------------------------------------------------------------------


def tiled(images: np.ndarray) -> np.ndarray:
    """(runs, block rows, block columns, pixels of a block, bands)."""
    runs, height, width, bands = images.shape
    rows = images.reshape(runs, height // BLOCK, BLOCK, width // BLOCK, BLOCK, bands)
    return rows.swapaxes(2, 3).reshape(runs, height // BLOCK, width // BLOCK, BLOCK**2, bands)


def worst_p_value(a: np.ndarray, b: np.ndarray, part: float = 0.0, dim: float = 0.0) -> float:
    """Chance, for all blocks together, of a difference like the largest if both have one mean; or,
    as standard errors, means that differ by a part of their light and by a radiance `dim`."""
    floor = (EDGE * np.ptp(tiled(a).mean(0), axis=2)) ** 2 + dim**2
    floor += (part * tiled(a).mean((0, 3))) ** 2
    a, b = tiled(a).mean(3), tiled(b).mean(3)
    noise_a, noise_b = a.var(0, ddof=1) / RUNS, b.var(0, ddof=1) / RUNS
    floor += (1e-6 * a.max()) ** 2  # rounding
    t = (a.mean(0) - b.mean(0)) / np.sqrt(noise_a + noise_b + floor)
    freedom = (noise_a + noise_b + floor) ** 2 / ((noise_a**2 + noise_b**2) / (RUNS - 1) + 1e-300)
    p = 2.0 * stats.t.sf(np.abs(t), np.minimum(freedom, 1e6))
    return float(-np.expm1(p.size * np.log1p(-p.min())))


# Shapes, irradiance, bounces. One bounce off the mirror: the sun that it throws on the ground is
# found too seldom for a t-test.
CASES = {
    "sun": ([GROUND, BOX, BALL], SOLAR, 2),
    "sun, mirror": ([GROUND, BOX, BALL, MIRROR, BACKING], SOLAR, 1),
    "lamp": ([GROUND, BOX, BALL, LAMP], 0.0, 2),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_same_image(case: str, tmp_path: Path):
    a = ours(*CASES[case], tmp_path, samples=OUR_SAMPLES)
    b = theirs(*CASES[case], tmp_path, samples=THEIR_SAMPLES)
    p = worst_p_value(a, b)
    ratio = a.mean() / b.mean()
    print(f"{case}: p = {p:.3g} over all blocks, mean ratio {ratio:.5f}")
    assert p > FALSE_ALARM
    assert abs(ratio - 1.0) < 5e-3
    # The test is sharp enough to see 3 %.
    assert worst_p_value(1.03 * a, b) < FALSE_ALARM
