"""Planetshine where it is hard: maps with two faces, tiny and huge bodies, many bodies."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))
import air_worlds
import test_planetshine as theory


def middle(asked, world) -> np.ndarray:
    """(3,): mean radiance about the middle of the image."""
    radiance = air_worlds.render(world, asked)["radiance"].astype(np.float64)
    y, x = asked["height"] // 2, asked["width"] // 2
    return radiance[y - 1 : y + 1, x - 1 : x + 1].mean(axis=(0, 1))


def test_the_side_that_shines_is_the_one_that_is_seen(tmp_path):
    """A map that is red where the Moon is overhead, and blue on the other side."""
    lon = (np.arange(256) + 0.5) / 256 * 360 - 180
    texels = np.zeros((128, 256, 3), np.uint8)
    texels[:, np.abs(lon) < 90, 0] = 255
    texels[:, np.abs(lon) > 90, 2] = 255
    path = tmp_path / "faces.png"
    Image.fromarray(texels).save(path)
    world = air_worlds.scene([None, None], str(path))
    asked = theory.new_moon(8.0, samples=256, tolerance_dn=0.0, size=(24, 18))
    # The Moon's own map shows its red side to both, or its blue one.
    asked["body_poses"][1, :, 3:] = [0.0, 0.0, 0.0, 1.0]
    red, green, blue = middle(asked, world)
    expected = theory.MOON_ALBEDO / math.pi * theory.earthlight(8.0)
    assert red == pytest.approx(expected, rel=0.03)
    assert green == blue == 0.0
    asked["body_poses"][1, :, 3:] = [1.0, 0.0, 0.0, 0.0]
    assert middle(asked, world).max() < 0.03 * expected


@pytest.mark.parametrize("radius_m", [1.0, 1e8])
def test_sizes(radius_m):
    """As the Earth and the Moon, from a metre to more than Jupiter."""
    world = air_worlds.scene([None, None])
    asked = theory.new_moon(45.0, samples=256, tolerance_dn=0.0)
    scale = radius_m / theory.EARTH_M
    asked["body_radii"] *= scale
    asked["body_poses"][:, :, :3] *= scale
    asked["camera_pose"][:, :3] *= scale
    expected = theory.MOON_ALBEDO / math.pi * theory.earthlight(45.0)
    assert middle(asked, world).mean() == pytest.approx(expected, rel=0.02)


def test_full_moon_gets_nothing_of_a_new_earth():
    """In the shadow of the Earth the Moon is black: the Earth has no lit side for it."""
    world = air_worlds.scene([None, None])
    asked = theory.new_moon(180.0, samples=16)
    assert middle(asked, world).max() == 0.0


def test_more_bodies_than_are_drawn_to():
    """Nine moons in the sky of one: the four brightest are drawn to, the rest met by chance."""
    centers, radii = [(0.0, 0.0, 0.0)], [1e6]
    for row in (-1, 0, 1):
        for column in (-1, 0, 1):
            centers.append((-20e6, 5e6 * row, 5e6 * column))
            radii.append(2e6)
    world = air_worlds.scene([None] * 10)
    sun = np.array([1.0, 0.132, 0.132])  # the shadow falls between them
    sun /= np.linalg.norm(sun)
    asked = air_worlds.request(
        [[r] * 3 for r in radii],
        (-4e6, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        sun,
        centers_m=centers,
        fov_deg=4.0,
        albedo=0.5,
        white=1.0,
        tolerance_dn=0.0,
        samples=128,
        size=(24, 18),
    )
    asked["quality"]["max_bounces"] = 1
    expected = 0.0
    for center in centers[1:]:
        to = np.array(center) - [-1e6, 0.0, 0.0]
        away = np.linalg.norm(to)
        phase = math.acos(float(-to @ sun / away))
        one = theory.light_of_sphere(0.5, 2e6, phase, away)
        expected += 0.5 / math.pi * one * (-to[0] / away)
    seen = air_worlds.render(world, asked)["radiance"]  # all within 6 degrees of the middle
    assert seen.mean(dtype=np.float64) == pytest.approx(expected, rel=0.03)
