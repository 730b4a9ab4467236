"""OAISYS files with one value replaced: each loads, or fails with an error that names the file.

Nothing else may come out of the reader, whatever stands where: not a TypeError, not a KeyError.
"""

from __future__ import annotations

import copy
import warnings
from pathlib import Path

import pytest

from perilune import document as cfg
from perilune.config import ConfigError
from perilune.document.loader import read_tree

FOLDER = Path(__file__).resolve().parents[3] / "configs" / "oaisys"
ABSURD = (None, True, -1, 1e300, "", "x", [], [1], [["x"]], {"x": 1})


def leaves(tree, path=()):
    """Every place of the tree: mappings, lists and values."""
    if path:
        yield path
    items = tree.items() if isinstance(tree, dict) else enumerate(tree)
    for key, value in items if isinstance(tree, (dict, list)) else ():
        if isinstance(value, (dict, list)):
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key)


def replaced(tree, path, value):
    tree = copy.deepcopy(tree)
    node = tree
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    return tree


WHOLE, MOTION = (), ("SENSOR_SETUP", "GENERAL")


@pytest.mark.parametrize(
    ("name", "below"),
    [("satellite_circular", WHOLE), ("linear", MOTION), ("spiral", MOTION), ("custom", MOTION)],
)
def test_any_value_in_any_place(name, below):
    tree = read_tree(FOLDER / f"{name}.json")
    loaded = failed = 0
    for path in leaves(tree):
        if path[: len(below)] != below:
            continue
        for value in ABSURD:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                try:
                    cfg.load(replaced(tree, path, value), base=FOLDER)
                    loaded += 1
                except ConfigError as error:
                    failed += str(error).startswith("configuration:\n  ")
                except Exception as error:
                    pytest.fail(f"{path} = {value!r}: {type(error).__name__}: {error}")
    assert loaded > 5
    assert failed > 30  # with the file's name
