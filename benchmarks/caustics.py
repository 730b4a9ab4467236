"""Noise of sunlight that mirrors throw onto others: drawn to a table of mirrors, and met by chance.

Fictional scenes: a white box and a wing that mirrors the Sun onto it, of several roughnesses; an
array of four panels; a dish; a crumpled foil. The error is the root mean square over pixels and
bands, in digital numbers of 255 before rounding, against a frame of many samples with the table.
Times are CPU seconds of a frame on one thread, medians; the gain is how many times as long a frame
without the table takes for the same error, if its square falls with one over the samples.
"""

from __future__ import annotations

import base64
import json
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import report
from numpy.typing import ArrayLike

from perilune import _core

WIDTH, HEIGHT, FOCAL = 96, 72, 120.0
AU, SOLAR = 149597870700.0, 1361.0
SUN = np.array([-0.2, -0.1, 0.97]) / np.linalg.norm([-0.2, -0.1, 0.97])
EYE, TARGET = np.array([5.0, -6.0, 2.2]), np.array([1.0, 0.0, 0.8])
TRUTH, SAMPLES, REPEATS = 16384, (4, 16, 64, 256), 3
WHITE = 1361.0 / np.pi

Mesh = tuple[np.ndarray, np.ndarray, float | None]  # corners, normals, roughness or None: Lambert


def rectangle(center: ArrayLike, along: ArrayLike, across: ArrayLike) -> np.ndarray:
    c, a, b = (np.asarray(v, dtype=float) for v in (center, along, across))
    p = [c - a - b, c + a - b, c + a + b, c - a + b]
    return np.array([[p[0], p[1], p[2]], [p[0], p[2], p[3]]])


def flat(corners: np.ndarray, roughness: float | None) -> Mesh:
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    return corners, np.repeat(n[:, None], 3, axis=1), roughness


def cube(center: np.ndarray, half: ArrayLike) -> Mesh:
    x, y, z = np.diag(np.asarray(half, dtype=float))
    faces = [(x, y, z), (-x, z, y), (y, z, x), (-y, x, z), (z, x, y), (-z, y, x)]
    return flat(np.concatenate([rectangle(center + n, a, b) for n, a, b in faces]), None)


def sheet(
    point: Callable[[np.ndarray, np.ndarray], np.ndarray], size: int, roughness: float
) -> Mesh:
    """A grid of size x size cells, smooth: `point` maps (u, v) in -1..1 to places."""
    u, v = np.meshgrid(np.linspace(-1, 1, size + 1), np.linspace(-1, 1, size + 1), indexing="ij")
    p, h = point(u, v), 1e-5
    n = np.cross(point(u + h, v) - point(u - h, v), point(u, v + h) - point(u, v - h))
    n /= np.linalg.norm(n, axis=-1, keepdims=True)

    def split(q: np.ndarray) -> np.ndarray:
        a, b, c, d = q[:-1, :-1], q[1:, :-1], q[1:, 1:], q[:-1, 1:]
        lower, upper = np.stack([a, b, c], -2), np.stack([a, c, d], -2)
        return np.concatenate([lower.reshape(-1, 3, 3), upper.reshape(-1, 3, 3)])

    return split(p), split(n), roughness


BUS = cube(np.array([0.0, 0.0, 1.0]), (0.6, 0.6, 1.0))
ALONG, ACROSS = np.array([0.8, 0.0, 0.6]), np.array([0.0, 1.0, 0.0])
UP = np.array([-0.6, 0.0, 0.8])


def wing(roughness: float) -> list[Mesh]:
    return [BUS, flat(rectangle((1.8, 0, 0.5), 1.0 * ALONG, 0.5 * ACROSS), roughness)]


def array() -> list[Mesh]:
    panels = []
    for i in range(4):
        tilt = np.radians(6.0 * (i - 1.5))
        along = np.cos(tilt) * ALONG + np.sin(tilt) * UP
        center = np.array([0.8, 0.0, -0.2]) + 0.55 * (i + 0.5) * ALONG
        panels.append(flat(rectangle(center, 0.25 * along, 0.5 * ACROSS), 0.1))
    return [BUS, *panels]


def dish() -> list[Mesh]:
    def point(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        base = np.array([1.8, 0.0, 0.5])
        height = 0.16 * (u**2 + v**2)
        return np.asarray(
            base + 0.7 * u[..., None] * ALONG + 0.7 * v[..., None] * ACROSS + height[..., None] * UP
        )

    return [BUS, sheet(point, 24, 0.1)]


def foil() -> list[Mesh]:
    """Creases of four waves, slopes of about 0.15."""

    def point(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        waves = [(7.0, 3.0, 0.4), (-4.0, 8.0, 1.9), (11.0, 6.0, 3.1), (3.0, -13.0, 5.0)]
        height = sum(0.08 / np.hypot(a, b) * np.sin(a * u + b * v + c) for a, b, c in waves)
        return np.asarray(
            np.array([1.8, 0.0, 0.5])
            + u[..., None] * ALONG
            + 0.5 * v[..., None] * ACROSS
            + height[..., None] * UP
        )

    return [BUS, sheet(point, 48, 0.15)]


SCENES = {
    "wing, roughness 0.05": wing(0.05),
    "wing, roughness 0.1": wing(0.1),
    "wing, roughness 0.2": wing(0.2),
    "wing, roughness 0.35": wing(0.35),
    "wing, roughness 0.45": wing(0.45),
    "array of four": array(),
    "dish": dish(),
    "foil": foil(),
}


def gltf_of(meshes: list[Mesh], path: Path) -> Path:
    def y_up(v: np.ndarray) -> np.ndarray:
        v = v.reshape(-1, 3)
        return np.stack([v[:, 0], v[:, 2], -v[:, 1]], -1).astype(np.float32)

    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": []}],
        "materials": [],
        "accessors": [],
        "bufferViews": [],
        "extensionsUsed": ["KHR_materials_specular"],
    }
    blob = b""
    for i, (corners, normals, roughness) in enumerate(meshes):
        first = len(document["accessors"])
        for values in (y_up(corners), y_up(normals)):
            view = {"buffer": 0, "byteOffset": len(blob), "byteLength": values.nbytes}
            document["bufferViews"].append(view)
            document["accessors"].append(
                {
                    "bufferView": len(document["bufferViews"]) - 1,
                    "componentType": 5126,
                    "count": len(values),
                    "type": "VEC3",
                    "min": values.min(0).tolist(),
                    "max": values.max(0).tolist(),
                }
            )
            blob += values.tobytes()
        attributes = {"POSITION": first, "NORMAL": first + 1}
        document["meshes"][0]["primitives"].append({"attributes": attributes, "material": i})
        shine = {"metallicFactor": 0.0 if roughness is None else 1.0}
        shine["roughnessFactor"] = 1.0 if roughness is None else roughness
        color = [0.8, 0.8, 0.8, 1.0] if roughness is None else [0.9, 0.8, 0.6, 1.0]
        material: dict[str, Any] = {
            "pbrMetallicRoughness": {"baseColorFactor": color, **shine},
            "doubleSided": True,
        }
        if roughness is None:
            material["extensions"] = {"KHR_materials_specular": {"specularFactor": 0.0}}
        document["materials"].append(material)
    uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    document["buffers"] = [{"byteLength": len(blob), "uri": uri}]
    path.write_text(json.dumps(document))
    return path


def camera_pose() -> np.ndarray:
    z = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    x = np.cross(z, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    m = np.stack([x, np.cross(z, x), z], axis=1)
    w = 0.5 * np.sqrt(max(0.0, 1.0 + np.trace(m)))
    q = [w, *(np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]) / (4.0 * w))]
    return np.stack([np.array([*EYE, *q])] * 2)


class Stage:
    """A scene, rendered with and without the table."""

    def __init__(self, meshes: list[Mesh], folder: Path) -> None:
        self.model = _core.Model(str(gltf_of(meshes, folder / "scene.gltf")))
        self.scene = _core.Scene(1)
        parts = len(self.model.parts)
        self.scene.add_object(
            name="scene",
            model=self.model,
            offset=np.zeros(3),
            obj_id=1,
            instance_id=1,
            part_ids=np.ones(parts, np.int32),
            class_ids=np.ones((parts, 1), np.uint16),
        )
        self.renderer = _core.Renderer(self.scene)

    def image(
        self, samples: int, table: bool, seed: int = 0, tolerance: float = 0.0
    ) -> tuple[np.ndarray, float]:
        """Radiance (H, W, 3) and CPU seconds."""
        k = [[FOCAL, 0, (WIDTH - 1) / 2], [0, FOCAL, (HEIGHT - 1) / 2], [0, 0, 1.0]]
        request: _core.FrameRequest = {
            "seed": seed,
            "index": 0,
            "width": WIDTH,
            "height": HEIGHT,
            "K": np.array(k),
            "camera_pose": camera_pose(),
            "object_poses": np.array([[[0, 0, 0, 1.0, 0, 0, 0]] * 2]),
            "object_scale": np.ones(1),
            "body_poses": np.empty((0, 2, 7)),
            "body_radii": np.empty((0, 3)),
            "body_albedo": np.empty((0, 3)),
            "body_emission": np.empty((0, 3)),
            "sun_position": AU * SUN,
            "sun_radius": 695700e3,
            "sun_irradiance": SOLAR,
            "quality": {
                "samples": samples,
                "max_bounces": 4,
                "texture_filter": 1,
                "tolerance_dn": tolerance,
                "force_on": [],
                "force_off": [] if table else ["caustics"],
            },
            "exposure": {"mode": "fixed", "white_radiance": WHITE, "percentile": 99.0, "key": 0.8},
        }
        out = np.empty((HEIGHT, WIDTH, 3), np.float32)
        start = time.process_time()
        self.renderer.render(request, {"radiance": out}, threads=1)
        return out.astype(float), time.process_time() - start


def encode(radiance: np.ndarray) -> np.ndarray:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance / WHITE, 0.0, 1.0)
    low = x <= 0.0031308
    return 255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--scene", default="", help="part of a name")
    parser.add_argument("--truth", type=int, default=TRUTH)
    parser.add_argument("--tolerance", type=float, default=0.0)
    options = parser.parse_args()
    rows: list[list[object]] = []
    for name, meshes in SCENES.items():
        if options.scene not in name:
            continue
        with tempfile.TemporaryDirectory() as folder:
            stage = Stage(meshes, Path(folder))
        truth = encode(stage.image(options.truth, True, seed=99)[0])
        for samples in SAMPLES:
            row: list[object] = [name, samples]
            for table in (False, True):
                runs = [
                    stage.image(samples, table, seed, options.tolerance) for seed in range(REPEATS)
                ]
                errors = [float(np.mean((encode(image) - truth) ** 2)) for image, _ in runs]
                row += [float(np.sqrt(np.mean(errors))), report.median([t for _, t in runs])]
            rows.append([*row, (row[2] / row[4]) ** 2 * row[3] / row[5]])  # type: ignore[operator]
    keys = ["scene", "samples", "chance_rms_dn", "chance_s", "table_rms_dn", "table_s", "gain"]
    report.publish(
        options.json,
        {"rows": [dict(zip(keys, row, strict=True)) for row in rows]},
        [report.table(["scene", "samples", "by chance, DN", "s", "table, DN", "s", "gain"], rows)],
    )


if __name__ == "__main__":
    main()
