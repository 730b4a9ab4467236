"""Plans: how the tolerance is shared, what rows say, and what measuring them finds."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

import perilune
from perilune.cost.rows import Rows
from perilune.frame.plan_rows import applies, state, totals

SCENE = Path(__file__).parent / "scene.yaml"
SMALL = {"camera.width": 32, "camera.height": 24}
CONFIGS = Path(__file__).resolve().parents[2] / "configs"
NAMES = ("demo", "fictional", "articulated")


@cache
def opened(name: str) -> perilune.Simulation:
    return perilune.open(CONFIGS / f"{name}.yaml", overrides=SMALL)


@settings(max_examples=20, deadline=None)
@example("demo", 0.0, 0)
@given(
    st.sampled_from(NAMES),
    st.floats(0.0, 300.0) | st.floats(-9.0, 2.4).map(lambda x: 10.0**x),
    st.integers(0, 3),
)
def test_the_tolerance_is_shared(name: str, tolerance: float, index: int) -> None:
    rows = opened(name).with_overrides({"render.tolerance_dn": tolerance}).plan(index)
    spent = sum(row["spent_dn"] for row in rows)
    assert spent <= tolerance * (1 + 1e-12)
    left = tolerance - spent
    for row in rows:
        assert (row["value"] > 0) is row["on"]
        assert row["value"] <= row["ceiling"]
        if row["value"] < row["ceiling"]:
            assert row["spent_dn"] == row["residual_dn"] <= tolerance
        # Nothing that is left would pay for leaving it out.
        assert not row["on"] or row["bound_dn"] > left or math.isclose(row["bound_dn"], left)


def test_a_row_pays_with_what_others_left() -> None:
    """Two effects whose bounds together exceed a tolerance that each alone would meet."""
    sensor = {"prnu": 0.01, "read_noise_e": 5.0, "dark_current_e_s": 10.0}
    channels = {"camera.sensor": sensor, "render.channels": ["sensor_rgb"]}
    sim = perilune.open(SCENE, overrides=SMALL | channels)
    bounds = sorted(
        row["bound_dn"] for row in sim.plan(1) if applies(row) and 0.0 < row["bound_dn"] < 255.0
    )
    assert len(bounds) >= 2, "the scene has no two effects with bounds"
    tolerance = 1.001 * bounds[1]
    rows = sim.with_overrides({"render.tolerance_dn": tolerance}).plan(1)
    within = [row for row in rows if applies(row) and 0.0 < row["bound_dn"] <= tolerance]
    assert len(within) >= 2
    kept = [row for row in within if row["on"]]
    assert kept
    assert any("is left" in row["reason"] for row in kept)


def test_an_exposure_in_motion_takes_what_its_worst_instant_does() -> None:
    """The plan of moving frames is the largest of those of several instants, row by row."""
    moving: dict[str, Any] = {"camera.exposure_time_s": 2.0, "render.tolerance_dn": 245.0}
    moving["render.force_on"] = ["motion_blur"]
    rows = perilune.open(SCENE, overrides=SMALL | moving).plan(1)
    assert next(row["on"] for row in rows if row["name"] == "motion_blur")
    assert any(row["spent_dn"] > 0.0 for row in rows)
    for row in rows:
        assert row["spent_dn"] in (0.0, row["residual_dn"])
        assert row["spent_dn"] <= 245.0
        if applies(row) and row["value"] < row["ceiling"]:
            assert row["spent_dn"] == row["residual_dn"]


def test_states_and_totals() -> None:
    def row(on: bool, value: int, ceiling: int, spent: float = 0.0) -> dict[str, Any]:
        return {"on": on, "value": value, "ceiling": ceiling, "spent_dn": spent, "cost_ms": 2.0}

    rows = [row(True, 1, 1), row(True, 6, 16, 0.25), row(False, 0, 3, 0.5), row(False, 0, 0)]
    assert [state(each) for each in rows] == ["on", "6 of 16", "off", "off"]
    assert [applies(each) for each in rows] == [True, True, True, False]
    sums = totals(rows)
    assert (sums.kept, sums.reduced, sums.left_out, sums.absent) == (1, 1, 1, 1)
    assert (sums.spent_dn, sums.cost_ms) == (0.75, 8.0)
    assert "1 effects on, 1 reduced, 1 left out, 1 not in the scene" in sums.text
    assert "at most 0.75 DN" in sums.text


@pytest.fixture(scope="module")
def measured() -> tuple[perilune.Simulation, Any]:
    sim = perilune.open(SCENE, overrides=SMALL | {"render.samples": 256})
    calls: list[tuple[int, int]] = []
    rows = sim.plan(1, measure=True, threads=1, progress=lambda *at: calls.append(at))
    there = [row for row in rows if "measured_dn" in row]
    assert calls == [(k + 1, len(there)) for k in range(len(there))]
    return sim, rows


def test_measuring_adds_to_the_plan(measured: tuple[perilune.Simulation, Any]) -> None:
    sim, rows = measured
    for row, plain in zip(rows, sim.plan(1), strict=True):
        assert {key: row[key] for key in plain} == plain
        assert ("measured_ms" in row) is applies(row)
        if applies(row) and row["name"] != "antialiasing":  # its row has noise
            assert row["measured_p999_dn"] <= row["bound_dn"] + 1e-9 or row["bound_dn"] >= 255.0
    assert rows.spread_ms >= 0.0
    assert "measured twice" in rows.text
    assert sim.plan(1).spread_ms is None
    page = rows._repr_html_()
    assert "changes" in page
    assert "rgba(46,160,67" in page  # what is on is green


def test_what_effects_change_is_what_frames_of_many_samples_show(
    measured: tuple[perilune.Simulation, Any],
) -> None:
    """Beside pictures of 1 024 samples at a tolerance of 0, of the same samples."""
    sim, rows = measured
    large = [row for row in rows if row["on"] and row.get("measured_dn", 0.0) > 0.5]
    chosen = [row for row in large if row["name"] != "antialiasing"]
    assert {"cast_shadows", "bounces"} <= {row["name"] for row in chosen}
    white = float(sim.frame(1, ["rgb"]).meta["white_radiance"] or 0.0)
    exact = {"render.tolerance_dn": 0.0, "render.samples": 1024}
    exact["camera.exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": white}

    def picture(off: list[str]) -> Any:
        made = sim.with_overrides(exact | {"render.force_off": off}).with_noise(1)
        light = np.clip(made.frame(1, ["radiance"])["radiance"] / white, 0.0, 1.0)
        return 255 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)

    whole = picture([])
    for row in chosen:
        off = picture([row["name"]]) - whole
        assert row["measured_dn"] == pytest.approx(np.sqrt(np.mean(off**2)), rel=0.2)


@pytest.mark.parametrize(
    "exposure",
    [{"gains": [1.0, 4.0], "max_ms": 0.2}, {"times_ms": [0.1, 0.3, 0.9]}, {"mode": "fixed"}],
)
def test_pictures_keep_the_exposure_of_the_frame(exposure: dict[str, Any]) -> None:
    """Leaving out what dims the frame must not be told as what a longer exposure changes."""
    changes = {"camera.sensor": {"exposure": exposure}, "render.channels": ["sensor_rgb"]}
    shutter = {"camera.exposure_time_s": 1e-3 * ("mode" in exposure), "render.samples": 2}
    sim = perilune.open(SCENE, overrides=SMALL | changes | shutter)
    fixed = sim.with_overrides(Rows(sim, 1, 1).exposed)
    own, again = (each.frame(1, ["sensor_rgb"]) for each in (sim, fixed))
    assert own.meta["exposure_s"] == pytest.approx(again.meta["exposure_s"], rel=1e-12)
    assert own.meta["gain_e_dn"] == again.meta["gain_e_dn"]
    darker = fixed.with_overrides({"render.force_off": ["bounces", "planetshine"]})
    dim = darker.frame(1, ["sensor_rgb"]).meta
    assert dim["exposure_s"] == pytest.approx(own.meta["exposure_s"], rel=1e-12)


@pytest.mark.parametrize(
    "render",
    [
        {"quality": "reference", "samples": 2},
        {"force_on": ["soft_sun"], "force_off": ["bounces"], "samples": 2},
        {"tolerance_dn": 255.0, "samples": 2},
    ],
)
@pytest.mark.filterwarnings("error::perilune.config.errors.ConfigWarning")
def test_measuring_under_all_settings(render: dict[str, Any]) -> None:
    """Without a word on the exposure that pictures have in place of the scene's own."""
    changes = {"camera.width": 8, "camera.height": 6, "camera.exposure.key": 0.7} | {
        f"render.{k}": v for k, v in render.items()
    }
    rows = perilune.open(SCENE, overrides=changes).plan(1, measure=True, threads=1)
    assert all(("measured_ms" in row) is applies(row) for row in rows)
    assert all(math.isfinite(row["measured_dn"]) for row in rows if applies(row))


def test_what_effects_change_is_below_their_bounds() -> None:
    """Drawn frames and tolerances; benchmarks/bounds.py has all configurations and many scenes, and
    the tests of rows in C every pixel."""
    rng = np.random.default_rng(2)
    few = {"camera.width": 12, "camera.height": 9, "render.samples": 2}
    drawn = {"render.tolerance_dn": float(10.0 ** rng.uniform(-1.0, 1.5))}
    sim = perilune.open(SCENE, overrides=few | drawn)
    rows = sim.plan(int(rng.integers(20)), measure=True, threads=1)
    compared = [row for row in rows if "measured_dn" in row and row["name"] != "antialiasing"]
    assert len(compared) > 5
    for row in compared:
        assert row["measured_dn"] <= row["bound_dn"] + 1e-9, row
