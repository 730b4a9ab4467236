"""Bodies: what the air of a planet costs, and its error against the steps along a ray.

The views are the limb from low orbit, the ground straight below, the whole Earth and the sky from
the ground, 640 x 480 unless --width says otherwise, 16 samples a pixel at a tolerance of 1 DN, on
one thread. Times are CPU milliseconds of a frame, the least of several; `off` is the same frame
with the row `atmosphere` forced off. Errors are those of the rays through pixels against 64 steps:
the 99th percentile in digital numbers of 255, before rounding, beside the time of a ray.
"""

from __future__ import annotations

import math
from typing import Any

import bodies_clouds
import bodies_ground
import bodies_planetshine
import bodies_rings
import bodies_shapes
import numpy as np
import report
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere

F64 = NDArray[np.float64]

RADIUS_M, AU_M, SUN_M = 6371e3, 149597870700.0, 695700e3
STEPS = (2, 3, 4, 5, 6, 8, 10, 12, 16, 24, 32)
WHITE, SOLAR = 330.0, 1361.0
SUN = np.array([0.45, 0.35, 0.82])
VIEWS = {
    "limb": (400e3, (-0.3346, 0.9424, 0.0), 50.0),
    "nadir": (400e3, (-1.0, 0.0, 0.0), 60.0),
    "whole": (3e7, (-1.0, 0.0, 0.0), 26.0),
    "sky": (2.0, (0.25, 1.0, 0.0), 60.0),
}
"""Height over (radius, 0, 0) in m, direction, field of view in degrees; x is up, or y."""


def rotation(forward: tuple[float, float, float]) -> F64:
    """Axes x right, y down, z forward as columns."""
    z = np.array(forward) / np.linalg.norm(forward)
    up = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = np.cross(z, up) / np.linalg.norm(np.cross(z, up))
    return np.stack([x, np.cross(z, x), z], axis=1)


def quaternion(m: F64) -> list[float]:
    """Of a rotation by at most a third of a turn or so from one of the axes."""
    values = [1.0 + m.trace(), *(1.0 + 2.0 * m[i, i] - m.trace() for i in range(3))]
    k = int(np.argmax(values))
    turned = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]
    if k == 0:
        q = [values[0], *turned]
    else:
        q = [turned[k - 1], *(m[k - 1, i] + m[i, k - 1] for i in range(3))]
        q[k] = values[k]
    return [float(value) for value in np.array(q) / np.linalg.norm(q)]


def intrinsics(width: int, fov_deg: float) -> F64:
    height = width * 3 // 4
    focal = 0.5 * width / math.tan(0.5 * math.radians(fov_deg))
    return np.array([[focal, 0, 0.5 * (width - 1)], [0, focal, 0.5 * (height - 1)], [0, 0, 1]])


def request(view: str, width: int, force_off: list[str]) -> dict[str, Any]:
    height_m, forward, fov_deg = VIEWS[view]
    pose = [RADIUS_M + height_m, 0.0, 0.0, *quaternion(rotation(forward))]
    return {
        "seed": 1,
        "index": 0,
        "width": width,
        "height": width * 3 // 4,
        "K": intrinsics(width, fov_deg),
        "camera_pose": np.array([pose, pose]),
        "object_poses": np.empty((0, 2, 7)),
        "object_scale": np.empty(0),
        "body_poses": np.array([[[0.0, 0, 0, 1, 0, 0, 0]] * 2]),
        "body_radii": np.full((1, 3), RADIUS_M),
        "body_albedo": np.full((1, 3), 0.3),
        "body_emission": np.zeros((1, 3)),
        "sun_position": AU_M * SUN / np.linalg.norm(SUN),
        "sun_radius": SUN_M,
        "sun_irradiance": SOLAR,
        "quality": {
            "samples": 16,
            "max_bounces": 0,
            "texture_filter": 4,
            "tolerance_dn": 1.0,
            "force_on": [],
            "force_off": force_off,
        },
        "exposure": {"mode": "fixed", "white_radiance": WHITE, "percentile": 99.0, "key": 0.8},
    }


def earth_air() -> _core.Air:
    return _core.Air(
        atmospheres.settings(Atmosphere(preset="earth"), (0.612, 0.549, 0.465)), RADIUS_M
    )


def scene_of(air: _core.Air) -> _core.Scene:
    """A body with this air."""
    scene = _core.Scene(1)
    scene.add_body(
        name="earth",
        map=None,
        map_center_lon_rad=0.0,
        reflectance="lambert",
        instance_id=1,
        part_id=1,
        class_ids=np.array([1], dtype=np.uint16),
        regolith_map=None,
        air=air,
    )
    return scene


def frame(air: _core.Air, view: str, width: int, force_off: list[str]) -> tuple[float, int]:
    """CPU milliseconds, and the steps of the plan."""
    renderer = _core.Renderer(scene_of(air))
    asked: Any = request(view, width, force_off)
    out = {"rgb": np.empty((asked["height"], width, 3), np.uint8)}
    result: Any = renderer.render(asked, out, 1)
    steps = next(row["value"] for row in result["plan"] if row["name"] == "atmosphere")
    return 1e3 * report.processor_s(lambda: renderer.render(asked, out, 1)), int(steps)


def encode(radiance: F64) -> F64:
    """Display values of 255, sRGB (IEC 61966-2-1), not rounded."""
    x = np.clip(SOLAR * radiance / WHITE, 0.0, 1.0)
    low = x <= 0.0031308
    shown: F64 = 255.0 * np.where(low, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)
    return shown


def errors(air: _core.Air, view: str) -> list[tuple[float, float]]:
    """Of each of STEPS: digital numbers, and microseconds a ray."""
    height_m, forward, fov_deg = VIEWS[view]
    width = 64
    rows, columns = np.indices((width * 3 // 4, width))
    pixels = np.stack([columns, rows, np.ones_like(rows)], axis=-1).reshape(-1, 3)
    rays = pixels @ np.linalg.inv(intrinsics(width, fov_deg)).T @ rotation(forward).T
    rays = np.ascontiguousarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))
    points = np.tile([RADIUS_M + height_m, 0.0, 0.0], (len(rays), 1))
    x, y, z = (float(value) for value in SUN / np.linalg.norm(SUN))

    def light(steps: int) -> F64:
        return air.scatter(points, rays, (x, y, z), SUN_M / AU_M, math.inf, steps, False)[0]

    exact = encode(light(64))
    found = []
    for steps in STEPS:
        off = np.abs(encode(light(steps)) - exact)
        took = report.processor_s(lambda steps=steps: light(steps), 0.05)  # type: ignore[misc]
        found.append((float(np.quantile(off, 0.99)), 1e6 * took / len(rays)))
    return found


PARTS = (
    bodies_clouds.part,
    bodies_ground.part,
    bodies_planetshine.part,
    bodies_rings.part,
    bodies_shapes.part,
)
"""Of the other modules: a function each, of the width, that gives results and tables."""


def main() -> None:
    parser = report.arguments(__doc__ or "")
    parser.add_argument("--width", type=int, default=640)
    arguments = parser.parse_args()
    air = earth_air()
    made_s = report.processor_s(earth_air)
    result: dict[str, Any] = {"air_made_ms": 1e3 * made_s}
    costs, curves = [], {view: errors(air, view) for view in VIEWS}
    for view in VIEWS:
        off_ms, _ = frame(air, view, arguments.width, ["atmosphere"])
        on_ms, steps = frame(air, view, arguments.width, [])
        costs.append((view, off_ms, on_ms, on_ms / off_ms, steps))
        result[view] = {"off_ms": off_ms, "on_ms": on_ms, "air_ratio": on_ms / off_ms}
        result[view]["steps"] = steps
        result[view]["error_dn"] = {n: e for n, (e, _) in zip(STEPS, curves[view], strict=True)}
        result[view]["ray_us"] = {n: t for n, (_, t) in zip(STEPS, curves[view], strict=True)}
    rows = [
        [str(n), *(value for view in VIEWS for value in curves[view][i])]
        for i, n in enumerate(STEPS)
    ]
    head = ["steps", *(text for view in VIEWS for text in (f"{view}, DN", "us a ray"))]
    tables = [
        f"An atmosphere is made in {1e3 * made_s:.0f} ms, once.",
        report.table(["view", "off, ms", "on, ms", "ratio", "steps"], costs),
        report.table(head, rows),
    ]
    for part in PARTS:
        name, numbers, texts = part(arguments.width)
        result[name] = numbers
        tables += texts
    report.publish(arguments.json, result, tables)


if __name__ == "__main__":
    main()
