"""Fixtures of the tests of orbits."""

from __future__ import annotations

import pytest

from perilune.document.loader import read_tree


@pytest.fixture
def scene(repo_dir):
    """A tree without a model to load: the small scene of the tests, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")
