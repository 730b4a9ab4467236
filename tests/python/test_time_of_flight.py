"""A time-of-flight camera: against closed forms of phases, wrap-around and noise."""

from __future__ import annotations

import numpy as np
import pytest
from tests.python.optics_scenes import at, ball, opened, tree

LIGHT_M_S = 299792458.0


def pictured(root, size=(24, 18), **keys):
    """A ball of 4 m before a far one; 9 and 60 m from the camera."""
    scene = tree(
        size,
        size[0] / 1.2,
        near=ball(at(9.0), 2.0, albedo=0.6),
        far=ball(at(90.0), 60.0, albedo=0.6),
    )
    scene["time_of_flight"] = {"signal_e": 1e9, "samples": 1, **keys}
    return opened(scene, root)


def test_ranges_are_right_up_to_the_noise(repo_dir):
    """20 and 50 MHz tell ranges apart up to 15 m: what is farther is folded."""
    sim = pictured(repo_dir)
    found = sim.time_of_flight(0)
    there = found["echoes"] == 1
    assert there.all()
    label = sim.frame(0, ["range"])["range"]
    np.testing.assert_allclose(found["true_range_m"], label, rtol=1e-6)
    common = 0.5 * LIGHT_M_S / 10e6
    off = found["range_m"] - found["true_range_m"] % common
    off -= common * np.round(off / common)
    near = found["true_range_m"] < 15.0
    assert 10 < near.sum() < near.size
    assert np.abs(off[near]).max() < 0.01
    assert np.abs(off).max() < 0.2
    assert found.tobytes() == sim.time_of_flight(0, threads=1).tobytes()


def test_noise_is_that_of_the_taps(repo_dir):
    """At one frequency the phase's deviation is sqrt(taps' variance) over the amplitude: shot noise
    of signal and ambient light, and read noise."""
    keys = {
        "modulation_hz": [10_000_000],
        "signal_e": 3e6,
        "ambient_e": 500.0,
        "read_noise_e": 20.0,
    }
    sim = pictured(repo_dir, (80, 60), **keys)
    found = sim.time_of_flight(0)
    near = found["true_range_m"] < 15.0
    signal = found["offset_e"][near].astype(float)
    amplitude = found["amplitude_e"][near].astype(float)
    deviation = np.sqrt((signal + 20.0**2) / 2.0) / amplitude
    metres = deviation / (2 * np.pi) * 0.5 * LIGHT_M_S / 10e6
    off = (found["range_m"][near] - found["true_range_m"][near]) / metres
    assert near.sum() > 500
    assert abs(off.mean()) < 4 / np.sqrt(near.sum())
    assert off.std() == pytest.approx(1.0, abs=4 * 1 / np.sqrt(2 * near.sum()))


def test_edges_fly(repo_dir):
    """Pixels that see both balls measure neither."""
    found = pictured(repo_dir, (80, 60), samples=16, modulation_hz=[1_000_000]).time_of_flight(0)
    mixed = found["echoes"] == 2
    assert 20 < mixed.sum() < 0.2 * mixed.size
    flying = found["range_m"][mixed]
    between = (flying > 9.0) & (flying < 29.0)
    assert between.mean() > 0.5
    assert np.nanmax(found["true_range_m"][~mixed]) > 30.0


def test_dark_and_full_pixels_have_no_range(repo_dir):
    dim = pictured(repo_dir, min_amplitude_e=1e5).time_of_flight(0)
    assert np.isnan(dim["range_m"][dim["amplitude_e"] < 1e5]).all()
    assert np.isfinite(dim["range_m"][dim["amplitude_e"] >= 1e5]).all()
    full = pictured(repo_dir, full_well_e=1e5).time_of_flight(0)
    assert 0 < full["full"].sum() < full.size
    np.testing.assert_array_equal(np.isnan(full["range_m"]), full["full"] > 0)
    with pytest.raises(ValueError, match="no such section"):
        opened(tree(), repo_dir).time_of_flight(0)
