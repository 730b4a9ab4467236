"""Sunlight that a mirror throws onto the ground: all of it arrives; what the plan says of it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.output.retrace import write_sheets

import perilune
from perilune.document.loader import read_tree

WHITE, SUN_BELOW_DEG = 200.0, 5.0


def opened(model: Path, height_km: float, **render: Any) -> perilune.Simulation:
    """A mirror of 20 m over the night of a small moon, which it lights; seen from high above."""
    scene = read_tree(Path(__file__).with_name("scene.yaml"))
    below = math.radians(SUN_BELOW_DEG)
    scene["sun"] = {"direction": [math.cos(below), 0.0, -math.sin(below)]}
    scene["root"] = "moon"
    ball = {"kind": "ellipsoid", "radii_km": [100.0] * 3, "gm_km3_s2": 1.0, "albedo": 0.5}
    scene["bodies"] = {"moon": ball}
    scene["spacecraft"]["sat"] = {
        "model": str(model),
        "metres_per_unit": 10.0,
        "centre": "origin",
        "orbit": {"around": "moon", "position_km": [0.0, 0.0, 100.0 + height_km]},
        "attitude": {"rotation_deg": [0.0, 45.0 + 0.5 * SUN_BELOW_DEG, 0.0]},
    }
    aside = {"kind": "fixed", "target": "sat", "position_m": [0.0, 1000.0, 2e4], "frame": "icrf"}
    scene["camera"] = {"width": 32, "height": 32, "fov_deg": 2.0, "trajectory": aside}
    scene["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": WHITE}
    scene["render"] = {"samples": 256, "max_bounces": 1, "tolerance_dn": 0.0, **render}
    return perilune.open(scene, base=Path(__file__).parent)


@pytest.fixture(scope="module")
def mirrors(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mirrors")

    def make(roughness: float) -> Path:
        metal = {"metallicFactor": 1.0, "roughnessFactor": roughness}
        sheet = {"place": [0, 0, 0], "material": {"pbrMetallicRoughness": metal}}
        return write_sheets(folder / f"mirror_{roughness}.gltf", sheet=sheet)

    return make


def on_ground(sim: perilune.Simulation) -> np.ndarray:
    sample = sim.frame(0, channels=["radiance", "instance"], threads=1)
    ground = sample["instance"] == sample["instance"][0, 0]
    assert ground.mean() > 0.9
    return sample["radiance"].astype(float) * ground[..., None]


@pytest.mark.parametrize(("height_km", "roughness"), [(0.5, 0.05), (1.0, 0.1)])
def test_a_mirror_lights_the_ground_at_a_tolerance_of_0(mirrors, height_km, roughness):
    """All of its light arrives: by the area of the mirror that the Sun sees."""
    sim = opened(mirrors(roughness), height_km, samples=1024)
    radiance = on_ground(sim)
    distance_m = 2e4 + 1e3 * height_km
    pixel_m2 = (2.0 * distance_m * math.tan(math.radians(1.0)) / 32) ** 2
    cosine = math.cos(math.radians(45.0 - 0.5 * SUN_BELOW_DEG))
    expected = 0.5 / math.pi * 1361.0 * 400.0 * cosine
    found = radiance.mean(axis=2).sum() * pixel_m2
    assert found == pytest.approx(expected, rel=0.04)


def test_the_bound_holds_for_mirrors(mirrors):
    """Over 4 x 4 pixels, against noise."""
    sim = opened(mirrors(0.1), 2.0)
    blocks = on_ground(sim).mean(axis=2).reshape(8, 4, 8, 4).mean(axis=(1, 3))
    linear = blocks.max() / WHITE
    changed = 255.0 * (1.055 * linear ** (1 / 2.4) - 0.055)
    without = opened(mirrors(0.1), 2.0, force_off=["body_bounces"])
    (row,) = (row for row in without.plan(0) if row["name"] == "body_bounces")
    assert changed > 3.0  # or there is nothing to bound
    assert row["bound_dn"] >= changed


def test_a_mirror_lights_the_ground_at_a_tolerance(mirrors):
    """The ground is sampled where the mirror's light may matter."""
    exact = on_ground(opened(mirrors(0.1), 2.0, samples=4096))
    lit = opened(mirrors(0.1), 2.0, samples=4096, tolerance_dn=1.0)
    (row,) = (row for row in lit.plan(0) if row["name"] == "body_bounces")
    assert row["on"]
    assert on_ground(lit).sum() == pytest.approx(exact.sum(), rel=0.1)
    unlit = opened(mirrors(0.1), 2.0, tolerance_dn=1.0, force_off=["body_bounces"])
    assert on_ground(unlit).sum() < 0.01 * exact.sum()
