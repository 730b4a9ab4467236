"""Rings: what they cost, and their error against the number of samples.

A planet like Saturn with rings of 2048 intervals of random depth: from 15 radii over them, from
their plane but for half a degree, from below on the unlit side, and from 0.02 radii over them.
Times are CPU milliseconds of frames at a tolerance of 1 DN with the row `rings` forced off, and
with it. Errors are those of a picture a quarter as wide, against 512 samples in every pixel: the
99th percentile in digital numbers of 255, before rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import report
from numpy.typing import NDArray

from perilune import _core

F64 = NDArray[np.float64]
RADIUS_M, AU_M = 6.03e7, 149597870700.0
DISTANCE_AU, WHITE = 9.5, 4.0
SUN = np.array([0.5, -0.8, 0.35])
SAMPLES, MANY = (1, 4, 16, 64), 512
VIEWS = {
    "over": ((0.0, -14.0, 5.0), (0.0, 0.0, 0.0), 22.0),
    "edge": ((0.0, -15.0, 0.13), (0.0, 0.0, 0.0), 22.0),
    "unlit": ((3.0, -14.0, -5.0), (0.0, 0.0, 0.0), 22.0),
    "near": ((0.3, -1.9, 0.02), (0.0, 0.0, 0.0), 60.0),
}
"""Place and aim in radii of the body, z along the rings' normal; field of view in degrees."""


def scene() -> _core.Scene:
    generator = np.random.default_rng(5)
    edges = RADIUS_M * np.linspace(1.24, 2.27, 2049)
    depth = np.exp(generator.normal(-0.3, 1.0, 2048))
    albedo = generator.uniform(0.3, 0.6, (2048, 3))
    made = _core.Scene(1)
    made.add_body(
        name="planet",
        map=None,
        map_center_lon_rad=0.0,
        reflectance="lambert",
        instance_id=1,
        part_id=1,
        class_ids=np.array([1], dtype=np.uint16),
        regolith_map=None,
        air=None,
        rings=_core.Rings(edges, depth, albedo, 3.092, 0.0, 0.7),
    )
    return made


def request(view: str, width: int, samples: int, tolerance_dn: float, off: bool) -> dict[str, Any]:
    import bodies  # which imports this module

    place, aim, fov_deg = VIEWS[view]
    x, y, z = np.array(aim) - np.array(place)
    turn = bodies.quaternion(bodies.rotation((float(x), float(y), float(z))))
    pose = [*(RADIUS_M * np.array(place)), *turn]
    return {
        "seed": 1,
        "index": 0,
        "width": width,
        "height": width * 3 // 4,
        "K": bodies.intrinsics(width, fov_deg),
        "camera_pose": np.array([pose, pose]),
        "object_poses": np.empty((0, 2, 7)),
        "object_scale": np.empty(0),
        "body_poses": np.array([[[0.0, 0, 0, 1, 0, 0, 0]] * 2]),
        "body_radii": np.array([[1.0, 1.0, 0.9]]) * RADIUS_M,
        "body_albedo": np.full((1, 3), 0.5),
        "body_emission": np.zeros((1, 3)),
        "sun_position": DISTANCE_AU * AU_M * SUN / np.linalg.norm(SUN),
        "sun_radius": 695700e3,
        "sun_irradiance": 1361.0,
        "quality": {
            "samples": samples,
            "max_bounces": 4,
            "texture_filter": 7,
            "tolerance_dn": tolerance_dn,
            "force_on": [],
            "force_off": ["rings"] if off else [],
        },
        "exposure": {"mode": "fixed", "white_radiance": WHITE, "percentile": 99.0, "key": 0.8},
    }


def frame_ms(renderer: _core.Renderer, view: str, width: int, samples: int, off: bool) -> float:
    asked: Any = request(view, width, samples, 1.0, off)
    out = {"rgb": np.empty((asked["height"], width, 3), np.uint8)}
    return 1e3 * report.processor_s(lambda: renderer.render(asked, out, 1))


def shown(renderer: _core.Renderer, view: str, width: int, samples: int, exact: bool) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    asked: Any = request(view, width, samples, 0.0 if exact else 1.0, off=False)
    out = {"radiance": np.empty((asked["height"], width, 3), np.float32)}
    renderer.render(asked, out, 1)
    x = np.clip(out["radiance"].astype(np.float64) / WHITE, 0.0, 1.0)
    root = 1.055 * np.maximum(x, 1e-9) ** (1.0 / 2.4) - 0.055
    return np.asarray(255.0 * np.where(x <= 0.0031308, 12.92 * x, root))


def part(width: int) -> tuple[str, dict[str, Any], list[str]]:
    """Name, numbers, and tables of them."""
    renderer = _core.Renderer(scene())
    result: dict[str, Any] = {}
    costs, errors = [], []
    small = width // 4
    for view in VIEWS:
        off_ms = frame_ms(renderer, view, width, 16, off=True)
        on_ms = frame_ms(renderer, view, width, 16, off=False)
        result[view] = {"off_ms": off_ms, "on_ms": on_ms, "rings_ratio": on_ms / off_ms}
        costs.append((view, off_ms, on_ms, on_ms / off_ms))
        truth = shown(renderer, view, small, MANY, exact=True)
        row: list[object] = [view]
        for samples in SAMPLES:
            off_dn = np.abs(shown(renderer, view, small, samples, exact=False) - truth)
            error = float(np.quantile(off_dn, 0.99))
            took_ms = frame_ms(renderer, view, small, samples, off=False)
            result[view][f"samples_{samples}"] = {"error_dn": error, "ms": took_ms}
            row += [error, took_ms]
        errors.append(row)
    head = ["rings", *(text for n in SAMPLES for text in (f"{n} samples, DN", "ms"))]
    return (
        "rings",
        result,
        [
            report.table(["rings", "off, ms", "on, ms", "ratio"], costs),
            report.table(head, errors),
        ],
    )
