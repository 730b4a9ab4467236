"""Spectra and bands: integrals against SciPy and published values, the channel, files, errors."""

from __future__ import annotations

import copy
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import constants, integrate

import perilune
from perilune.base import spectra
from perilune.camera import bands
from perilune.config import ConfigError
from perilune.document.loader import read_tree

SUN_K, BLANKETED, EDGE_UM = 5850.0, 0.7, 0.4


@pytest.fixture(scope="module")
def tree(repo_dir: Path) -> Any:
    """The small scene."""
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(repo_dir / "assets/models/smallsat.glb")
    return tree


def opened(tree: Any, chosen: Any, sun: Any = None, **keywords: Any) -> perilune.Simulation:
    tree = copy.deepcopy(tree)
    tree["camera"]["bands"] = chosen
    if sun is not None:
        tree["sun"] = sun
    return perilune.open(tree, **keywords)


def planck(um: float) -> float:
    """W m-2 um-1 sr-1 in some scale, SciPy's constants."""
    m = um * 1e-6
    return float(um**-5.0 / np.expm1(constants.h * constants.c / (m * constants.k * SUN_K)))


def default_sun(um: float) -> float:
    return planck(um) * (BLANKETED if um < EDGE_UM else 1.0)


def quad(function: Any, low: float, high: float, points: Any = ()) -> float:
    inside = sorted(point for point in points if low < point < high)
    edges = [low, *inside, high]
    parts = [integrate.quad(function, *pair, epsrel=1e-11)[0] for pair in pairwise(edges)]
    return float(sum(parts))


TOTAL = quad(default_sun, 0.02, 3000.0, (0.1, EDGE_UM, 1.0, 5.0, 50.0))


@pytest.mark.parametrize(("low", "high"), [(0.6, 0.7), (0.3, 1.1), (0.38, 0.385), (2.0, 9.0)])
def test_the_default_sun_is_plancks_law(low, high):
    light = spectra.gather(None, spectra.box(low, high))
    energy = quad(default_sun, low, high, (EDGE_UM,))
    weighted = quad(lambda um: um * default_sun(um), low, high, (EDGE_UM,))
    assert sum(light["part"]) == pytest.approx(energy / TOTAL, rel=1e-9)
    assert light["mean_um"] == pytest.approx(weighted / energy, rel=1e-10)
    assert sum(light["moment_um"]) == pytest.approx(weighted / TOTAL, rel=1e-9)


def test_a_gaussian_is_its_formula():
    center, width = 0.55, 0.08
    light = spectra.gather(None, spectra.gaussian(center, width))
    formula = quad(
        lambda um: default_sun(um) * 2.0 ** (-((2.0 * (um - center) / width) ** 2)),
        EDGE_UM, 0.8, (0.5, 0.55, 0.6),
    )  # fmt: skip
    assert sum(light["part"]) == pytest.approx(formula / TOTAL, rel=1e-5)


def test_srgb_looks_as_it_is_and_the_sun_is_reddish():
    """A reflectance that is rebuilt of a colour has that colour in sunlight: no part of others.

    White sunlight of 6000 and 5772 K relative to green in linear sRGB: (1.110, 1, 0.973) and
    (1.137, 1, 0.935) by the same fits of the observer (integrated apart)."""
    lights = [spectra.gather(None, curve) for curve in spectra.srgb_curves()]
    parts = np.array([light["part"] for light in lights])
    assert np.abs(parts / parts.sum(axis=1, keepdims=True) - np.eye(3)).max() < 1e-12
    um = np.linspace(0.38, 0.78, 4001)
    to_display = spectra.srgb_response(um) * spectra._SRGB_PEAKS[:, None]
    for kelvin, expected in ((6000.0, (1.110, 1.0, 0.973)), (5772.0, (1.137, 1.0, 0.935))):
        light = um**-5.0 / np.expm1(14387.76877 / (um * kelvin))
        seen = np.trapezoid(to_display * light, um, axis=1)
        assert seen / seen[1] == pytest.approx(expected, abs=1e-3)


def test_the_error_of_integration_falls_with_its_step():
    """Of steps of 200 to 10 nm, against 1 nm: the eighth order of four points, then rounding."""
    curve = spectra.box(0.75, 2.5)  # reflectances are even there: nothing else makes steps
    exact = sum(spectra.gather(None, curve, step_um=0.001)["part"])
    steps = (1.0, 0.5, 0.25, 0.05, 0.01)
    errors = [abs(sum(spectra.gather(None, curve, step_um=s)["part"]) / exact - 1) for s in steps]
    assert errors[0] > 16.0 * errors[1] > 16.0 * 16.0 * errors[2]
    assert errors[0] < 1e-3
    assert max(errors[3:]) < 1e-12


def test_the_default_against_wehrli(data_dir):
    """What the documentation says of the default's error, and published values through a file:
    1.912, 1.850 and 1.474 W m-2 nm-1 at 440, 550 and 680 nm (ASTM E490; Wehrli differs by 4 %)."""
    path = data_dir / "reflectance/selene_sp/Wehrli_1985.txt"
    sun = spectra.read(path, 1e-3)
    assert spectra.integral(sun) == pytest.approx(1365.2e0, abs=0.1)
    assert sun.shape[1] == 2

    def by_hand(low: float, high: float) -> float:
        """By SciPy and NumPy, straight from the file."""
        um = np.unique([low, high, *sun[(sun[:, 0] > low) & (sun[:, 0] < high), 0]])
        inside = np.trapezoid(np.interp(um, *sun.T), um) / np.trapezoid(sun[:, 1], sun[:, 0])
        return quad(default_sun, low, high, (EDGE_UM,)) / TOTAL / inside - 1.0

    def error(low: float, high: float) -> float:
        curve = spectra.box(low, high)
        parts = [sum(spectra.gather(which, curve)["part"]) for which in (None, sun)]
        found = parts[0] / parts[1] - 1.0
        assert found == pytest.approx(by_hand(low, high), abs=2e-6)
        return float(found)

    fifties = [error(0.3 + 0.05 * i, 0.35 + 0.05 * i) for i in range(16)]
    assert 0.055 < max(map(abs, fifties)) < 0.062  # "6 %"
    hundreds = [error(0.4 + 0.1 * i, 0.5 + 0.1 * i) for i in range(3)]
    assert [round(100.0 * e, 1) for e in hundreds] == [-2.3, -1.2, 0.6]
    assert error(0.4, 0.9) == pytest.approx(0.005, abs=1e-3)
    assert error(1.1, 2.5) == pytest.approx(-0.0999, abs=5e-4)
    for um, value in ((0.44, 1.912), (0.55, 1.850), (0.68, 1.474)):
        part = sum(spectra.gather(sun, spectra.box(um - 0.005, um + 0.005))["part"])
        assert part * spectra.integral(sun) / 10.0 == pytest.approx(value, rel=0.045)


@given(
    edges=st.lists(st.floats(0.2, 2.0), min_size=2, max_size=6, unique=True),
    color=st.tuples(*[st.floats(0.0, 1.0)] * 3),
)
@settings(max_examples=60, deadline=None)
def test_bands_that_part_a_band_hold_what_it_holds(edges, color):
    """Neighbours add up to the whole; nothing is negative; no colour gives more than white."""
    edges = sorted(edges)
    pairs = [pair for pair in pairwise(edges) if pair[1] - pair[0] > 1e-6]
    parts = [np.array(spectra.gather(None, spectra.box(*pair))["part"]) for pair in pairs]
    for part in parts:
        assert (part >= 0.0).all()
        assert 0.0 <= part @ color <= part.sum() * (1.0 + 1e-12)
    if edges[-1] - edges[0] > 1e-5:
        whole = spectra.gather(None, spectra.box(edges[0], edges[-1]))["part"]
        assert sum(parts) == pytest.approx(np.array(whole), rel=1e-5, abs=1e-6)


# --- the channel


THREE = [
    {"name": "blue", "center_um": 0.45, "width_um": 0.1},
    {"name": "red", "center_um": 0.65, "width_um": 0.05, "shape": "gaussian"},
    {"name": "near infrared", "center_um": 0.8, "width_um": 0.2},
    {"name": "all", "center_um": 0.7, "width_um": 0.8},
]


def test_the_channel_is_the_radiance_in_the_bands(tree):
    sun = {"band_wavelengths_um": [0.612, 0.549, 0.465]}  # else the disc darkens by the bands
    sim = opened(tree, THREE, sun)
    sample = sim.frame(0, ["bands", "radiance", "rgb"])
    curves = bands.curves(sim.config.camera.bands)
    parts = np.array([spectra.gather(None, curve)["part"] for curve in curves])
    assert sample["bands"].shape == (32, 48, 4)
    assert sample["bands"].dtype == np.float32
    expected = np.einsum("bc,hwc->hwb", parts, sample["radiance"].astype(float))
    assert sample["bands"] == pytest.approx(expected, rel=1e-5, abs=1e-9)
    assert sample["bands"].max() > 1.0
    named = sample.meta["bands"]
    assert [row["name"] for row in named] == ["blue", "red", "near infrared", "all"]
    assert [row["sun_part"] for row in named] == pytest.approx(parts.sum(axis=1))
    assert named[2]["mean_um"] == pytest.approx(0.795, abs=0.01)
    alone, plain = sim.frame(0, ["bands"]), opened(tree, "srgb").frame(0, ["rgb", "bands"])
    assert np.array_equal(alone["bands"], sample["bands"])
    assert np.array_equal(plain["rgb"], sample["rgb"])
    assert plain["bands"].shape == (32, 48, 3)
    assert opened(tree, "monochrome").frame(0, ["bands"])["bands"].shape == (32, 48, 1)


def test_a_white_surface_sends_its_irradiance_over_pi(tree):
    """A white sphere under the sun behind the camera: its middle, at 0.5 deg of slope a pixel."""
    tree = copy.deepcopy(tree)
    tree["spacecraft"] = {}
    tree["bodies"] = {"earth": {"kind": "ellipsoid", "radii_km": 1000.0, "gm_km3_s2": 1.0,
                                "albedo": 1.0}}  # fmt: skip
    tree["sun"] = {"direction": [1.0, 0.0, 0.0]}
    tree["camera"] = {
        "width": 33, "height": 33, "fov_deg": 1.0, "bands": THREE,
        "trajectory": {"kind": "fixed", "target": "earth", "position_m": [2e7, 0.0, 0.0]},
    }  # fmt: skip
    light = perilune.open(tree).frame(0, ["bands"])["bands"][16, 16]
    # the irradiance of a band, W m-2, is its part of 1361
    energy = [quad(default_sun, 0.4, 0.5), None, quad(default_sun, 0.7, 0.9), None]
    for value, of_band in zip(light, energy, strict=True):
        if of_band is not None:
            assert value == pytest.approx(1361.0 * of_band / TOTAL / np.pi, rel=2e-3)


def test_sensors_have_bands_of_their_own(tree):
    tree = copy.deepcopy(tree)
    tree["sensors"] = {"colour": {}, "infrared": {"bands": THREE[2:3]}}
    sim = perilune.open(tree)
    shapes = [sim.frame(i, ["bands"])["bands"].shape for i in range(2)]
    assert shapes == [(32, 48, 3), (32, 48, 1)]


def test_bands_carry_drivers(tree):
    width = {"ideal": 0.1, "jitter_variance": 0.001, "clip_min": 0.05, "clip_max": 0.2}
    sim = opened(tree, [{"center_um": 0.6, "width_um": width}])
    widths = []
    for i in range(3):
        sample = sim.frame(i, ["bands", "radiance"])
        widths.append(sample.meta["drivers"]["camera.bands[0].width_um"])
        half = 0.5 * widths[-1]
        parts = spectra.gather(None, spectra.box(0.6 - half, 0.6 + half))["part"]
        expected = sample["radiance"].astype(float) @ np.array(parts)
        assert sample["bands"][:, :, 0] == pytest.approx(expected, rel=1e-5, abs=1e-9)
    assert np.ptp(widths) > 0.0


def test_the_sun_darkens_as_the_bands_see_it(tree):
    def found(chosen: Any, sun: Any = None) -> Any:
        sim = opened(tree, chosen, sun)
        return sim.request(0)["sun_wavelengths"]

    assert found("srgb").tolist() == [0.612, 0.549, 0.465]
    assert found([{"center_um": 0.9, "width_um": 0.02}]) == pytest.approx([0.9] * 3, abs=1e-4)
    red, green, blue = found("monochrome")
    assert 0.4 < blue < 0.5 < green < 0.6 < 0.7 < red < 0.75  # red has all beyond 0.7 um
    assert found([THREE[0], THREE[2]])[2] == pytest.approx(0.45, abs=0.01)
    given = {"band_wavelengths_um": [0.7, 0.6, 0.5]}
    assert found("monochrome", given).tolist() == [0.7, 0.6, 0.5]


# --- files


def test_files_are_read_with_their_units(tree, tmp_path):
    flat = tmp_path / "flat.csv"
    flat.write_text("# an even sun\nwavelength, irradiance\n200, 1.361\n1200, 1.361\n")
    filter_file = tmp_path / "filter.txt"
    filter_file.write_text("0.5 0\n0.6 1\n0.7 0\n")
    sun = {"spectrum": {"file": "flat.csv"}}
    band = {"file": "filter.txt", "wavelength_unit": "um"}
    sim = opened(tree, [band], sun, base=tmp_path)
    # a triangle of half a tenth of a micrometre in 1 um of even light
    assert bands.matrix(sim.config.camera, sim.config.sun).sum() == pytest.approx(0.1, rel=1e-9)
    filter_file.write_text("0.5 0\n0.6 0.5\n0.7 0\n1.0 0\n")
    assert bands.matrix(sim.config.camera, sim.config.sun).sum() == pytest.approx(0.05, rel=1e-9)


def test_wehrlis_sun_can_be_the_scenes(tree, data_dir):
    spectrum = {"file": "data:reflectance/selene_sp/Wehrli_1985.txt", "irradiance_unit": "mW_m2_nm"}
    sim = opened(tree, "monochrome", {"spectrum": spectrum})
    # 759.16 of 1365.24 W m-2 between 0.4 and 0.9 um, by the trapezoidal rule on its rows
    part = bands.matrix(sim.config.camera, sim.config.sun).sum()
    assert part == pytest.approx(759.1625 / 1365.2354, rel=1e-5)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "at least two rows"),
        ("500 1\n", "at least two rows of numbers, this has 1"),
        ("500 1\n400 1\n", "line 2: the wavelength 400 does not rise above"),
        ("nm r\n500 1\n500 1\n", "line 3: the wavelength 500 does not rise"),
        ("500 1\nnan 1\n", "line 2: not finite"),
        ("500 1\n600 inf\n", "line 2: not finite"),
        ("500 1\n600 -0.5\n", "line 2: -0.5 is negative"),
        ("500 1\n600 1 1\n", "line 2: 3 numbers; expected 2"),
        ("500\n600\n", "line 1: 1 numbers; expected 2 or more"),
        ("500 1\n600 one\n", "line 2: '600 one' is no row of numbers"),
        ("500 0\n600 0\n", "holds zeros alone"),
        ("500 90\n600 90\n", "values are 0 to 1, not 90"),
        ("500 1 2\n600 1 2\n", "2 columns of values after the wavelength; expected 1"),
        ("0.5 1\n0.6 1\n", "line 1: a wavelength of 0.0005 um is not in 0.01 to 1000 um"),
        ("100 1\n600 1\n", "reaches beyond the sun's spectrum"),
    ],
)
def test_broken_curves_are_named(tree, tmp_path, text, complaint):
    (tmp_path / "curve.csv").write_text(text)
    (tmp_path / "sun.csv").write_text("200 1.361\n1200 1.361\n")
    with pytest.raises(ConfigError) as caught:
        opened(tree, [{"file": "curve.csv"}], {"spectrum": {"file": "sun.csv"}}, base=tmp_path)
    assert complaint in str(caught.value)
    assert "camera.bands[0]" in str(caught.value)
    if "line" in complaint:
        assert "curve.csv" in str(caught.value)


@pytest.mark.parametrize(
    ("band", "complaint"),
    [
        ({}, "camera.bands[0]: needs center_um and width_um, or a file"),
        ({"center_um": 0.5}, "camera.bands[0]: needs center_um and width_um"),
        ({"center_um": 0.5, "width_um": 0.0}, "camera.bands[0].width_um = 0.0"),
        ({"center_um": 0.05, "width_um": 0.1}, "must begin at 0.01 um"),
        ({"center_um": 0.5, "width_um": 0.1, "shape": "triangle"}, "camera.bands[0].shape"),
        ({"file": "none.csv"}, "camera.bands[0].file"),
        ({"centre_um": 0.5, "width_um": 0.1}, "did you mean 'center_um'"),
    ],
)
def test_wrong_bands_are_named(tree, band, complaint):
    with pytest.raises(ConfigError) as caught:
        opened(tree, [band])
    assert complaint in str(caught.value)


def test_nanometres_read_as_micrometres_are_named(tree, tmp_path):
    (tmp_path / "curve.csv").write_text("500 1\n600 1\n")
    with pytest.raises(ConfigError, match=r"bands\[0\]\.file: .*600 um is more than 100; check"):
        opened(tree, [{"file": "curve.csv", "wavelength_unit": "um"}], base=tmp_path)


def test_other_wrong_keys(tree, tmp_path):
    (tmp_path / "sun.csv").write_text("400 1.361\n700 1.361\n")
    with pytest.raises(ConfigError, match=r"sun\.spectrum\.irradiance_unit: .* holds 408\.3 W/m2"):
        opened(tree, "srgb", {"spectrum": {"file": "sun.csv"}}, base=tmp_path)
    relative = {"spectrum": {"file": "sun.csv", "irradiance_unit": "relative"}}
    with pytest.raises(ConfigError, match=r"camera\.bands: the band, 0\.38 to 0\.78 um, reaches"):
        opened(tree, "srgb", relative, base=tmp_path)
    with pytest.raises(ConfigError, match=r"camera\.bands"):
        opened(tree, "rgb")
    with pytest.raises(ConfigError, match=r"camera\.bands: must have 1 to 64 bands, not 0"):
        opened(tree, [])
    with pytest.raises(ConfigError, match=r"camera\.bands: two bands have the name 'red'"):
        opened(tree, [THREE[1], THREE[1]])
