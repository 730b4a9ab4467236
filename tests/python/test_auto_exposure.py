"""Automatic exposure of the sensor: metering, windows, steps of time and gain, and its lag."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import perilune
from perilune.base.timeline import Timeline
from perilune.config import ConfigError
from perilune.document.loader import read_tree

QUIET = {"read_noise_e": 0.0, "prnu": 0.0, "dark_current_e_s": 0.0, "mosaic": "mono", "bits": 16,
         "gain_e_dn": 0.5, "vignetting": 0.0, "point_spread": {"core": "point"}}  # fmt: skip


@pytest.fixture(scope="module")
def tree(request):
    """The small scene, its camera close over the sunlit Earth."""
    root = request.config.rootpath
    tree = read_tree(root / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(root / "assets/models/smallsat.glb")
    tree["camera"]["trajectory"] = {"kind": "orbit_object", "target": "earth", "distance_m": 7e6}
    return tree


def opened(tree, exposure, sensor=None, **overrides):
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = {**QUIET, **(sensor or {}), "exposure": exposure}
    return perilune.open(tree, overrides=overrides)


def white_parts(sample, sim):
    """What the pixels have of white, which is the full well, or where the digits end."""
    sensor = sim.config.camera.sensor
    return (sample["raw"] - 64.0) * 0.5 / min(sensor.full_well_e, (65535 - 64.0) * 0.5)


def test_the_mean_is_brought_to_the_key(tree):
    sim = opened(tree, {"metering": "mean", "key": 0.3})
    assert white_parts(sim.frame(0, ["raw"]), sim).mean() == pytest.approx(0.3, rel=0.05)


def test_a_body_that_glows_is_metered_as_it_is_seen(tree):
    """It is convex, and so gives no light to itself."""
    tree = copy.deepcopy(tree)
    tree["bodies"]["earth"]["emission_w_m2_sr"] = [100.0, 100.0, 100.0]
    sim = opened(tree, {"metering": "mean", "key": 0.3})
    assert white_parts(sim.frame(0, ["raw"]), sim).mean() == pytest.approx(0.3, rel=0.01)


def test_the_window_is_metered(tree):
    """Of a lens that is dim at its border, the lower left corner and the middle."""
    corner = {"metering": "mean", "key": 0.3, "window": [0.0, 0.75, 0.25, 1.0]}
    sim = opened(tree, corner)
    parts = white_parts(sim.frame(0, ["raw"]), sim)
    assert parts[24:, :12].mean() == pytest.approx(0.3, rel=0.1)
    other = opened(tree, {**corner, "window": [0.5, 0.0, 1.0, 1.0]})
    parts = white_parts(other.frame(0, ["raw"]), other)
    assert parts[:, 24:].mean() == pytest.approx(0.3, rel=0.1)


def test_no_more_pixels_are_overexposed_than_may_be(tree):
    full = [
        np.mean(white_parts(sim.frame(0, ["raw"]), sim) > 0.999)
        for sim in (
            opened(tree, {"percentile": 50.0, "key": 1.0, "saturated": part})
            for part in (1.0, 0.2, 0.0)
        )
    ]
    assert full[0] > 0.4
    assert full[1] == pytest.approx(0.2, abs=0.03)
    assert full[2] < 0.06  # the small image has few samples


def test_times_are_those_of_the_camera(tree):
    free = opened(tree, {}).frame(0, ["raw"]).meta["exposure_s"]
    times = [free * 1e3 * part for part in (0.1, 0.6, 0.97, 1.2)]
    given = opened(tree, {"times_ms": times, "min_ms": 1e-6}).frame(0, ["raw"]).meta
    assert given["exposure_s"] == pytest.approx(0.97 * free, rel=1e-12)
    longest = opened(tree, {"times_ms": times, "min_ms": 1e-6, "max_ms": times[2] * 0.9})
    assert longest.frame(0, ["raw"]).meta["exposure_s"] == pytest.approx(0.6 * free, rel=1e-12)


def test_gain_rises_where_the_longest_time_is_too_short(tree):
    digits = {"full_well_e": 1e6}  # the digits end long before the well
    free = opened(tree, {"min_ms": 1e-6}, digits).frame(0, ["raw"]).meta
    limit = {"min_ms": 1e-6, "max_ms": free["exposure_s"] * 1e3 / 3.0, "gains": [1.0, 2.0, 4.0]}
    meta = opened(tree, limit, digits).frame(0, ["raw"]).meta
    assert free["gain_e_dn"] == 0.5
    assert meta["gain_e_dn"] == 0.125
    assert meta["exposure_s"] == pytest.approx(free["exposure_s"] / 4.0, rel=1e-9)


def brightening(tree, lag, **more):
    """Frames of a sun that is different in each."""
    tree = copy.deepcopy(tree)
    tree["sun"] = {"irradiance_w_m2": {
        "ideal": 1361.0, "jitter_variance": 1e5, "clip_min": 300.0, "clip_max": 4000.0,
    }}  # fmt: skip
    tree["drivers"] = {"interval": 1}
    tree["time"]["frames_per_scene"] = 4
    return opened(tree | more, {"lag_frames": lag, "min_ms": 1e-6})


def exposures(sim, frames):
    return [sim.frame(i, ["raw"]).meta["exposure_s"] for i in frames]


def test_exposure_lags_within_its_scene(tree):
    now = exposures(brightening(tree, 0), range(9))
    assert len(set(now)) >= 8
    assert exposures(brightening(tree, 1), range(9)) == [
        now[i] for i in (0, 0, 1, 2, 4, 4, 5, 6, 8)
    ]
    assert exposures(brightening(tree, 9), range(9)) == [now[4 * (i // 4)] for i in range(9)]


def test_a_lagging_frame_is_a_pure_function(tree):
    sim = brightening(tree, 1)
    forward = [sim.frame(i, ["raw"], threads=1)["raw"].tobytes() for i in range(4)]
    again = pickle.loads(pickle.dumps(sim))
    backward = [again.frame(i, ["raw"], threads=2)["raw"].tobytes() for i in (3, 2, 1, 0)]
    assert forward == backward[::-1]
    plan = {row["name"]: row["bound_dn"] for row in sim.plan(2)}
    assert plan["cast_shadows"] >= 0.0


@pytest.mark.parametrize(
    ("intervals", "scene", "frame", "lag", "earlier"),
    [
        ({}, 1, 7, 3, 7),
        ({}, 5, 7, 3, 5),
        ({}, 5, 9, 3, 6),
        # steps 0: a b, 1: a, 2: a, 3: a b, 4: a, 5: a, 6: a b
        ({"a": 1, "b": 3}, 10, 9, 2, 1),
        ({"a": 1, "b": 3}, 10, 9, 1, 5),  # frame 9 is b at step 6, frame 5 b at step 3
        ({"a": 1, "b": 3}, 5, 9, 1, 9),  # the scene began at step 5
    ],
)
def test_the_frame_before(intervals, scene, frame, lag, earlier):
    assert Timeline(scene, intervals).earlier(frame, lag) == earlier


@pytest.mark.parametrize(
    ("exposure", "text"),
    [
        ({"window": [0.5, 0.0, 0.5, 1.0]}, "window: must be"),
        ({"window": [0.0, 0.0, 1.0, 1.5]}, r"window\[3\]"),
        ({"times_ms": [2.0, 1.0]}, "times_ms: must rise"),
        ({"times_ms": [1.0], "min_ms": 2.0}, "times_ms: none is within"),
        ({"gains": []}, "gains"),
        ({"gains": [2.0, 2.0]}, "gains: must rise"),
        ({"metering": "median"}, "metering"),
        ({"lag_frames": -1}, "lag_frames"),
        ({"saturated": 1.5}, "saturated"),
    ],
)
def test_what_is_no_exposure_is_refused(tree, exposure, text):
    with pytest.raises(ConfigError, match=rf"camera\.sensor\.exposure.*{text}"):
        opened(tree, exposure)
