"""Levels of `semantic` that a configuration makes itself."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree


@pytest.fixture
def scene(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["labels"] = {"levels": ["origin", "object"], "ids": {"origin": {"made": 7}}}
    tree["spacecraft"]["sat"]["classes"] = {"origin": "made"}
    return tree


def opened(repo_dir, tree):
    return perilune.open(tree, base=repo_dir / "tests/python")


def test_one_without_a_class_is_background(repo_dir, scene):
    sim = opened(repo_dir, scene)
    sample = sim.frame(0, ["semantic", "instance"])
    names = sim.taxonomy.names("instance")
    for number in np.unique(sample["instance"]).tolist():
        ids = np.unique(sample["semantic"][sample["instance"] == number][:, 0])
        assert ids.tolist() == [7 if names[number] == "sat" else 0]
    assert sim.taxonomy.names("semantic/0") == {0: "background", 7: "made"}
    assert sim.taxonomy.names("origin") == {0: "background", 7: "made"}


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"levels": ["orign", "object"]}, "no level 'origin'; did you mean 'orign'"),
        ({"levels": ["object"]}, "labels.ids.origin: no level 'origin'"),
        ({"levels": ["objct", "origin"]}, "labels.levels[0]: no 'objct'; did you mean 'object'"),
        ({"levels": ["a b"]}, "labels.levels[0]"),
        ({"ids": {"origin": {"mad": 7}}}, "labels.ids.origin: no class named 'mad'"),
    ],
)
def test_wrong_levels(repo_dir, scene, change, expected):
    scene["labels"] |= change
    with pytest.raises(ConfigError) as error:
        _ = opened(repo_dir, scene).taxonomy
    assert expected in str(error.value)


def test_levels_that_other_keys_say(repo_dir, scene):
    scene["spacecraft"]["sat"]["classes"]["object"] = "x"
    with pytest.raises(ConfigError, match=r"classes\.object: the key `class` says it"):
        opened(repo_dir, scene)
