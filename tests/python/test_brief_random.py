"""Random numbers from an object that a thread starts again: those of a new one."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

from perilune.base.random import brief_generator, generator


def _drawn(make: object, index: int) -> list[float]:
    rng = make(3, "camera.aim", index)  # type: ignore[operator]
    # an odd number of 32-bit draws leaves half a word, which the next start must drop
    half = int(rng.integers(0, 2**32, dtype="uint32"))
    return [half, *rng.random(index % 5).tolist(), *rng.standard_normal(3).tolist()]


def test_numbers_are_those_of_a_new_generator_in_all_threads() -> None:
    wanted = [_drawn(generator, index) for index in range(40)]
    assert [_drawn(brief_generator, index) for index in range(40)] == wanted
    with ThreadPoolExecutor(4) as pool:
        found = pool.map(lambda index: _drawn(brief_generator, index), range(40))
        assert list(found) == wanted
