"""`perilune cost`: errors and times of knobs, advice that is kept, studies that go on."""

from __future__ import annotations

import csv
import dataclasses
import io
import itertools
import json
import math

import numpy as np
import pytest
import yaml

import perilune
from perilune.cost import combine, knobs, pictures, study
from perilune.cost.knobs import Knob, Rung
from perilune.cost.report import Point, Report

SMALL = {"camera.width": 24, "camera.height": 18, "time.step_s": 60.0}
TARGET_DN = 8.0


@pytest.fixture(scope="module")
def sim(repo_dir):
    return perilune.open(repo_dir / "tests/python/scene.yaml", overrides=SMALL)


@pytest.fixture(scope="module")
def report(sim) -> Report:
    return sim.cost(0, [TARGET_DN], quick=True, reference_samples=256, threads=1)


def rows(report, knob):
    return [point for point in report.points if point.knob == knob]


def test_noise_falls_with_samples(report):
    """At most as the root of their number, 8 from 1 to 64; the reference's own error is small."""
    first, *_, last = rows(report, "samples")
    assert (first.rung, last.rung) == ("1", "64")
    assert 2.0 < first.rmse_dn / last.rmse_dn < 10.0
    assert report.reference_dn < last.rmse_dn


def test_exact_settings_err_nothing_but_noise(report):
    """Their pictures are those that errors are measured against, to the bit."""
    of_image = [name for name in dict.fromkeys(p.knob for p in report.points) if name in LEFT_OUT]
    assert of_image
    for name in of_image:
        assert rows(report, name)[-1].rmse_dn == rows(report, name)[-1].p999_dn == 0.0, name
    assert rows(report, "cast_shadows")[0].rmse_dn > 1.0


LEFT_OUT = {"bounces", "sun", "cast_shadows", "planetshine", "surface_maps"}


def test_orbits_err_in_metres(report):
    """In a day J2 turns the node of this orbit by 1 degree, some 100 km; higher zonals are a
    thousandth of it, and the least tolerance is exact."""
    kepler, j2, loose, exact = (point.orbit_m for point in rows(report, "orbit, sat"))
    assert 5e4 < kepler < 1e6
    assert j2 < 0.2 * kepler
    assert exact == 0.0 < loose < 0.1 * j2


def test_the_advice_keeps_its_target(report, sim):
    """The block as it is printed, opened, against a reference of other random numbers."""
    (advice,) = report.advice
    assert advice.met
    assert advice.setting.rmse_dn <= TARGET_DN < report.own.rmse_dn
    block = yaml.safe_load(advice.setting.block)
    assert set(block) == {"render"}
    advised = sim.with_overrides({f"render.{key}": value for key, value in block["render"].items()})
    exact = {"render.samples": 1024, "render.tolerance_dn": 0.0, "render.max_bounces": 8}
    shots = []
    camera = pictures.Camera(sim, 0, 1)
    truth = camera.shoot(sim.with_overrides(exact).with_noise(77)).dn
    for noise in range(4):
        shots.append(camera.shoot(advised.with_noise(100 + noise)).dn - truth)
    assert np.sqrt(np.mean(np.square(shots))) < 1.3 * TARGET_DN  # four frames: a few bright pixels


def test_the_front_holds_the_best(report):
    times = [setting.cpu_ms for _, setting in report.front]
    errors = [setting.rmse_dn for _, setting in report.front]
    assert times == sorted(times)
    assert errors == sorted(errors, reverse=True)
    everything = [report.own, *(s for advice in report.advice for s in advice.tried)]
    for setting in everything:
        assert any(
            s.cpu_ms <= setting.cpu_ms and s.rmse_dn <= setting.rmse_dn for _, s in report.front
        )


def test_text_csv_and_json_say_the_same(report):
    table = list(csv.DictReader(io.StringIO(report.csv)))
    tree = json.loads(report.json)
    assert len(table) == len(report.points) + 2
    for point, row, node in zip(report.points, table, tree["points"], strict=False):
        assert (
            (row["knob"], row["rung"]) == (point.knob, point.rung) == (node["knob"], node["rung"])
        )
        for name in ("rmse_dn", "orbit_m", "cpu_ms"):
            value = getattr(point, name)
            assert (row[name] == "") == (node[name] is None) == math.isnan(value)
            if not math.isnan(value):
                assert float(row[name]) == pytest.approx(value, rel=1e-5)
                assert node[name] == value
    assert "orbit, sat" in report.text
    assert f"# for {TARGET_DN:g} DN: measured" in report.text
    assert "cast_shadows" in report._repr_html_()
    assert tree["advice"][0]["block"] == report.advice[0].setting.block


def test_the_figure_shows_every_knob(report):
    left, right = report.figure().axes
    shown = {text.get_text() for text in left.get_legend().get_texts()}
    shown |= {text.get_text() for text in right.get_yticklabels()}
    knobs_of_image = {p.knob for p in report.points if not math.isnan(p.rmse_dn)}
    assert knobs_of_image < shown
    assert "combined: front" in shown
    assert left.get_xscale() == left.get_yscale() == "log"


class StopError(Exception):
    pass


def test_a_study_that_was_stopped_goes_on(sim, tmp_path, monkeypatch):
    monkeypatch.setattr(knobs, "KNOBS", knobs.KNOBS[:3])
    monkeypatch.setattr(knobs, "rest", lambda scene: iter(()))
    frames = []
    shoot = pictures.Camera.shoot
    monkeypatch.setattr(
        pictures.Camera, "shoot", lambda self, *a: frames.append(1) or shoot(self, *a)
    )

    def study_of(folder, progress=None):
        frames.clear()
        found = sim.cost(0, [TARGET_DN], quick=True, reference_samples=16, threads=1,
                         folder=folder, progress=progress)  # fmt: skip
        return found, len(frames)

    whole, all_frames = study_of(None)

    def stop(done, total):
        if done == 6:
            raise StopError

    with pytest.raises(StopError):
        study_of(tmp_path, stop)
    with (tmp_path / "measured.jsonl").open("a") as file:
        file.write('{"stamp": "cut')  # as a kill leaves it
    before = len(frames)
    done = []
    found, _ = study_of(tmp_path, lambda *progress: done.append(progress))
    assert 0 < before < all_frames
    # Choices follow times, so that other settings may be tried; the rest is not measured again.
    ladder = [(p.knob, p.rung, p.rmse_dn, p.p999_dn, p.raw_dn) for p in whole.points]
    assert [(p.knob, p.rung, p.rmse_dn, p.p999_dn, p.raw_dn) for p in found.points] == ladder
    assert [n for n, _ in done] == list(range(1, len(done) + 1))
    assert done[-1][0] <= done[-1][1]
    assert study_of(tmp_path)[1] == 0


def test_a_knob_is_one_line(sim, monkeypatch):
    line = knobs.Row("volume steps of mine", "an example", knobs.values("volume_steps", 1, 1024))
    monkeypatch.setattr(knobs, "KNOBS", (*knobs.KNOBS, line))
    found = knobs.knobs_of(knobs.Scene(sim.config, frozenset({"texture_filter"})))
    (mine,) = (knob for knob in found if knob.name == line.name)
    assert [rung.changes for rung in mine.rungs] == [
        {"render.volume_steps": steps} for steps in (1, 32, 1024)
    ]


def test_every_effect_has_a_knob_or_is_chance(sim):
    """Whatever a scene has, each of its effects is in a rung, or is a count that a knob turns."""
    everything = frozenset(effect["name"] for effect in perilune._core.EFFECTS)
    found = knobs.knobs_of(knobs.Scene(sim.config, everything))
    off = {name for knob in found for rung in knob.rungs for name in rung.off}
    turned = {"bounces", "texture_filter", "volumes", "antialiasing", "terrain"}
    assert off | turned | knobs.OF_CHANCE == everything
    assert not off & (turned | knobs.OF_CHANCE)


def test_other_noise_moves_no_label(sim):
    """Nor what drivers draw; 0 is the frame itself, to the bit."""
    moved = sim.with_overrides({"camera.fov_deg": {"uniform": [30.0, 50.0]}})
    one, two = moved.frame(3), moved.with_noise(5).frame(3)
    assert one.meta["drivers"] == two.meta["drivers"]
    assert np.array_equal(one["depth"], two["depth"])
    assert not np.array_equal(one["rgb"], two["rgb"])
    assert np.array_equal(one["rgb"], moved.with_noise(0).frame(3)["rgb"])


def test_grounds_are_compared_along_the_normal():
    """A plane that is moved by 2 m, seen from 100 m by pixels of 0.01 rad: 2 pixels, however steep;
    one that is turned by 3 degrees errs as much."""
    shape = (10, 10)
    normal = np.broadcast_to([0.6, 0.0, 0.8], (*shape, 3))
    true = {
        "position": np.random.default_rng(1).normal(size=(*shape, 3)),
        "geometric_normal": normal,
        "slope": np.full(shape, 0.3),
        "depth": np.full(shape, 100.0),
        "instance": np.ones(shape),
        "pixel_rad": np.asarray(0.01),
    }
    along = np.cross(normal, [0.0, 1.0, 0.0])
    moved = {**true, "position": true["position"] + 2.0 * normal + 5.0 * along}
    moved["slope"] = true["slope"] + math.radians(3.0)
    assert pictures.ground_errors(moved, true) == pytest.approx((2.0, 3.0))
    elsewhere = {**true, "instance": np.zeros(shape)}
    assert all(math.isnan(error) for error in pictures.ground_errors(elsewhere, true))


def ladder(name, times, errors, noisy=False):
    rungs = [Rung(f"{k}", {f"render.{name}": k}) for k in range(len(times))]
    points = [
        Point(name, r.name, dict(r.changes), [], t, t, t, 0.0, rmse_dn=e, raw_dn=e)
        for r, t, e in zip(rungs, times, errors, strict=True)
    ]
    return Knob(name, "", rungs, noisy), points


def test_combinations_beside_a_search_of_all():
    """Greedy choices keep the target, and take at most a tenth more than the best of all."""
    draw = np.random.default_rng(3)
    for _ in range(20):
        made = [ladder("samples", [1.0, 2.0, 4.0, 8.0], [8.0, 5.7, 4.0, 2.8], noisy=True)]
        for k in range(3):
            times = np.sort(draw.uniform(1.0, 3.0, 3))
            made.append(ladder(f"k{k}", times.tolist(), [*-np.sort(-draw.uniform(0, 4, 2)), 0.0]))
        all_knobs = [knob for knob, _ in made]
        points = {knob.name: found for knob, found in made}
        found = combine.cheapest(all_knobs, points, 5.0)

        def judged(rungs, made=made):
            at = [next(p for p in points if p.rung == rungs[knob.name].name)
                  for knob, points in made]  # fmt: skip
            return math.sqrt(sum(p.rmse_dn**2 for p in at)), math.prod(p.cpu_ms for p in at)

        error, time = judged(found)
        assert error <= 5.0
        every = itertools.product(*(knob.rungs for knob in all_knobs))
        names = [knob.name for knob in all_knobs]
        best = min(
            t for e, t in (judged(dict(zip(names, r, strict=True))) for r in every) if e <= 5
        )
        assert time <= 1.5 * best


def test_more_samples_than_were_measured():
    knob, points = ladder("samples", [1.0, 2.0], [8.0, 4.0], noisy=True)
    points = [dataclasses.replace(p, changes={"render.samples": 32 * (k + 1)})
              for k, p in enumerate(points)]  # fmt: skip
    longer, rows = combine.more_samples(knob, points, 300)
    assert [rung.name for rung in longer.rungs[2:]] == ["128", "256"]
    assert [p.cpu_ms for p in rows[2:]] == [4.0, 8.0]
    assert [p.raw_dn for p in rows[2:]] == pytest.approx([4.0 / math.sqrt(2.0), 2.0])


def test_orbits_that_a_scene_cannot_have_are_named(sim):
    """No gravity field is known of a body of one's own: integrated orbits are left out by name."""
    own = {"kind": "ellipsoid", "radii_km": 6378.0, "gm_km3_s2": 4e5, "albedo": 0.3}
    fields = {f"bodies.earth.{key}": value for key, value in own.items()}
    work = study.Study(sim.with_overrides(fields), 0, study.Options(True, 2, 1))
    assert "orbit, sat" not in {knob.name for knob in work.knobs}
    assert len(work.notes) == 3
    assert all("orbit, sat: no " in note for note in work.notes)


@pytest.mark.parametrize("target", [0.0, -1.0, math.nan, math.inf])
def test_targets_that_are_none(sim, target):
    with pytest.raises(ValueError, match="targets: must be above 0"):
        sim.cost(0, [target])


def test_ground_knobs_err_in_pixels_and_degrees(repo_dir):
    """A coarser mesh is farther from the finest; leaving craters out changes slopes."""
    small = {"camera.width": 16, "camera.height": 12}
    rover = perilune.open(repo_dir / "configs/lunar_rover.yaml", overrides=small)
    work = study.Study(rover, 0, study.Options(True, 2, 1))
    names = [knob.name for knob in work.knobs]
    assert {"ground mesh, moon", "craters, moon", "rocks, moon"} <= set(names)
    camera = work.camera
    true = camera.ground_of({"bodies.moon.terrain.cells_per_pixel": 2.0})
    errors = [
        pictures.ground_errors(camera.ground_of(changes), true)
        for changes in (
            {"bodies.moon.terrain.cells_per_pixel": 0.125},
            {"bodies.moon.terrain.cells_per_pixel": 1.0},
            {"bodies.moon.terrain.cells_per_pixel": 2.0},
        )
    ]
    assert errors[0][0] > errors[1][0] > errors[2][0] == 0.0
    assert errors[0][1] > errors[2][1] == 0.0
