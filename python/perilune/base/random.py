"""Counter-based random numbers, which depend only on (seed, what, frame)."""

from __future__ import annotations

import threading
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.random.bit_generator import ISeedSequence
from numpy.typing import NDArray

_FNV_OFFSET = 0xCBF29CE484222325
_FNV_PRIME = 0x100000001B3
_MASK = (1 << 64) - 1


@lru_cache(maxsize=4096)
def stable_hash(text: str) -> int:
    """FNV-1a of the UTF-8 bytes, 64 bit (RFC 9923), as csrc/base/hash.h: the same everywhere."""
    value = _FNV_OFFSET
    for byte in text.encode():
        value = ((value ^ byte) * _FNV_PRIME) & _MASK
    return value


class _NoSeed(ISeedSequence):
    """A constant instead of entropy, which NumPy would request from the system although a key is
    given."""

    def generate_state(self, n_words: int, dtype: Any = np.uint32) -> NDArray[Any]:
        """Zeros."""
        return np.zeros(n_words, dtype)


_NO_SEED = _NoSeed()
_EMPTY = np.zeros(4, dtype=np.uint64)


def generator(seed: int, what: str, frame: int) -> np.random.Generator:
    """Philox4x64 keyed by (seed, hash of `what`), its counter starting at (0, 0, 0, frame).

    Two frames' streams are 2^192 blocks apart, so they never meet.
    """
    bits = np.random.Philox(_NO_SEED)  # type: ignore[arg-type]  # stubs know SeedSequence alone
    _start(bits, seed, what, frame)
    return np.random.Generator(bits)


_of_thread = threading.local()


def brief_generator(seed: int, what: str, frame: int) -> np.random.Generator:
    """The numbers of `generator`, from an object that the thread's next call for `what` starts
    again: for numbers that are drawn at once. To make a new object takes four times as long."""
    made: dict[str, np.random.Generator] = _of_thread.__dict__
    found = made.get(what)
    if found is None:
        found = made[what] = generator(seed, what, frame)
    else:
        _start(found.bit_generator, seed, what, frame)
    return found


def _start(bits: np.random.BitGenerator, seed: int, what: str, frame: int) -> None:
    key = np.array([seed & _MASK, stable_hash(what)], dtype=np.uint64)
    counter = np.array([0, 0, 0, frame], dtype=np.uint64)
    bits.state = {
        "bit_generator": "Philox",
        "state": {"counter": counter, "key": key},
        "buffer": _EMPTY,
        "buffer_pos": len(_EMPTY),
        "has_uint32": 0,
        "uinteger": 0,
    }
