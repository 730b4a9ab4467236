"""Short runs of the fuzzers of Python's readers; script/soak has the long ones."""

from __future__ import annotations

import numpy as np
import pytest
from tests.fuzz.readers import READERS, Reader, fuzz, mutated, trial


@pytest.mark.parametrize("name", READERS)
def test_seeds_are_taken_and_mutations_are_errors_or_sound(name, tmp_path):
    """A seed that is refused would let nothing but the first lines of a reader be tried."""
    reader = READERS[name]
    for seed in reader.seeds():
        path = tmp_path / f"seed{reader.suffix}"
        path.write_bytes(seed)
        reader.read(path)
    slow = name in ("configuration", "graph")
    assert fuzz(name, 10 if slow else 40, 7, tmp_path) == []


def test_findings_are_found(tmp_path):
    """Exceptions of other kinds, and errors that say nothing."""

    def broken(path):
        data = path.read_bytes()
        if b"x" not in data:
            raise KeyError("x")
        if len(data) % 2:
            raise ValueError

    reader = Reader(".txt", lambda: [b"xy"], broken)
    path = tmp_path / "a.txt"
    assert trial(reader, b"xy", path) is None
    assert "KeyError" in (trial(reader, b"yy", path) or "")
    assert trial(reader, b"x", path) == "ValueError without a message"


def test_mutations_differ_and_are_repeated():
    made = {mutated(b"a seed of some length", np.random.default_rng((1, k))) for k in range(50)}
    assert len(made) > 40
    one, two = (mutated(b"a seed", np.random.default_rng(5)) for _ in range(2))
    assert one == two
