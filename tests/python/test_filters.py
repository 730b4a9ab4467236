"""Filters of image sensors: quantum efficiency by wavelength, mosaics, planes, errors."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import constants

import perilune
from perilune.base import spectra
from perilune.camera import filters
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.show import preview

QUIET = {"prnu": 0.0, "vignetting": 0.0, "black_level_dn": 100.0, "exposure": {"mode": "fixed"}}
NOISE = ["shot_noise", "read_noise", "dark_current"]
TWO = [
    {"name": "green", "center_um": 0.55, "width_um": 0.04, "shape": "gaussian"},
    {"name": "near infrared", "center_um": 0.8, "width_um": 0.1},
]


@pytest.fixture(scope="module")
def tree(repo_dir: Path) -> Any:
    """The small scene."""
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(repo_dir / "assets/models/smallsat.glb")
    return tree


def ball(albedo: Any, sensor: Any, camera: Any = None, **sections: Any) -> Any:
    """A ball under the sun behind the camera, whose middle, below 1 degree of slope, is seen."""
    return {
        "version": 1, "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60.0}, "root": "ball",
        "bodies": {"ball": {"kind": "ellipsoid", "radii_km": 1000.0, "gm_km3_s2": 1.0,
                            "albedo": albedo}},
        "camera": {"width": 9, "height": 9, "fov_deg": 0.05, "exposure_time_s": 1e-3,
                   "trajectory": {"kind": "fixed", "target": "ball", "position_m": [2e7, 0.0, 0.0]},
                   "sensor": {**QUIET, **sensor}, **(camera or {})},
        "render": {"samples": 1, "force_off": NOISE},
        **sections, "sun": {"direction": [1.0, 0.0, 0.0], **sections.get("sun", {})},
    }  # fmt: skip


def electrons(sim: perilune.Simulation) -> np.ndarray:
    """Of each pixel, to half a digital number."""
    sensor = sim.config.camera.sensor
    raw = sim.frame(0, ["raw"])["raw"].astype(float)
    return (raw - sensor.black_level_dn) * sensor.gain_e_dn


def test_the_worked_example(tmp_path):
    """I/F 0.1 at 1 au under 1.8504 W m-2 nm-1 from 500 to 600 nm, f/5.6, 5.5 um, 1 ms, quantum
    efficiency 0.5, transmission 0.9: 5559.726455065379 electrons (worked by hand)."""
    (tmp_path / "sun.csv").write_text("200 1.8504\n1000 1.8504\n")
    sensor = {"f_number": 5.6, "pixel_um": 5.5, "transmission": 0.9, "mosaic": "rggb",
              "quantum_efficiency": [0.1, 0.5, 0.2], "bits": 16, "gain_e_dn": 0.1,
              "full_well_e": 1e5}  # fmt: skip
    spectrum = {"file": "sun.csv", "irradiance_unit": "relative"}
    sun = {"spectrum": spectrum, "irradiance_w_m2": 1.8504 * 800.0}
    sim = perilune.open(ball(0.1, sensor, sun=sun), base=tmp_path)
    green = electrons(sim)[4, 5]
    assert green == pytest.approx(5559.726455065379, rel=1e-4)


def test_filters_see_a_colour_as_its_spectrum_is(tmp_path):
    """Pixels under each filter against the integral over the rebuilt reflectance."""
    (tmp_path / "qe.csv").write_text(
        "nm red green blue\n350 0 0 0.1\n450 0.02 0.1 0.6\n550 0.1 0.7 0.1\n650 0.8 0.1 0\n"
        "900 0.3 0.3 0.3\n1000 0 0 0\n"
    )
    sensor = {"quantum_efficiency": {"file": "qe.csv"}, "bits": 16, "gain_e_dn": 0.5,
              "f_number": 16.0, "full_well_e": 1e6}  # fmt: skip
    albedo = [0.5, 0.2, 0.1]
    sim = perilune.open(ball(albedo, sensor), base=tmp_path)
    seen = electrons(sim)
    um = np.linspace(0.35, 1.0, 65001)
    light = um**-5.0 / np.expm1(14387.768775 / (um * 5850.0)) * np.where(um < 0.4, 0.7, 1.0)
    whole = sum(spectra.gather(None, spectra.box(0.35, 1.0))["part"])
    light *= whole * 1361.0 / np.trapezoid(light, um)
    reflected = np.array(albedo) @ reflectances(um)
    table = np.loadtxt(tmp_path / "qe.csv", skiprows=1)
    photon_j = constants.h * constants.c / (um * 1e-6)
    collected = np.pi * 0.9 / (4.0 * 16.0**2) * (5.5e-6) ** 2 * 1e-3 * light * reflected / np.pi
    for (x, y), column in (((4, 4), 1), ((5, 4), 2), ((5, 5), 3)):
        efficiency = np.interp(um, 1e-3 * table[:, 0], table[:, column])
        expected = np.trapezoid(collected * efficiency / photon_j, um)
        assert seen[y, x] == pytest.approx(expected, rel=1e-3)
    sample = sim.frame(0, ["raw"])
    assert next(row for row in sample.plan if row["name"] == "filters")["on"]


def reflectances(um: np.ndarray) -> np.ndarray:
    """(3, n): the shares of red, green and blue, by narrow bands under an even sun."""
    even = np.array([[0.01, 1.0], [10.0, 1.0]])
    nodes = np.arange(0.345, 1.0101, 0.005)
    parts = np.array([spectra.gather(even, spectra.box(n - 1e-6, n + 1e-6))["part"] for n in nodes])
    return np.array([np.interp(um, nodes, row) for row in (parts / parts.sum(1, keepdims=True)).T])


def test_white_fills_a_mosaic_as_its_curves_say(tree):
    """Of white every filter has what its curve alone gathers; without the row, colours part."""
    described = filters.described(opened(tree, {}).config.camera, None)
    assert described["mix"].sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert (described["mix"].diagonal() > 0.8).all()
    sensor = {"bits": 16, "gain_e_dn": 0.5, "full_well_e": 1e6}
    white = [perilune.open(ball(0.3, sensor)), perilune.open(ball(0.3, sensor))]
    off = perilune.open(ball(0.3, sensor, render={"samples": 1, "force_off": [*NOISE, "filters"]}))
    assert np.array_equal(electrons(white[0]), electrons(off))
    red = ball([0.3, 0.0, 0.0], sensor)
    green_of_red = electrons(perilune.open(red))[4, 5]
    assert green_of_red > 50.0
    red["render"] = {"samples": 1, "force_off": [*NOISE, "filters"]}
    assert electrons(perilune.open(red))[4, 5] == 0.0


def opened(tree: Any, sensor: Any, **camera: Any) -> perilune.Simulation:
    tree = copy.deepcopy(tree)
    tree["camera"] |= {"sensor": sensor, **camera}
    return perilune.open(tree)


def test_a_bare_sensor_sees_all_its_boxes(tree):
    """As before there were spectra: the electrons of three boxes, whatever the colours are."""
    sensor = opened(tree, {"mosaic": "mono"}).config.camera.sensor
    camera = opened(tree, {"mosaic": "mono"}).config.camera
    described = filters.described(camera, None)
    boxes = [spectra.gather(None, spectra.box(low * 1e-3, high * 1e-3))
             for low, high in sensor.bands_nm]  # fmt: skip
    expected = sum(q * sum(b["moment_um"]) for q, b in
                   zip(sensor.quantum_efficiency, boxes, strict=True))  # fmt: skip
    found = described["band_share"] @ described["wavelength_m"] * 1e6
    assert found == pytest.approx(expected, rel=1e-12)
    assert "mix" not in described


@given(
    efficiency=st.tuples(*[st.floats(0.01, 1.0)] * 3),
    cuts=st.lists(st.integers(300, 1100), min_size=4, max_size=4, unique=True),
)
@settings(max_examples=40, deadline=None)
def test_no_filter_makes_light(efficiency, cuts):
    """Shares add up to less than all; parts of a filter's charge are parts."""
    a, b, c, d = sorted(cuts)
    boxes = ((float(c), float(d)), (float(b), float(c)), (float(a), float(b)))
    described = filters._mosaic(None, filters.efficiencies(efficiency, boxes))
    assert 0.0 < described["band_share"].sum() < max(efficiency)
    assert (described["mix"] >= 0.0).all()
    assert described["mix"].sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    low, high = np.array(boxes).T * 1e-9
    assert (described["wavelength_m"] > low).all()
    assert (described["wavelength_m"] < high).all()


# --- planes


def test_planes_are_bare_sensors_behind_their_filters():
    sensor = {"mosaic": "planes", "bits": 16, "gain_e_dn": 0.5, "full_well_e": 1e6,
              "f_number": 8.0, "quantum_efficiency": [0.5, 0.5, 0.5],
              "bands_nm": [[600.0, 1000.0], [500.0, 600.0], [400.0, 500.0]]}  # fmt: skip
    albedo = [0.5, 0.3, 0.1]
    sim = perilune.open(ball(albedo, sensor, {"bands": TWO}))
    seen = electrons(sim)
    assert seen.shape == (9, 9, 2)
    for name in ("sensor_rgb", "glare"):
        with pytest.raises(ConfigError, match=rf"'{name}': none where .* is planes"):
            sim.frame(0, [name])
    for plane, curve in enumerate((spectra.gaussian(0.55, 0.04), spectra.box(0.75, 0.85))):
        photons = np.array(spectra.gather(None, curve)["moment_um"]) @ albedo * 1e-6
        radiance = 1361.0 / np.pi * photons / (constants.h * constants.c)
        expected = np.pi * 0.9 / 256.0 * (5.5e-6) ** 2 * 1e-3 * 0.5 * radiance
        assert seen[4, 4, plane] == pytest.approx(expected, rel=1e-3)


def test_planes_share_pixels_but_no_noise():
    sensor = {"mosaic": "planes", "prnu": 0.2, "bits": 16, "gain_e_dn": 0.5, "full_well_e": 1e6}
    twice = [TWO[0], {**TWO[0], "name": "again"}]
    scene = ball(0.3, sensor, {"bands": twice, "width": 33, "height": 33})
    same = electrons(perilune.open(scene))
    assert np.array_equal(same[..., 0], same[..., 1])
    assert same.std() > 0.1 * same.mean()
    scene["render"] = {"samples": 1}
    noisy = electrons(perilune.open(scene))
    assert np.mean(noisy[..., 0] == noisy[..., 1]) < 0.05
    difference = noisy[..., 0] - noisy[..., 1]
    # two counts and two readings of 8 electrons; a standard deviation of 1089 samples to 10 %
    assert difference.std() == pytest.approx(np.sqrt(2.0 * (same.mean() + 64.0)), rel=0.12)
    threads = [perilune.open(scene).frame(0, ["raw"], threads=n)["raw"] for n in (1, 2)]
    assert np.array_equal(*threads)


def test_planes_are_exposed_for_the_brightest():
    sensor = {"mosaic": "planes", "exposure": {"key": 0.7}, "quantum_efficiency": [0.5, 0.5, 0.5],
              "bands_nm": [[600.0, 1000.0], [500.0, 600.0], [400.0, 500.0]], "bits": 16,
              "gain_e_dn": 0.5, "full_well_e": 2e4}  # fmt: skip
    sim = perilune.open(ball(0.5, sensor, {"bands": TWO}))
    assert electrons(sim).max() == pytest.approx(0.7 * 2e4, rel=0.01)


def test_planes_on_the_sheet():
    blue = {"center_um": 0.45, "width_um": 0.1}
    scene = ball(0.5, {"mosaic": "planes"}, {"bands": [TWO[0], blue]})
    image = preview.render_sheet(perilune.open(scene), 0)
    assert image.max() > 100


# --- errors


@pytest.mark.parametrize(
    ("text", "sensor", "complaint"),
    [
        ("400 0.5\n900 0.5\n", {}, "1 columns of values after the wavelength; expected 3"),
        ("400 1 1 1\n900 1 1 1\n", {"mosaic": "mono"}, "3 columns of values"),
        ("400 50\n900 50\n", {"mosaic": "mono"}, "values are 0 to 1, not 50"),
        ("400 0.5\n400 0.5\n", {"mosaic": "mono"}, "line 2: the wavelength 400 does not rise"),
        ("400 -0.5\n500 0.5\n", {"mosaic": "mono"}, "line 1: -0.5 is negative"),
        ("400 0\n500 0\n", {"mosaic": "mono"}, "holds zeros alone"),
        ("400 0.5\n500 0.5\n", {"mosaic": "mono", "bands_nm": [[1, 2]] * 3}, "bands_nm"),
    ],
)
def test_broken_efficiencies_are_named(tree, tmp_path, text, sensor, complaint):
    (tmp_path / "qe.csv").write_text(text)
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = {"quantum_efficiency": {"file": "qe.csv"}, **sensor}
    with pytest.raises(ConfigError) as caught:
        perilune.open(tree, base=tmp_path)
    assert complaint in str(caught.value)
    assert "camera.sensor" in str(caught.value)


def test_what_sees_nothing_is_refused(tree):
    nothing = {"name": "far", "center_um": 2.0, "width_um": 0.1}
    with pytest.raises(ConfigError, match=r"camera\.sensor\.quantum_efficiency: .* bands\[1\]"):
        opened(tree, {"mosaic": "planes"}, bands=[TWO[0], nothing])
    with pytest.raises(ConfigError, match=r"camera\.bands: srgb is no filter"):
        opened(tree, {"mosaic": "planes"})
    with pytest.raises(ConfigError, match=r"'sensor_rgb': none where camera\.sensor\.mosaic"):
        opened(tree, {"mosaic": "planes"}, bands=TWO[:1]).frame(0, ["sensor_rgb"])
