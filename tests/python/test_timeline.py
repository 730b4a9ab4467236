"""The timeline: frames against their enumeration, and what is drawn by step and by scene."""

from __future__ import annotations

import pytest
from hypothesis import given, strategies as st

from perilune import document as cfg, world
from perilune.base.timeline import Moment, Timeline
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.orbits import solar_system

INTERVALS = st.lists(st.integers(1, 9), min_size=1, max_size=5)


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def enumerated(timeline, steps):
    """Frames of the first steps by going through them."""
    names = timeline.trigger_intervals or {None: 1}
    pairs = [(k, n) for k in range(steps) for n, every in names.items() if k % every == 0]
    return [
        Moment(i, step, step // timeline.frames_per_scene, name)
        for i, (step, name) in enumerate(pairs)
    ]


def test_without_sensors_a_frame_is_a_step():
    assert Timeline().at(7) == Moment(7, 7, 7, None)
    assert Timeline(frames_per_scene=3).at(7) == Moment(7, 7, 2, None)
    assert Timeline().index_of(7) == 7
    assert Timeline().sensors_of(7) == ()


def test_sensors_of_a_step_follow_each_other():
    timeline = Timeline(2, {"left": 1, "right": 1, "slow": 3})
    expected = [
        (0, "left"), (0, "right"), (0, "slow"), (1, "left"), (1, "right"), (2, "left"),
        (2, "right"), (3, "left"), (3, "right"), (3, "slow"), (4, "left"),
    ]  # fmt: skip
    assert [(m.step, m.sensor) for m in map(timeline.at, range(11))] == expected
    assert [timeline.at(i).scene for i in range(11)] == [0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2]


@given(INTERVALS, st.integers(1, 7))
def test_frames_are_those_counted_one_by_one(intervals, per_scene):
    timeline = Timeline(per_scene, {f"s{k}": n for k, n in enumerate(intervals)})
    expected = enumerated(timeline, 40)
    assert [timeline.at(i) for i in range(len(expected))] == expected
    assert [timeline.index_of(m.step, m.sensor) for m in expected] == list(range(len(expected)))


@given(INTERVALS, st.integers(0, 2**31 - 1))
def test_far_frames_find_their_way_back(intervals, index):
    timeline = Timeline(1, {f"s{k}": n for k, n in enumerate(intervals)})
    moment = timeline.at(index)
    assert timeline.index_of(moment.step, moment.sensor) == index


def test_a_sensor_that_is_not_triggered_is_refused():
    timeline = Timeline(1, {"a": 2})
    for step, sensor in ((1, "a"), (0, "b"), (0, None)):
        with pytest.raises(ValueError, match=f"step {step}: sensor {sensor!r} takes no frame"):
            timeline.index_of(step, sensor)


def jittered(ideal, **more):
    return {"ideal": ideal, "jitter_variance": 4.0, "clip_min": 30, "clip_max": 50, **more}


def test_drivers_are_drawn_once_a_scene_unless_they_say_otherwise(scene):
    scene["time"]["frames_per_scene"] = 4
    scene["camera"]["fov_deg"] = jittered(40)
    scene["camera"]["exposure"] = {"percentile": jittered(40, interval=1)}
    document = cfg.load(scene)
    values = [document.at(i)[1] for i in range(12)]
    fov = [v["camera.fov_deg"] for v in values]
    assert [len(set(fov[k : k + 4])) for k in (0, 4, 8)] == [1, 1, 1]
    assert len(set(fov)) == 3
    assert len({v["camera.exposure.percentile"] for v in values}) == 12
    scene["drivers"] = {"interval": 2}
    pairs = [cfg.load(scene).at(i)[1]["camera.fov_deg"] for i in range(8)]
    assert pairs[::2] == pairs[1::2]
    assert len(set(pairs)) == 4


def test_draws_of_a_world(scene):
    scene["time"]["frames_per_scene"] = 3
    document = cfg.load(scene)
    epoch = solar_system.date_from_utc(document.config.time.utc_fields())
    worlds = [world.build(document.config, {}, i, epoch, {"sat": 1.0}) for i in range(6)]
    assert [(w.index, w.step, w.scene, w.sensor) for w in worlds][4] == (4, 4, 1, None)
    assert [w.t_s for w in worlds] == [60.0 * k for k in range(6)]
    assert len({float(w.random("x").random()) for w in worlds}) == 6
    scenes = [float(w.scene_random("x").random()) for w in worlds]
    assert scenes[0] == scenes[1] == scenes[2] != scenes[3] == scenes[4] == scenes[5]


@pytest.mark.parametrize("value", [0, -1, 2.0, True])
def test_frames_per_scene_must_count(scene, value):
    scene["time"]["frames_per_scene"] = value
    with pytest.raises(ConfigError, match=r"time\.frames_per_scene"):
        cfg.load(scene)
