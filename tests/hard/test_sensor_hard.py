"""Sensors and lenses where they degenerate, through the whole of a frame.

Every stage of the sensor is on. Values are exact where physics says so: the black level without
light or time, the full well with too much of either.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import perilune

SENSOR: dict[str, Any] = {
    "exposure": {"mode": "fixed"},
    "point_spread": {"core": "airy", "wings": 0.02},
    "vignetting": 4.0,
    "prnu": 0.02,
    "dark_current_e_s": 10.0,
    "hot_pixels": 0.02,
    "dead_pixels": 0.02,
    "shift_us": 0.1,
    "drain": 0.0,
    "cosmic_rays": {"flux_cm2_s": 100.0},
    "column_noise_e": 3.0,
    "lens_flare": {},
    "bits": 12,
    "full_well_e": 20000.0,
    "gain_e_dn": 5.0,
    "black_level_dn": 64.0,
}
FULL_DN = 4064  # 64 + 20000 / 5
QUIET = {"read_noise_e": 0.0, "column_noise_e": 0.0, "prnu": 0.0, "hot_pixels": 0.0,
         "dead_pixels": 0.0, "dark_current_e_s": 0.0, "cosmic_rays": {}}  # fmt: skip
SCENE: dict[str, Any] = {
    "version": 1,
    "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60},
    "root": "rock",
    "bodies": {
        "rock": {"kind": "ellipsoid", "radii_km": 10.0, "gm_km3_s2": 0.1, "albedo": 0.3,
                 "reflectance": "hapke"}
    },
    "sun": {"direction": [1.0, 0.3, 0.0]},
    "camera": {
        "width": 24,
        "height": 18,
        "fov_deg": 40.0,
        "exposure_time_s": 1e-3,
        "trajectory": {"kind": "fixed", "target": "rock", "position_m": [50e3, 0.0, 0.0]},
    },
    "render": {"samples": 4, "max_bounces": 1, "tolerance_dn": 0.0},
}  # fmt: skip
CLOSE = {"camera.trajectory.position_m": [11e3, 0.0, 0.0]}  # the rock fills the frame


def shot(sensor: dict[str, Any] | None = None, **changes: Any) -> perilune.Sample:
    keys = {"camera.sensor": SENSOR | (sensor or {})} | changes
    return perilune.open(SCENE, overrides=keys).frame(0, ["raw", "sensor_rgb", "depth"], threads=1)


def keys_of(**changes: Any) -> dict[str, Any]:
    return {name.replace("__", "."): value for name, value in changes.items()}


def test_no_time() -> None:
    """Noise of reading about the black level; without noise, it alone."""
    noisy = shot(**keys_of(camera__exposure_time_s=0.0))["raw"]
    # read noise of 8 electrons and columns of 3 are 1.7 DN: six of them
    assert 0.5 < noisy.std() < 3.0
    assert np.abs(noisy.astype(int) - 64).max() < 11
    still = shot(QUIET, **keys_of(camera__exposure_time_s=0.0))
    assert (still["raw"] == 64).all()
    assert (still["sensor_rgb"] == 0).all()


def test_too_much_time() -> None:
    """In 1e6 s even dark pixels are full, and none more than that; dead ones bloom full as well."""
    sample = shot({"dead_pixels": 0.0, "read_noise_e": 0.0, "column_noise_e": 0.0},
                  **keys_of(camera__exposure_time_s=1e6))  # fmt: skip
    assert (sample["raw"] == FULL_DN).all()
    assert (sample["sensor_rgb"] == 255).all()


def test_no_photons() -> None:
    """The night side, and a sun that does not shine; an automatic time is within its limits."""
    for dark in (keys_of(sun__direction=[-1.0, 0.0, 0.0]), keys_of(sun__irradiance_w_m2=0.0)):
        assert (shot(QUIET, **dark)["raw"] == 64).all()
        sample = shot(QUIET | {"exposure": {"mode": "auto", "max_ms": 7.0}}, **dark)
        assert 1e-5 <= sample.meta["exposure_s"] <= 7e-3
        assert (sample["raw"] == 64).all()


def test_the_sun_in_the_frame() -> None:
    """1e12 electrons and more in a pixel: full columns, and every number a number."""
    for time_s in (1e-6, 1e-3, 1e3):
        sun = keys_of(sun__direction=[-1.0, 0.0, 0.015], camera__exposure_time_s=time_s,
                   camera__trajectory__position_m=[5e6, 0.0, 0.0], camera__fov_deg=4.0)  # fmt: skip
        sample = shot({"read_noise_e": 0.0, "column_noise_e": 0.0}, **sun)
        assert sample["raw"].max() == FULL_DN
        assert sample["sensor_rgb"].max() == 255
    assert (sample["raw"] == FULL_DN).mean() > 0.9


@pytest.mark.parametrize("mosaic", ["mono", "rggb", "bggr", "grbg", "gbrg"])
def test_black_and_white_frames(mosaic: str) -> None:
    """Of one value all over, borders too, whatever the filters."""
    white = shot({**QUIET, "mosaic": mosaic}, **CLOSE, **keys_of(camera__exposure_time_s=10.0))
    assert (white["raw"] == FULL_DN).all()
    assert (white["sensor_rgb"] == 255).all()
    black = shot({**QUIET, "mosaic": mosaic}, **CLOSE, **keys_of(sun__direction=[-1.0, 0.0, 0.0]))
    assert (black["raw"] == 64).all()
    assert (black["sensor_rgb"] == 0).all()


@pytest.mark.parametrize(
    "spread",
    [
        {"core": "gauss", "sigma_px": 1e4},
        {"core": "gauss", "sigma_px": 0.001},
        {"core": "point", "wings": 1.0, "wing_radius_px": 1e4},
        {"core": "point", "wings": 1.0, "wing_radius_px": 0.001, "wing_beta": 1.001},
        {"core": "airy", "wings": 1.0, "wing_beta": 100.0},
    ],
)
def test_kernels_beyond_the_image(spread: dict[str, Any]) -> None:
    """What leaves the image is lost, nothing is made: at most as much light as without."""
    noiseless = keys_of(render__force_off=["shot_noise"])
    plain = shot(QUIET | {"point_spread": {"core": "point"}}, **noiseless)["raw"].astype(int) - 64
    wide = shot(QUIET | {"point_spread": spread}, **noiseless)["raw"].astype(int) - 64
    assert plain.max() > 100
    assert plain.sum() * 1.01 + wide.size >= wide.sum()
    assert wide.max() <= plain.max() + 1


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (7, 1), (2, 2)])
@pytest.mark.parametrize("mosaic", ["mono", "rggb"])
@pytest.mark.parametrize("lens", [None, {"model": "brown_conrady", "k1": -0.1}])
def test_images_of_a_pixel(size: tuple[int, int], mosaic: str, lens: Any) -> None:
    """Every stage and a lens in images of one pixel, row or column."""
    keys = {"camera.width": size[0], "camera.height": size[1], "camera.lens": lens} | CLOSE
    keys |= {"camera.fov_deg": None, "camera.focal_px": 30.0}
    sample = shot({"mosaic": mosaic}, **keys)
    assert sample["raw"].shape == size[::-1]
    assert sample["sensor_rgb"].shape == (*size[::-1], 3)
    assert (sample["depth"] > 0.0).all()
    assert sample["raw"].max() > 64


@pytest.mark.parametrize(
    ("lens", "text"),
    [
        ({"k1": -6.0}, r"folds the image over: pixel .* 13\.26 deg off the axis"),
        ({"k1": 0.1, "k2": -20.0}, r"folds the image over: pixel .* deg off the axis"),
        ({"k1": -1e6}, r"folds the image over: pixel .* deg off the axis"),
    ],
)
def test_lenses_that_fold(lens: dict[str, float], text: str) -> None:
    """An error that says where, with a sensor as without."""
    with pytest.raises(ValueError, match=text):
        shot(**{"camera.lens": {"model": "brown_conrady", **lens}})
