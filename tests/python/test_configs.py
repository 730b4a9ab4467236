"""The ready-to-run configurations load, find a camera in every frame, and name parts that exist."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path

import numpy as np
import pytest
import yaml

import perilune

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
NAMES = sorted(path.stem for path in CONFIGS.glob("*.yaml"))
FRAMES = (*range(40), 1_000, 100_000)  # far ones too: an orbit must not drift into the night


def params() -> list:
    """One parameter a configuration; those that use data: paths need the data."""
    out = []
    for name in NAMES:
        needs = "data:" in (CONFIGS / f"{name}.yaml").read_text()
        out.append(pytest.param(name, marks=[pytest.mark.needs_data] if needs else []))
    return out


def opened(name: str) -> perilune.Simulation:
    return perilune.open(str(CONFIGS / f"{name}.yaml"))


def test_there_are_the_configurations_the_readme_names():
    assert set(NAMES) >= {"demo", "iss_leo", "voyager_phobos", "mro_mars", "lro_moon"}


def test_the_demo_needs_no_data():
    assert "data:" not in (CONFIGS / "demo.yaml").read_text()


@pytest.mark.parametrize("name", params())
def test_every_frame_has_a_camera_and_a_sunlit_target(name):
    simulation = opened(name)
    target = simulation.config.camera.trajectory.target
    for index in FRAMES:
        simulation.request(index)  # raises when no camera pose meets the limits
        world = simulation.world(index)
        place = world.position_m(target)
        to_sun = world.sun_position_m - place
        to_sun /= np.linalg.norm(to_sun)
        shaded = [body for body in world.body_radii_m if world.hit_m(body, place, to_sun)]
        assert not shaded, f"frame {index}: {target} is in the shadow of {shaded}"


@pytest.mark.parametrize("name", params())
def test_every_pattern_of_part_classes_matches_a_part(name):
    simulation = opened(name)
    raw = yaml.safe_load((CONFIGS / f"{name}.yaml").read_text())
    for craft, entry in raw.get("spacecraft", {}).items():
        parts = [part for part in simulation.taxonomy.parts if part.owner == craft]
        known = [text.lower() for part in parts for text in (part.name, part.material)]
        for patterns in entry.get("part_classes", {}).values():
            for pattern in patterns:
                assert any(fnmatch(text, pattern.lower()) for text in known), (craft, pattern)
