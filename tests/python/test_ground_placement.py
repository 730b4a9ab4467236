"""What stands on the ground, drives over it, or keeps a height over it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from tests.python.camera_worlds import columns, worlds

import perilune
from perilune.base import rotations
from perilune.base.curves import Curve
from perilune.camera import trajectories
from perilune.config import ConfigError
from perilune.config.standing import Standing, Way
from perilune.document.loader import read_tree
from perilune.orbits.ground import Ground, smooth, way_stance

MOON_M = 1737.4e3
RADII = np.array([1740e3, 1737e3, 1730e3])


@pytest.fixture
def scene(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["bodies"], tree["root"] = {"moon": {"kind": "moon"}}, "moon"
    tree["spacecraft"]["sat"]["orbit"] = {"around": "moon", "altitude_km": 500,
                                          "mean_anomaly_deg": 0}  # fmt: skip
    return tree


def sloped(slope_east, slope_north, lon=0.3, lat=0.2):
    """A sphere with a plane through its surface at a place, in metres a metre."""
    up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
    east = np.array([-math.sin(lon), math.cos(lon), 0.0])
    normal = up - slope_east * east - slope_north * np.cross(up, east)
    distance = MOON_M * float(normal @ up)
    return Ground(np.full(3, MOON_M), False, lambda d: distance / (d @ normal)), normal


# -- curves ----------------------------------------------------------------------------------------


@settings(max_examples=15, deadline=None)
@given(st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=2, max_size=5))
def test_a_curve_passes_its_points(points):
    way = np.array(points)
    if (np.linalg.norm(np.diff(way, axis=0), axis=1) < 0.1).any():
        return
    found = Curve(way)
    places = np.array([found.at(s)[0] for s in np.linspace(0.0, found.length, 200)])
    np.testing.assert_allclose(places[[0, -1]], way[[0, -1]], atol=1e-9)
    for point in way:
        assert np.linalg.norm(places - point, axis=1).min() < found.length / 150


def test_a_curve_is_even():
    found = Curve(np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [25.0, 12.0]]))
    at = [found.at(s) for s in np.linspace(0.0, found.length, 301)]
    chords = np.diff([place for place, _ in at], axis=0)
    np.testing.assert_allclose(np.linalg.norm(chords, axis=1), found.length / 300, rtol=0.02)
    for chord, (_, tangent) in zip(chords, at, strict=False):
        assert chord @ tangent / np.linalg.norm(chord) > 0.998
    assert found.length == pytest.approx(np.linalg.norm(chords, axis=1).sum(), rel=1e-4)


def test_a_curve_of_two_points_is_straight():
    found = Curve(np.array([[1.0, 2.0], [4.0, 6.0]]))
    assert found.length == pytest.approx(5.0)
    place, tangent = found.at(2.5)
    np.testing.assert_allclose(place, [2.5, 4.0], atol=1e-12)
    np.testing.assert_allclose(tangent, [0.6, 0.8], atol=1e-9)


# -- stances ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("slopes", [(0.3, 0.0), (0.0, -0.2), (0.25, 0.5)])
def test_pitch_and_roll_are_the_grounds(slopes):
    ground, normal = sloped(*slopes)
    spec = Standing(lon_deg=math.degrees(0.3), lat_deg=math.degrees(0.2))
    place, up, north = ground.site(spec)
    for footprint in ((2.0, 1.0), (20.0, 30.0)):
        stance = ground.stance(place, north, footprint)
        np.testing.assert_allclose(stance.axes.T @ stance.axes, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(stance.axes[:, 2], normal / np.linalg.norm(normal), atol=1e-6)
        assert stance.axes[:, 0] @ np.cross(north, up) == pytest.approx(0.0, abs=1e-6)
        np.testing.assert_allclose(stance.point_m, place, rtol=0, atol=1e-3)
        level = ground.stance(place, north, footprint, level=True)
        np.testing.assert_allclose(level.axes[:, 2], up, atol=1e-12)


def test_a_footprint_smooths_what_is_smaller():
    def bumps(d):
        return MOON_M + 0.2 * np.sin(d[:, 1] * MOON_M * 40.0)

    ground = Ground(np.full(3, MOON_M), False, bumps)
    stance = ground.stance(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), (30.0, 30.0))
    assert stance.axes[:, 2] @ [1.0, 0.0, 0.0] > 1.0 - 1e-3


def test_heights_over_an_ellipsoid_of_three_axes():
    ground = Ground(RADII, True, lambda d: 1.0 / np.linalg.norm(d / RADII, axis=1) + 5000.0)
    place, normal, _ = ground.site(Standing(lon_deg=40.0, lat_deg=50.0))
    height = ground.over(place, normal)
    assert ground.height_m(place + height * normal) == pytest.approx(0.0, abs=1e-6)
    assert ground.height_m(place + height * normal, "datum") == pytest.approx(5000.0, abs=1e-6)
    assert height == pytest.approx(5000.0, abs=0.2)  # radial against vertical


def test_a_way_goes_east_and_north():
    ground = smooth((MOON_M,) * 3, False)
    way = Way(lon_deg=20.0, lat_deg=0.0, waypoints_m=((0.0, 0.0), (3000.0, 4000.0)))
    stance = way_stance(ground, way, 5000.0, (1.0, 1.0))
    x, y, z = stance.point_m.tolist()
    assert math.hypot(x, y, z) == pytest.approx(MOON_M, rel=1e-12)
    assert (math.atan2(y, x) - math.radians(20.0)) * MOON_M == pytest.approx(3000.0, rel=1e-5)
    assert z == pytest.approx(4000.0, rel=1e-5)


# -- spacecraft ------------------------------------------------------------------------------------


def opened(scene, repo_dir, orbit, attitude=None):
    craft = scene["spacecraft"]["sat"]
    craft["orbit"] = {"around": "moon", "lon_deg": 10.0, "lat_deg": 20.0, **orbit}
    craft.pop("attitude", None)
    if attitude is not None:
        craft["attitude"] = attitude
    return perilune.open(scene, base=repo_dir / "tests/python")


def on_the_body(sim, t_s):
    """Place and axes of the spacecraft in the axes of the moon."""
    found = sim.system(0).states(np.array([t_s]))
    moon, sat = found.poses["moon"][0], found.poses["sat"][0]
    back = rotations.conjugate(moon[3:])
    turn = rotations.multiply(back, sat[3:])
    return rotations.rotate(back, sat[:3]), rotations.to_matrix(turn), found


def local(place):
    up = place / np.linalg.norm(place)
    east = np.cross([0.0, 0.0, 1.0], up)
    east /= np.linalg.norm(east)
    return east, np.cross(up, east), up


def test_a_craft_stands_on_its_lowest_point_and_turns_with_the_ground(scene, repo_dir):
    sim = opened(scene, repo_dir, {"kind": "surface", "heading_deg": 90.0, "height_m": -0.1})
    low = sim.models["sat"].metres_per_unit * sim.models["sat"].model.bounds[0]
    low = low - sim.models["sat"].metres_per_unit * sim.models["sat"].offset
    for t_s in (0.0, 1e6):
        place, axes, found = on_the_body(sim, t_s)
        assert np.linalg.norm(place) == pytest.approx(MOON_M - 0.1 - low[2], abs=1e-4)
        east, north, up = local(place)
        np.testing.assert_allclose(axes, np.column_stack([east, north, up]), atol=1e-6)
        # 2.66e-6 rad/s at a latitude of 20 degrees
        speed = np.linalg.norm(found.velocities_m_s["sat"][0])
        assert speed == pytest.approx(2.6617e-6 * MOON_M * math.cos(math.radians(20)), rel=1e-3)


def test_an_attitude_comes_on_top(scene, repo_dir):
    turn = {"pointing": "ground", "rotation_deg": [0.0, 0.0, 90.0]}
    sim = opened(scene, repo_dir, {"kind": "surface"}, turn)
    place, axes, _ = on_the_body(sim, 0.0)
    east, north, up = local(place)
    np.testing.assert_allclose(axes, np.column_stack([-east, -north, up])[:, [0, 1, 2]], atol=1e-6)


def test_a_stated_attitude_counts(scene, repo_dir):
    sim = opened(scene, repo_dir, {"kind": "surface"}, {"pointing": "inertial"})
    pose = sim.system(0).states(np.array([0.0])).poses["sat"][0]
    np.testing.assert_allclose(pose[3:], [1, 0, 0, 0], atol=1e-12)


def test_a_rover_drives(scene, repo_dir):
    way = {"kind": "traverse", "waypoints_m": [[0.0, 0.0], [0.0, 100.0]], "speed_m_s": 2.0}
    sim = opened(scene, repo_dir, way)
    places = [on_the_body(sim, t)[0] for t in (0.0, 10.0, 50.0, 90.0)]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    np.testing.assert_allclose(steps, [20.0, 80.0, 0.0], atol=1e-3)
    place, axes, _ = on_the_body(sim, 10.0)
    np.testing.assert_allclose(axes[:, 0], local(place)[1], atol=1e-4)


@pytest.mark.parametrize(
    ("orbit", "attitude", "text"),
    [
        ({"kind": "surface", "altitude_above": "datum"}, None,
         "orbit.altitude_above.*moon is a smooth ellipsoid"),
        ({"kind": "traverse", "speed_m_s": 1.0, "waypoints_m": [[1, 1], [1, 1]]}, None,
         r"waypoints_m\[1\].*is the point before it"),
        ({"kind": "traverse", "speed_m_s": 1.0, "waypoints_m": [[1, 1]]}, None,
         "waypoints_m.*at least 2"),
        ({"kind": "surface", "lat_deg": 91.0}, None, "lat_deg"),
        ({"kind": "circular", "scale": 2.0, "v_step": 0.0, "lon_deg": None}, {"pointing": "ground"},
         "attitude.pointing: ground: only with orbit.kind surface"),
    ],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(scene, repo_dir, orbit, attitude, text):
    if orbit["kind"] == "circular":
        scene["spacecraft"]["sat"] |= {
            "orbit": {"around": "moon", "kind": "circular", "scale": 2.0, "v_step": 0.0},
            "attitude": attitude,
        }
        with pytest.raises(ConfigError, match=text):
            perilune.open(scene, base=repo_dir / "tests/python")
        return
    with pytest.raises(ConfigError, match=text):
        opened(scene, repo_dir, orbit, attitude)


def test_only_a_spacecraft_stands_and_only_on_a_body(scene, repo_dir):
    stands = {"kind": "surface", "lon_deg": 0.0, "lat_deg": 0.0}
    craft = scene["spacecraft"]["sat"]
    scene["spacecraft"]["on"] = {**craft, "orbit": {"around": "sat", **stands}}
    with pytest.raises(ConfigError, match=r"spacecraft\.on\.orbit\.around.*sat is none"):
        perilune.open(scene, base=repo_dir / "tests/python")
    del scene["spacecraft"]["on"]
    scene["bodies"]["rock"] = {"kind": "phobos", "orbit": {"around": "moon", **stands}}
    with pytest.raises(ConfigError, match=r"bodies\.rock\.orbit\.kind.*only for a spacecraft"):
        perilune.open(scene, base=repo_dir / "tests/python")


# -- the Sun ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("azimuth", "elevation"), [(90.0, 1.5), (200.0, -3.0), (0.0, 60.0)])
def test_the_sun_stays_in_its_place_in_the_sky(scene, repo_dir, azimuth, elevation):
    scene["sun"] = {"at": {"lon_deg": 10.0, "lat_deg": 20.0, "azimuth_deg": azimuth,
                           "elevation_deg": elevation}}  # fmt: skip
    sim = opened(scene, repo_dir, {"kind": "surface"}, {"pointing": "sun"})
    for frame in (0, 10_000):  # a week
        world = sim.world(frame)
        place = world.body_axes("moon", world.position_m("sat"))
        east, north, up = local(place)
        to_sun = world.body_axes("moon", world.sun_position_m) - place
        size = np.linalg.norm(to_sun)
        assert size == pytest.approx(1.495978707e11, rel=1e-4)
        assert math.degrees(math.asin(to_sun @ up / size)) == pytest.approx(elevation, abs=1e-6)
        found = math.degrees(math.atan2(to_sun @ east, to_sun @ north)) % 360.0
        assert found == pytest.approx(azimuth, abs=1e-5) or azimuth == 0.0
        x = columns(world.poses["sat"][0])[:, 0]
        assert x @ (world.sun_position_m - world.position_m("sat")) == pytest.approx(size)


def test_the_sun_is_in_one_place(scene, repo_dir):
    at = {"lon_deg": 0.0, "lat_deg": 0.0, "azimuth_deg": 0.0, "elevation_deg": 5.0}
    scene["sun"] = {"at": at, "direction": [1, 0, 0]}
    with pytest.raises(ConfigError, match="sun: give only one of direction, at"):
        opened(scene, repo_dir, {"kind": "surface"})
    scene["sun"] = {"distance_au": 2.0}
    with pytest.raises(ConfigError, match="does nothing without direction or at"):
        opened(scene, repo_dir, {"kind": "surface"})


# -- cameras ---------------------------------------------------------------------------------------

MAST = {"kind": "traverse", "target": "moon", "lon_deg": 10.0, "lat_deg": 20.0,
        "waypoints_m": [[0.0, 0.0], [0.0, 30.0]], "height_m": 1.5, "positions": 4}  # fmt: skip


def test_a_mast_keeps_its_height_and_looks_ahead(scene):
    for step, place in enumerate(
        worlds(scene, {**MAST, "yaw_deg": 30, "pitch_deg": -20}, range(4))
    ):
        pose = trajectories.camera_poses(place)[0]
        own = place.body_axes("moon", pose[:3])
        assert np.linalg.norm(own) - MOON_M == pytest.approx(1.5, abs=1e-3)
        east, north, up = local(own)
        forward = place.body_axes("moon", columns(pose)[:, 2])
        assert math.degrees(math.asin(forward @ up)) == pytest.approx(-20.0, abs=1e-3)
        assert math.degrees(math.atan2(-(forward @ east), forward @ north)) == pytest.approx(
            30.0, abs=1e-2
        )
        moved = math.asin(own[2] / np.linalg.norm(own)) - math.radians(20.0)
        assert moved * MOON_M == pytest.approx(10.0 * step, abs=1e-2)


def test_speed_is_distance_over_time(scene):
    keys = {key: value for key, value in MAST.items() if key != "positions"} | {"after": "hold"}
    first, last = worlds(scene, {**keys, "speed_m_s": 0.25}, (0, 1))  # 60 s: half of the way
    a, b = (w.body_axes("moon", trajectories.camera_poses(w)[0][:3]) for w in (first, last))
    assert np.linalg.norm(b - a) == pytest.approx(15.0, abs=1e-3)


def test_rates_exclude_each_other(scene):
    with pytest.raises(ConfigError, match="give only one of positions, speed_m_s"):
        worlds(scene, {**MAST, "speed_m_s": 1.0}, [0])


def test_a_way_over_a_spacecraft_is_refused(scene):
    with pytest.raises(ConfigError, match=r"camera\.trajectory\.target"):
        worlds(scene, {**MAST, "target": "sat"}, [0])


def test_hover_counts_from_the_datum_of_a_shape_when_asked(scene, repo_dir, tmp_path):
    corners = [(x, y, z) for x in (-900, 900) for y in (-900, 900) for z in (-900, 900)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    (tmp_path / "box.obj").write_text(
        "\n".join(lines + ["f " + " ".join(map(str, f)) for f in faces])
    )
    scene["bodies"]["moon"]["shape"] = str(tmp_path / "box.obj")
    for above, distance_m in (("terrain", 900e3), ("datum", MOON_M)):
        scene["camera"]["trajectory"] = {
            "kind": "hover", "target": "moon", "lon_deg": 0.0, "lat_deg": 0.0,
            "height_m": 1e5, "altitude_above": above}  # fmt: skip
        sim = perilune.open(scene, base=repo_dir / "tests/python")
        place = sim.camera_poses(0)[0, :3]
        assert np.linalg.norm(place) == pytest.approx(distance_m + 1e5, rel=1e-9)


def test_a_flyby_counts_its_height_from_the_ground_when_asked(scene):
    pass_by = {"kind": "flyby", "target": "moon", "closest_m": 5e3, "before_m": 1e5,
               "positions": 3, "frame": "target", "side": [0.0, 1.0, 1.0]}  # fmt: skip
    (place,) = worlds(scene, {**pass_by, "altitude_above": "terrain"}, [1])
    found = np.linalg.norm(trajectories.camera_poses(place)[0, :3])
    assert found == pytest.approx(MOON_M + 5e3, abs=1e-3)
    with pytest.raises(ConfigError, match=r"altitude_above.*only with frame: target"):
        worlds(scene, {**pass_by, "frame": "icrf", "altitude_above": "datum"}, [1])
    with pytest.raises(ConfigError, match=r"altitude_above.*sat is no body"):
        worlds(scene, {**pass_by, "target": "sat", "altitude_above": "datum"}, [1])


def test_a_craft_stands_on_a_shape(scene, repo_dir, tmp_path):
    corners = [(x, y, z) for x in (-900, 900) for y in (-900, 900) for z in (-900, 900)]
    faces = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    (tmp_path / "box.obj").write_text(
        "\n".join(lines + ["f " + " ".join(map(str, f)) for f in faces])
    )
    scene["bodies"]["moon"]["shape"] = str(tmp_path / "box.obj")
    sim = opened(scene, repo_dir, {"kind": "surface"})
    place, axes, _ = on_the_body(sim, 0.0)
    np.testing.assert_allclose(axes[:, 2], [1.0, 0.0, 0.0], atol=1e-5)  # the face's normal
    assert 900e3 < place[0] < 900e3 + 10.0
