"""Stars beside and behind the sun; unresolved bodies from a metre to a hundred thousand km."""

from __future__ import annotations

import math

import numpy as np
import pytest

import perilune
from perilune.base import rotations


def scene(radius_m: float = 1.0, **camera):
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "ball",
        "bodies": {
            "ball": {"kind": "ellipsoid", "radii_km": radius_m / 1e3, "gm_km3_s2": 1.0,
                     "albedo": 0.5, "ephemeris": "earth"},
        },
        "sun": {"direction": [0.0, 0.6, -0.8]},
        "camera": {
            "width": 33, "height": 33, "focal_px": 200.0,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 200.0},
            "trajectory": {"kind": "fixed", "target": "ball", "position_m": [0, 0, -1e9]},
            **camera,
        },
        "render": {"samples": 4, "channels": ["radiance"]},
    }  # fmt: skip


@pytest.mark.parametrize("radius_m", [1.0, 300.0, 1e8])
def test_unresolved_bodies_of_all_sizes(radius_m):
    """Lambert's phase law (Russell 1916) at 0.7 pixels across."""
    distance_m = 2.0 * radius_m * 200.0 / 0.7
    pose = np.array([0, 0, -distance_m, 1.0, 0, 0, 0])
    sample = perilune.open(scene(radius_m), trajectory=lambda _: pose)[0]
    phase = math.acos(0.8)
    law = (math.sin(phase) + (math.pi - phase) * math.cos(phase)) / math.pi
    want = 2.0 / 3.0 * 0.5 * 1361.0 * (radius_m / distance_m) ** 2 * law
    energy = sample["radiance"][..., 1].astype(float).sum() / 200.0**2
    assert energy == pytest.approx(want, rel=0.01)


def test_the_sun_in_the_frame_hides_stars_and_adds_no_glare(tmp_path):
    """A star behind the disc is not seen, one beside it is as without the sun; glare is the
    sensor's."""
    path = tmp_path / "stars.csv"
    ra, dec = 90.0, math.degrees(math.asin(-0.8))  # of the sun, as the scene has it
    path.write_text(f"number,ra_deg,dec_deg,vmag\n1,{ra},{dec + 0.1},-20\n2,{ra},{dec + 1.5},-20\n")
    tree = scene()
    tree["sky"] = {"stars": {"catalogue": str(path), "aberration": False}}
    tree["render"]["tolerance_dn"] = 0
    q = rotations.look_at(np.array([0.0, 0.6, -0.8]), np.array([1.0, 0.0, 0.0]))
    pose = np.concatenate([[0, 0, -1e9], q])
    lit = perilune.open(tree, trajectory=lambda _: pose)[0]
    tree["sun"]["irradiance_w_m2"] = 0.0
    dark = perilune.open(tree, trajectory=lambda _: pose)[0]
    assert lit.stars["number"].tolist() == dark.stars["number"].tolist() == [2]
    far = np.hypot(*(np.mgrid[0:33, 0:33] - 16)) > 3
    np.testing.assert_array_equal(lit["radiance"][far], dark["radiance"][far])
    assert dark["radiance"][far].max() > 0
    assert lit["radiance"][16, 16].min() > 1e6
