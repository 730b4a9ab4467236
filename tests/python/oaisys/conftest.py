"""The tree of one OAISYS file, and its sections."""

from __future__ import annotations

import pytest
from tests.python.oaisys.oaisys_files import FOLDER

from perilune.document.loader import read_tree


@pytest.fixture
def tree():
    """The tree of listing 4's file, free to be changed."""
    return read_tree(FOLDER / "satellite_circular.json")


@pytest.fixture
def planet(tree):
    return tree["ASSET_SETUP"]["MESHES"][0]["meshParams"]


@pytest.fixture
def iss(tree):
    return tree["ASSET_SETUP"]["MESHES"][1]


@pytest.fixture
def general(tree):
    return tree["SENSOR_SETUP"]["GENERAL"]
