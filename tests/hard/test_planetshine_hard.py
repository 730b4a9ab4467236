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

from perilune import _core
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere


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


def lit(radii_m, away_m, phase_deg, *, white, air=None, samples=64, seed=1):
    """(H, W): the night of a ball of 100 km, a body of these radii in its zenith."""
    angle = math.radians(phase_deg)
    place = (away_m, 0.0, 0.0)
    asked = air_worlds.request(
        [radii_m, [1e5] * 3],
        (away_m - 2.5e5 if away_m - 2.5e5 > max(radii_m) else away_m - 1.2e5, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (math.cos(angle), math.sin(angle), 0.0),
        centers_m=[(0.0, 0.0, 0.0), place],
        size=(24, 18),
        fov_deg=20.0,
        white=white,
        tolerance_dn=0.0,
        samples=samples,
    )
    asked["quality"]["max_bounces"] = 1
    asked["seed"] = seed
    world = air_worlds.scene([air, None])
    return air_worlds.render(world, asked)["radiance"].astype(np.float64).mean(axis=2)


BY_CHANCE = 1e12
"""An exposure for which no body is bright enough to be drawn to."""


def earth_air():
    return _core.Air(atmospheres.settings(Atmosphere(preset="earth"), (0.612, 0.549, 0.465)), 6.4e6)


@pytest.mark.parametrize(
    ("radii_m", "away_m", "phase_deg", "air"),
    [
        ([6.4e6] * 3, 6.4e6 + 3e5, 40.0, False),  # fills nearly half the sky
        ([6.4e6, 6.0e6, 4.5e6], 1.3e7, 60.0, False),  # oblate, and not round
        ([6.4e6] * 3, 1.1e7, 130.0, True),  # a crescent, and twilight beyond it
        ([6.4e6] * 3, 4.2e7, 174.0, True),  # a ring of air alone
    ],
)
def test_draws_agree_with_chance(radii_m, away_m, phase_deg, air):
    """Welch's test of means over pixels and seeds: drawing to bodies moves nothing."""
    one, other = (
        np.array([lit(radii_m, away_m, phase_deg, white=white, samples=samples, seed=seed,
                      air=earth_air() if air else None) for seed in range(1, 6)])
        for white, samples in ((1e-6, 16), (BY_CHANCE, 64))
    )  # fmt: skip
    means, others = one.mean(axis=(1, 2)), other.mean(axis=(1, 2))
    assert means.min() > 0.0
    spread = math.sqrt((means.var(ddof=1) + others.var(ddof=1)) / 5)
    assert abs(means.mean() - others.mean()) < 5.0 * spread + 1e-3 * means.mean()


def test_twilight_is_drawn_to():
    """A ring of air, of which 16 samples by chance find next to nothing."""
    drawn, chance = (
        np.array([lit([6.4e6] * 3, 4.2e7, 174.0, white=white, samples=16, seed=seed,
                      air=earth_air()) for seed in (1, 2)])
        for white in (1e-6, BY_CHANCE)
    )  # fmt: skip
    seen = drawn[0] > 0.0
    noise = np.abs(drawn[0] - drawn[1])[seen].mean() / drawn[0][seen].mean()
    assert noise < 0.6
    assert (chance[0] > 0.0).mean() < 0.5 * seen.mean()


def test_a_body_that_is_a_point_lights():
    """A radius of a ten-thousandth of the distance: as the phase law says, far below white."""
    radius, away, phase = 4.2e3, 4.2e7, 50.0
    seen = lit([radius] * 3, away, phase, white=1e-9)
    phase_rad = math.radians(phase)
    expected = 0.3 / math.pi * theory.light_of_sphere(0.3, radius, phase_rad, away - 1e5)
    middle_px = seen[8:10, 11:13].mean()
    assert middle_px == pytest.approx(expected, rel=0.05)
