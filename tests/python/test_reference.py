"""`render.quality: reference`: what it sets, and what contradicts it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune.config.errors import ConfigError

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
