"""The user's functions: what they are given, and that what they draw depends on nothing else."""

from __future__ import annotations

import random

import numpy as np
import pytest

from perilune.base import hooks


def paper_sampler(body_radius_xyz=(6378.0, 6378.0, 6378.0)):
    """Listing 2 of the Space OAISYS paper, with its parentheses where they are meant."""
    altitude = np.random.uniform(800.0, 1200.0)  # noqa: NPY002 (the paper's)
    scale_xyz = (altitude + np.array(body_radius_xyz)) / np.array(body_radius_xyz)
    roll = np.random.uniform(np.deg2rad(-5), np.deg2rad(5))  # noqa: NPY002
    yaw = np.random.uniform(-np.pi, np.pi)  # noqa: NPY002
    return {"scale_xyz": scale_xyz, "rotation_rpy": np.array([roll, 0.0, yaw])}


RADII = {"body_radius_xyz": lambda: [1000.0, 1000.0, 900.0]}


def drawn(function, index, seed=1, key="k", params=None, offers=RADII):
    return hooks.call(function, key, seed=seed, index=index, offers=offers, params=params)


def test_global_generators_are_keyed_and_restored():
    """Equal in any order, after other draws, and invisible to the rest of the process."""

    def both():
        return np.random.random(3).tolist(), random.random()  # noqa: NPY002

    first = [drawn(both, index) for index in range(4)]
    np.random.seed(5)  # noqa: NPY002
    random.seed(5)
    expected = np.random.random(), random.random()  # noqa: NPY002
    np.random.seed(5)  # noqa: NPY002
    random.seed(5)
    assert [drawn(both, index) for index in (3, 1, 0, 2)] == [first[k] for k in (3, 1, 0, 2)]
    assert (np.random.random(), random.random()) == expected  # noqa: NPY002
    flat = [number for row, other in first for number in (*row, other)]
    assert len(set(flat)) == len(flat)
    assert drawn(both, 0, seed=2) != first[0]
    assert drawn(both, 0, key="other") != first[0]


def test_global_generators_are_restored_after_an_error():
    def fails():
        np.random.seed(0)  # noqa: NPY002
        raise KeyError("no")

    np.random.seed(5)  # noqa: NPY002
    with pytest.raises(KeyError) as error:
        drawn(fails, 0)
    assert "raised by the hook of k" in error.value.__notes__
    after = np.random.random()  # noqa: NPY002
    np.random.seed(5)  # noqa: NPY002
    assert after == np.random.random()  # noqa: NPY002


def test_the_papers_form():
    answers = [drawn(paper_sampler, index) for index in range(50)]
    for answer in answers:
        altitude = answer["scale_xyz"] * [1000.0, 1000.0, 900.0] - [1000.0, 1000.0, 900.0]
        assert np.ptp(altitude) < 1e-9  # the same over each axis
        assert 800.0 <= altitude[0] <= 1200.0
        assert abs(answer["rotation_rpy"][0]) <= np.deg2rad(5)
    again = drawn(paper_sampler, 7)
    assert np.array_equal(again["scale_xyz"], answers[7]["scale_xyz"])


def test_only_what_is_asked_for():
    made = []

    def offer(name):
        return lambda: made.append(name) or name

    offers = {"world": offer("world"), "body_radius_xyz": offer("radii")}
    assert drawn(lambda: 3, 0, offers=offers) == 3
    assert made == []
    assert drawn(lambda world: world, 0, offers=offers) == "world"
    assert made == ["world"]
    assert drawn(lambda a, params: (a, params), 0, params={"a": 2}) == (2, {"a": 2})
    assert drawn(lambda **rest: rest, 0, params={"a": 2}) == {"a": 2}
    numbers = drawn(lambda rng: rng.random(), 3), drawn(lambda rng: rng.random(), 3)
    assert numbers[0] == numbers[1] != drawn(lambda rng: rng.random(), 4)


def test_a_first_argument_of_any_name():
    def call(function, **params):
        offers = {"world": lambda: "w", "body_radius_xyz": lambda: "r"}
        return hooks.call(
            function, "k", seed=0, index=0, offers=offers, params=params, first="world"
        )

    assert call(lambda anything: anything) == "w"
    assert call(lambda world: world) == "w"
    assert call(lambda body_radius_xyz, world: (body_radius_xyz, world)) == ("r", "w")
    assert call(lambda scene, height: (scene, height), height=3) == ("w", 3)
    assert call(str) == "w"
    assert call(lambda *all_of: all_of) == ("w",)


def test_errors_name_the_key():
    with pytest.raises(hooks.HookError, match=r"a\.b: its argument 'x' has no default.*rng"):
        drawn(lambda x: x, 0, key="a.b")
    with pytest.raises(hooks.HookError, match=r"a\.b: params\.height"):
        drawn(lambda rng: 0, 0, key="a.b", params={"height": 1})
    for name, text in (
        ("no_such_module:f", "no_such_module"),
        ("math:no_such_function", "no_such_function"),
        ("math:pi", "not a function"),
    ):
        with pytest.raises(hooks.HookError, match=text):
            hooks.load(name, "a.b")
    assert hooks.load("os:path.join", "a.b")("x", "y")


def test_a_module_beside_the_configuration(tmp_path):
    """Found when it cannot be imported; run once; what it lacks itself is told as such."""

    def find(text, key):
        path = tmp_path / text
        if not path.is_file():
            raise FileNotFoundError(text)
        return path

    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "own_hooks.py").write_text("state = []\ndef f():\n    return state\n")
    (tmp_path / "broken_hooks.py").write_text("import perilune_no_such_module\n")
    function = hooks.load("deep.own_hooks:f", "a.b", find)
    assert function() is hooks.load("deep.own_hooks:f", "a.b", find)()
    for name, what in (
        ("other_hooks:f", "No module named 'other_hooks'"),
        ("broken_hooks:f", "perilune_no_such_module"),
    ):
        with pytest.raises(hooks.HookError, match=r"a\.b = ") as error:
            hooks.load(name, "a.b", find)
        assert what in str(error.value)
        assert "beside the configuration" in str(error.value)
    with pytest.raises(hooks.HookError, match=r"no function 'stat' in own_hooks; .* 'state'"):
        hooks.load("deep.own_hooks:stat", "a.b", find)
    with pytest.raises(hooks.HookError):
        hooks.load("deep.own_hooks:f", "a.b")
