"""A tiny simulation, and loaders of the real torch."""

from __future__ import annotations

import pytest

import perilune

TINY = {"camera.width": 16, "camera.height": 12, "render.samples": 1}


@pytest.fixture(scope="session")
def scene_file(repo_dir):
    return repo_dir / "tests/python/scene.yaml"


@pytest.fixture(scope="session")
def sim(scene_file):
    return perilune.open(scene_file, overrides=TINY)
