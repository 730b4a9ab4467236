"""Soil at the feet of rocks: a part of the ground's heights, near rocks alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError
from tests.python import moon

from perilune import _core
from perilune.bodies.rocks import rock_field
from perilune.config.rocks import Rocks

PLACE = np.array([0.9, 0.35, 0.2]) / np.linalg.norm([0.9, 0.35, 0.2])
RIGHT = np.cross([0.0, 0.0, 1.0], PLACE) / np.linalg.norm(np.cross([0.0, 0.0, 1.0], PLACE))
FILLET = 0.2
CELL_M = 0.02
LAW = {"law": "haworth", "min_diameter_m": 0.5, "max_diameter_m": 3.0}


def field(**settings: object) -> _core.RockField:
    return _core.RockField({"radius_m": moon.RADIUS_M, "seed": 4, **LAW, **settings})


def ground(**settings: object) -> _core.Terrain:
    """A plain of slopes of a few degrees."""
    return _core.Terrain(
        np.full(3, moon.RADIUS_M), [], {"seed": 7, "strength": 0.2}, None, field(**settings)
    )


BARE, HEAPED = ground(), ground(fillet=FILLET)


def around(rock: Any, away_m: NDArray[np.float64], turns: int = 24) -> NDArray[np.float64]:
    """Directions (turns, n, 3) at distances from a rock's middle along the ground."""
    up = rock["up"]
    a = np.cross(up, RIGHT) / np.linalg.norm(np.cross(up, RIGHT))
    turn = np.linspace(0.0, 2.0 * np.pi, turns, endpoint=False)
    along = np.cos(turn)[:, None] * a + np.sin(turn)[:, None] * np.cross(up, a)
    at = rock["center"] + along[:, None] * away_m[None, :, None]
    return np.asarray(at / np.linalg.norm(at, axis=-1, keepdims=True))


def raised(directions: NDArray[np.float64], cell_m: float = CELL_M) -> NDArray[np.float64]:
    flat = directions.reshape(-1, 3)
    found = HEAPED.heights(flat, cell_m) - BARE.heights(flat, cell_m)
    return np.asarray(found.reshape(directions.shape[:-1]))


def listed() -> NDArray[np.void]:
    return field().list(BARE, PLACE, 40.0, 0.8)


def test_rocks_are_set_on_the_ground_without_them() -> None:
    np.testing.assert_array_equal(field(fillet=FILLET).list(HEAPED, PLACE, 40.0, 0.8), listed())


def test_heights_widths_and_slopes() -> None:
    """Under a rock there is 0.5 to 1.5 times the share, beside it 0.6 to 1.4 times as much; it
    falls outwards to nothing over 3.2 times as much."""
    shares, slopes, leans = [], [], []
    for rock in listed():
        away_m = np.linspace(0.0, 3.0 * rock["diameter_m"], 121)
        soil_m = raised(around(rock, away_m))
        assert soil_m.min() >= 0.0
        if soil_m[:, -40:].max() > 0.0:  # of another rock
            continue
        shares.append(soil_m[:, 0].max() / rock["height_m"] / FILLET)
        assert 0.49 < shares[-1] < 1.51
        at_foot_m = soil_m.max(axis=1) / soil_m[:, 0].max()
        leans.append((at_foot_m.min(), at_foot_m.max()))
        down = -np.diff(soil_m, axis=1) / np.diff(away_m)
        assert down.min() > -0.2  # under the rock it may rise to one side
        slopes.append(down.max())
    assert len(shares) > 10
    assert np.mean(shares) == pytest.approx(1.0, abs=0.15)
    assert 1.3 < np.median([most for _, most in leans]) < 1.41
    assert 0.9 < np.median([least for least, _ in leans]) < 1.1  # it is 1 in the middle
    assert 0.5 < np.median(slopes) < 1.4 * 2.0 / 3.2  # that of repose, more where it leans


def test_bits_do_not_depend_on_what_is_asked_together() -> None:
    rock = listed()[0]
    at = around(rock, np.linspace(0.0, 2.0 * rock["diameter_m"], 12)).reshape(-1, 3)
    together = HEAPED.heights(at, CELL_M)
    assert (together != BARE.heights(at, CELL_M)).any()
    order = np.random.default_rng(1).permutation(len(at))
    far = np.concatenate([at[order], -at[:3], PLACE[None]])
    np.testing.assert_array_equal(HEAPED.heights(far, CELL_M)[: len(at)], together[order])
    alone = [HEAPED.heights(one[None], CELL_M)[0] for one in at[::7]]
    np.testing.assert_array_equal(alone, together[::7])


def test_they_fade_before_cells_are_too_wide() -> None:
    """In full from 2 cells of their width on, not at all below 1."""
    for rock in listed()[:5]:
        at = around(rock, np.zeros(1), 1)
        high_m = raised(at)[0, 0]
        assert raised(at, 1.6 * high_m)[0, 0] == pytest.approx(high_m, rel=0.05)
        assert raised(at, 6.5 * high_m)[0, 0] == 0.0  # levels are powers of two


def test_bounds_hold() -> None:
    low_m, high_m = HEAPED.bounds
    assert (low_m, high_m) > BARE.bounds
    most_m = max(
        raised(around(rock, np.linspace(0.0, rock["diameter_m"], 9))).max() for rock in listed()
    )
    assert 0.0 < most_m < high_m - BARE.bounds[1]


@pytest.mark.parametrize("fillet", [-0.1, 0.31, math.nan])
def test_errors(fillet: float) -> None:
    with pytest.raises(ValueError, match="fillet = "):
        field(fillet=fillet)
    with pytest.raises(ValidationError, match="fillet"):
        Rocks(fillet=fillet)


def test_the_key_is_the_core_s() -> None:
    given = Rocks(law="haworth", min_diameter_m=0.5, max_diameter_m=3.0, seed=4, fillet=FILLET)
    mine = _core.Terrain(
        np.full(3, moon.RADIUS_M),
        [],
        {"seed": 7, "strength": 0.2},
        None,
        rock_field(given, moon.RADIUS_M),
    )
    at = around(listed()[0], np.linspace(0.0, 1.0, 5)).reshape(-1, 3)
    np.testing.assert_array_equal(mine.heights(at, CELL_M), HEAPED.heights(at, CELL_M))
