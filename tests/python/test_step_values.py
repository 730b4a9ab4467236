"""A step's configuration, made in few moves: the same values and the same refusals as in many."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import perilune
from perilune import _core
from perilune.base.random import generator, stable_hash
from perilune.base.same import Latest, Same
from perilune.config.errors import ConfigError
from perilune.config.schema import Config
from perilune.document.loader import read_tree
from perilune.drivers import Plan, find

CONFIGS = ("demo", "rendezvous", "mli_randomised", "articulated", "moonlet", "clouds")


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def drawn(seed, rows):
    columns = (
        np.array([stable_hash(name) for name, _, _, _ in rows], dtype=np.uint64),
        np.array([frame for _, frame, _, _ in rows], dtype=np.uint64),
        np.array([normal for _, _, normal, _ in rows], dtype=np.bool_),
        np.array([count for _, _, _, count in rows], dtype=np.int64),
    )
    return _core.draws(seed, *columns)


@pytest.mark.parametrize("seed", [0, 2**63 - 1])
def test_draws_are_those_of_numpy(seed):
    """50 000 normals: a few hundred are of the tails, and of the edges of the ziggurat's layers."""
    rows = [("tails", 0, True, 50_000), ("none", 1, True, 0)]
    rows += [(f"driver:a{k}", 2**40 + k, k % 3 == 0, k) for k in range(40)]
    expected = []
    for name, frame, normal, count in rows:
        rng = generator(seed, name, frame)
        expected.append(rng.standard_normal(count) if normal else rng.random(count))
    assert (drawn(seed, rows) == np.concatenate(expected)).all()


def test_no_draws():
    assert drawn(1, []).shape == (0,)


@pytest.mark.parametrize("counts", [[-1], [2**62], [2**24, 1]])
def test_counts_that_cannot_be(counts):
    rows = [("a", 0, True, count) for count in counts]
    with pytest.raises(ValueError, match="counts: between 0 and"):
        drawn(1, rows)


def test_columns_that_differ_in_length():
    with pytest.raises(ValueError, match="frames"):
        _core.draws(
            1, np.zeros(2, np.uint64), np.zeros(1, np.uint64), np.ones(2, bool), np.ones(2, int)
        )


def outcome(make):
    try:
        return make()
    except ConfigError as error:
        return str(error)


def is_same(one: Config, other: Config) -> bool:
    """To the bit, -0 and the types of numbers included."""
    return one == other and repr(one) == repr(other) and set(one.__dict__) == set(other.__dict__)


@pytest.mark.parametrize("name", CONFIGS)
def test_what_is_patched_is_what_would_be_validated(repo_dir, name, monkeypatch):
    document = perilune.open(repo_dir / f"configs/{name}.yaml", seed=5).document
    document.at(0)
    whole = document._validate
    calls = []
    monkeypatch.setattr(document, "_validate", lambda *a: calls.append(a) or whole(*a))
    for frame in range(1, 40):
        config, values = document.at(frame)
        step = document.config.timeline.at(frame).step
        now = document._values(step)
        assert values == {row.name: now[row.path] for row in document.drivers}
        assert is_same(config, whole(now))
    assert len(calls) <= 1  # not one a frame: the seldom case is another outcome of a choice


@pytest.mark.parametrize("name", CONFIGS)
def test_limits_are_tried_by_patches(repo_dir, name):
    """The configuration with one driver at a limit, as it would be validated whole."""
    document = perilune.open(repo_dir / f"configs/{name}.yaml").document
    patch, ideals = document._patch_of(document.tree), document._plan.ideals
    numbers = [row for row in document.drivers if row.path not in document._choosing]
    assert numbers
    for driver in numbers[:: max(1, len(numbers) // 4)]:
        for limit in driver.distribution.limits.values():
            values = {**ideals, driver.path: limit}
            assert is_same(patch.tried(values), document._validate(values))


@settings(derandomize=True, max_examples=100, deadline=None)
@given(
    kind=st.sampled_from(["normal", "log_normal"]),
    truncated=st.booleans(),
    middle=st.floats(1e-3, 1e3),
    variance=st.floats(0.0, 1e4),
    below=st.floats(0.0, 1.0),
    above=st.floats(1.0, 10.0),
    strength=st.sampled_from([1e-3, 1.0, 7.0]),
    seed=st.integers(0, 99),
)
def test_single_numbers_are_drawn_as_lists_are(
    kind, truncated, middle, variance, below, above, strength, seed
):
    """A scalar is drawn in one step; a list of one goes the long way."""
    first, second = {"normal": ("ideal", "jitter_variance")}.get(kind, ("median", "log_variance"))
    raw = {first: middle, second: variance, "clip_min": below * middle, "clip_max": above * middle}
    raw |= {"truncated": truncated, "strength": strength}

    def values(given):
        plan = Plan(tuple(find({"a": given})))
        return [next(iter(plan.values(seed, step).values())) for step in range(3)]

    assert values(raw) == [value for (value,) in values({**raw, first: [middle]})]


def test_steps_do_not_share_what_can_be_changed(scene, repo_dir):
    colour = {"ideal": [0.5, 0.5, 0.5], "jitter_variance": 0.01, "clip_min": 0, "clip_max": 1}
    body = next(iter(scene["bodies"]))
    scene["bodies"][body]["albedo"] = colour
    sim = perilune.open(scene, base=repo_dir / "tests/python")
    key = f"bodies.{body}.albedo"
    first = sim.config_at(3)[1][key]
    before = list(first)
    first[0] = -7.0
    assert sim.config_at(3)[1][key] == before


def test_two_drivers_that_do_not_go_together_are_refused_as_ever(scene, repo_dir):
    """Each limit is valid beside the other's ideal; some draws are not beside each other."""
    low = {"ideal": 10.0, "jitter_variance": 400.0, "clip_min": 5.0, "clip_max": 24.0}
    high = {"ideal": 25.0, "jitter_variance": 400.0, "clip_min": 11.0, "clip_max": 60.0}
    trajectory = {"kind": "orbit_object", "target": next(iter(scene["spacecraft"]))}
    scene["camera"]["trajectory"] = {**trajectory, "distance_m": [low, high]}
    document = perilune.open(scene, base=repo_dir / "tests/python").document
    refused = 0
    for frame in range(60):
        values = document._values(document.config.timeline.at(frame).step)
        whole = outcome(lambda values=values: document._validate(values))
        patched = outcome(lambda frame=frame: document.at(frame)[0])
        assert patched == whole
        refused += isinstance(whole, str)
    assert 0 < refused < 60


def test_the_generator_is_philox_with_its_key_and_counter():
    key = np.array([7, stable_hash("camera.aim")], dtype=np.uint64)
    bits = np.random.Philox(key=key, counter=np.array([0, 0, 0, 9], dtype=np.uint64))
    theirs, ours = np.random.Generator(bits), generator(7, "camera.aim", 9)
    assert (ours.random(9) == theirs.random(9)).all()
    assert (ours.standard_normal(99) == theirs.standard_normal(99)).all()
    assert (ours.integers(0, 9, 9) == theirs.integers(0, 9, 9)).all()


def test_what_is_kept_belongs_to_the_objects_it_was_made_from():
    kept, made = Same(2), []
    rows = [[k] for k in range(4)]
    for row in (rows[0], rows[1], rows[0], rows[2], rows[3], rows[0]):
        assert kept.of((row,), lambda row=row: made.append(row[0]) or [row[0]]) == row
    assert made == [0, 1, 2, 3, 0]
    assert kept.of((list(rows[0]),), lambda: "an equal one") == "an equal one"


def test_the_latest_result_of_a_name():
    kept, made = Latest(), []
    one, other = [1], [2]
    for name, parts in [("a", (one, other)), ("b", (one, other)), ("a", (one, other))]:
        kept.of(name, parts, lambda name=name: made.append(name) or [name])
    kept.of("a", (other, one), lambda: made.append("again") or [])
    assert made == ["a", "b", "again"]


def test_orbits_that_no_driver_changes_are_kept(repo_dir):
    """The demo's planet is; its satellite is drawn anew, and stands where it does without."""
    sim, fresh = (perilune.open(repo_dir / "configs/demo.yaml") for _ in range(2))
    first, later = sim.system(0), sim.system(1)
    planet, craft = next(iter(sim.config.bodies)), next(iter(sim.config.spacecraft))
    nodes = [{node["name"]: node for node in system._nodes} for system in (first, later)]
    assert nodes[0][planet] is nodes[1][planet]
    assert nodes[0][craft] is not nodes[1][craft]
    for when in (np.zeros(1), np.array([0.0, 1e4])):
        ours, theirs = later.states(when), fresh.system(1).states(when)
        for name in (planet, craft):
            assert (ours.poses[name] == theirs.poses[name]).all()


def test_an_orbit_follows_its_central_body(scene, repo_dir):
    """Only the mass of the body varies: the spacecraft's own section stays the same object."""
    gm = {"ideal": 4e5, "jitter_variance": 1e8, "clip_min": 3e5, "clip_max": 5e5, "interval": 1}
    scene["bodies"]["earth"]["gm_km3_s2"] = gm
    sim = perilune.open(scene, base=repo_dir / "tests/python")
    configs = [sim.config_at(k)[0] for k in range(2)]
    assert configs[0].spacecraft["sat"] is configs[1].spacecraft["sat"]
    for k in (0, 1, 0):
        fresh = perilune.open(scene, base=repo_dir / "tests/python")
        ours, theirs = (s.system(k).states(np.array([1e3])) for s in (sim, fresh))
        assert (ours.poses["sat"] == theirs.poses["sat"]).all()


def test_steps_with_the_same_draws_share_what_is_made_of_them(repo_dir):
    sim = perilune.open(repo_dir / "configs/rendezvous.yaml")
    first, later, next_scene = (sim.config_at(index)[0] for index in (0, 7, 250))
    assert first is later
    assert first is not next_scene
    request = sim.request(0)
    assert request["body_albedo"] is sim.request(7)["body_albedo"]
    with pytest.raises(ValueError, match="read-only"):
        request["body_albedo"][:] = 0.5
