"""Truncated drivers: the distribution within the limits, exactly; and a warning of piles."""

from __future__ import annotations

import math
import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from scipy import stats

import perilune
from perilune import document as cfg
from perilune.config import ConfigError
from perilune.config.errors import ConfigWarning
from perilune.document import oaisys
from perilune.document.loader import read_tree
from perilune.drivers import Defaults, Plan, find
from perilune.drivers.truncated import truncated_normal

COUNT = 4_000
FOV = "camera.fov_deg"
LIMITS = {"clip_min": 30.0, "clip_max": 50.0}
NORMAL = {"ideal": 40.0, "jitter_variance": 4.0, **LIMITS}


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def draws(raw, *, strength=1.0, count=COUNT):
    plan = Plan(tuple(find({"a": {**raw, "truncated": True}})), defaults=Defaults(strength, 1))
    return np.array([plan.values(1, step)[("a",)] for step in range(count)])


def distance(values, cdf):
    """D sqrt(n) of Kolmogorov and Smirnov; above 2.7 with a probability of 1e-6."""
    return stats.kstest(values, cdf).statistic * math.sqrt(len(values))


@pytest.mark.parametrize("strength", [0.25, 1.0, 9.0])
@pytest.mark.parametrize(
    ("ideal", "variance", "low", "high"),
    [(40.0, 400.0, 30.0, 50.0), (0.0, 1.0, 0.0, 8.0), (0.9, 0.04, 0.0, 1.0), (2.0, 1e8, 0.0, 3.0)],
)
def test_the_law_of_a_truncated_normal(ideal, variance, low, high, strength):
    values = draws(
        {"ideal": ideal, "jitter_variance": variance, "clip_min": low, "clip_max": high},
        strength=strength,
    )
    sigma = math.sqrt(variance * strength)
    law = stats.truncnorm((low - ideal) / sigma, (high - ideal) / sigma, ideal, sigma)
    assert values.min() >= low
    assert values.max() <= high
    assert len(np.unique(values)) == COUNT, "no pile"
    assert distance(values, law.cdf) < 2.7


def test_the_law_of_a_truncated_log_normal():
    raw = {"median": 2.0, "log_variance": 1.0, "clip_min": 1.5, "clip_max": 4.0}
    values = draws(raw)
    low, high = math.log(1.5 / 2.0), math.log(4.0 / 2.0)
    assert distance(np.log(values / 2.0), stats.truncnorm(low, high).cdf) < 2.7
    assert (
        distance(np.log(draws({**raw, "clip_min": 0.0}) / 2.0), stats.truncnorm(-99, high).cdf)
        < 2.7
    )


@pytest.mark.parametrize("low", [-40.0, -6.0, -1.0, -1e-3, -1e-9, 0.0])
@pytest.mark.parametrize("high", [0.0, 1e-9, 1e-3, 1.0, 6.0, 40.0])
def test_the_inverse_is_exact(low, high):
    """Against mpmath's 40 digits, in the tails and where the limits all but meet."""
    mpmath = pytest.importorskip("mpmath")
    if low == high:
        return
    with mpmath.workdps(40):
        for uniform in (0.0, 1e-12, 0.01, 0.3, 0.5, 0.8, 1.0 - 2.0**-53):
            z = truncated_normal(low, high, uniform)
            whole = mpmath.ncdf(high) - mpmath.ncdf(low)
            rank = (mpmath.ncdf(z) - mpmath.ncdf(low)) / whole
            wrong = abs(rank - uniform) * whole / mpmath.npdf(z)
            assert wrong < 1e-13 * max(1.0, abs(z)) * (high - low), (uniform, z)


def test_vectors_and_joint_draws():
    raw = {"ideal": [0.0, 1.0], "jitter_variance": [1.0, 0.0], "clip_min": 0.0, "clip_max": 1.0}
    values = draws(raw)
    assert (values[:, 1] == 1.0).all(), "no variance: the ideal, to the bit"
    assert distance(values[:, 0], stats.truncnorm(0.0, 1.0).cdf) < 2.7
    joint = draws({**raw, "jitter_variance": 1.0, "jointly": True, "ideal": [0.5, 0.5]})
    assert (joint[:, 0] == joint[:, 1]).all()


def test_no_strength_is_the_ideal_and_false_is_clipped():
    assert set(draws(NORMAL, strength=0.0, count=9)) == {40.0}
    plain, said = (
        Plan(tuple(find({"a": raw}))) for raw in (NORMAL, {**NORMAL, "truncated": False})
    )
    assert plain.values(3, 5) == said.values(3, 5)


def test_it_goes_along_in_a_correlated_group():
    """The copula is that of the group; the law of each is its own."""
    truncated = {**NORMAL, "jitter_variance": 400.0, "truncated": True, "group": "g"}
    other = {"ideal": 0.0, "jitter_variance": 1.0, "clip_min": -9, "clip_max": 9, "group": "g"}
    tree = {"a": truncated, "b": other}
    from perilune.drivers import Group, factor

    group = Group("g", members=("a", "b"), factor=factor([[1.0, 0.9], [0.9, 1.0]]))
    plan = Plan(tuple(find(tree)), {"g": group})
    rows = np.array([list(plan.values(1, step).values()) for step in range(COUNT)])
    assert distance(rows[:, 0], stats.truncnorm(-0.5, 0.5, 40.0, 20.0).cdf) < 2.7
    expected = 6.0 / math.pi * math.asin(0.9 / 2.0)  # Spearman's, of a Gaussian copula
    assert abs(stats.spearmanr(rows).statistic - expected) < 0.02


def test_the_same_bits_in_any_process_and_order(repo_dir):
    """As a worker draws them that gets the simulation pickled, and begins elsewhere."""
    driver = {**NORMAL, "jitter_variance": 400.0, "truncated": True}
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides={FOV: driver})
    steps = list(range(40))
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as workers:
        found = list(workers.map(sim.config_at, reversed(steps)))
    drawn = [values[FOV] for _, values in reversed(found)]
    assert drawn == [sim.config_at(step)[1][FOV] for step in steps]
    assert len(set(drawn)) == len(steps)


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        ({**NORMAL, "truncated": 1}, [f"{FOV}.truncated", "true or false"]),
        ({**NORMAL, "truncate": True}, [f"{FOV}.truncate", "did you mean 'truncated'"]),
        ({**NORMAL, "median": 3, "truncated": True}, [f"{FOV}.ideal", "another distribution"]),
        ({"uniform": [30, 50], "truncated": True}, [f"{FOV}.truncated", "unknown key"]),
        ({"ideal": 40.0, "truncated": True}, ["jitter_variance is missing"]),
    ],
)
def test_mistakes(scene, raw, expected):
    with pytest.raises(ConfigError) as error:
        cfg.load(scene, {FOV: raw})
    for text in expected:
        assert text in str(error.value)


def test_a_pile_is_told_and_truncation_ends_it(scene):
    piled = {**NORMAL, "jitter_variance": 400.0}
    with pytest.warns(
        ConfigWarning, match=f"{FOV}: 31% of its draws are clipped to clip_min"
    ) as told:
        perilune.open(scene, overrides={FOV: piled})
    assert len(told) == 2
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for raw in (NORMAL, {**piled, "truncated": True}, {**piled, "strength": 0.01}):
            perilune.open(scene, overrides={FOV: raw})


def test_no_file_of_ours_piles_up(repo_dir):
    with warnings.catch_warnings():
        warnings.simplefilter("error", ConfigWarning)
        for path in sorted((repo_dir / "configs").rglob("*.*")):
            if path.suffix in (".yaml", ".json"):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore", oaisys.OaisysWarning)
                    cfg.load(path)
