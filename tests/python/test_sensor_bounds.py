"""What a frame changes when a row of the sensor is left out, against the bound that its plan says.

The stages by themselves are in tests/c/test_sensor_effects.c; here the light is rendered, so that
the bounds stand on what the plan knows of the scene: a rock by Hapke's law at and off opposition,
or by Lambert's, dim, well exposed, overexposed, and its night side. Random rows are bounded by a
quantile: normal numbers within 6 standard deviations, counts within what one in 1e9 passes. As
there, rows other than `shot_noise` and `blooming` are compared without these two, which draw other
numbers and let other pixels bloom when the charge before them changes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import perilune

NONLINEAR = ("blooming", "shot_noise")
BITS = 16
SENSOR: dict[str, Any] = {"exposure": {"mode": "fixed"}, "bits": BITS, "black_level_dn": 500.0}
SCENE: dict[str, Any] = {
    "version": 1,
    "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60},
    "root": "rock",
    "bodies": {"rock": {"kind": "ellipsoid", "radii_km": 10.0, "gm_km3_s2": 0.1, "albedo": 0.2}},
    "camera": {
        "width": 40,
        "height": 28,
        "fov_deg": 30.0,
        "trajectory": {"kind": "fixed", "target": "rock", "position_m": [50e3, 0.0, 0.0]},
    },
    "render": {"samples": 2, "max_bounces": 1, "tolerance_dn": 0.0},
}
SUN = {"opposition": [1.0, 0.0, 0.0], "aslant": [1.0, 1.0, 0.2], "night": [-1.0, 0.0, 0.0]}


ROWS = ("vignetting", "point_spread", "fixed_pattern", "smear", "dark_current", "defects",
        "shot_noise", "cosmic_rays", "blooming", "read_noise")  # fmt: skip


def frame(changes: dict[str, Any], off: set[str]) -> perilune.Sample:
    sim = perilune.open(SCENE, overrides=changes | {"render.force_off": sorted(off)})
    return sim.frame(0, channels=["sensor_rgb"], threads=1)


def fraction(most: float) -> Any:
    return st.just(0.0) | st.floats(1e-4, most)


SENSORS = st.fixed_dictionaries(
    {
        "mosaic": st.sampled_from(["mono", "rggb", "gbrg"]),
        "quantum_efficiency": st.tuples(*[st.floats(0.1, 1.0)] * 3).map(list),
        "f_number": st.floats(1.0, 16.0),
        "vignetting": fraction(8.0),
        "point_spread": st.fixed_dictionaries(
            {"core": st.sampled_from(["point", "airy"]), "wings": fraction(0.5)}
        )
        | st.fixed_dictionaries({"sigma_px": st.floats(0.2, 5.0), "wings": fraction(0.5)}),
        "prnu": fraction(0.1),
        "dark_current_e_s": fraction(1e4),
        "hot_pixels": fraction(0.1),
        "dead_pixels": fraction(0.02),
        "shift_us": fraction(100.0),
        "drain": st.floats(0.0, 1.0),
        "cosmic_rays": st.fixed_dictionaries({"flux_cm2_s": fraction(1e5)}),
        "read_noise_e": fraction(100.0),
        "column_noise_e": fraction(100.0),
        "full_well_e": st.floats(1e3, 1e5),
    }
)


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    SENSORS,
    st.sampled_from(sorted(SUN)),
    st.sampled_from(["hapke", "lambert"]),
    st.sampled_from([1e-7, 1e-5, 1e-3, 1.0]),
)
def test_rows_stay_below_their_bounds(
    sensor: dict[str, Any], sun: str, law: str, exposure_s: float
) -> None:
    gain = sensor["full_well_e"] / (2**BITS - 1 - SENSOR["black_level_dn"])
    changes = {
        "camera.sensor": SENSOR | sensor | {"gain_e_dn": gain},
        "camera.exposure_time_s": exposure_s,
        "sun.direction": SUN[sun],
        "bodies.rock.reflectance": law,
    }
    full = {others: frame(changes, set(others)) for others in (("blooming",), NONLINEAR, ())}
    bounds = {row["name"]: row["bound_dn"] for row in full[()].plan}
    for name in ROWS:
        others = {"blooming": (), "shot_noise": ("blooming",)}.get(name, NONLINEAR)
        less = frame(changes, {*others, name})["sensor_rgb"].astype(int)
        change = np.abs(full[others]["sensor_rgb"] - less).max()
        if bounds[name] == 0.0:
            assert change == 0, name
        # Both are rounded to 8 bits, and before to 16, of which a step makes 0.1 DN at most, here.
        assert change <= bounds[name] + 1.1, name


@pytest.mark.parametrize("law", ["hapke", "lambert"])
def test_bounds_say_something(law: str) -> None:
    """In plain scenes they hold, with room of a factor of ten at most: beside the picture itself,
    of up to 141 DN, that tells a row that matters from one that does not."""
    sensor = SENSOR | {"mosaic": "mono", "prnu": 1e-3, "read_noise_e": 2.0, "shift_us": 0.01}
    changes = {"camera.sensor": sensor, "camera.exposure_time_s": 1e-4,
               "sun.direction": SUN["aslant"], "bodies.rock.reflectance": law}  # fmt: skip
    full = frame(changes, set(NONLINEAR))
    bounds = {row["name"]: row["bound_dn"] for row in full.plan}
    for name in ("vignetting", "fixed_pattern", "dark_current", "smear", "read_noise"):
        less = frame(changes, {*NONLINEAR, name})["sensor_rgb"].astype(int)
        change = float(np.abs(full["sensor_rgb"] - less).max())
        assert change <= bounds[name] + 1.1, name
        assert 0.0 < bounds[name] < 10.0 * max(1.0, change), name
