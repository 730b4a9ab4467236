"""The channel `shadow` beside normals and beside colour under a point Sun."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from tests.python.test_terrain_frames import moon, over

import perilune
from perilune.frame import shutter
from perilune.show import preview

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
POINT_SUN: dict[str, Any] = {
    "render.samples": 1,
    "render.max_bounces": 0,
    "render.force_off": ["soft_sun", "antialiasing"],
}
CHANNELS = ["shadow", "radiance", "range", "normal", "geometric_normal", "position", "incidence"]


def facing_sun(sim: perilune.Simulation, sample: perilune.Sample, normal: str) -> np.ndarray:
    """Cosines between normals and the way to the Sun's centre."""
    to_sun = shutter.middle(sim.world(0)).sun_position_m - sample["position"]
    to_sun /= np.linalg.norm(to_sun, axis=-1, keepdims=True)
    turned = sample[normal].astype(float) @ sample.camera.R_w2c
    return (turned * to_sun).sum(axis=-1)


def test_the_night_of_a_sphere_is_where_normals_face_away() -> None:
    camera = {"trajectory": over(4e6) | {"altitude_above": "datum"}, "width": 96, "height": 96}
    keys = ("kind", "target", "lon_deg", "lat_deg", "height_m")
    camera["trajectory"] = {key: camera["trajectory"][key] for key in keys}
    sim = moon({}, camera, bodies={"moon": {"kind": "moon", "albedo": 0.3}})
    sample = sim.frame(0, CHANNELS)
    seen = sample["range"] > 0.0
    facing = facing_sun(sim, sample, "normal")
    sure = seen & (np.abs(facing) > 1e-6)
    np.testing.assert_array_equal(sample["shadow"][sure] == 1, facing[sure] < 0.0)
    assert sample["shadow"].dtype == np.uint8
    assert not sample["shadow"][~seen].any()
    assert 0.1 < sample["shadow"][seen].mean() < 0.9
    assert (~seen).any()


def test_what_is_in_shadow_is_black_and_the_rest_is_lit() -> None:
    """Ground, rocks and a lander: the pixels that a point Sun does not light, less those of
    which only the shading normal faces away."""
    changes = POINT_SUN | {"camera.width": 160, "camera.height": 120}
    sim = perilune.open(CONFIGS / "lunar_rover.yaml", overrides=changes)
    sample = sim.frame(0, CHANNELS)
    seen, shadow = sample["range"] > 0.0, sample["shadow"] == 1
    black = seen & (sample["radiance"][..., 1] == 0.0)
    away = sample["incidence"] > 0.5 * np.pi - 1e-4
    assert (shadow & ~black).sum() + (black & ~shadow & ~away).sum() <= 3  # by rounding
    facing = facing_sun(sim, sample, "geometric_normal")
    assert shadow[seen & (facing < -1e-6)].all()
    assert (shadow & (facing > 0.0)).sum() > 50
    np.testing.assert_array_equal(sim.frame(0, ["shadow"], threads=3)["shadow"], sample["shadow"])
    assert preview.draw(sample).shape[2] == 3
