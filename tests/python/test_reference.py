"""`render.quality`: what each word sets, and what contradicts it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import perilune
from perilune.config.errors import ConfigError
from perilune.config.render import QUALITIES, Render

SCENE = Path(__file__).parent / "scene.yaml"


def opened(**render: Any) -> perilune.Simulation:
    size = {"camera.width": 32, "camera.height": 24}
    return perilune.open(SCENE, overrides=size | {f"render.{k}": v for k, v in render.items()})


def test_reference_is_a_tolerance_of_0() -> None:
    assert opened().config.render.tolerance_dn == 1.0
    assert opened(quality="reference").config.render.tolerance_dn == 0.0
    assert opened(quality="adaptive", tolerance_dn=2.0).config.render.tolerance_dn == 2.0


def test_same_bits_as_a_tolerance_of_0() -> None:
    a = opened(quality="reference", samples=4).frame(1, channels=["radiance"])["radiance"]
    b = opened(tolerance_dn=0.0, samples=4).frame(1, channels=["radiance"])["radiance"]
    assert np.array_equal(a, b)


def test_reference_leaves_out_nothing() -> None:
    sim = opened(quality="reference")
    assert [row["name"] for row in sim.plan(1) if row["value"] == 0 and row["bound_dn"] > 0.0] == []


@pytest.mark.parametrize(
    ("render", "message"),
    [
        ({"tolerance_dn": 1.0}, "render.tolerance_dn: is 1, but quality: reference"),
        ({"force_off": ["bounces"]}, "render.force_off: leaves out bounces, but quality"),
    ],
)
def test_contradictions(render: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        opened(quality="reference", **render)


def test_nearest_name() -> None:
    with pytest.raises(ConfigError, match="did you mean 'reference'"):
        opened(quality="refrence")


def keys(sim: perilune.Simulation) -> dict[str, Any]:
    return {key: getattr(sim.config.render, key) for key in QUALITIES["train"]}


@pytest.mark.parametrize("word", QUALITIES)
def test_a_word_sets_its_keys_and_says_so(word: str) -> None:
    """In place of what the file says."""
    tree = yaml.safe_load(SCENE.read_text())
    tree["render"] = {"samples": 7, "tolerance_dn": 3.0, "texture_filter": "nearest"}
    tree["camera"] |= {"width": 32, "height": 24}
    assert perilune.open(tree, base=SCENE.parent).config.render.named_quality == "adaptive"
    sim = perilune.open(tree, base=SCENE.parent, overrides={"render.quality": word})
    kept = {"samples": 7} if word == "reference" else {}  # which may have any number
    assert keys(sim) == {**QUALITIES[word], **kept}
    assert sim.frame(0, channels=["depth"]).meta["quality"] == word
    assert keys(opened(quality=word, **QUALITIES[word])) == QUALITIES[word]


@pytest.mark.parametrize("word", ["draft", "train"])
@pytest.mark.parametrize(
    ("key", "value"), [("samples", 7), ("tolerance_dn", 0.5), ("texture_filter", "nearest")]
)
def test_a_key_beside_a_word_is_refused(word: str, key: str, value: object) -> None:
    with pytest.raises(ConfigError, match=f"render.{key}: is {value}, but quality: {word} is"):
        opened(quality=word, **{key: value})


def test_a_configuration_that_says_nothing_trains() -> None:
    assert Render().named_quality == "train"
    assert all(getattr(Render(), key) == value for key, value in QUALITIES["train"].items())
    assert Render(tolerance_dn=0.0).named_quality == "adaptive"


def test_a_word_has_the_bits_of_its_keys() -> None:
    a = opened(quality="draft").frame(1, channels=["radiance"])["radiance"]
    b = opened(**QUALITIES["draft"]).frame(1, channels=["radiance"])["radiance"]
    assert np.array_equal(a, b)


def test_drafts_are_coarser_than_what_one_trains_with() -> None:
    draft, train, reference = (QUALITIES[word] for word in ("draft", "train", "reference"))
    assert draft["samples"] < train["samples"] < reference["samples"]
    assert draft["tolerance_dn"] > train["tolerance_dn"] > reference["tolerance_dn"] == 0.0


def test_a_study_spells_the_word_out() -> None:
    """So that it may change one of its keys."""
    changes = opened(quality="draft").config.render.spelt_out
    sim = opened(quality="draft").with_overrides({**changes, "render.samples": 3})
    assert keys(sim) == {**QUALITIES["draft"], "samples": 3}
