"""Trajectories that are a place or a table, against poses worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation
from tests.python.camera_worlds import RADIUS_M, close, columns, offsets, orbit_axes, worlds

from perilune import document as cfg
from perilune.camera import trajectories
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.orbits.ground import surface


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


# -- axes ------------------------------------------------------------------------------------------


def test_axes_of_the_orbit(scene):
    fixed = {"kind": "fixed", "target": "sat", "position_m": [10, 20, 30]}
    # lvlh has x forward, y along minus the normal, z down.
    for frame, expected in (("rsw", [10, 20, 30]), ("lvlh", [-30, 10, -20])):
        for place in worlds(scene, {**fixed, "frame": frame}, range(4)):
            assert close(offsets([place])[0], orbit_axes(place) @ expected)


def test_axes_of_an_orbit_that_is_none(scene):
    scene["spacecraft"]["sat"]["orbit"] = {"around": "earth", "position_km": [8000, 0, 0]}
    trajectory = {"kind": "fixed", "target": "sat", "position_m": [9, 0, 0], "frame": "lvlh"}
    (place,) = worlds(scene, trajectory, [2])
    with pytest.raises(ValueError, match="frame 2: frame: lvlh: sat moves in no plane"):
        trajectories.camera_poses(place)


def test_fixed_keeps_its_clearance_when_asked(scene):
    trajectory = {"kind": "fixed", "target": "sat", "position_m": [2, 0, 0]}
    assert close(offsets(worlds(scene, trajectory, [0]))[0], [2, 0, 0])
    (place,) = worlds(scene, {**trajectory, "clearance_m": 1.5}, [0])
    text = r"within clearance_m of sat .*radius 4 m\); it is 2 m from the centre of sat .*: 1\.5\)"
    with pytest.raises(ValueError, match=text):
        trajectories.camera_poses(place)


# -- hover -----------------------------------------------------------------------------------------


def test_hover_over_a_point(scene):
    """Geodetic to Cartesian: WGS 84, 45 deg north, 10 deg east, 1000 m (textbook formula)."""
    trajectory = {"kind": "hover", "target": "earth", "lon_deg": 10.0, "lat_deg": 45.0,
                  "height_m": 1000.0, "azimuth_deg": 0.0}  # fmt: skip
    a, b = 6378137.0, 6356752.314245
    lat, lon = math.radians(45), math.radians(10)
    prime = a / math.sqrt(1 - (1 - (b / a) ** 2) * math.sin(lat) ** 2)
    expected = [
        (prime + 1000) * math.cos(lat) * math.cos(lon),
        (prime + 1000) * math.cos(lat) * math.sin(lon),
        ((b / a) ** 2 * prime + 1000) * math.sin(lat),
    ]
    for place in worlds(scene, trajectory, range(3)):
        pose = trajectories.camera_poses(place)[0]
        assert close(place.body_axes("earth", pose[:3]), expected, 1e-3)  # radii as tabulated
        down = place.body_axes("earth", columns(pose)[:, 2])
        up = -place.body_axes("earth", columns(pose)[:, 1])
        normal = [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]
        assert close(down, -np.array(normal), 1e-12)
        north = [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)]
        assert close(up, north, 1e-12)


def test_hover_aslant(scene):
    trajectory = {"kind": "hover", "target": "earth", "lon_deg": 0.0, "lat_deg": 0.0,
                  "height_m": 1e5, "azimuth_deg": 90.0, "off_nadir_deg": 30.0}  # fmt: skip
    (place,) = worlds(scene, trajectory, [0])
    forward = place.body_axes("earth", columns(trajectories.camera_poses(place)[0])[:, 2])
    assert close(forward, [-math.cos(math.radians(30)), 0.5, 0], 1e-12)  # down, and to the east


def test_hover_at_random(scene):
    trajectory = {"kind": "hover", "target": "earth", "height_m": [1e4, 2e4], "interval": 2,
                  "lat_deg": [-90, 30]}  # fmt: skip
    places = worlds(scene, trajectory, range(300))
    own = np.array([w.body_axes("earth", trajectories.camera_poses(w)[0][:3]) for w in places])
    assert close(own[::2], own[1::2], 1e-8)
    sine = own[::2, 2] / np.linalg.norm(own[::2], axis=1)
    assert sine.max() < 0.5
    # Uniform on [-1, 1/2]: mean -1/4 within 5 standard errors (geocentric, so 0.003 of slack).
    assert abs(sine.mean() + 0.25) < 5 * 1.5 / math.sqrt(12 * 150) + 0.003
    assert len(np.unique(own[::2, 0])) == 150


@given(
    st.tuples(*[st.floats(0.5, 20.0)] * 3),
    st.floats(-math.pi, math.pi),
    st.floats(-math.pi / 2, math.pi / 2),
)
def test_surface_points_have_their_normal(radii, lon, lat):
    normal = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
    point = surface(np.array(radii), normal)
    assert abs(np.sum((point / radii) ** 2) - 1) < 1e-12
    gradient = point / np.square(radii)
    assert np.abs(gradient / np.linalg.norm(gradient) - normal).max() < 1e-12


# -- random box ------------------------------------------------------------------------------------


def test_random_box(scene):
    trajectory = {
        "kind": "random_box", "around": "sat", "min_m": [10, -5, -30], "max_m": [20, 5, -30],
        "rotation_min_deg": [0, 0, -180], "rotation_max_deg": [0, 0, 180],
    }  # fmt: skip
    places = worlds(scene, trajectory, range(200))
    found = offsets(places)
    assert (found[:, 0] >= 10 - 1e-8).all()
    assert (found[:, 0] <= 20 + 1e-8).all()
    assert close(found[:, 2], -30, 1e-8)
    assert abs(found[:, 0].mean() - 15) < 5 * 10 / math.sqrt(12 * 200)
    for place in places[:5]:
        assert close(columns(trajectories.camera_poses(place)[0])[:, 2], [0, 0, 1], 1e-12)
    still = {**trajectory, "rotation_min_deg": [10, 20, 30], "rotation_max_deg": [10, 20, 30]}
    pose = trajectories.camera_poses(worlds(scene, still, [4])[0])[0]
    expected = Rotation.from_euler("xyz", [10, 20, 30], degrees=True).as_matrix()
    assert close(columns(pose), expected, 1e-12)


def test_random_box_looks_at_things_and_points(scene):
    box = {"kind": "random_box", "min_m": [7e6, 1e6, 0], "max_m": [8e6, 2e6, 0]}
    for place in worlds(scene, {**box, "target": "sat"}, range(5)):
        pose = trajectories.camera_poses(place)[0]
        to = place.position_m("sat") - pose[:3]
        assert close(columns(pose)[:, 2], to / np.linalg.norm(to), 1e-9)
    points = {"target_min_m": [0, 0, 1e6], "target_max_m": [0, 0, 1e6]}
    for place in worlds(scene, {**box, **points, "up": [1, 0, 0]}, range(5)):
        pose = trajectories.camera_poses(place)[0]
        to = np.array([0, 0, 1e6]) - pose[:3]
        assert close(columns(pose)[:, 2], to / np.linalg.norm(to), 1e-12)
        assert columns(pose)[0, 1] < 0.0  # +x is up in the image


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({}, "give exactly one of rotation_min_deg, target, target_min_m"),
        ({"target": "sat", "target_min_m": [0, 0, 0]}, "give only one of"),
        ({"target_min_m": [0, 0, 0]}, "target_max_m: target_min_m and target_max_m go together"),
        ({"target": "sat", "max_m": [0, 2, 3]}, "max_m: must not be below min_m"),
        ({"target": "sat", "frame": "lvlh"}, "frame: lvlh: only with `around`"),
        ({"target": "sat", "around": "mars"}, r"around: no entry named 'mars'"),
    ],
)
def test_random_box_faults(scene, changes, text):
    box = {"kind": "random_box", "min_m": [1, 2, 3], "max_m": [1, 2, 4]}
    scene["camera"]["trajectory"] = {**box, **changes}
    with pytest.raises(ConfigError, match=text):
        cfg.load(scene)


def test_random_box_keeps_clear(scene):
    box = {"kind": "random_box", "around": "sat", "min_m": [-6, -6, -6], "max_m": [6, 6, 6],
           "target": "sat", "clearance_m": 1.0}  # fmt: skip
    found = offsets(worlds(scene, box, range(60)))
    assert np.linalg.norm(found, axis=1).min() > RADIUS_M + 1.0
    small = {**box, "min_m": [-2, -2, -2], "max_m": [2, 2, 2]}
    with pytest.raises(ValueError, match=r"no camera pose in 2000 tries \(2000 times: .* of sat"):
        offsets(worlds(scene, small, [0]))


# -- deterministic ---------------------------------------------------------------------------------

CSV = "0,10,0,0,1,0,0,0\n2,30,0,0,0,0,0,1\n3,30,8,0,2,0,0,0\n"


def deterministic(scene, tmp_path, text, frames, **changes):
    path = tmp_path / "poses.csv"
    path.write_text(text)
    trajectory = {"kind": "deterministic", "file": str(path), "target": "sat", **changes}
    return worlds(scene, trajectory, frames)


def test_deterministic(scene, tmp_path):
    places = deterministic(scene, tmp_path, CSV, range(6))
    expected = [[10, 0, 0], [20, 0, 0], [30, 0, 0], [30, 8, 0], [10, 0, 0], [20, 0, 0]]
    assert close(offsets(places), expected)
    turned = [columns(trajectories.camera_poses(w)[0])[:, 0] for w in places[:4]]
    # Halfway to half a turn about z is a quarter.
    assert close(turned, [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [1, 0, 0]], 1e-12)
    held = deterministic(scene, tmp_path, CSV, range(6), after="hold")
    assert close(offsets(held)[4:], [30, 8, 0])


def test_deterministic_header_units_and_axes(scene, tmp_path):
    text = "x, y, z, qw, qx, qy, qz, t_s\n\n1,2,3,1,0,0,0,60\n3,2,3,1,0,0,0,180\n"
    changes = {"metres_per_unit": 10.0, "offset_m": [0, 0, -1], "camera_axes": "opengl"}
    places = deterministic(scene, tmp_path, text, range(4), **changes)
    assert close(offsets(places), [[10, 20, 29], [10, 20, 29], [20, 20, 29], [30, 20, 29]])
    assert close(columns(trajectories.camera_poses(places[0])[0]), np.diag([1, -1, -1]), 1e-12)
    root = deterministic(scene, tmp_path, "0,2e7,0,0,1,0,0,0\n", [5], target=None)
    assert (trajectories.camera_poses(root[0])[0] == [2e7, 0, 0, 1, 0, 0, 0]).all()


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("0,1,2,3,1,0,0\n", r"poses\.csv: line 1: 7 values, must be 8"),
        (CSV + "4,1,2,3,1,0,x,0\n", r"line 4: could not convert string to float: 'x'"),
        ("0,1,2,3,1,0,0,0\n0,1,2,3,1,0,0,0\n", r"line 2: frame 0 does not rise from 0"),
        ("0,1,2,3,0,0,0,0\n", "line 1: the quaternion is zero"),
        ("0,1,2,nan,1,0,0,0\n", "line 1: a value is not finite"),
        ("frame,x,y,z,qw,qx,qy,qq\n", r"line 1: no column 'qq'; did you mean 'q.'"),
        ("frame,x,y,z,qw,qx,qy\n", "line 1: column 'qz' is missing"),
        ("frame,x,y,z,qw,qx,qy,qz,t_s\n", "has both of the columns frame and t_s"),
        ("frame,x,y,z,qw,qx,qy,qz\n", r"poses\.csv: holds no pose"),
        ("", "holds no pose"),
    ],
)
def test_deterministic_faults(scene, tmp_path, text, fault):
    (place,) = deterministic(scene, tmp_path, text, [0])
    with pytest.raises(ValueError, match=fault):
        trajectories.camera_poses(place)


def test_deterministic_file_is_relative_to_the_configuration(scene, tmp_path):
    (tmp_path / "way.csv").write_text(CSV)
    scene["camera"]["trajectory"] = {"kind": "deterministic", "file": "way.csv", "target": "sat"}
    document = cfg.load(scene, base=tmp_path)
    assert document.config.camera.trajectory.file == str(tmp_path / "way.csv")
    with pytest.raises(FileNotFoundError, match=r"camera\.trajectory\.file: no such file"):
        cfg.load(scene, {"camera.trajectory.file": "none.csv"}, base=tmp_path)
