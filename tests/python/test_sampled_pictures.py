"""Samples serve the picture that is asked for; of several, the one that shows noise the most."""

from __future__ import annotations

import copy

import numpy as np
import pytest

import perilune
from perilune.document.loader import read_tree

QUIET = {"read_noise_e": 0.0, "prnu": 0.0, "dark_current_e_s": 0.0, "mosaic": "mono", "bits": 16,
         "gain_e_dn": 0.5, "vignetting": 0.0, "point_spread": {"core": "point"},
         "full_well_e": 30000.0, "exposure": {"mode": "auto"}}  # fmt: skip
NOISELESS = ["shot_noise", "read_noise", "dark_current", "fixed_pattern", "defects", "smear"]
BLIND, NORMAL = 2e5, 300.0
"""Radiances shown as white: by a display to which all is black, and by one as usual."""


@pytest.fixture(scope="module")
def tree(request):
    """The satellite close up, its gloss and inner reflections noisy."""
    root = request.config.rootpath
    tree = read_tree(root / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(root / "assets/models/smallsat.glb")
    tree["camera"] |= {"width": 64, "height": 48, "sensor": QUIET}
    tree["render"] |= {"samples": 32, "max_bounces": 2}
    return tree


def frame(tree, channels, white, tolerance=1.0, samples=32):
    tree = copy.deepcopy(tree)
    tree["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": white}
    tree["render"] |= {"tolerance_dn": tolerance, "samples": samples, "force_off": NOISELESS}
    return perilune.open(tree).frame(0, channels)


def shown(raw):
    """Of 255, encoded; white is the full well."""
    x = np.clip((raw.astype(np.float64) - 64.0) * 0.5 / 30000.0, 0.0, 1.0)
    high = 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055
    return 255.0 * np.where(x <= 0.0031308, 12.92 * x, high)


def rms(a, b):
    return float(np.sqrt(np.mean((a.astype(np.float64) - b.astype(np.float64)) ** 2)))


@pytest.fixture(scope="module")
def exact(tree):
    return frame(tree, ["raw", "rgb"], NORMAL, tolerance=0.0, samples=256)


def test_a_sensor_is_served_whatever_the_display_shows(tree, exact):
    """The display's exposure is no matter of a picture that is the sensor's alone."""
    noise = [rms(shown(frame(tree, ["raw"], white)["raw"]), shown(exact["raw"]))
             for white in (NORMAL, BLIND)]  # fmt: skip
    np.testing.assert_array_equal(
        frame(tree, ["raw"], NORMAL)["raw"], frame(tree, ["raw"], BLIND)["raw"]
    )
    assert noise[0] == noise[1] < 3.0


def test_a_display_is_served_alone(tree):
    """As if there were no sensor."""
    bare = copy.deepcopy(tree)
    del bare["camera"]["sensor"]
    bare["render"]["force_off"] = []
    alone = frame(tree, ["rgb"], NORMAL)["rgb"]
    bare["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": NORMAL}
    bare["render"]["tolerance_dn"] = 1.0
    np.testing.assert_array_equal(perilune.open(bare).frame(0, ["rgb"])["rgb"], alone)


@pytest.mark.parametrize("white", [BLIND, NORMAL, 3.0])
def test_both_are_served(tree, exact, white):
    """Each is no noisier than alone, but for luck."""
    both = frame(tree, ["raw", "rgb"], white)
    sensor = rms(shown(both["raw"]), shown(exact["raw"]))
    alone = rms(shown(frame(tree, ["raw"], white)["raw"]), shown(exact["raw"]))
    assert sensor < 1.1 * alone + 0.05
    reference = frame(tree, ["rgb"], white, tolerance=0.0, samples=256)["rgb"]
    display = rms(both["rgb"], reference)
    assert display < 1.1 * rms(frame(tree, ["rgb"], white)["rgb"], reference) + 0.05


def test_the_suns_limb_is_seen_by_a_sensor_alone(tree):
    """A sensor that the Sun alone fills: pixels that its limb crosses end by no luck of neighbours,
    whose samples have found nothing."""
    limb = copy.deepcopy(tree)
    limb["camera"] |= {"width": 96, "height": 72}
    toward_sun = {"distance_m": [12, 14], "sun_angle_deg": [164, 168]}
    limb["camera"]["trajectory"] = {"kind": "orbit_object", "target": "sat"} | toward_sun
    limb["camera"]["exposure"] = {"mode": "auto"}
    seen = []
    for tolerance in (0.0, 1.0):
        limb["render"] |= {"tolerance_dn": tolerance, "samples": 32, "force_off": NOISELESS}
        seen.append(shown(perilune.open(limb).frame(0, ["raw"])["raw"]))
    assert np.count_nonzero(seen[0] > 250.0) >= 4
    assert (seen[1][seen[0] > 250.0] > 250.0).all()


MIST = {"parent": "sat", "shape": "ellipsoid", "radii_m": [30, 20, 25], "albedo": 0.9,
        "extinction_per_m": [0.02, 0.05, 0.08]}  # fmt: skip


AIR = {"rayleigh_per_km": [0.006, 0.013, 0.03], "rayleigh_height_km": 8.0, "top_km": 80.0,
       "multiple_scattering": False}  # fmt: skip


def sun_in_air(tree):
    """The Sun's direction, 25 km over the equator as the camera of frame 0 sees it."""
    place = perilune.open(tree).frame(0, ["instance"]).camera.position_m
    far_m = np.linalg.norm(place)
    up = place / far_m
    level = np.cross(up, [0.0, 0.0, 1.0])
    dip = np.arccos((6378.1e3 + 25e3) / far_m)
    return np.cos(dip) * level / np.linalg.norm(level) - np.sin(dip) * up


@pytest.mark.parametrize(("medium", "lens_m"), [("none", 0.6), ("air", 0.0), ("volume", 0.6)])
def test_slivers_of_the_suns_limb_are_seen_through_air_and_lenses(tree, medium, lens_m):
    """Rays that look for the Sun alone are dimmed and bent as samples; of 1 024 none are sent."""
    limb = copy.deepcopy(tree)
    limb["spacecraft"]["sat"]["size_m"] = 0.5
    limb["camera"] |= {"width": 14, "height": 10, "fov_deg": 10}
    toward_sun = {"distance_m": [12, 14], "sun_angle_deg": [177, 177.5]}
    limb["camera"]["trajectory"] = {"kind": "orbit_object", "target": "sat"} | toward_sun
    limb["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": NORMAL}
    del limb["camera"]["sensor"]
    if lens_m > 0.0:
        limb["camera"]["lens"] = {"focus_distance_m": 40.0, "aperture_mm": 1e3 * lens_m}
    if medium == "air":
        limb["bodies"]["earth"]["atmosphere"] = AIR
        limb["sun"] = {"direction": [float(x) for x in sun_in_air(limb)]}
    if medium == "volume":
        limb["volumes"] = {"mist": MIST}
    seen = []
    for samples in (1024, 16):
        limb["render"] |= {"tolerance_dn": 0.0, "samples": samples, "max_bounces": 0}
        limb["render"] |= {"volume_steps": 4, "force_off": []}
        seen.append(perilune.open(limb).frame(0, ["radiance"])["radiance"])
    sunlit = seen[0].max(axis=-1) > 1e-4 * seen[0].max()
    assert np.count_nonzero(sunlit) >= 4
    np.testing.assert_allclose(seen[1][sunlit], seen[0][sunlit], rtol=1e-3)


@pytest.mark.parametrize(
    ("tolerance", "exposure_s"),
    [
        pytest.param(0.0, 0.0, id="exact"),
        pytest.param(1.0, 0.0, id="adaptive"),
        pytest.param(1.0, 4.0, id="blurred"),
    ],
)
def test_slivers_of_the_suns_limb_are_not_missed(tree, tolerance, exposure_s):
    """Pixels of which the disc has a hundredth are white, and 16 samples meet it in some alone."""
    limb = copy.deepcopy(tree)
    limb["camera"] |= {"width": 96, "height": 72, "exposure": {"mode": "auto"}}
    toward_sun = {"distance_m": [12, 14], "sun_angle_deg": [164, 168]}
    limb["camera"]["trajectory"] = {"kind": "orbit_object", "target": "sat"} | toward_sun
    limb["camera"]["exposure_time_s"] = exposure_s
    seen = []
    for samples in (1024, 16):
        limb["render"] |= {"tolerance_dn": tolerance, "samples": samples, "max_bounces": 0}
        limb["render"]["force_off"] = NOISELESS
        frame = perilune.open(limb).frame(0, ["raw"])
        assert ("motion_blur" in frame.meta["effects"]) == (exposure_s > 0.0)
        seen.append(shown(frame["raw"]))
    assert np.count_nonzero(seen[0] > 250.0) >= 6
    np.testing.assert_array_equal(seen[0] > 250.0, seen[1] > 250.0)
