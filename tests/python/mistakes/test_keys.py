"""Mistakes in keys of a configuration are told by file, key and value, with the nearest name."""

from __future__ import annotations

import re
import warnings

import pytest
from tests.python.mistakes.keys import KEYS
from tests.python.mistakes.rule import fault

import perilune
from perilune.document.loader import read_tree

SCENE = "tests/python/scene.yaml"


def shown(key):
    """A key as messages have it."""
    return re.sub(r"\.(\d+)", r"[\1]", key)


def as_file(repo_dir, key, value):
    """Opens the scene as a user would who has written this into the file."""
    tree = read_tree(repo_dir / SCENE)
    *parents, last = key.lstrip("!").split(".")
    node = tree
    for name in parents:
        node = node.setdefault(name, {})
    if value is None:
        node.pop(last)
    else:
        node[last] = value
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return perilune.open(tree, base=repo_dir / "tests/python")


@pytest.mark.parametrize(("key", "value", "needed"), [(k, v, n) for k, v, *n in KEYS])
def test_it_is_told_by_its_key(repo_dir, key, value, needed):
    named = [] if key.startswith("!") else [shown(key)]
    found = fault(lambda: as_file(repo_dir, key, value), ["configuration", *named, *needed])
    assert not found


def test_the_mistakes_are_different_ones():
    seen = {(key, repr(value)) for key, value, *_ in KEYS}
    assert len(seen) == len(KEYS) >= 180
