"""A step's configuration, made in few moves: the same values and the same refusals as in many."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.base.random import generator, stable_hash
from perilune.base.same import Same
from perilune.config.errors import ConfigError
from perilune.config.schema import Config
from perilune.document.loader import read_tree

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


def test_steps_with_the_same_draws_share_what_is_made_of_them(repo_dir):
    sim = perilune.open(repo_dir / "configs/rendezvous.yaml")
    first, later, next_scene = (sim.config_at(index)[0] for index in (0, 7, 250))
    assert first is later
    assert first is not next_scene
    request = sim.request(0)
    assert request["body_albedo"] is sim.request(7)["body_albedo"]
    with pytest.raises(ValueError, match="read-only"):
        request["body_albedo"][:] = 0.5
