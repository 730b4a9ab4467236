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


@pytest.fixture
def grouped(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["labels"] = {
        "levels": ["group", "material"],
        "classes": {"group": {"optics": ["telescope*"], "foil": ["*/mli_*"]}},
    }
    return tree


def expected_of(sim, group):
    """(part id -> class names) by a rule written again, on lower-case names."""
    names = {}
    for part in sim.taxonomy.parts:
        if part.owner == "sat":
            names[part.id] = (group(part.name, part.material), part.material)
    return names


def assert_semantic(sim, expected):
    sample = sim.frame(3, ["semantic", "part"])
    levels = sim.taxonomy.levels
    named = [sim.taxonomy.names(level) for level in levels]
    seen = set(np.unique(sample["part"]).tolist()) & set(expected)
    assert len(seen) > 10
    for number in seen:
        ids = np.unique(sample["semantic"][sample["part"] == number], axis=0)
        assert ids.shape == (1, len(levels))
        found = tuple(names[k] for names, k in zip(named, ids[0].tolist(), strict=True))
        assert found == tuple(name or "background" for name in expected[number])


def test_patterns_at_a_level_of_ones_own(repo_dir, grouped):
    def group(name, material):
        if name.startswith("telescope"):
            return "optics"
        return "foil" if material.startswith("mli_") else None

    sim = opened(repo_dir, grouped)
    assert sim.taxonomy.names("group") == {0: "background", 1: "optics", 2: "foil"}
    assert_semantic(sim, expected_of(sim, group))


def test_a_spacecraft_that_speaks_for_itself_is_not_asked_by_patterns(repo_dir, grouped):
    grouped["spacecraft"]["sat"]["classes"] = {"group": {"wing": ["*PANEL*"]}}
    sim = opened(repo_dir, grouped)
    panel = expected_of(sim, lambda name, material: "wing" if "panel" in name + material else None)
    assert_semantic(sim, panel)
    grouped["spacecraft"]["sat"]["classes"] = {"group": "whole"}
    sim = opened(repo_dir, grouped)
    assert_semantic(sim, expected_of(sim, lambda *_: "whole"))


def test_fixed_ids_of_materials(repo_dir, grouped):
    grouped["labels"]["ids"] = {"material": {"mli_gold": 40000}}
    assert opened(repo_dir, grouped).taxonomy.classes["material"]["mli_gold"] == 40000
    grouped["labels"]["ids"] = {"material": {"mli_gild": 40000}}
    with pytest.raises(ConfigError, match="did you mean 'mli_gold'"):
        _ = opened(repo_dir, grouped).taxonomy


def test_patterns_that_match_nothing_are_told(repo_dir, grouped):
    grouped["labels"]["classes"]["group"]["ghost"] = ["ghost*"]
    grouped["labels"]["classes"]["group"]["foil"].append("phantom")  # another pattern matches
    found = dict(opened(repo_dir, grouped).unmatched_part_classes())
    assert list(found) == ["labels.classes.group.ghost"]
    grouped["spacecraft"]["sat"]["classes"] = {"group": {"wing": ["*panel*", "antena_boom"]}}
    found = dict(opened(repo_dir, grouped).unmatched_part_classes())
    assert "did you mean 'antenna_boom'" in found["spacecraft.sat.classes.group.wing"]


@pytest.mark.parametrize(
    ("level", "expected"),
    [
        ("part", r"labels\.classes\.part: the key `part_classes` says it"),
        ("material", r"labels\.classes\.material: follows from the model's file"),
        ("grop", r"labels\.classes\.grop: none of labels\.levels; did you mean 'group'"),
    ],
)
def test_patterns_at_levels_that_have_none(repo_dir, grouped, level, expected):
    grouped["labels"]["classes"][level] = {"a": ["*"]}
    with pytest.raises(ConfigError, match=expected):
        opened(repo_dir, grouped)


def test_a_level_whose_table_is_empty_is_refused(repo_dir, grouped):
    grouped["labels"]["classes"]["group"] = {}
    with pytest.raises(ConfigError, match=r"labels\.levels\[0\]: no 'group'"):
        opened(repo_dir, grouped)
