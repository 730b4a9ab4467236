"""Hard clouds: grazing rays, cameras in the shell, small bodies, stars, motion, maps."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from perilune import _core
from perilune.bodies import clouds
from perilune.config.clouds import CloudNoise, Clouds

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))
import air_worlds
import cloud_worlds

EARTH_M = 6371e3


def ask(camera_m, forward, sun, **changes):
    given = {"tolerance_dn": 0.0, "samples": 4, "size": (33, 33), "fov_deg": 40.0, **changes}
    return air_worlds.request([[EARTH_M] * 3], camera_m, forward, sun, **given)


def toward(height_m: float, low_m: float) -> list[float]:
    """From (radius + height, 0, 0) past the lowest point at low_m."""
    sine = (EARTH_M + low_m) / (EARTH_M + height_m)
    return [-math.sqrt(1.0 - sine * sine), sine, 0.0]


@pytest.mark.parametrize("low_m", [0.0, 1e-6, 7999.999, 8000.0, 8000.001, 9e3])
def test_rays_along_the_shell(low_m: float) -> None:
    """Tangent to the ground or the shell, from space; and back-lit."""
    for sun in ([0.3, 1, 0.2], [-1, 0.2, 0]):
        forward = toward(4e5, low_m)
        asked = ask([EARTH_M + 4e5, 0, 0], forward, sun, size=(3, 3), fov_deg=1e-5, up=(1, 0, 0))
        picture = cloud_worlds.render(Clouds(), asked)["radiance"]
        assert np.isfinite(picture).all()
        assert picture.min() >= 0.0
        assert picture.max() < air_worlds.SOLAR / math.pi


def from_height(height_m: float) -> np.ndarray:
    """A level view by day."""
    asked = ask([EARTH_M + height_m, 0, 0], [0, 1, 0], [1, 0.4, 0], up=(1, 0, 0), samples=1,
                size=(33, 32))  # fmt: skip
    return np.asarray(cloud_worlds.render(Clouds(), asked)["radiance"][..., 0])


@pytest.mark.parametrize("off_m", [-1.0, -0.01, 0.01, 1.0])
def test_camera_next_to_the_shell(off_m: float) -> None:
    """Above or below it the picture is that of ten times as far."""
    near, far = from_height(8000.0 + off_m), from_height(8000.0 + 10.0 * off_m)
    # Only rays at the horizon miss the shell or meet it.
    assert np.isclose(near, far, rtol=0.02, atol=1.0).mean() > 0.9
    assert (near[:15] > 1.0).all() == (off_m < 0.0)


def test_camera_in_the_shell() -> None:
    """No ray crosses it there, whichever way it goes: no speckle of rounding."""
    picture = from_height(8000.0)
    assert (picture[:15] == 0.0).all()
    rows = picture[17:]
    assert (np.ptp(rows, axis=1) < 0.15 * rows.max(axis=1)).all()


@pytest.mark.parametrize("radius_m", [1.0, 1e8])
def test_scaled_worlds_look_the_same(radius_m: float) -> None:
    pictures = []
    for r in (radius_m, EARTH_M):
        k = r / EARTH_M
        row = clouds.settings(Clouds(noise=CloudNoise(warp=0.2)), 0.0)
        for key in ("altitude_m", "thickness_m", "size_m", "relief_m"):
            row[key] *= k  # type: ignore[literal-required]
        asked = air_worlds.request(
            [[r] * 3], [2.0 * r, 0, 0], [-1, 0.1, 0], [1, 0.7, 0.6], tolerance_dn=0.0, samples=4,
        )  # fmt: skip
        scene = air_worlds.scene([None])
        pictures.append(air_worlds.render(scene, {**asked, "body_clouds": [row]})["radiance"])
    # At 1e8 m the sun's direction differs over the body by 7e-4.
    off = np.abs(pictures[0] - pictures[1]) > 0.02 * pictures[1] + 0.5
    assert off.mean() < 0.01


def test_map_of_one_pixel_is_an_even_cover(tmp_path) -> None:
    path = cloud_worlds.write_map(tmp_path / "one.png", np.full((1, 1), 0.4))
    asked = ask([3 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0.2, 0])
    by_map = cloud_worlds.render(Clouds(map=path), asked)["radiance"]
    by_number = cloud_worlds.render(Clouds(opacity=0.4), asked)["radiance"]
    np.testing.assert_allclose(by_map, by_number, rtol=1e-3, atol=1e-3)


def test_dot_with_clouds_has_the_light_of_a_disc() -> None:
    """A body of three pixels brings what it brings when it is large."""
    sums = []
    for size, force_off in (((256, 256), ()), ((15, 15), ("stars",))):
        asked = ask([200 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0.5, 0], size=size, fov_deg=3.0,
                    tolerance_dn=0.2, samples=16, force_off=force_off, albedo=0.1)  # fmt: skip
        picture = cloud_worlds.render(Clouds(), asked)["radiance"].astype(np.float64)
        sums.append(picture.sum() / (size[0] * size[1]))
    assert sums[1] == pytest.approx(sums[0], rel=0.02)


def test_planet_with_clouds_behind_another() -> None:
    """The nearer planet hides clouds, and its own do not shine on the other's."""
    asked = air_worlds.request(
        [[EARTH_M] * 3, [0.25 * EARTH_M] * 3], [10 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0, 0.2],
        centers_m=[[0, 0, 0], [5 * EARTH_M, 0, 0]], size=(65, 65), fov_deg=14.0, albedo=0.0,
        tolerance_dn=0.0, samples=4,
    )  # fmt: skip
    found = cloud_worlds.render(Clouds(), asked)
    # Pixels on the edge have both.
    assert np.quantile(found["radiance"][found["instance"] == 2], 0.8) == 0.0
    assert np.median(found["radiance"][found["instance"] == 1]) > 100.0


def test_oblate_world_is_covered_evenly() -> None:
    asked = ask([0, 3 * EARTH_M, 0], [0, -1, 0], [0, 1, 0.1], samples=16)
    asked["body_radii"] = np.array([[EARTH_M, EARTH_M, 0.8 * EARTH_M]])
    thin, thick = (
        cloud_worlds.render(Clouds(optical_depth=d), asked)["radiance"][..., 0] for d in (1e-9, 1e6)
    )
    # A white ball of the same shape: what a thick cloud sends is Lambert's.
    asked["body_albedo"] = np.full((1, 3), 1.0)
    white = cloud_worlds.render(None, asked)["radiance"][..., 0]
    inside = thin > 30.0
    # But for the limb, where the shell is larger.
    assert (np.abs(thick - white) < 0.02 * white)[inside].mean() > 0.94


def test_sun_through_clouds_is_dimmed_by_their_depth() -> None:
    """What is seen behind clouds comes straight through."""
    depth = 1.2
    asked = ask([EARTH_M + 10.0, 0, 0], [1, 0, 0], [1, 0, 0], size=(3, 3), fov_deg=1e-4,
                samples=1, force_off=["soft_sun", "limb_darkening"])  # fmt: skip
    bare = cloud_worlds.render(None, asked)["radiance"][1, 1, 0]
    through = cloud_worlds.render(Clouds(optical_depth=depth), asked)["radiance"][1, 1, 0]
    assert through / bare == pytest.approx(math.exp(-depth), rel=1e-3)


def test_clouds_in_a_moving_frame() -> None:
    """Blur and a rolling shutter see them as a frame at rest does, when nothing moves much."""
    asked = ask([2 * EARTH_M, 0, 0], [-1, 0, 0], [1, 0.4, 0], samples=16, tolerance_dn=0.5)
    still = cloud_worlds.render(Clouds(noise=CloudNoise()), asked)["radiance"]
    pose = asked["camera_pose"][0]
    moved = pose + np.array([0.0, 2e5, 0, 0, 0, 0, 0])
    keys = np.stack([pose, 0.5 * (pose + moved), moved])
    body = np.array([[0.0, 0, 0, 1, 0, 0, 0]])
    asked["camera_pose"] = np.stack([pose, moved])
    asked["motion"] = {
        "times": (0.01, 0.0, False),
        "camera": keys,
        "objects": np.empty((0, 3, 7)),
        "bodies": np.repeat(body[:, None], 3, axis=1),
        "sun": np.repeat(asked["sun_position"][None], 3, axis=0),
        "movers": np.empty((3, 0, 3, 4)),
    }
    blurred = cloud_worlds.render(Clouds(noise=CloudNoise()), asked)["radiance"]
    assert blurred.mean() == pytest.approx(still.mean(), rel=0.02)
    assert not np.array_equal(blurred, still)


def test_clouds_over_night_are_dark_and_over_sunset_lit_from_below() -> None:
    # The sun 1 degree below the horizon of the ground: clouds at 8 km see it (dip 2.9 degrees).
    low = math.radians(1.0)
    asked = ask([EARTH_M + 10.0, 0, 0], [1, 0, 0], [-math.sin(low), math.cos(low), 0],
                size=(3, 3), fov_deg=1.0)  # fmt: skip
    sunset = cloud_worlds.render(Clouds(), asked)["radiance"][1, 1, 0]
    part = cloud_worlds.reflected(15.0, math.sqrt(math.sin(low) ** 2 + 4e3 / (EARTH_M + 8e3)))
    assert sunset == pytest.approx(air_worlds.SOLAR * math.sin(low) * part / math.pi, rel=0.02)
    low = math.radians(4.0)
    asked = ask([EARTH_M + 10.0, 0, 0], [1, 0, 0], [-math.sin(low), math.cos(low), 0],
                size=(3, 3), fov_deg=1.0)  # fmt: skip
    assert cloud_worlds.render(Clouds(), asked)["radiance"].max() == 0.0


def test_cover_does_not_depend_on_neighbours() -> None:
    """The same place, asked alone or among others."""
    row = clouds.settings(Clouds(noise=CloudNoise(warp=0.5)), 0.0)
    points = np.random.default_rng(2).normal(size=(50, 3)) * EARTH_M
    together = _core.cloud_cover(row, points, 1e4, 16)
    alone = [_core.cloud_cover(row, points[i : i + 1], 1e4, 16)[0] for i in range(50)]
    np.testing.assert_array_equal(together, alone)
    assert ((together >= 0.0) & (together <= 1.0)).all()
    with pytest.raises(ValueError, match="out of range"):
        _core.cloud_cover(row, points, -1.0, 16)
