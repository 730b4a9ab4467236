"""Scalar drivers: statistics, exactness without strength, purity, what takes no driver.

The statistical tests use fixed seeds. Their bounds are at 5 standard errors, so a change of seed
fails one of them by chance with a probability below 1e-6 for each bound.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from perilune import document as cfg
from perilune.base.random import generator, stable_hash
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.drivers import Defaults, Plan, find

COUNT = 20_000


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def row(raw, name="a"):
    """The driver of a mapping at the key `name`."""
    (found,) = find({name: raw})
    return found


def driver(ideal=3.0, variance=4.0, low=-1e9, high=1e9, interval=None, strength=None, name="a"):
    settings = {"interval": interval, "strength": strength}
    more = {key: value for key, value in settings.items() if value is not None}
    return row(driven(ideal, variance, low, high, **more), name)


def draws(found, seed=1, strength=1.0, interval=1, count=COUNT, groups=None):
    plan = Plan((found,), groups or {}, Defaults(strength, interval))
    return np.array([plan.values(seed, step)[found.path] for step in range(count)])


def normal_cdf(x):
    return 0.5 * (1.0 + math.erf(x / math.sqrt(2.0)))


@pytest.mark.parametrize("strength", [0.25, 1.0, 2.0])
def test_mean_variance_and_distribution(strength):
    values = draws(driver(), strength=strength)
    sigma = math.sqrt(4.0 * strength)
    assert abs(values.mean() - 3.0) < 5.0 * sigma / math.sqrt(COUNT)
    assert abs(values.var() / sigma**2 - 1.0) < 5.0 * math.sqrt(2.0 / COUNT)
    # Kolmogorov-Smirnov: P(D sqrt(n) > 2.7) < 2 exp(-2 * 2.7^2) = 1e-6.
    expected = np.array([normal_cdf((x - 3.0) / sigma) for x in np.sort(values)])
    steps = np.arange(1, COUNT + 1) / COUNT
    distance = max(np.abs(expected - steps).max(), np.abs(expected - steps + 1.0 / COUNT).max())
    assert distance * math.sqrt(COUNT) < 2.7


def test_successive_frames_and_other_keys_are_independent():
    a, b = draws(driver(name="a")) - 3.0, draws(driver(name="b")) - 3.0
    limit = 5.0 / math.sqrt(COUNT)
    assert abs(np.corrcoef(a[:-1], a[1:])[0, 1]) < limit
    assert abs(np.corrcoef(a, b)[0, 1]) < limit
    assert abs(np.corrcoef(a, draws(driver(name="a"), seed=2))[0, 1]) < limit


def test_clipping():
    values = draws(driver(ideal=0.0, variance=1.0, low=-1.0, high=0.5))
    assert values.min() == -1.0
    assert values.max() == 0.5
    for share, expected in (
        ((values == -1.0).mean(), normal_cdf(-1.0)),
        ((values == 0.5).mean(), 1.0 - normal_cdf(0.5)),
    ):
        assert abs(share - expected) < 5.0 * math.sqrt(expected * (1.0 - expected) / COUNT)


def test_uniform():
    """Kolmogorov-Smirnov against the uniform distribution, as above."""
    found = row({"uniform": [-1.0, 3.0]})
    values = np.sort(draws(found))
    assert values.min() >= -1.0
    assert values.max() <= 3.0
    distance = np.abs((values + 1.0) / 4.0 - (np.arange(COUNT) + 0.5) / COUNT).max()
    assert distance * math.sqrt(COUNT) < 2.7
    half = draws(found, strength=0.25)
    assert half.min() >= 0.0
    assert half.max() <= 2.0
    assert (draws(found, strength=0.0) == 1.0).all()


def test_uniform_in_a_file(scene):
    document = cfg.load(scene, {"camera.fov_deg": {"uniform": [30.0, 50.0]}})
    assert document.config.camera.fov_deg == 40.0
    drawn = [document.at(index)[0].camera.fov_deg for index in range(20)]
    assert len(set(drawn)) == 20
    assert all(30.0 <= value <= 50.0 for value in drawn)


def test_the_suns_direction_by_angles(scene):
    angles = {"azimuth_deg": 90.0, "elevation_deg": {"uniform": [-30.0, 30.0]}}
    document = cfg.load(scene, {"sun.direction": angles})
    assert document.config.sun.direction == pytest.approx((0.0, 1.0, 0.0))
    x, y, z = document.at(3)[0].sun.direction
    assert (x, math.hypot(y, z)) == pytest.approx((0.0, 1.0))
    assert 0.0 < abs(z) < 0.5
    with pytest.raises(ConfigError, match=r"sun\.direction\.elevation_deg = 91"):
        cfg.load(scene, {"sun.direction": {"azimuth_deg": 0.0, "elevation_deg": 91.0}})


@pytest.mark.parametrize("ideal", [0.1, 1.0 / 3.0, -7e22, 5e-324])
def test_strength_zero_gives_exactly_the_ideal(ideal):
    limits = {"low": -1e30, "high": 1e30}
    assert set(draws(driver(ideal, **limits), strength=0.0, count=50)) == {ideal}
    assert set(draws(driver(ideal, strength=0.0, **limits), strength=1.0, count=50)) == {ideal}
    assert set(draws(driver(ideal, variance=0.0, **limits), count=50)) == {ideal}


def test_interval():
    values = draws(driver(interval=5), interval=2, count=20).reshape(4, 5)
    assert (values == values[:, :1]).all()
    assert len(set(values[:, 0])) == 4
    assert (draws(driver(), interval=2, count=10).reshape(5, 2).std(axis=1) == 0.0).all()


def test_philox_is_keyed_as_stated():
    """NumPy's Philox, key (seed, FNV-1a of the text), counter (0, 0, 0, frame)."""
    assert stable_hash("") == 0xCBF29CE484222325
    assert stable_hash("foobar") == 0x85944171F73967E8  # RFC 9923, appendix C
    key = np.array([3, stable_hash("x")], dtype=np.uint64)
    counter = np.array([0, 0, 0, 9], dtype=np.uint64)
    expected = np.random.Generator(np.random.Philox(key=key, counter=counter)).random(4)
    assert (generator(3, "x", 9).random(4) == expected).all()


def driven(ideal, variance, low, high, **more):
    return {"ideal": ideal, "jitter_variance": variance, "clip_min": low, "clip_max": high, **more}


def test_any_number_can_be_driven(scene):
    scene["camera"]["fov_deg"] = driven(40, 4, 30, 50)
    scene["camera"]["trajectory"]["distance_m"] = [driven(12, 1, 10, 14), 20]
    scene["spacecraft"]["sat"]["orbit"]["raan_deg"] = driven(90, 100, 0, 180, interval=3)
    scene["bodies"]["earth"]["albedo"] = driven(0.3, 0.01, 0, 1)
    document = cfg.load(scene)
    assert document.config.camera.fov_deg == 40.0
    assert document.config.bodies["earth"].albedo == (0.3, 0.3, 0.3)
    config, values = document.at(4)
    assert values == {
        "camera.fov_deg": config.camera.fov_deg,
        "camera.trajectory.distance_m[0]": config.camera.trajectory.distance_m[0],
        "spacecraft.sat.orbit.raan_deg": config.spacecraft["sat"].orbit.raan_deg,
        "bodies.earth.albedo": config.bodies["earth"].albedo[0],
    }
    assert values["camera.fov_deg"] != 40.0
    assert document.at(3)[0].spacecraft == config.spacecraft
    assert document.at(5)[1]["camera.fov_deg"] != values["camera.fov_deg"]


def test_frames_do_not_depend_on_order_or_on_other_drivers(scene):
    scene["camera"]["fov_deg"] = driven(40, 4, 30, 50)
    one = cfg.load(scene)
    forward = [one.at(i)[1]["camera.fov_deg"] for i in range(20)]
    backward = [one.at(i)[1]["camera.fov_deg"] for i in reversed(range(20))][::-1]
    scene["bodies"]["earth"]["albedo"] = driven(0.3, 0.01, 0, 1)
    two = cfg.load(scene)
    assert forward == backward == [two.at(i)[1]["camera.fov_deg"] for i in range(20)]
    assert forward != [cfg.load(scene, {"seed": 8}).at(i)[1]["camera.fov_deg"] for i in range(20)]


def test_default_strength_of_the_configuration(scene):
    scene["camera"]["fov_deg"] = driven(40.1, 4, 30, 50)
    scene["drivers"] = {"strength": 0.0}
    assert cfg.load(scene).at(3)[0].camera.fov_deg == 40.1


@pytest.mark.parametrize(
    "key",
    [
        "seed",
        "version",
        "camera.width",
        "render.samples",
        "spacecraft.sat.obj_id",
        "bodies.earth.map_center_lon_deg",
        "drivers.strength",
        "drivers.interval",
    ],
)
def test_identities_and_shapes_take_no_driver(scene, key):
    with pytest.raises(ConfigError) as error:
        cfg.load(scene, {key: driven(1, 0, 1, 1)})
    assert key in str(error.value)
    assert "takes no driver" in str(error.value)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (driven(40, 4, 30, 200), ["camera.fov_deg.clip_max = 200.0", "less than 180"]),
        (driven(60, 4, 30, 50), ["camera.fov_deg.ideal", "outside [clip_min, clip_max]"]),
        (driven(40, -4, 30, 50), ["camera.fov_deg.jitter_variance", "negative"]),
        (driven("x", 4, 30, 50), ["camera.fov_deg.ideal", "finite number"]),
        (driven(40, 4, 30, math.inf), ["camera.fov_deg.clip_max", "finite number"]),
        (driven(40, 4, 30, 50, interval=0), ["camera.fov_deg.interval", "whole number"]),
        (driven(40, 4, 30, 50, strength=-1), ["camera.fov_deg.strength", "negative"]),
        (driven(40, 4, 30, 50, sigma=1), ["camera.fov_deg.sigma", "unknown key", "strength"]),
        ({"ideal": 40}, ["camera.fov_deg", "jitter_variance is missing"]),
        ({"uniform": [30, 20]}, ["camera.fov_deg.uniform", "[low, high]"]),
        ({"uniform": [30]}, ["camera.fov_deg.uniform", "[low, high]"]),
        ({"uniform": [30, "x"]}, ["camera.fov_deg.uniform[1]", "finite number"]),
        ({"uniform": [30, 200]}, ["camera.fov_deg.uniform[1] = 200.0", "less than 180"]),
        ({"uniform": [30, 40], "ideal": 35}, ["camera.fov_deg.ideal", "unknown key", "uniform"]),
    ],
)
def test_faulty_drivers(scene, value, expected):
    with pytest.raises(ConfigError) as error:
        cfg.load(scene, {"camera.fov_deg": value})
    for text in expected:
        assert text in str(error.value)
