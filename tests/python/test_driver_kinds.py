"""Distributions beyond the normal one, lists, groups: statistics, exactness, errors by key.

Statistics as in test_drivers.py: Kolmogorov-Smirnov with P(false alarm) < 1e-6 for each bound
(P(D sqrt(n) > 2.7) < 2 exp(-2 * 2.7^2), for distributions with atoms even less), other bounds at 5
standard errors.
"""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy import stats

import perilune
from perilune import document as cfg
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.drivers import Defaults, DriverError, Plan, factor, find

COUNT = 4_000
REFLECTANCES = ["lambert", "metallic_roughness"]
NORMAL = {"ideal": 40.0, "jitter_variance": 4.0, "clip_min": 30.0, "clip_max": 50.0}
COLOUR = {
    "ideal": [0.1, 0.2, 0.3],
    "jitter_variance": [0.01, 0.0, 0.04],
    "clip_min": -10.0,
    "clip_max": [10.0, 11.0, 12.0],
}


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def draws(raw, *, seed=1, strength=1.0, count=COUNT, interval=1):
    """What a driver draws at each step; (count,) or (count, n)."""
    plan = Plan(tuple(find({"a": raw})), defaults=Defaults(strength, interval))
    return np.array([plan.values(seed, step)[("a",)] for step in range(count)])


def clipped_distance(values, cdf, low, high):
    """D sqrt(n) of Kolmogorov and Smirnov, between the limits, where clipping changes no CDF."""
    ordered = np.sort(values)
    n = len(ordered)
    assert ordered[0] >= low
    assert ordered[-1] <= high
    inner = (ordered > low) & (ordered < high)
    above = np.searchsorted(ordered, ordered[inner], "right") / n
    below = np.searchsorted(ordered, ordered[inner], "left") / n
    expected = cdf(ordered[inner])
    at_low = abs((ordered <= low).mean() - cdf(low))
    distance = max(np.abs(above - expected).max(), np.abs(below - expected).max(), at_low)
    return distance * math.sqrt(n)


@pytest.mark.parametrize("strength", [0.3, 1.0, 4.0])
def test_log_normal(strength):
    raw = {"median": 2.0, "log_variance": 0.25, "clip_min": 1.2, "clip_max": 4.0}
    law = stats.lognorm(math.sqrt(0.25 * strength), scale=2.0)
    values = draws(raw, strength=strength)
    assert clipped_distance(values, law.cdf, 1.2, 4.0) < 2.7
    assert {values.min(), values.max()} == {1.2, 4.0}
    assert set(draws(raw, strength=0.0, count=20)) == {2.0}


@pytest.mark.parametrize("strength", [0.3, 1.0, 4.0])
def test_clipped_normal(strength):
    raw = {"ideal": 1.0, "jitter_variance": 4.0, "clip_min": 0.5, "clip_max": 3.0}
    law = stats.norm(1.0, 2.0 * math.sqrt(strength))
    assert clipped_distance(draws(raw, strength=strength), law.cdf, 0.5, 3.0) < 2.7


def test_jitter_that_always_clips():
    """A variance so large that (nearly) every value is one of the limits, or limits that meet."""
    raw = {"ideal": 0.0, "jitter_variance": 1e300, "clip_min": -1.0, "clip_max": 1.0}
    values = draws(raw, count=1000)
    assert set(values) == {-1.0, 1.0}
    assert abs(values.mean()) < 5.0 / math.sqrt(1000)
    assert set(draws({**raw, "clip_min": 0.0, "clip_max": 0.0}, count=50)) == {0.0}
    wide = {"median": 1.0, "log_variance": 1e300, "clip_min": 0.5, "clip_max": 2.0}
    assert set(draws(wide, count=100)) == {0.5, 2.0}


def test_choice_follows_its_weights():
    values = draws({"choice": ["a", "b", "c", "d"], "weights": [1, 0, 5, 2]})
    for value, share in (("a", 1 / 8), ("c", 5 / 8), ("d", 2 / 8)):
        error = math.sqrt(share * (1 - share) / COUNT)
        assert abs((values == value).mean() - share) < 5.0 * error
    assert "b" not in values
    alike = draws({"choice": [1.0, 2.0, 4.0]})
    for value in (1.0, 2.0, 4.0):
        assert abs((alike == value).mean() - 1 / 3) < 5.0 * math.sqrt(2 / 9 / COUNT)


def test_strength_of_a_choice():
    raw = {"choice": ["a", "b"], "weights": [0, 1]}
    assert set(draws(raw, strength=0.0, count=50)) == {"a"}
    assert set(draws(raw, count=50)) == {"b"}
    share = (draws(raw, strength=0.25) == "b").mean()
    assert abs(share - 0.25) < 5.0 * math.sqrt(0.25 * 0.75 / COUNT)
    assert set(draws({"choice": ["only"]}, count=50)) == {"only"}
    # A choice far beyond the whole strength is that by the weights.
    assert set(draws(raw, strength=9.0, count=50)) == {"b"}


def test_lists_vary_by_component_or_jointly():
    values = draws(COLOUR) - np.array([0.1, 0.2, 0.3])
    assert (values[:, 1] == 0.0).all()
    for k, sigma in ((0, 0.1), (2, 0.2)):
        assert clipped_distance(values[:, k], stats.norm(0, sigma).cdf, -10, 12) < 2.7
    assert abs(np.corrcoef(values[:, 0], values[:, 2])[0, 1]) < 5.0 / math.sqrt(COUNT)
    joint = draws({**COLOUR, "jointly": True}) - np.array([0.1, 0.2, 0.3])
    assert np.allclose(joint[:, 2], 2.0 * joint[:, 0], atol=1e-15)
    box = draws({"uniform": [[0, 0, 1], [1, 2, 1]]})
    for k, width in ((0, 1.0), (1, 2.0)):
        assert clipped_distance(box[:, k], stats.uniform(0, width).cdf, 0, width) < 2.7
    assert (box[:, 2] == 1.0).all()
    assert draws(COLOUR, strength=0.0, count=1).tolist() == [[0.1, 0.2, 0.3]]
    grey = draws({"uniform": [[0, 0], [1, 1]], "jointly": True}, count=100)
    assert (grey[:, 0] == grey[:, 1]).all()


def gaussian(rng, ideal, strength, params):
    """A hook: normal with a given width."""
    return ideal + params["sigma"] * strength * rng.standard_normal()


def test_hook():
    raw = {
        "hook": f"{__name__}:gaussian",
        "ideal": 1.0,
        "clip_min": -1.0,
        "clip_max": 2.0,
        "params": {"sigma": 2.0},
    }
    values = draws(raw)
    assert clipped_distance(values, stats.norm(1.0, 2.0).cdf, -1.0, 2.0) < 2.7
    assert set(draws(raw, strength=0.0, count=5)) == {1.0}
    assert (draws(raw, count=10, interval=5).reshape(2, 5).std(axis=1) == 0.0).all()
    assert (draws(raw, seed=2, count=10) != draws(raw, count=10)).all()


def grouped(scene, settings, *, names=("camera.fov_deg", "spacecraft.sat.orbit.raan_deg")):
    """The small scene with two normal drivers in a group."""
    driver = {"ideal": 40.0, "jitter_variance": 1.0, "clip_min": 30.0, "clip_max": 50.0}
    changes = {name: {**driver, "group": "g"} for name in names}
    return cfg.load(scene, {**changes, "drivers.groups.g": settings})


def pairs(document, count=COUNT):
    """The drawn values at each step, (count, 2), without the cost of validation."""
    rows = [list(document._plan.values(1, step).values()) for step in range(count)]
    return np.array(rows)


def test_correlation_matrix(scene):
    members = ["spacecraft.sat.orbit.raan_deg", "camera.fov_deg"]
    settings = {"members": members, "correlation": [[1.0, -0.8], [-0.8, 1.0]]}
    values = pairs(grouped(scene, {**settings, "step_interval": 1}))
    # The standard error of a correlation r is (1 - r^2) / sqrt(n).
    assert abs(np.corrcoef(values.T)[0, 1] + 0.8) < 5.0 * 0.36 / math.sqrt(COUNT)
    for column in values.T:
        assert clipped_distance(column, stats.norm(40.0, 1.0).cdf, 30.0, 50.0) < 2.7
    # The order of the file does not matter, nor whether the other one is drawn.
    turned = dict(reversed(list(scene.items())))
    names = grouped(turned, {**settings, "step_interval": 1})
    plain = names._plan.values(1, 7)
    assert plain == grouped(scene, {**settings, "step_interval": 1})._plan.values(1, 7)
    alone = grouped(scene, {**settings, "step_interval": 1}, names=("camera.fov_deg",))
    assert alone._plan.values(1, 7) == {("camera", "fov_deg"): plain[("camera", "fov_deg")]}


def test_shared_draw_through_a_copula(scene):
    scene["camera"]["fov_deg"] = {**NORMAL, "group": "g"}
    scene["sun"] = {"irradiance_w_m2": {"uniform": [0.0, 1000.0], "group": "g"}}
    scene["bodies"]["earth"]["reflectance"] = {
        "choice": REFLECTANCES,
        "group": "g",
    }
    scene["drivers"] = {"groups": {"g": {"shared": True, "step_interval": 1}}}
    plan = cfg.load(scene)._plan
    rows = [plan.values(1, step) for step in range(2000)]
    fov = np.array([row[("camera", "fov_deg")] for row in rows])
    sun = np.array([row[("sun", "irradiance_w_m2")] for row in rows])
    look = np.array([row[("bodies", "earth", "reflectance")] for row in rows])
    assert np.allclose(sun, 1000.0 * stats.norm.cdf(fov, 40.0, 2.0), atol=1e-9)
    assert ((look == "metallic_roughness") == (fov >= 40.0)).all()
    assert clipped_distance(sun, stats.uniform(0, 1000).cdf, 0, 1000) < 2.7


def test_settings_of_groups_and_sections(scene):
    document = grouped(scene, {"jitter_strength": 0.0, "step_interval": 3})
    assert (pairs(document, 10) == 40.0).all()
    values = pairs(grouped(scene, {"step_interval": 3}), 12).reshape(4, 3, 2)
    assert (values == values[:, :1]).all()
    assert len(set(values[:, 0, 0])) == 4
    section = {
        "drivers": {"scale": dict(NORMAL), "own": {**NORMAL, "strength": 1.0, "interval": 1}},
        "jitter_strength": 0.0,
        "step_interval": 2,
    }
    plan = Plan(tuple(find({"materials": {"foil": {"drivers": section}}})))
    rows = [list(plan.values(1, step).values()) for step in range(4)]
    assert [row[0] for row in rows] == [40.0] * 4
    assert len({row[1] for row in rows}) == 4


def test_reflectances_and_sections_by_choice(scene):
    scene["bodies"]["earth"]["reflectance"] = {"choice": REFLECTANCES}
    scene["camera"]["trajectory"] = {
        "choice": [
            {"kind": "orbit_object", "target": "sat", "distance_m": [12, 20]},
            {"kind": "orbit_object", "target": "sat", "distance_m": 100.0},
        ]
    }
    sim = perilune.open(scene, base="tests/python")
    found = set()
    for index in range(16):
        config, drawn = sim.config_at(index)
        assert drawn["bodies.earth.reflectance"] == config.bodies["earth"].reflectance
        found.add((config.bodies["earth"].reflectance, config.camera.trajectory.distance_m[1]))
    assert len(found) == 4


def test_a_chosen_reflectance_is_rendered(repo_dir, scene):
    base = repo_dir / "tests/python"
    names = ["lambert", "metallic_roughness"]
    scene["spacecraft"], scene["render"] = {}, {"samples": 2, "max_bounces": 0}
    scene["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": 400.0}
    scene["camera"]["trajectory"] = {"kind": "hover", "target": "earth", "height_m": 5e6}
    options = {"bodies.earth.reflectance": {"choice": names}}
    sim = perilune.open(scene, overrides=options, base=base)
    fixed = {
        name: perilune.open(scene, overrides={"bodies.earth.reflectance": name}, base=base)
        for name in names
    }
    seen = set()
    for index in range(6):
        sample = sim.frame(index, ["rgb"])
        name = sample.meta["drivers"]["bodies.earth.reflectance"]
        seen.add(name)
        assert (sample["rgb"] == fixed[name].frame(index, ["rgb"])["rgb"]).all()
    assert seen == set(names)
    images = [fixed[name].frame(0, ["rgb"])["rgb"] for name in names]
    assert (images[0] != images[1]).any()


def test_python_class(scene):
    fov = perilune.Driver(40.0, 4.0, 30.0, 50.0, interval=2)
    assert dict(fov) == {**NORMAL, "interval": 2}
    rows = {
        "camera.fov_deg": fov,
        "bodies.earth.albedo": perilune.Driver.uniform(np.zeros(3), np.ones(3)),
        "sun.irradiance_w_m2": perilune.Driver.log_normal(1361.0, 0.01, 1000.0, 2000.0),
        "bodies.earth.reflectance": perilune.Driver.choice(REFLECTANCES, [1, 2]),
        "spacecraft.sat.orbit.raan_deg": perilune.Driver.hook(
            gaussian, 90.0, 0.0, 180.0, {"sigma": 1.0}
        ),
    }
    document = cfg.load(scene, rows)
    plain = cfg.load(scene, json.loads(json.dumps({k: _dict(v) for k, v in rows.items()})))
    assert document.at(5) == plain.at(5)
    assert set(document.at(5)[1]) == set(rows)
    with pytest.raises(DriverError, match="negative"):
        perilune.Driver(1.0, -1.0, 0.0, 2.0)
    with pytest.raises(DriverError, match="weights"):
        perilune.Driver.choice([1.0, 2.0], [0.0, 0.0])


def _dict(driver):
    return {k: v.tolist() if hasattr(v, "tolist") else _lists(v) for k, v in driver.items()}


def _lists(value):
    return [_lists(v) for v in value] if isinstance(value, (list, np.ndarray)) else value


FOV = "camera.fov_deg"
ORBITS = [
    {"around": "earth", "altitude_km": 500, "inclination_deg": 97.4, "mean_anomaly_deg": 0},
    {"kind": "circular", "around": "earth", "scale": 1.1, "v_step": 0.0},
]
FAULTY = [
    (FOV, {**NORMAL, "clip_min": 60.0}, [f"{FOV}.clip_min", "above clip_max"]),
    (FOV, {**NORMAL, "ideal": [40.0, 40.0]}, [FOV]),
    (FOV, {**NORMAL, "jitter_variance": [1.0]}, [f"{FOV}.jitter_variance", "one number"]),
    (FOV, {**NORMAL, "ideal": []}, [f"{FOV}.ideal", "empty"]),
    (FOV, {**NORMAL, "jointly": 1}, [f"{FOV}.jointly", "true or false"]),
    (FOV, {**NORMAL, "intervall": 1}, [f"{FOV}.intervall", "did you mean 'interval'"]),
    (FOV, {**NORMAL, "group": "optics"}, [f"{FOV}.group", "no group 'optics'"]),
    (FOV, {"median": 0.0, "log_variance": 1.0, "clip_min": 0, "clip_max": 1}, [".median", "above"]),
    (FOV, {"median": 1.0, "log_variance": -1.0, "clip_min": 0, "clip_max": 2}, ["log_variance"]),
    (FOV, {"median": 1.0, "log_variance": 1.0, "clip_min": 0}, ["clip_max is missing"]),
    (FOV, {"choice": []}, [f"{FOV}.choice", "one value or more"]),
    (FOV, {"choice": [40, 50], "weights": [1]}, [f"{FOV}.weights", "2 numbers"]),
    (FOV, {"choice": [40, 50], "weights": [0, 0]}, [f"{FOV}.weights", "sum above 0"]),
    (FOV, {"choice": [40, 50], "weights": [1, -1]}, [f"{FOV}.weights[1]", "negative"]),
    (FOV, {"choice": [40, 500]}, [f"{FOV}.choice[1] = 500", "less than 180"]),
    (FOV, {"choice": [40, {"uniform": [1, 2]}]}, [f"{FOV}.choice[1]", "takes no driver"]),
    (FOV, {"weights": [1]}, [FOV]),
    ("bodies.earth.reflectance", {"choice": ["lambert", "lamberts"]}, ["reflectance", "lamberts"]),
    ("camera.width", {"choice": [48, 64]}, ["camera.width", "takes no driver"]),
    ("spacecraft.sat.model", {"choice": ["a.glb", "b.glb"]}, ["sat.model", "takes no driver"]),
    ("spacecraft.sat.orbit", {"choice": ORBITS}, ["spacecraft.sat.orbit: takes no driver", "kind"]),
    (FOV, {"hook": "nothing", "ideal": 40}, [f"{FOV}.hook", "module:function"]),
    (FOV, {"hook": "no.module:f", "ideal": 40, "clip_min": 30, "clip_max": 50}, [f"{FOV}.hook"]),
    (FOV, {"hook": "math:pi", "ideal": 40, "clip_min": 30, "clip_max": 50}, ["not a function"]),
    (FOV, {"hook": "math:sin", "ideal": 40}, ["clip_min is missing"]),
    (FOV, {"hook": "math:sin", "ideal": "x", "clip_min": 1}, [f"{FOV}.clip_min", "only for"]),
    (FOV, {"hook": "math:sin", "clip_min": 1, "clip_max": 2}, ["ideal is missing"]),
]


@pytest.mark.parametrize(("key", "value", "expected"), FAULTY)
def test_faulty_drivers(scene, key, value, expected):
    with pytest.raises(ConfigError) as error:
        cfg.load(scene, {key: value})
    for text in expected:
        assert text in str(error.value)


CORRELATION = {"members": [FOV, "sun.irradiance_w_m2"], "correlation": [[1, 0.5], [0.5, 1]]}
FAULTY_GROUPS = [
    ({"correlation": [[1, 0.5], [0.5, 1]]}, ["drivers.groups.g.members", "required"]),
    ({"members": [FOV]}, ["drivers.groups.g.members", "correlation"]),
    ({**CORRELATION, "shared": True}, ["drivers.groups.g.shared"]),
    ({**CORRELATION, "correlation": [[1, 1], [1, 1]]}, ["g.correlation", "positive definite"]),
    ({**CORRELATION, "correlation": [[1, 0.5], [0.4, 1]]}, ["g.correlation", "symmetric"]),
    ({**CORRELATION, "correlation": [[1, 0.5], [0.5, 0.9]]}, ["g.correlation", "diagonal"]),
    ({**CORRELATION, "correlation": [[1, 0.5]]}, ["g.correlation", "2 x 2"]),
    ({**CORRELATION, "correlation": [[1, 1.5], [1.5, 1]]}, ["g.correlation[0][1]"]),
    ({**CORRELATION, "members": [FOV, FOV]}, ["g.members", "twice"]),
    ({**CORRELATION, "members": [FOV, "camera.fov"]}, ["g.members[1]", "did you mean"]),
    ({**CORRELATION, "members": ["seed", "root"]}, [f"{FOV}.group", "members"]),
    ({"jitter_strength": -1}, ["g.jitter_strength"]),
    ({"step_interval": 0}, ["g.step_interval"]),
    ({"strenght": 0}, ["g.strenght", "unknown key"]),
]


@pytest.mark.parametrize(("settings", "expected"), FAULTY_GROUPS)
def test_faulty_groups(scene, settings, expected):
    driver = {**NORMAL, "group": "g"}
    rows = {FOV: driver, "sun.irradiance_w_m2": {"uniform": [1, 2]}, "drivers.groups.g": settings}
    with pytest.raises(ConfigError) as error:
        cfg.load(scene, rows)
    for text in expected:
        assert text in str(error.value)


def test_what_cannot_go_with_a_correlated_group(scene):
    shared = {"drivers.groups.g": {"shared": True}}
    hook = {"hook": "math:sin", "ideal": 40, "clip_min": 30, "clip_max": 50, "group": "g"}
    with pytest.raises(ConfigError, match=r"fov_deg\.group: a hook draws by itself"):
        cfg.load(scene, {FOV: hook, **shared})
    with pytest.raises(ConfigError, match=r"fov_deg\.interval: .*step_interval"):
        cfg.load(scene, {FOV: {**NORMAL, "group": "g", "interval": 2}, **shared})


def test_factor_of_a_correlation_matrix():
    matrix = [[1.0, 0.5, 0.2], [0.5, 1.0, -0.3], [0.2, -0.3, 1.0]]
    lower = factor(matrix)
    assert np.allclose(lower @ lower.T, matrix, atol=1e-15)
    with pytest.raises(ValueError, match="positive definite"):
        factor([[1.0, 0.9, -0.9], [0.9, 1.0, 0.9], [-0.9, 0.9, 1.0]])
