"""Configurations read with libyaml and with PyYAML's own parser are the same."""

from __future__ import annotations

import os
import random
from typing import Any

import pytest
import yaml
from hypothesis import given, strategies as st

from perilune.document import loader

pytestmark = pytest.mark.skipif(
    loader._Fast is None and os.environ.get("CI") != "true", reason="PyYAML without libyaml"
)

TEXT = """\
version: 1  # the format's, from "1" up
time: {epoch: 2026-03-20T12:00:00Z, step_s: 6.0e1}
bodies:
  earth: {kind: earth, albedo: [0.1, .2, 3.e-1], clouds: null, on: off}
  moon: &moon
    note: |
      two lines: of text
      'and' "quotes" # no comment
  other: {<<: *moon, radius_km: -010, text: "a\\n\\u00e9: b", plain: a - b#c}
list:
- [true, False, ~, .inf, -.nan]
- >-
  folded
  text
"""


SYNTAX = st.text("\t\n :-[]{},'\"#&*!|>%@`?\u00e9\u20280a~<", max_size=3)


def plain(text: str) -> Any:
    """The tree by PyYAML's own parser, as text, so that nan equals nan; None for an error."""
    try:
        return repr(yaml.load(text, Loader=loader._Loader))
    except (yaml.YAMLError, ValueError, RecursionError):
        return None


def check(text: str) -> bool:
    """Whether libyaml read the text, and then as the other parser does."""
    tree = loader._parsed_fast(text)
    if tree is not None:
        assert repr(tree) == plain(text)
    return tree is not None


def test_files_of_the_package_are_read_fast(repo_dir):
    folders = ("configs", "assets/materials")
    paths = [path for folder in folders for path in (repo_dir / folder).glob("*.yaml")]
    fast = [check(path.read_text()) for path in paths]
    assert len(fast) > 30
    assert sum(fast) > 0.9 * len(fast)
    assert check(TEXT)


@given(
    seed=st.integers(0, 2**32),
    inserted=SYNTAX,
)
def test_damaged_texts_are_read_alike(seed, inserted):
    draw = random.Random(seed)
    lines = TEXT.splitlines(keepends=True)
    first = draw.randrange(len(lines))
    text = "".join(lines[first : first + draw.randrange(1, 8)])
    for character in inserted:
        place = draw.randrange(len(text) + 1)
        text = text[:place] + character + text[place + draw.randrange(2) :]
    check(text)


def test_what_libyaml_refuses_or_reads_otherwise_is_left_to_the_other():
    for text in ("a: b\t", "|# text", "a: [", "[a:, b]", "\ufeffa: 1", "!", ""):
        assert loader._parsed_fast(text) is None
    assert loader.parse_yaml("{a:, b: 1}", "x") == {"a": None, "b": 1}
    assert loader._parsed_fast("[" * 100_000) is None
