"""The model of costs: counts of work, costs fitted to them, budgets, samples by a stated error."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import perilune
from perilune.cli import main
from perilune.config.errors import ConfigError, ConfigWarning
from perilune.cost import budget, calibration, model
from perilune.cost.pictures import srgb
from perilune.frame.request import arrays_of, sigmas

SCENE = Path(__file__).parent / "scene.yaml"
SCENES = calibration.SCENES
SMALL = {"camera.width": 96, "camera.height": 72, "render.channels": ["rgb"]}
TINY = SMALL | {"camera.width": 32, "camera.height": 24}


@cache
def opened(**render: Any) -> perilune.Simulation:
    return perilune.open(SCENE, overrides=SMALL | {f"render.{k}": v for k, v in render.items()})


def counted(sim: perilune.Simulation, threads: int, pilot: bool) -> dict[str, int]:
    scene, handles = sim.world(1), sim._mine()
    with handles.lock:
        arrays = arrays_of(scene.config, ["rgb"], {}, handles.pool)
        request = sim._request(scene)
        return handles.renderer_of(scene.config).render(request, arrays, threads, pilot)["work"]


@pytest.mark.parametrize("pilot", [False, True])
def test_counts_do_not_depend_on_threads(pilot: bool) -> None:
    sim = opened()
    assert counted(sim, 1, pilot) == counted(sim, 3, pilot)


def test_a_part_of_the_picture_stands_for_all_of_it() -> None:
    sim = opened().with_overrides({"camera.width": 256, "camera.height": 192})
    whole, part = counted(sim, 2, False), counted(sim, 2, True)
    costs = calibration.of_table()
    expected, true = (model.Expected(work, costs, []).ms for work in (part, whole))
    assert expected == pytest.approx(true, rel=0.25)
    assert part["samples"] == pytest.approx(whole["samples"], rel=0.25)
    assert part["pixels"] == whole["pixels"]
    assert part["samples"] != whole["samples"]  # it is but a part


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**31))
def test_costs_are_found_from_pictures(seed: int) -> None:
    """Costs that differ from the prior by a factor of up to 3, and times with 5 % of noise."""
    rng = np.random.default_rng(seed)
    prior = dict.fromkeys(calibration.of_table().ns, 100.0)
    true = {name: 100.0 * 3.0 ** rng.uniform(-1.0, 1.0) for name in prior}
    pictures = []
    for k in range(80):
        counts = {name: int(10.0 ** rng.uniform(1.0, 6.0)) for name in prior}
        ms = sum(1e-6 * true[name] * counts[name] for name in prior) * rng.normal(1.0, 0.05)
        pictures.append(calibration.Timed(str(k), counts, ms))
    found, ratios = calibration.fit(pictures, prior)
    assert np.mean(np.abs(ratios - 1.0) < 0.3) > 0.9
    errors = [abs(np.log(found[name] / true[name])) for name in prior]
    assert np.median(errors) < 0.25


def test_a_calibration_changes_what_is_told_and_no_frame(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    sim = perilune.open(SCENE, overrides=TINY)
    before, shipped = sim.frame(1)["rgb"].copy(), model.expect(sim, 1)
    plan = sim.plan(1)
    twice = {name: 2.0 * ns for name, ns in calibration.of_table().ns.items()}
    kept = {"ns": twice, "machine": "a slow one", "made": 0.0, "took_s": 1.0, "pictures": []}
    kept["pictures"] = [{"name": "a", "ms": 1.0, "expected_over_measured": 1.1}]
    file = calibration.save(kept)
    assert file == calibration.path() == tmp_path / "perilune" / "costs.json"
    slow = model.expect(sim, 1)
    assert slow.ms == pytest.approx(2.0 * shipped.ms)
    assert slow.counts == shipped.counts
    assert "a slow one" in slow.text
    assert "table that ships" in shipped.text
    np.testing.assert_array_equal(sim.frame(1)["rgb"], before)
    assert sim.plan(1) == plan
    assert main(["calibrate", "--show"]) == 0
    assert "a slow one" in capsys.readouterr().out
    assert main(["calibrate", "--show", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["ns"] == twice
    file.write_text('{"ns": {}}')
    assert main(["plan", str(SCENE)]) == 1
    assert "costs.json" in capsys.readouterr().err
    assert main(["calibrate", "--reset"]) == 0
    assert not file.exists()
    assert main(["calibrate", "--show"]) == 0
    assert "not calibrated" in capsys.readouterr().out


def test_calibrating(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(calibration, "SCENES", ("rendezvous", "no_such_scene"))
    monkeypatch.setattr(calibration, "WIDTH", 24)
    seen: list[tuple[int, int]] = []
    found = calibration.calibrate(perilune.open, lambda done, of: seen.append((done, of)))
    assert seen == [(1, 2), (2, 2)]
    assert len(found["pictures"]) == len(calibration.SETTINGS)
    assert list(found["left_out"]) == ["configs/no_such_scene.yaml"]
    assert "no_such_scene" in found["left_out"]["configs/no_such_scene.yaml"]
    calibration.save(found)
    assert calibration.current().ns == found["ns"]
    assert min(found["ns"].values()) > 0.0


def test_calibrating_nothing_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration, "SCENES", ("no_such_scene",))
    with pytest.raises(calibration.CostsError, match="no_such_scene"):
        calibration.calibrate(perilune.open)


def test_scenes_that_are_timed_ship(repo_dir: Path) -> None:
    assert [name for name in SCENES if not (repo_dir / f"configs/{name}.yaml").is_file()] == []


def test_a_budget_is_met_by_the_least_tolerance() -> None:
    sim = opened(samples=64)
    whole = model.expect(sim, 1, tolerance_dn=0.0).ms
    plan = sim.plan(1, budget_ms=0.4 * whole)
    assert plan.expected_ms is not None
    assert plan.tolerance_dn is not None
    assert plan.expected_ms <= 0.4 * whole
    below = [dn for dn in budget.rungs(0.0) if dn < plan.tolerance_dn]
    assert model.expect(sim, 1, tolerance_dn=below[-1]).ms > 0.4 * whole
    assert f"at a tolerance of {plan.tolerance_dn:g} DN" in plan.text
    assert sim.plan(1, budget_ms=1e9).tolerance_dn == 0.0
    with pytest.raises(ValueError, match=r"1e-06 ms cannot be met.*ms of CPU"):
        sim.plan(1, budget_ms=1e-6)
    with pytest.raises(ValueError, match="budget_ms: must be above 0"):
        sim.plan(1, budget_ms=0.0)
    with pytest.raises(ValueError, match="leave out measure or budget_ms"):
        sim.plan(1, budget_ms=1.0, measure=True)


def test_plan_tells_what_is_expected(capsys: pytest.CaptureFixture[str]) -> None:
    sets = [f"--set={key}={value}" for key, value in TINY.items() if key != "render.channels"]
    assert main(["plan", str(SCENE), *sets, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["expected_ms"] == pytest.approx(sum(told["expected_parts_ms"].values()))
    assert main(["plan", str(SCENE), *sets, "--budget-ms", "1e-6"]) == 1
    assert "cannot be met" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["plan", str(SCENE), "--budget-ms", "nan"])


def luminance_dn(radiance: np.ndarray[Any, Any], white: float) -> np.ndarray[Any, Any]:
    return 255.0 * srgb(radiance.astype(np.float64) @ [0.2126, 0.7152, 0.0722] / white)


@pytest.mark.filterwarnings("ignore::perilune.config.errors.ConfigWarning")
def test_a_stated_error_is_reached_within_its_confidence() -> None:
    fixed = TINY | {"camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 300.0}}
    exact = fixed | {"render.tolerance_dn": 0.0}
    sim = perilune.open(SCENE, overrides=exact | {"render.samples": 4096})
    truth = luminance_dn(sim.with_noise(1).frame(1, ["radiance"])["radiance"], 300.0)
    for target in (2.0, 8.0):
        aimed = perilune.open(
            SCENE,
            overrides=exact | {"render.samples": 512, "render.target_error_dn": target},
        )
        misses, missed = [], []
        for noise in range(4):
            sample = aimed.with_noise(10 + noise).frame(1, ["radiance"])
            off = np.abs(luminance_dn(sample["radiance"], 300.0) - truth)
            misses.append(np.mean(off > target))
            missed.append(sample.meta["target_missed"])
        # Pixels that `samples` did not bring to it are told, and need not be within it.
        assert np.mean(misses) <= 0.05 + np.mean(missed), (target, misses, missed)


def test_what_a_target_takes_and_leaves() -> None:
    coarse, fine = (opened(samples=256, target_error_dn=dn) for dn in (16.0, 2.0))
    least, more = (counted(sim, 2, False)["samples"] for sim in (coarse, fine))
    all_samples = counted(opened(samples=256, tolerance_dn=0.0), 2, False)["samples"]
    assert least < more < all_samples
    np.testing.assert_array_equal(coarse.frame(1, threads=1)["rgb"], coarse.frame(1)["rgb"])
    depth = [sim.frame(1, ["depth"])["depth"] for sim in (coarse, fine)]
    np.testing.assert_array_equal(*depth)
    assert sigmas(0.95) == pytest.approx(1.959964, abs=1e-6)


def test_what_is_not_reached_is_told() -> None:
    few = {"render.samples": 8, "render.target_error_dn": 0.01}
    with pytest.warns(ConfigWarning, match=r"target_error_dn: .* % of the pixels are not within"):
        share = perilune.open(SCENE, overrides=TINY | few).frame(1).meta["target_missed"]
    assert 0.0 < share <= 1.0
    lens = {"camera.lens": {"aperture_mm": 20.0, "focus_distance_m": 5.0}}
    with pytest.warns(ConfigWarning, match="is not used behind a lens with an aperture"):
        meta = perilune.open(SCENE, overrides=TINY | few | lens).frame(1).meta
    assert np.isnan(meta["target_missed"])
    assert "target_missed" not in perilune.open(SCENE, overrides=TINY).frame(1).meta


def test_a_time_budget_keeps_labels_and_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    names = ["rgb", "depth", "instance"]
    plain = opened(samples=64)
    ms = 0.5 * model.expect(plain, 1).ms
    sim = opened(samples=64, time_budget_ms=ms)
    free, kept = plain.frame(1, names), sim.frame(1, names, threads=1)
    assert kept.meta["expected_ms"] <= ms
    assert kept.meta["budget_tolerance_dn"] > 1.0
    assert np.any(kept["rgb"] != free["rgb"])
    for name in names[1:]:
        np.testing.assert_array_equal(kept[name], free[name])
    # Another machine's costs, and other threads, change no bit.
    costs = {name: 9.0 * ns for name, ns in calibration.of_table().ns.items()}
    calibration.save({"ns": costs, "machine": "slow", "made": 0.0})
    np.testing.assert_array_equal(sim.frame(1, ["rgb"], threads=3)["rgb"], kept["rgb"])
    assert "expected_ms" not in sim.frame(1, ["depth"]).meta
    generous = opened(samples=64, time_budget_ms=1e9).frame(1, ["rgb"])
    np.testing.assert_array_equal(generous["rgb"], free["rgb"])


def test_a_budget_that_cannot_be_met_is_told() -> None:
    with pytest.warns(ConfigWarning, match=r"time_budget_ms: 1e-06 ms cannot be met.* ms"):
        meta = perilune.open(SCENE, overrides=TINY | {"render.time_budget_ms": 1e-6}).frame(1).meta
    assert meta["budget_tolerance_dn"] == budget.MOST_DN


@pytest.mark.parametrize(
    ("render", "message"),
    [
        ({"time_budget_ms": 0.0}, "time_budget_ms"),
        ({"time_budget_ms": 9.0, "quality": "reference"}, "leaves out none"),
        ({"target_confidence": 0.9}, "target_confidence.*is not used without target_error_dn"),
        ({"target_error_dn": 0.0}, "target_error_dn"),
        ({"target_error_dn": 1.0, "target_confidence": 1.0}, "target_confidence"),
        ({"target_error_dn": 1.0, "force_on": ["antialiasing"]}, "takes all of them"),
    ],
)
def test_refused(render: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        perilune.open(SCENE, overrides={f"render.{key}": value for key, value in render.items()})
