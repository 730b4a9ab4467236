"""Arrays come back only when nobody can see them any more."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.frame.pool import Pool

SHAPE, TYPE = (300, 200), np.dtype(np.float64)


def _take(pool: Pool, name: str = "depth", shape: tuple[int, ...] = SHAPE) -> Any:
    return pool.take(name, shape, TYPE)


def _address(array: Any) -> int:
    return int(array.ctypes.data)


def test_array_that_was_dropped_comes_again() -> None:
    pool = Pool()
    first = _take(pool)
    address = _address(first)
    del first
    assert _address(_take(pool)) == address
    assert _take(pool).shape == SHAPE
    assert _take(pool).dtype == TYPE


@pytest.mark.parametrize(
    "hold",
    [
        lambda a: a,
        lambda a: a[3:5, ::2],
        lambda a: a.T,
        memoryview,
        lambda a: {"deep": [a.view(np.uint8)]},
        lambda a: np.frombuffer(memoryview(a).cast("B"), dtype=np.uint8),
    ],
)
def test_array_that_is_held_in_any_way_does_not(hold: Any) -> None:
    pool = Pool()
    first = _take(pool)
    first[...] = 7.0
    held = hold(first)
    address = _address(first)
    del first
    for _ in range(4):
        other = _take(pool)
        assert _address(other) != address
        other[...] = 1.0
    assert held is not None


def test_a_loop_needs_two() -> None:
    pool = Pool()
    seen = set()
    for _ in range(10):
        array = _take(pool)  # held while the next is taken
        seen.add(_address(array))
    assert len(seen) == 2


def test_no_more_than_two_are_kept() -> None:
    pool = Pool()
    held = [_take(pool) for _ in range(5)]
    assert len({_address(array) for array in held}) == 5
    addresses = [_address(array) for array in held]
    del held
    gc.collect()
    again = [_take(pool), _take(pool)]
    assert {_address(array) for array in again} == set(addresses[-2:])


def test_channels_and_sizes_do_not_mix() -> None:
    pool = Pool()
    assert _take(pool).shape == SHAPE
    assert _take(pool, shape=(200, 400)).shape == (200, 400)
    a, b = _take(pool, "depth"), _take(pool, "range")
    assert not np.shares_memory(a, b)


@pytest.mark.parametrize("spoil", ["lock", "shape"])
def test_array_that_a_holder_changed_is_dropped(spoil: str) -> None:
    pool = Pool()
    first = _take(pool)
    if spoil == "lock":
        first.flags.writeable = False
    else:
        first.shape = (200, 300)
    del first
    array = _take(pool)
    assert array.flags.writeable
    assert array.shape == SHAPE


def test_frames_do_not_show_what_their_arrays_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every value of every channel is written, of those of the sensor too."""
    scene = Path(__file__).parent / "scene.yaml"
    sim = perilune.open(scene, overrides={"camera.sensor": {}})
    channels = [row["name"] for row in _core.CHANNELS]
    shown, taken = [], set()
    for content in (0x00, 0xAB):

        def take(pool: Pool, name: str, shape: Any, dtype: Any, byte: int = content) -> Any:
            taken.add(name)
            size = dtype.itemsize * int(np.prod(shape))
            return np.full(size, byte, np.uint8).view(dtype).reshape(shape)

        monkeypatch.setattr(Pool, "take", take)
        sample = sim.frame(3, channels=channels, threads=2)
        shown.append({name: np.asarray(sample[name]).tobytes() for name in sample})
    assert taken >= set(shown[0])
    assert {"rgb", "raw", "sensor_rgb"} <= taken
    assert [name for name in shown[0] if shown[0][name] != shown[1][name]] == []
