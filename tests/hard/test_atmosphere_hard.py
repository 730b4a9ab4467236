"""Air where it is hard: tiny and huge bodies, edges of the air, the horizon, several worlds."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from perilune import _core
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))
import air_worlds
import test_atmosphere as theory

UM = (0.68, 0.55, 0.44)
EARTH_M = 6371e3


HEIGHTS = ("rayleigh_height_m", "mie_height_m", "ozone_center_m", "ozone_width_m", "top_m")


def air_of(radius_m: float, scale: float = 1.0, **changes) -> _core.Air:
    """The Earth's air, its heights times `scale` and its densities over it; scattered once."""
    settings = dict(theory.earth())
    for key in HEIGHTS:
        settings[key] *= scale
    settings["rayleigh_upper_m"] = tuple(scale * value for value in settings["rayleigh_upper_m"])
    for key in ("rayleigh_scattering", "mie_scattering", "mie_extinction", "ozone_absorption"):
        settings[key] = tuple(value / scale for value in settings[key])
    return _core.Air(settings | changes, radius_m)


def limb(radius_m: float, height_m: float, low_m: float) -> list[float]:
    """From (radius + height, 0, 0) past the lowest point at low_m."""
    sine = (radius_m + low_m) / (radius_m + height_m)
    return [-math.sqrt(1.0 - sine * sine), sine, 0.0]


def exact(asked, pixel, settings, radius_m):
    point = asked["camera_pose"][0, :3]
    sun = asked["sun_position"] / np.linalg.norm(asked["sun_position"])
    direction = air_worlds.directions(asked)[pixel]
    light, passed = theory.march(settings, radius_m, point, direction, sun, 3000)
    return light * air_worlds.SOLAR, passed


@pytest.mark.parametrize("radius_m", [1.0, 1e3, EARTH_M, 1e8])
def test_scaled_worlds_look_the_same(radius_m: float) -> None:
    """Everything in proportion, but for the sun, which is at 1 AU: the same picture."""
    pictures = []
    for r in (radius_m, EARTH_M):
        k = r / EARTH_M
        scene = air_worlds.scene([air_of(r, k)])
        asked = air_worlds.request(
            [[r] * 3], [1.06 * r, 0, 0], limb(1.0, 0.06, 0.002), [0.3, 0.7, 0.6],
            up=(1, 0, 0), fov_deg=20.0, force_on=["atmosphere"], tolerance_dn=0.0,
        )  # fmt: skip
        pictures.append(air_worlds.render(scene, asked)["radiance"])
    # At 1e8 m the sun's direction differs over the body by 7e-4, and so does its distance.
    tolerance = 1e-2 if radius_m == 1e8 else 2e-3
    # Pixels cut by the horizon may be on either side of it by rounding.
    differs = np.abs(pictures[0] - pictures[1]) > tolerance * pictures[1] + 0.01
    assert differs.mean() < 0.005


@pytest.mark.parametrize("low_m", [-2e3, 0.0, 1e-3, 5e3, 20e3, 60e3, 99.9e3, 100e3, 150e3])
def test_rendered_limb_is_that_of_brute_force(low_m: float) -> None:
    settings = theory.earth()
    scene = air_worlds.scene([_core.Air(settings, EARTH_M)])
    # The middle pixel of an odd image looks straight there.
    asked = air_worlds.request(
        [[EARTH_M] * 3], [EARTH_M + 4e5, 0, 0], limb(EARTH_M, 4e5, low_m), [0.5, 0.3, 0.8],
        up=(1, 0, 0), size=(3, 3), fov_deg=0.001, albedo=0.0, tolerance_dn=0.0, samples=1,
        force_on=["atmosphere"], force_off=["multiple_scattering"],
    )  # fmt: skip
    found = air_worlds.render(scene, asked)["radiance"][1, 1]
    light, _ = exact(asked, (1, 1), settings, EARTH_M)
    np.testing.assert_allclose(found, light, rtol=1e-2, atol=1e-3)


@pytest.mark.parametrize("height_m", [0.01, 1.0, 50.0, 99999.99, 100000.0, 100000.01, 1e9])
@pytest.mark.parametrize("forward", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.01, 1.0, 0.0)])
def test_from_all_heights(height_m: float, forward: tuple[float, float, float]) -> None:
    """Inside the air, on its edge and beyond; up, exactly level and hardly down."""
    settings = theory.earth()
    scene = air_worlds.scene([_core.Air(settings, EARTH_M)])
    asked = air_worlds.request(
        [[EARTH_M] * 3], [EARTH_M + height_m, 0, 0], forward, [0.5, 0.3, 0.8],
        up=(0.1, 0.2, 1), size=(3, 3), fov_deg=0.001, albedo=0.0, tolerance_dn=0.0, samples=1,
        force_on=["atmosphere"], force_off=["multiple_scattering"],
    )  # fmt: skip
    found = air_worlds.render(scene, asked)["radiance"][1, 1]
    light, _ = exact(asked, (1, 1), settings, EARTH_M)
    np.testing.assert_allclose(found, light, rtol=1e-2, atol=1e-3)


def test_ground_is_lit_through_the_air() -> None:
    settings = theory.earth()
    scene = air_worlds.scene([_core.Air(settings, EARTH_M)])
    for sine in (1.0, 0.5, 0.1, 0.03):
        sun = [sine, math.sqrt(1.0 - sine * sine), 0.0]
        asked = air_worlds.request(
            [[EARTH_M] * 3], [EARTH_M + 1.0, 0, 0], [-1, 0, 0], sun, size=(3, 3), fov_deg=1.0,
            albedo=0.5, tolerance_dn=0.0, samples=4, force_on=["atmosphere"],
            force_off=["multiple_scattering", "skylight", "soft_sun"],
        )  # fmt: skip
        found = air_worlds.render(scene, asked)["radiance"][1, 1]
        passed = np.exp(-theory.depth(settings, EARTH_M, 0.0, sine))
        expected = 0.5 / math.pi * sine * passed * air_worlds.SOLAR
        np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-3)


def test_sun_through_the_limb_is_dimmed_and_red() -> None:
    """A sunset from orbit: the disc in the middle of the frame."""
    settings = theory.earth()
    scene = air_worlds.scene([_core.Air(settings, EARTH_M)])
    forward = limb(EARTH_M, 4e5, 12e3)
    asked = air_worlds.request(
        [[EARTH_M] * 3], [EARTH_M + 4e5, 0, 0], forward, forward, up=(1, 0, 0), size=(3, 3),
        fov_deg=0.001, tolerance_dn=0.0, samples=1, force_off=["limb_darkening"],
    )  # fmt: skip
    disc = air_worlds.SOLAR / (math.pi * (air_worlds.SUN_M / air_worlds.AU_M) ** 2)
    found = air_worlds.render(scene, asked)["radiance"][1, 1]
    passed = np.exp(-2.0 * theory.depth(settings, EARTH_M, 12e3, 0.0))
    # Scattered light near the sun adds parts in a thousand.
    np.testing.assert_allclose(found, disc * passed, rtol=1e-2)
    assert found[0] > 2.0 * found[1] > 4.0 * found[2]


def test_night_is_dark() -> None:
    scene = air_worlds.scene([air_of(EARTH_M, multiple=True)])
    asked = air_worlds.request(
        [[EARTH_M] * 3], [EARTH_M + 4e5, 0, 0], [-1, 0.4, 0], [-1, 0.01, 0], force_on=["atmosphere"]
    )
    assert air_worlds.render(scene, asked)["radiance"].max() < 1e-4


@pytest.mark.parametrize("height_m", [1.0, 1e6])
def test_scale_heights_of_a_metre_and_of_a_thousand_kilometres(height_m: float) -> None:
    settings = theory.earth(
        rayleigh_height_m=height_m, mie_height_m=height_m, rayleigh_upper_m=(0.0, 0.0),
        ozone_absorption=(0.0, 0.0, 0.0),
        rayleigh_scattering=tuple(x / height_m for x in (0.05, 0.1, 0.25)),
        mie_scattering=(0.0, 0.0, 0.0), mie_extinction=(0.02 / height_m,) * 3,
        top_m=10.0 * height_m,
    )  # fmt: skip
    air = _core.Air(settings, EARTH_M)
    points, directions = theory.rays(0.0, [1.0, 0.3, 0.0])
    found = air.transmittance(points, directions)
    expected = [np.exp(-theory_depth(settings, height_m, mu)) for mu in (1.0, 0.3, 0.0)]
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-30)


def theory_depth(settings, height_m: float, mu: float):
    """By even steps in the height's exponential."""
    n = 200000
    v = (np.arange(n) + 0.5) / n
    length = theory.way_m(EARTH_M, settings["top_m"], EARTH_M, mu)
    s = length * v**3
    ds = 3.0 * length * v**2 / n
    rise = s * (2.0 * EARTH_M * mu + s)
    h = rise / (np.sqrt(EARTH_M**2 + rise) + EARTH_M)
    return (np.exp(-h / height_m) * ds).sum() * theory.extinctions(settings)[:2].sum(axis=0)


def test_airless_body_beside_one_with_air_and_behind_it() -> None:
    """The moon is as without air, but for where the limb's air lies before it."""
    moon_m, earth = 1737e3, _core.Air(theory.earth(), EARTH_M)
    centers = [[0.0, 0.0, 0.0], [-3e8, 3.3e8 * math.tan(0.217), 0.0]]
    kwargs = {
        "centers_m": centers, "up": (0, 0, 1), "fov_deg": 1.0, "size": (64, 48),
        "samples": 4, "tolerance_dn": 0.0,
    }  # fmt: skip
    camera = [3e7, 0.0, 0.0]
    aim = [-math.cos(0.217), math.sin(0.217), 0.0]
    radii = [[EARTH_M] * 3, [moon_m] * 3]
    asked = air_worlds.request(radii, camera, aim, [1.0, 0.3, 0.2], **kwargs)
    with_air = air_worlds.render(air_worlds.scene([earth, None]), asked)
    without = air_worlds.render(air_worlds.scene([None, None]), asked)
    for key in ("range", "instance"):
        np.testing.assert_array_equal(with_air[key], without[key])
    moon = without["instance"] == 2
    point = np.array(camera)
    rays = air_worlds.directions(asked)
    lowest = np.linalg.norm(np.cross(point, rays), axis=-1)
    clear = moon & (lowest > EARTH_M + 110e3)
    assert clear.sum() > 20
    np.testing.assert_array_equal(with_air["radiance"][clear], without["radiance"][clear])


def test_world_behind_the_air_of_another() -> None:
    """Both have air: seen through the nearer's the farther is dimmed, and its own is behind."""
    settings = theory.earth()
    near, far = _core.Air(settings, EARTH_M), _core.Air(settings, EARTH_M)
    forward = limb(EARTH_M, 4e5, 10e3)
    camera = np.array([EARTH_M + 4e5, 0.0, 0.0])
    center = camera + 1e9 * np.array(forward)
    kwargs = {
        "centers_m": [[0.0, 0.0, 0.0], center.tolist()], "up": (1, 0, 0), "size": (3, 3),
        "fov_deg": 0.001, "tolerance_dn": 0.0, "samples": 1, "albedo": 0.5,
        "force_on": ["atmosphere"], "force_off": ["multiple_scattering"],
    }  # fmt: skip
    sun = [0.6, -0.7, 0.2]
    radii = [[EARTH_M] * 3] * 2
    asked = air_worlds.request(radii, camera, forward, sun, **kwargs)
    both = air_worlds.render(air_worlds.scene([near, far]), asked)["radiance"][1, 1]
    only_far = air_worlds.render(air_worlds.scene([None, far]), asked)["radiance"][1, 1]
    light, passed = exact(asked, (1, 1), settings, EARTH_M)
    np.testing.assert_allclose(both, light + passed * only_far, rtol=1e-2)


def test_same_bits_on_any_threads_and_no_memory_in_the_steady_state() -> None:
    scene = air_worlds.scene([air_of(EARTH_M, multiple=True)])
    asked = air_worlds.request(
        [[EARTH_M, EARTH_M, 0.99 * EARTH_M]], [EARTH_M + 4e5, 0, 0], limb(EARTH_M, 4e5, 2e4),
        [0.2, 0.3, 1.0], up=(1, 0, 0), size=(96, 80),
    )  # fmt: skip
    one = air_worlds.render(scene, asked, 1)
    three = air_worlds.render(scene, asked, 3)
    for key, value in one.items():
        np.testing.assert_array_equal(value, three[key])
    renderer = _core.Renderer(scene)
    out = {"radiance": np.empty((80, 96, 3), np.float32)}
    for _ in range(2):
        renderer.render(asked, out, 1)
    before = _core.allocations()
    renderer.render(asked, out, 1)
    assert _core.allocations() == before


def test_tiles_have_no_seams() -> None:
    """Interpolated air against that of every sample."""
    scene = air_worlds.scene([air_of(EARTH_M, multiple=True)])
    asked = air_worlds.request(
        [[EARTH_M] * 3], [EARTH_M + 4e5, 0, 0], limb(EARTH_M, 4e5, 2e4), [0.3, 0.2, 1.0],
        up=(1, 0, 0), size=(96, 80),
    )  # fmt: skip
    fast = air_worlds.render(scene, asked)["rgb"].astype(int)
    asked["quality"]["tolerance_dn"] = 0.0
    asked["quality"]["samples"] = 64
    full = air_worlds.render(scene, asked)["rgb"].astype(int)
    off = np.abs(fast - full)
    # One is rounding; the horizon's pixels have noise.
    assert np.mean(off > 2) < 0.01
    assert off.mean() < 0.3


def test_presets_in_a_document_are_named_when_wrong() -> None:
    with pytest.raises(ValueError, match="earth"):
        Atmosphere(preset="erth")
    with pytest.raises(ValueError, match="less than the scattering"):
        Atmosphere(preset="earth", mie_scattering_per_km=0.1, mie_extinction_per_km=0.05)
    with pytest.raises(ValueError, match="top_km"):
        Atmosphere.model_validate({"topkm": 3.0})
    with pytest.raises(ValueError, match="there is no air without one of rayleigh_per_km"):
        Atmosphere()
    dust = Atmosphere(mie_scattering_per_km=0.01)
    assert atmospheres.settings(dust, UM)["rayleigh_scattering"] == (0.0, 0.0, 0.0)


def test_edge_of_the_air_in_a_long_exposure() -> None:
    """Just after sunset, exposed so that even the top of the air burns out: its outline is that of
    samples without interpolation, and no light is negative."""
    r = EARTH_M
    up = np.array([0.0, 0.0, 1.0])
    low = math.acos(r / (r + 800e3))
    toward = [-math.cos(low), 0.05, -math.sin(low)]
    sun = [-math.sin(math.radians(118.0)), 0.3, math.cos(math.radians(118.0))]
    asked = air_worlds.request(
        [[r] * 3], (r + 8e5) * up, toward, sun, up=up, size=(120, 60), fov_deg=30.0, white=1.2e-3
    )
    world = air_worlds.scene([air_of(r)])
    fast = air_worlds.render(world, asked)
    asked["quality"]["tolerance_dn"] = 0.0
    whole = air_worlds.render(world, asked)
    assert fast["radiance"].min() >= 0.0
    assert (whole["rgb"] == 255).sum() > 1000
    off = np.abs(fast["rgb"].astype(int) - whole["rgb"]).max(axis=-1) > 12
    # In the row of pixels that the edge crosses few samples may miss what many find.
    assert off.sum() < 2 * asked["width"]
    assert (off[1:-1] & off[:-2] & off[2:]).sum() == 0
