"""Opening a configuration of many spacecraft: its work grows with their number, not its square."""

from __future__ import annotations

from copy import deepcopy

import pytest

import perilune
from perilune.config.errors import ConfigError
from perilune.config.schema import Config
from perilune.document.loader import read_tree


def many(repo_dir, count):
    """The small scene with copies of its satellite, each with drivers and an altitude of its
    own."""
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    sat = tree["spacecraft"]["sat"]
    sat["model"] = str(repo_dir / "assets/models/smallsat.glb")
    sat["size_m"] = {"uniform": [1.0, 2.0]}
    sat["orbit"]["raan_deg"] = {"uniform": [80.0, 90.0]}
    for i in range(count - 1):
        other = deepcopy(sat)
        other["orbit"]["altitude_km"] = 600.0 + i
        tree["spacecraft"][f"copy_{i}"] = other
    return tree


def sections(monkeypatch, tree):
    """Number of sections of spacecraft that are validated while a tree is opened."""
    validate, counts = Config.model_validate.__func__, []

    def counting(cls, given, **options):
        counts.append(len(given["spacecraft"]))
        return validate(cls, given, **options)

    with monkeypatch.context() as patch:
        patch.setattr(Config, "model_validate", classmethod(counting))
        perilune.open(tree)
    return sum(counts)


def test_sections_are_validated_a_fixed_number_of_times(repo_dir, monkeypatch):
    few, many_more = (sections(monkeypatch, many(repo_dir, n)) for n in (5, 30))
    assert many_more <= 6 * few


def test_spacecraft_that_are_alike_share_what_is_made_of_them(repo_dir):
    sim = perilune.open(many(repo_dir, 4), overrides={"camera.width": 16, "camera.height": 12})
    objects = sim.frame(0, ["objects"]).objects
    cuts = list(sim._mine().partitions.values())
    assert len(objects) == 4
    assert all(cut is cuts[0] for cut in cuts)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("size_m", {"ideal": 1.0, "jitter_variance": 1.0, "clip_min": -1.0, "clip_max": 2.0}),
        (
            "orbit.altitude_km",
            {"ideal": 500.0, "jitter_variance": 1.0, "clip_min": -1e9, "clip_max": 600.0},
        ),
        ("orbit", {"choice": [{"around": "earth", "altitude_km": 1.0}, {"around": "nowhere"}]}),
    ],
)
def test_a_limit_that_is_no_value_is_found_on_any_of_them(repo_dir, key, value):
    tree = many(repo_dir, 6)
    section = tree["spacecraft"]["copy_3"]
    *above, last = key.split(".")
    for name in above:
        section = section[name]
    section[last] = value
    with pytest.raises(ConfigError, match=rf"copy_3\.{key}"):
        perilune.open(tree)


def test_a_spacecraft_that_another_names_takes_part(repo_dir):
    tree = many(repo_dir, 4)
    tree["spacecraft"]["copy_1"]["attitude"] = {"pointing": "target", "target": "copy_2"}
    perilune.open(tree)
    tree["spacecraft"]["copy_1"]["attitude"]["target"] = {"choice": ["copy_2", "copy_9"]}
    with pytest.raises(ConfigError, match="copy_9"):
        perilune.open(tree)
