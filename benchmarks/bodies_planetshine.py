"""Planetshine: noise and time against the samples of a pixel.

A satellite on its shaded side over the Earth, in a low and in a geostationary orbit, and the
Moon's night side by the light of the Earth; exposed for that light, every sample forced. Errors
are root mean squares over the frame, of 255, not rounded, against 1024 samples; times CPU
milliseconds of a frame on one thread, `off` without the row.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]

EARTH_M, MOON_M, AU_M, SUN_M = 6371e3, 1737.4e3, 149597870700.0, 695700e3
SAMPLES = (1, 4, 16, 64)
MANY = 1024
VIEWS = {
    "low orbit": (EARTH_M + 400e3, 0.0, 100.0, (0.35, 0.0, -0.94)),
    "geostationary": (42164e3, 0.0, 1.5, (0.77, 0.2, -0.6)),
    "earthshine": (384400e3, MOON_M, 0.02, (0.97, 0.2, 0.1)),
}
"""Distance from the Earth's centre along x and radius of what is lit (0: a satellite), m; radiance
shown as white, W m-2 sr-1; direction of the sun. The camera stands on the side of the Earth."""


def world(radius_m: float) -> _core.Scene:
    scene = _core.Scene(1)
    if radius_m == 0.0:
        model = _core.Model(str(report.ROOT / "assets/models/smallsat.glb"))
        parts = len(model.parts)
        scene.add_object(
            name="satellite",
            model=model,
            offset=np.zeros(3),
            obj_id=3,
            instance_id=3,
            part_ids=np.full(parts, 3, np.int32),
            class_ids=np.full((parts, 1), 3, np.uint16),
        )
    for index in range(1 if radius_m == 0.0 else 2):
        scene.add_body(
            name=f"body{index}",
            map=None,
            map_center_lon_rad=0.0,
            reflectance="lambert",
            instance_id=index + 1,
            part_id=index + 1,
            class_ids=np.array([index + 1], np.uint16),
            regolith_map=None,
            air=None,
        )
    return scene


def request(view: str, width: int, samples: int, force_off: list[str]) -> dict[str, Any]:
    away_m, radius_m, white, sun = VIEWS[view]
    height = width * 3 // 4
    stands_m = away_m - (4.0 if radius_m == 0.0 else 12.0 * radius_m)
    focal = 0.5 * width / math.tan(math.radians(25.0 if radius_m == 0.0 else 6.0))
    # Looks along x with z up: camera x to -y, y to -z, z to x.
    pose = [stands_m, 0.0, 0.0, 0.5, -0.5, 0.5, -0.5]
    bodies = [[0.0, EARTH_M]] + ([[away_m, radius_m]] if radius_m > 0.0 else [])
    return {
        "seed": 1,
        "index": 0,
        "width": width,
        "height": height,
        "K": np.array([[focal, 0, 0.5 * (width - 1)], [0, focal, 0.5 * (height - 1)], [0, 0, 1]]),
        "camera_pose": np.array([pose, pose]),
        "object_poses": np.array([[[away_m, 0, 0, 0.8, 0.0, 0.0, 0.6]] * 2])[: radius_m == 0],
        "object_scale": np.ones(1)[: radius_m == 0],
        "body_poses": np.array([[[x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]] * 2 for x, _ in bodies]),
        "body_radii": np.array([[r] * 3 for _, r in bodies]),
        "body_albedo": np.array([[0.3] * 3, [0.12] * 3])[: len(bodies)],
        "body_emission": np.zeros((len(bodies), 3)),
        "sun_position": AU_M * np.array(sun) / np.linalg.norm(sun),
        "sun_radius": SUN_M,
        "sun_irradiance": 1361.0,
        "quality": {
            "samples": samples,
            "max_bounces": 2,
            "texture_filter": 4,
            "tolerance_dn": 1.0,
            "force_on": ["antialiasing"],
            "force_off": force_off,
        },
        "exposure": {"mode": "fixed", "white_radiance": white, "percentile": 99.0, "key": 0.8},
    }


def shown(radiance: NDArray[np.float32], white: float) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(radiance.astype(np.float64) / white, 0.0, 1.0)
    high = 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055
    return np.asarray(255.0 * np.where(x <= 0.0031308, 12.92 * x, high))


def part(width: int) -> tuple[str, dict[str, Any], list[str]]:
    """Results and tables; of frames of a fifth of the width."""
    width = max(width // 5, 16)
    result: dict[str, Any] = {}
    rows = []
    for view, (_, radius_m, white, _) in VIEWS.items():
        renderer = _core.Renderer(world(radius_m))
        out = {"radiance": np.empty((width * 3 // 4, width, 3), np.float32)}

        def draw(samples: int, off: list[str], seed: int = 1, view: str = view) -> None:
            asked: Any = {**request(view, width, samples, off), "seed": seed}
            renderer.render(asked, out, 1)  # noqa: B023

        draw(MANY, [], 2)
        exact = shown(out["radiance"], white)
        result[view] = {"error_dn": {}, "ms": {}, "off_ms": {}}
        for samples in SAMPLES:
            ms = 1e3 * report.processor_s(lambda n=samples: draw(n, []))  # type: ignore[misc]
            error = float(np.sqrt(np.mean((shown(out["radiance"], white) - exact) ** 2)))
            off_ms = 1e3 * report.processor_s(  # type: ignore[misc]
                lambda n=samples: draw(n, ["planetshine"])
            )
            result[view]["error_dn"][samples] = error
            result[view]["ms"][samples] = ms
            result[view]["off_ms"][samples] = off_ms
            rows.append((view, str(samples), error, ms, off_ms))
    head = ["planetshine", "samples", "error, DN", "on, ms", "off, ms"]
    return "planetshine", result, [report.table(head, rows)]
