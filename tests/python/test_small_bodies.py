"""Bodies of a few pixels and less keep their light, and the sun's disc its own."""

from __future__ import annotations

import math

import numpy as np
import pytest

import perilune
from perilune.base import rotations

RADIUS_M, ALBEDO, SUN = 1.7374e6, 0.3, np.array([0.5, 0.3, -1.0]) / math.sqrt(1.34)
SIZE, FOCAL = 32, 1000.0


def scene(**bodies):
    return {
        "version": 1,
        "seed": 3,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 0},
        "root": "moon",
        "bodies": {
            "moon": {"kind": "moon", "albedo": ALBEDO, "radii_km": RADIUS_M / 1e3},
            **bodies,
        },
        "sun": {"direction": SUN.tolist()},
        "camera": {
            "width": SIZE,
            "height": SIZE,
            "focal_px": FOCAL,
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 130.0},
            "trajectory": {"kind": "fixed", "target": "moon", "position_m": [0, 0, -1e8]},
        },
        "render": {"samples": 4, "channels": ["radiance", "instance"]},
    }


def solid_angles(K, size):
    v, u = np.mgrid[0:size, 0:size]
    x, y = (u - K[0, 2]) / K[0, 0], (v - K[1, 2]) / K[1, 1]
    return (1.0 + x * x + y * y) ** -1.5 / (K[0, 0] * K[1, 1])


def frame(tree, u, v, distance_m, **options):
    """The moon's centre at (u, v) pixels from the middle, seen along +z."""
    pose = np.array([-u * distance_m / FOCAL, -v * distance_m / FOCAL, -distance_m, 1.0, 0, 0, 0])
    return perilune.open(tree, trajectory=lambda _: pose).frame(0, **options)


def lambert_flux(u, v, distance_m):
    """Of a sphere in sunlight, far away (Russell 1916): 2/3 A E (R/d)^2 times the phase law."""
    back = np.array([-u / FOCAL, -v / FOCAL, -1.0])
    distance_m = distance_m * np.linalg.norm(back)
    phase = math.acos(SUN @ back / np.linalg.norm(back))
    law = (math.sin(phase) + (math.pi - phase) * math.cos(phase)) / math.pi
    return 2.0 / 3.0 * ALBEDO * 1361.0 * (RADIUS_M / distance_m) ** 2 * law


@pytest.mark.parametrize("pixels", [0.02, 0.3, 0.9, 1.0, 2.0, 2.6, 4.5])
def test_small_moons_keep_their_light(pixels):
    """On pixels, between them, on corners: within 1 %, and centred to 0.05 of their size."""
    distance_m = 2.0 * RADIUS_M * FOCAL / pixels
    rng = np.random.default_rng(int(10 * pixels))
    places = [(0.5, 0.5), (0.0, 0.0), (-8.5, 8.5), *rng.uniform(-9, 9, (4, 2))]
    for u, v in places:
        sample = frame(scene(), u, v, distance_m)
        energy = sample["radiance"][..., 1].astype(float) * solid_angles(sample.camera.K, SIZE)
        assert energy.sum() == pytest.approx(lambert_flux(u, v, distance_m), rel=0.01)
        rows, columns = np.nonzero(energy > 0)
        reach = 0.5 * pixels + 0.5 + 1e-3
        assert np.abs(columns - (SIZE - 1) / 2 - u).max() <= reach
        assert np.abs(rows - (SIZE - 1) / 2 - v).max() <= reach


def test_labels_of_small_moons_stay():
    sample = frame(scene(), 0.5, 0.5, 2.0 * RADIUS_M * FOCAL / 3.0)
    assert 5 <= (sample["instance"] == 1).sum() <= 9


def test_hidden_moons_are_dark_and_threads_are_alike():
    tree = scene(
        near={"kind": "ellipsoid", "radii_km": 1500.0, "gm_km3_s2": 1.0, "albedo": 0.0,
              "orbit": {"around": "moon", "semi_major_axis_km": 5e5, "inclination_deg": 90.0,
                        "frame": "icrf", "mean_anomaly_deg": 270.0}},
    )  # fmt: skip
    distance_m = 1e9  # 3.5 pixels across
    assert frame(scene(), 0.2, 0.1, distance_m)["radiance"].max() > 0
    hidden = frame(tree, 0.0, 0.0, distance_m)
    assert not hidden["radiance"].any()
    one = frame(scene(), 3.3, 0.1, distance_m, threads=1)
    three = frame(scene(), 3.3, 0.1, distance_m, threads=3)
    np.testing.assert_array_equal(one["radiance"], three["radiance"])


def test_the_suns_disc():
    """Size, place, mean radiance and limb of the disc, and the irradiance of all of it."""
    tree = scene()
    tree["sun"] = {"direction": [0.0, 0.0, 1.0]}
    tree["camera"].update(width=256, height=256, focal_px=20000.0)
    tree["camera"]["exposure"]["white_radiance_w_m2_sr"] = 2e7
    tree["render"].update(samples=16, tolerance_dn=0.1)
    q = rotations.look_at(np.array([0, 0, 1.0]), np.array([1.0, 0, 0]))
    pose = np.concatenate([[0, 0, 3e6], q])
    sample = perilune.open(tree, trajectory=lambda _: pose).frame(0, channels=["radiance"])
    radiance = sample["radiance"].astype(float)
    energy = radiance * solid_angles(sample.camera.K, 256)[..., None]
    # 1361 W m-2 at 1 au from the root, 3e6 m nearer here
    assert energy.sum(axis=(0, 1)) == pytest.approx([1361.0] * 3, rel=2e-3)
    v, u = np.mgrid[0:256, 0:256]
    green = energy[..., 1]
    assert (green * u).sum() / green.sum() == pytest.approx(127.5, abs=0.02)
    assert (green * v).sum() / green.sum() == pytest.approx(127.5, abs=0.02)
    radius_px = 20000.0 * math.tan(math.asin(695700e3 / 149597870700.0))
    lit = (radiance[..., 1] > 0).sum()
    # All pixels that the disc touches are lit: some 4 R more than its area.
    assert math.sqrt(lit / math.pi) == pytest.approx(radius_px + 2.0 / math.pi, abs=0.15)
    # Neckel 2005: at the limb a third to a half of the centre, and redder
    from_centre = np.hypot(u - 127.5, v - 127.5) / radius_px
    edge = radiance[(from_centre > 0.96) & (from_centre < 0.98)].mean(axis=0)
    centre = radiance[from_centre < 0.05].mean(axis=0)
    assert 0.3 < edge[2] / centre[2] < edge[1] / centre[1] < edge[0] / centre[0] < 0.7
