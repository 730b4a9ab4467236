"""Streams that make frames ahead: the same frames, changes, states and errors as without."""

from __future__ import annotations

import itertools
import threading
import types

import numpy as np
import pytest

import perilune
from perilune.training.ahead import Ahead

TINY = {"camera.width": 16, "camera.height": 12, "render.samples": 1}
CHANNELS = ["rgb", "depth"]
LONG_S = 60.0
"""Longer than anything here takes, so that a loop that would wait for ever ends."""


@pytest.fixture(scope="module")
def sim(request):
    return perilune.open(request.config.rootpath / "tests/python/scene.yaml", overrides=TINY)


def stream_of(sim, prefetch, **options):
    return perilune.Stream(sim, start=3, channels=CHANNELS, prefetch=prefetch, **options)


def taken(stream, count):
    return list(itertools.islice(stream, count))


def indices(samples):
    return [sample.meta["index"] for sample in samples]


@pytest.mark.parametrize("prefetch", [1, 3])
def test_frames_are_the_same(sim, prefetch):
    plain = taken(stream_of(sim, 0, shard=(1, 2)), 4)
    ahead = taken(stream_of(sim, prefetch, shard=(1, 2)), 4)
    assert indices(plain) == indices(ahead) == [4, 6, 8, 10]
    for one, other in zip(plain, ahead, strict=True):
        assert all(np.array_equal(one[name], other[name], equal_nan=True) for name in CHANNELS)


def test_the_next_frame_is_made_while_the_loop_works(sim):
    made = [threading.Event() for _ in range(8)]
    threads = set()

    def note(sample):
        threads.add(threading.current_thread())
        made[sample.meta["index"]].set()
        return sample

    for sample in itertools.islice(stream_of(sim, 2, transform=note), 3):
        assert made[sample.meta["index"] + 2].wait(LONG_S)
    assert len(threads) == 1
    assert threads != {threading.current_thread()}


def test_nothing_runs_after_the_loop(sim):
    """A loop that is left waits for the frame that is being made, and drops the others."""
    made = []
    before = set(threading.enumerate())
    for _ in stream_of(sim, 3, transform=made.append):
        break
    assert set(threading.enumerate()) <= before
    assert len(made) <= 4


def test_a_loop_goes_on_and_resumes_with_the_frame_after_the_last(sim):
    stream = stream_of(sim, 3)
    assert indices(taken(stream, 2)) == [3, 4]
    assert stream.position == 2
    state = stream.state_dict()
    assert indices(taken(stream, 2)) == [5, 6]
    other = stream_of(sim, 1)
    other.load_state_dict(state)
    assert indices(taken(other, 2)) == [5, 6]


def test_a_state_that_is_loaded_within_a_loop_drops_what_was_made(sim):
    stream = stream_of(sim, 2)
    state, loop = stream.state_dict(), iter(stream)
    assert indices([next(loop), next(loop)]) == [3, 4]
    stream.load_state_dict(state)
    assert indices([next(loop), next(loop)]) == [3, 4]


def test_changes_hold_from_the_first_frame_that_is_not_begun(sim):
    stream = stream_of(sim, 2)
    loop = iter(stream)
    next(loop)
    since = stream.set({"camera.width": 20})
    assert since == 6  # 3 is handed out; 4 and 5 are made or being made
    with pytest.raises(ValueError, match="the earliest is 6"):
        stream.set({"camera.width": 24}, at=5)
    widths = [next(loop)["rgb"].shape[1] for _ in range(4)]
    assert widths == [16, 16, 20, 20]


def test_an_error_comes_in_its_turn(sim):
    def refuse(sample):
        if sample.meta["index"] == 5:
            raise ArithmeticError("not this one")
        return sample

    stream = stream_of(sim, 3, transform=refuse)
    loop = iter(stream)
    assert indices([next(loop), next(loop)]) == [3, 4]
    with pytest.raises(ArithmeticError, match="not this one"):
        next(loop)
    assert stream.position == 2
    stream.transform = None
    assert indices(taken(stream, 2)) == [5, 6]


def test_wrong_numbers(sim):
    for prefetch, error in ((-1, ValueError), (1.5, TypeError), ("2", TypeError)):
        with pytest.raises(error, match="prefetch"):
            stream_of(sim, prefetch)


def test_workers_make_frames_ahead_by_themselves(sim, monkeypatch):
    info = types.SimpleNamespace(id=0, num_workers=2)
    monkeypatch.setattr("perilune.dataset.in_torch_worker", lambda: True)
    monkeypatch.setattr("perilune.dataset.torch_worker", lambda: (info.id, info.num_workers))
    with pytest.raises(ValueError, match="prefetch = 2: leave it out in workers"):
        next(iter(stream_of(sim, 2)))


def test_tasks_run_in_order_and_no_more_than_asked_ahead():
    begun = []

    def begin(position):
        begun.append(position)
        return lambda: 10 * position

    with Ahead[int](2) as ahead:
        for taken_before in range(4):
            assert ahead.take(lambda k, n=taken_before: n + k, begin) == 10 * taken_before
            assert begun == list(range(taken_before + 3))
