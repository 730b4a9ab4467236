"""Rings where they are hard: edge-on, thin as lines, shadows both ways, things before, behind."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import quad

from perilune import _core

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))
import air_worlds
import test_rings as theory

F64 = NDArray[np.float64]

SATURN_M = 6e7
INNER, OUTER = 1.3, 2.2
SUN = (0.6, -0.7, 0.35)


def even(radius_m: float, depth: float, albedo: float = 0.6) -> _core.Rings:
    """In proportion to the body; particles scatter to all sides alike."""
    edges_m = radius_m * np.array([INNER, OUTER])
    return _core.Rings(edges_m, np.array([depth]), np.full((1, 3), albedo), 0.0, 0.0, 0.0)


def worlds(rings: _core.Rings | None, others: int = 0) -> _core.Scene:
    return air_worlds.scene([None] * (1 + others), rings=[rings])


def thin_ray(camera_m: F64, at_m: F64, **changes) -> dict:
    """The middle pixel of three looks exactly there."""
    asked = {
        "size": (3, 3), "fov_deg": 1e-4, "samples": 1, "tolerance_dn": 0.0, "force_on": ["rings"],
        "force_off": ["limb_darkening"],  # one sample would be of one place of the disc
    }  # fmt: skip
    forward = np.asarray(at_m) - np.asarray(camera_m)
    return air_worlds.request(
        changes.pop("radii_m", [[SATURN_M] * 3]), list(camera_m), list(forward),
        changes.pop("sun", SUN), **(asked | changes)
    )  # fmt: skip


def middle(scene: _core.Scene, asked: dict) -> float:
    return float(air_worlds.render(scene, asked)["radiance"][1, 1, 0])


def unit(v) -> F64:
    return np.asarray(v, dtype=np.float64) / np.linalg.norm(v)


@pytest.mark.parametrize("radius_m", [1.0, SATURN_M, 1e8])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_lit_and_unlit_side_are_those_of_the_integral(radius_m: float, side: float) -> None:
    at = radius_m * np.array([0.0, -1.7, 0.0])
    camera = at + radius_m * np.array([3.0, 0.3, 1.5 * side])
    found = middle(worlds(even(radius_m, 0.7)), thin_ray(camera, at, radii_m=[[radius_m] * 3]))
    to_sun = unit(air_worlds.AU_M * unit(SUN) - at)
    mu = abs(unit(at - camera)[2])
    part = theory.single_scattering(0.7, mu, side * to_sun[2])
    distance = np.linalg.norm(air_worlds.AU_M * unit(SUN) - at)
    sunlight = air_worlds.SOLAR * (air_worlds.AU_M / distance) ** 2
    assert found == pytest.approx(0.6 * part * sunlight, rel=2e-3)


def test_the_bodys_shadow_has_the_suns_penumbra() -> None:
    """Across the edge of the shadow the light is that of the disc above a straight limb: the body's
    own is 900 times the sun's."""
    sun = unit([0.9, 0.0, 0.3])
    radius = math.asin(air_worlds.SUN_M / air_worlds.AU_M)
    scene = worlds(even(SATURN_M, 0.7))
    away = -1.7 * SATURN_M  # along x
    # sine of the angle under which the body's radius is seen, for the ray to the sun's centre
    lit = None
    checked = 0
    for heights in np.linspace(-1.5, 1.5, 13):
        # y such that the line to the sun passes the centre at SATURN_M + offset
        along = abs(away) * sun[0]
        offset = heights * radius * along
        y = math.sqrt((SATURN_M + offset) ** 2 - (away * sun[2]) ** 2)
        at = np.array([away, y, 0.0])
        camera = at + SATURN_M * np.array([-1.0, 2.0, 3.0])
        found = middle(scene, thin_ray(camera, at, sun=list(sun)))
        free = middle(scene, thin_ray(camera, at, sun=list(sun), radii_m=[[1.0] * 3]))
        lit = found / free
        # The true angle from the sun's centre to the limb, over the sun's radius.
        to_sun = air_worlds.AU_M * sun - at
        distance = math.sqrt(at @ at)
        apart = math.acos(np.clip(-(at @ to_sun) / (distance * np.linalg.norm(to_sun)), -1, 1))
        x = (apart - math.asin(SATURN_M / distance)) / radius
        x = min(1.0, max(-1.0, x))
        expected = quad(lambda s: 2.0 / math.pi * math.sqrt(1.0 - s * s), -1.0, x)[0]
        assert lit == pytest.approx(expected, abs=3e-3)
        checked += 0.02 < expected < 0.98
    assert checked >= 6


def test_the_rings_shade_the_body() -> None:
    """On the ground, exp(-depth/sine) of the sun's light comes through; the footprint and the
    sun's disc lie within the even rings."""
    sun = unit([1.0, 0.0, 0.4])
    ring = np.array([1.6, 0.0, 0.0])
    b = ring @ sun
    ground = ring - sun * (b - math.sqrt(max(0.0, b * b - (ring @ ring - 1.0))))
    assert np.linalg.norm(ground) == pytest.approx(1.0)
    assert ground[2] < 0.0
    camera = SATURN_M * (ground + np.array([1.0, 0.0, -2.0]))
    asked = thin_ray(camera, SATURN_M * ground, sun=list(sun))
    for depth in (0.1, 1.0):
        shaded = middle(worlds(even(SATURN_M, depth)), asked)
        free = middle(worlds(None), asked)
        assert shaded / free == pytest.approx(math.exp(-depth / sun[2]), rel=2e-3)


@pytest.mark.parametrize("near", [True, False])
def test_things_before_and_behind_the_rings(near: bool) -> None:
    at = SATURN_M * np.array([1.7, 0.0, 0.0])
    camera = at + SATURN_M * np.array([0.0, -1.0, 2.0])
    forward = unit(at - camera)
    place = at + (-0.3 if near else 0.3) * SATURN_M * forward
    sun = unit([0.0, -0.6, 0.8]) if near else unit([0.0, -1.0, -0.2])
    asked = thin_ray(
        camera, at, sun=list(sun), radii_m=[[SATURN_M] * 3, [0.02 * SATURN_M] * 3],
        centers_m=[(0.0, 0.0, 0.0), tuple(place)],
    )  # fmt: skip
    seen = middle(worlds(even(SATURN_M, 0.8), 1), asked)
    alone = middle(worlds(None, 1), asked)
    assert alone > 1.0
    if near:
        assert seen == pytest.approx(alone, rel=1e-3)
        return
    mu = abs(forward[2])
    empty = thin_ray(camera, at, sun=list(sun))
    rings = middle(worlds(even(SATURN_M, 0.8)), empty)
    assert seen == pytest.approx(alone * math.exp(-0.8 / mu) + rings, rel=2e-3)


def test_the_sun_behind_the_rings_is_dimmed() -> None:
    sun = unit([0.0, 1.0, 0.2])
    camera = SATURN_M * np.array([1.7, 0.0, 0.0]) - 0.3 * SATURN_M * sun
    asked = thin_ray(camera, camera + sun, sun=list(sun), fov_deg=1e-6)
    clear = middle(worlds(None), asked)
    seen = middle(worlds(even(SATURN_M, 0.5, 0.0)), asked)
    assert clear > 1e6
    assert seen / clear == pytest.approx(math.exp(-0.5 / sun[2]), rel=0.02)


def edge_on(height_m: float, **changes) -> F64:
    asked = air_worlds.request(
        [[SATURN_M] * 3], [0.0, -12.0 * SATURN_M, height_m], [0.0, 1.0, 0.0], [0.4, -1.0, 0.3],
        size=(96, 24), fov_deg=26.0, white=60.0, **changes,
    )  # fmt: skip
    return air_worlds.render(worlds(even(SATURN_M, 1.0)), asked)["radiance"]


@pytest.mark.parametrize("height_m", [0.0, 1e-9, -1e-3, 1.0, 1e4, -1e5, 1e6])
def test_edge_on(height_m: float) -> None:
    """Nothing is not a number; the rings vanish as they come to be seen from their plane."""
    light = edge_on(height_m)
    assert np.isfinite(light).all()
    assert (light >= 0.0).all()
    beside = light[:, :20].max()
    bare = edge_on(height_m, force_off=["rings"])[:, :20].max()
    assert bare == 0.0
    if abs(height_m) <= 1.0:
        assert beside < 1e-3
    if height_m >= 1e6:
        assert beside > 1.0


def test_a_line_of_rings_has_no_gaps() -> None:
    """A tenth of a pixel thick: every pixel of it has the light that many samples give."""
    columns = edge_on(3e5, samples=256, tolerance_dn=0.0)[:, 10:28, 1].sum(axis=0)
    assert (columns > 0.1).all()
    for samples in (16, 64, 256):
        several = edge_on(3e5, samples=samples)[:, 9:28, 1].sum(axis=0)
        even = edge_on(3e5, samples=samples, tolerance_dn=0.0)[:, 9:28, 1].sum(axis=0)
        np.testing.assert_allclose(several, even, rtol=0.05)
    np.testing.assert_allclose(several[1:], columns, rtol=0.1)
    few = edge_on(3e5)[:, 11:28, 1].sum(axis=0)  # in the outermost one sample in 16 is too much
    np.testing.assert_allclose(few, columns[1:], rtol=0.1)


def test_the_camera_among_the_rings() -> None:
    """From within the plane, and from just beside it, in all directions."""
    for height_m in (0.0, 1e-6, -10.0):
        for forward in ([1, 0, 0], [0, 1, 0], [0.2, 0.1, 1.0], [0, 0, -1]):
            asked = air_worlds.request(
                [[SATURN_M] * 3], [1.7 * SATURN_M, 0.0, height_m], forward, SUN,
                up=(0.3, 0.5, 0.4), size=(24, 18), fov_deg=90.0,
            )  # fmt: skip
            light = air_worlds.render(worlds(even(SATURN_M, 0.5)), asked)["radiance"]
            assert np.isfinite(light).all()
            assert (light >= 0.0).all()


def test_a_whole_system_in_a_pixel() -> None:
    """A planet of half a pixel and its rings: their light is that of a large image of them."""
    wide = {"tolerance_dn": 0.0, "samples": 4096}
    sums = []
    for distance, fov_deg, size in ((2000.0, 1.2, (16, 16)), (2000.0, 0.16, (128, 128))):
        asked = air_worlds.request(
            [[SATURN_M] * 3], [0.0, -distance * SATURN_M, 0.4 * distance * SATURN_M],
            [0.0, 1.0, -0.4], [0.4, -1.0, 0.5], size=size, fov_deg=fov_deg, white=60.0,
            **(wide if size[0] == 16 else {}),
        )  # fmt: skip
        light = air_worlds.render(worlds(even(SATURN_M, 1.0)), asked)["radiance"]
        sums.append(light.sum() * math.tan(math.radians(0.5 * fov_deg)) ** 2 / size[0] ** 2)
    assert sums[0] == pytest.approx(sums[1], rel=0.01)


@pytest.mark.parametrize("seed", range(8))
def test_every_tile_that_the_rings_are_in_shows_them(seed: int) -> None:
    """About a body too small to matter: pixels whose centre's ray meets lit rings are lit; where
    their light changes slowly they are as bright as that ray."""
    generator = np.random.default_rng(seed)
    rings = even(SATURN_M, 1.0)
    camera = SATURN_M * generator.normal(size=3) * generator.choice([0.5, 2.0, 20.0])
    camera[2] += 0.02 * SATURN_M
    turn = generator.uniform(0.0, 2.0 * math.pi)
    aim = SATURN_M * 1.8 * np.array([math.cos(turn), math.sin(turn), 0.0])
    sun = unit([0.5, 0.3, math.copysign(0.6, camera[2])])
    asked = air_worlds.request(
        [[1.0] * 3], list(camera), list(aim - camera), list(sun), size=(160, 128),
        fov_deg=float(generator.choice([3.0, 25.0, 80.0])), samples=4, white=100.0,
    )  # fmt: skip
    seen = air_worlds.render(worlds(rings), asked)["radiance"][..., 0]
    rays = air_worlds.directions(asked).reshape(-1, 3)
    points = np.tile(camera, (len(rays), 1))
    light, _ = rings.scatter(points, rays, tuple(sun), 1e-6, 0.0, 1e-9)
    expected = air_worlds.SOLAR * light[:, 0].reshape(seen.shape)
    assert (expected > 1.0).any()
    assert (seen[expected > 1.0] > 0.0).all()
    inside = np.zeros(seen.shape, dtype=bool)  # and so are the eight about it
    inside[1:-1, 1:-1] = True
    for y in (-1, 0, 1):
        for x in (-1, 0, 1):
            around = np.roll(expected, (y, x), (0, 1))
            inside &= np.abs(around - expected) < 0.01 * expected
    np.testing.assert_allclose(seen[inside], expected[inside], rtol=0.02)


def test_the_same_bits_for_any_threads() -> None:
    asked = air_worlds.request(
        [[SATURN_M] * 3], [0.0, -5.0 * SATURN_M, 1.5 * SATURN_M], [0.0, 1.0, -0.3], SUN,
        size=(80, 60), fov_deg=60.0,
    )  # fmt: skip
    scene = worlds(even(SATURN_M, 0.7))
    pictures = [air_worlds.render(scene, asked, threads)["radiance"] for threads in (1, 2, 3)]
    assert np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[0], pictures[2])
