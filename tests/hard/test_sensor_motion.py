"""Sensor motion where it degenerates: straight up, no length or radius, one position, far."""

from __future__ import annotations

import math

import numpy as np
import pytest
from tests.python.camera_worlds import RADIUS_M, close, columns, offsets, worlds

from perilune import config as cfg
from perilune.base.timeline import Timeline
from perilune.camera import trajectories
from perilune.camera.trajectories.linear import between
from perilune.document.loader import read_tree

LAST = 2**31 - 1


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def sound(place, target="sat"):
    """Poses that are finite and orthonormal, and look at the target."""
    poses = trajectories.camera_poses(place)
    for pose, thing in zip(poses, place.poses[target], strict=True):
        assert np.isfinite(pose).all()
        axes = columns(pose)
        assert np.abs(axes.T @ axes - np.eye(3)).max() < 1e-12
        to = thing[:3] - pose[:3]
        assert np.abs(axes[:, 2] - to / np.linalg.norm(to)).max() < 1e-8
    return poses


@pytest.mark.parametrize("position", [[0, 0, 30], [0, 0, -30], [1e-9, 0, 30], [0, 3e-8, -30]])
def test_looking_along_up(scene, position):
    spec = {"kind": "fixed", "target": "sat", "position_m": position}
    for place in worlds(scene, spec, range(3)):
        sound(place)


def test_a_spiral_through_the_direction_of_up(scene):
    """Over the pole of `up`: the view turns, but every frame has a sound one."""
    spec = {"kind": "spiral", "target": "sat", "r_start_m": 20.0, "plane": "zx", "positions": 9}
    for place in worlds(scene, spec, range(9)):
        sound(place)


def test_no_radius(scene):
    spiral = {"kind": "spiral", "target": "sat", "start_m": [0, 0, 0], "positions": 2}
    with pytest.raises(cfg.ConfigError, match=r"start_m: must not be the target's centre"):
        worlds(scene, spiral, [0])
    for key, value in (("r_start_m", 0.0), ("r_end_m", 0.0)):
        with pytest.raises(cfg.ConfigError, match=key):
            worlds(scene, {**spiral, "start_m": None, "r_start_m": 9.0, key: value}, [0])
    through = {"kind": "flyby", "target": "sat", "closest_m": 0.0, "before_m": 20.0, "positions": 3}
    first, last = worlds(scene, through, [0, 2])
    sound(first)
    sound(last)
    with pytest.raises(ValueError, match="frame 1: the camera is within clearance_m of sat"):
        offsets(worlds(scene, {**through, "positions": 5, "before_m": 6.0}, [1]))
    with pytest.raises(ValueError, match="frame 1: the camera is at the point that it looks at"):
        offsets(worlds(scene, {**through, "clearance_m": None}, [1]))


def test_start_and_end_in_one_place(scene):
    place = {"position_m": [0, 0, 15]}
    spec = {"kind": "linear", "target": "sat", "start": place, "end": place, "positions": 4}
    assert close(offsets(worlds(scene, spec, range(5))), [0, 0, 15])
    speeds = {**spec, "start_speed_m_s": 2.0, "end_speed_m_s": 0.0}
    assert close(offsets(worlds(scene, speeds, range(5))), [0, 0, 15])
    del speeds["positions"]  # a way of no length takes no time that could be followed
    with pytest.raises(cfg.ConfigError, match="positions: required"):
        worlds(scene, speeds, [0])


@pytest.mark.parametrize("after", ["repeat", "hold"])
def test_one_position_is_the_start(scene, after):
    common = {"target": "sat", "positions": 1, "after": after}
    ends = {"start": {"position_m": [0, 0, 30]}, "end": {"position_m": [0, 0, 20]}}
    for spec, start in (
        ({"kind": "linear", **ends}, [0, 0, 30]),
        ({"kind": "spiral", "r_start_m": 9.0, "r_end_m": 5.0}, [9, 0, 0]),
        ({"kind": "flyby", "closest_m": 8.0, "before_m": 6.0}, [-6, 0, 8]),
    ):
        places = worlds(scene, {**common, **spec}, [0, 1, 7], **{"camera.exposure_time_s": 30.0})
        for when in range(2):
            assert close(offsets(places, when=when), start, 1e-8)


def test_standing_still_at_the_end_of_slowing_down(scene):
    ends = {"start": {"position_m": [0, 0, 30]}, "end": {"position_m": [0, 0, 10]}}
    spec = {"kind": "linear", "target": "sat", **ends, "start_speed_m_s": 1.0, "end_speed_m_s": 0.0}
    # Twenty metres at a mean of half a metre a second: 40 s; 5 s before, 20 * (5 / 40)^2 are left.
    held = worlds(scene, {**spec, "after": "hold"}, [7, 8, 9, 10**6], **{"time.step_s": 5.0})
    assert close(offsets(held)[:, 2], [10 + 20 * (5 / 40) ** 2, 10, 10, 10], 1e-7)


def test_a_long_exposure_stops_at_the_end(scene):
    ends = {"start": {"position_m": [0, 0, 30]}, "end": {"position_m": [0, 0, 10]}}
    spec = {"kind": "linear", "target": "sat", **ends, "duration_s": 50.0}
    changes = {"time.step_s": 45.0, "camera.exposure_time_s": 30.0}
    (place,) = worlds(scene, spec, [1], **changes)
    assert close(offsets([place], when=1)[0], [0, 0, 10], 1e-8)


def test_time_backwards(scene):
    ends = {"start": {"position_m": [0, 0, 30]}, "end": {"position_m": [0, 0, 10]}}
    spec = {"kind": "linear", "target": "sat", **ends, "duration_s": 40.0}
    places = worlds(scene, spec, range(4), **{"time.step_s": -10.0})
    assert close(offsets(places)[:, 2], [30, 15, 20, 25], 1e-8)
    drawn = {"kind": "centred_target", "target": "sat", "duration_s": 40.0}
    found = offsets(worlds(scene, drawn, range(6), **{"time.step_s": -10.0}))
    assert close(found[1], found[4], 1e-8)  # t = -10 and -40 are the run before the epoch
    assert np.linalg.norm(found[0] - found[1]) > 0.01


@pytest.mark.parametrize(
    "spec",
    [
        {"kind": "spiral", "r_start_m": 20.0, "positions": 2**31},
        {"kind": "spiral", "r_start_m": 20.0, "positions": 7},
        {"kind": "spiral", "r_start_m": 20.0, "duration_s": 1e-3},
        {"kind": "spiral", "r_start_m": 1e12, "r_end_m": 1e-3, "positions": 3, "after": "repeat"},
        {"kind": "relative", "ellipse": {"radial_m": 30.0}},
        {"kind": "orbit_object", "distance_m": [5, 1e9], "interval": 1000, "roll_deg": 0},
    ],
)
@pytest.mark.parametrize("frame", [0, 1, 1_000_000])
def test_far_frames_and_lengths(scene, spec, frame):
    (place,) = worlds(scene, {"target": "sat", "clearance_m": None, **spec}, [frame])
    sound(place)


def test_half_a_turn_has_one_axis():
    """Between opposite directions any axis would do; it must be the same every time."""
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for axis in np.eye(3):
        b = np.concatenate([[0.0], axis])
        halves = [between(q, sign * b, 0.5) for sign in (1.0, -1.0)]
        for half in halves:
            assert abs(half[0] - math.sqrt(0.5)) < 1e-15
        assert abs(np.linalg.norm(halves[0]) - 1.0) < 1e-15
    assert (between(q, q, 0.3) == q).all()
    assert (between(q, -q, 0.3) == q).all()
    # -q is the same rotation: never the long way round.
    little = np.array([math.cos(0.1), math.sin(0.1), 0.0, 0.0])
    for b in (little, -little):
        half = between(q, b, 0.5)
        assert np.abs(half - [math.cos(0.05), math.sin(0.05), 0.0, 0.0]).max() < 1e-15
    tiny = np.array([1.0, 1e-200, 0.0, 0.0])
    assert np.isfinite(between(q, tiny, 0.5)).all()


@pytest.mark.parametrize("lat", [-90.0, 90.0])
@pytest.mark.parametrize("lean", [0.0, 90.0, 180.0])
def test_hover_over_the_poles(scene, lat, lean):
    spec = {"kind": "hover", "target": "earth", "lat_deg": lat, "lon_deg": 77.0, "height_m": 5e5,
            "off_nadir_deg": lean}  # fmt: skip
    for place in worlds(scene, spec, range(2)):
        pose = trajectories.camera_poses(place)[0]
        own = place.body_axes("earth", pose[:3])
        assert np.abs(own[:2]).max() < 1e-8
        polar = place.body_radii_m["earth"][2]
        assert abs(own[2] - math.copysign(polar + 5e5, lat)) < 1e-8
        down = -math.copysign(1.0, lat)
        forward = place.body_axes("earth", columns(pose)[:, 2])
        assert abs(forward[2] - down * math.cos(math.radians(lean))) < 1e-12


def test_hover_just_over_an_irregular_moon(scene):
    scene["bodies"]["moonlet"] = {"kind": "phobos", "orbit": {
        "around": "earth", "altitude_km": 9000, "mean_anomaly_deg": 0}}  # fmt: skip
    spec = {"kind": "hover", "target": "moonlet", "height_m": 0.5}
    for place in worlds(scene, spec, range(40)):
        pose = trajectories.camera_poses(place)[0]
        assert place.inside(pose[:3]) is None
        assert place.inside(pose[:3], 1.0) == "moonlet"


def test_orbits_that_are_no_circles(scene):
    """Axes and mean motion of a hyperbola: there is a plane, and no period."""
    scene["spacecraft"]["sat"]["orbit"] = {
        "around": "earth", "periapsis_km": 7000, "eccentricity": 1.7, "true_anomaly_deg": 20,
    }  # fmt: skip
    spec = {"kind": "relative", "target": "sat", "state": {"position_m": [0, -20, 0]}}
    for place in worlds(scene, spec, range(5)):
        sound(place)
        r, v = place.orbital_state("sat")
        rate = np.linalg.norm(np.cross(r, v)) / (r @ r)
        assert place.mean_motion_rad_s("sat") == pytest.approx(rate, rel=1e-14)


def test_mean_motion_of_an_ellipse_is_one_number(scene):
    scene["spacecraft"]["sat"]["orbit"] |= {"eccentricity": 0.3}
    spec = {"kind": "relative", "target": "sat", "state": {"position_m": [0, -20, 0]}}
    rates = [place.mean_motion_rad_s("sat") for place in worlds(scene, spec, range(0, 200, 9))]
    semi_major = 1e3 * (0.5 * (6378.137 * 2) + 500) / 0.7
    assert rates == pytest.approx([math.sqrt(398600.435507e9 / semi_major**3)] * len(rates), 1e-8)


def test_boxes_of_no_extent(scene):
    spec = {"kind": "random_box", "around": "sat", "target": "sat", "min_m": [0, 9, 0],
            "max_m": [0, 9, 0]}  # fmt: skip
    for place in worlds(scene, spec, range(3)):
        sound(place)
        assert close(offsets([place])[0], [0, 9, 0])
    spec |= {"min_m": [0, 0, 0], "max_m": [0, 0, 0], "clearance_m": None}
    with pytest.raises(ValueError, match="at the point that it looks at"):
        offsets(worlds(scene, spec, [0]))


def test_one_row_of_poses_holds_for_ever(scene, tmp_path):
    path = tmp_path / "one.csv"
    path.write_bytes(b"\xef\xbb\xbfframe,x,y,z,qw,qx,qy,qz\r\n5,9,0,0,1e-3,0,0,0\r\n")
    for after in ("repeat", "hold"):
        spec = {"kind": "deterministic", "file": str(path), "target": "sat", "after": after}
        assert close(offsets(worlds(scene, spec, [0, 5, 6, 1000])), [9, 0, 0], 1e-8)


def test_a_table_that_changes_is_read_again(scene, tmp_path):
    path = tmp_path / "one.csv"
    spec = {"kind": "deterministic", "file": str(path), "target": "sat"}
    for x in ("9", "10"):
        path.write_text(f"0,{x},0,0,1,0,0,0\n")
        assert close(offsets(worlds(scene, spec, [0])), [float(x), 0, 0])


def test_just_outside_is_clear(scene):
    spec = {"kind": "fixed", "target": "sat", "clearance_m": 0.0}
    outside = RADIUS_M * (1 + 1e-6)
    (place,) = worlds(scene, {**spec, "position_m": [outside, 0, 0]}, [0])
    assert close(offsets([place])[0], [outside, 0, 0])
    (place,) = worlds(scene, {**spec, "position_m": [RADIUS_M * (1 - 1e-6), 0, 0]}, [0])
    with pytest.raises(ValueError, match="bounding sphere"):
        trajectories.camera_poses(place)


def test_the_last_frame_of_many_sensors():
    """Steps far beyond 2^31 when sensors are triggered rarely."""
    timeline = Timeline(3, {"a": 10**6, "b": 7})
    moment = timeline.at(LAST)
    assert timeline.index_of(moment.step, moment.sensor) == LAST
    assert moment.step > 2**33
