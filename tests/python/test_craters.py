"""Craters of a body from Python: lists, relief, errors."""

from __future__ import annotations

import numpy as np
import pytest

from perilune import _core

MOON_M = 1737400.0
PLACE = np.array([0.2, -0.5, 0.8]) / np.linalg.norm([0.2, -0.5, 0.8])


def field(**settings: object) -> _core.CraterField:
    return _core.CraterField({"radius_m": MOON_M, "seed": 4, **settings})


def test_counts_of_equilibrium() -> None:
    """794 craters of 10 m or more on a km^2 (Trask 1966), within 4.5 standard errors."""
    craters = field(law="trask").list(PLACE, 2000.0, 10.0)
    expected = 794.328 * np.pi * 4.0 * (1.0 - (10.0 / 300e3) ** 2)
    assert abs(len(craters) - expected) < 4.5 * np.sqrt(expected)
    assert craters.dtype == np.dtype(list(_core.CRATER))
    assert len(set(craters["id"].tolist())) == len(craters)
    assert (craters["diameter_m"] >= 10.0).all()
    np.testing.assert_allclose(np.linalg.norm(craters["direction"], axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(
        np.sum(craters["direction"] * craters["major"], axis=1), 0.0, atol=1e-12
    )
    assert (craters["direction"] @ PLACE >= np.cos(2000.0 / MOON_M) - 1e-12).all()


def test_most_small_craters_are_shallow() -> None:
    """Half of all have d/D below 0.07, and few above 0.12: the classes of Basilevsky (1976)."""
    craters = field().list(PLACE, 1500.0, 5.0)
    shallow = craters["depth_m"] / craters["diameter_m"]
    assert np.mean(shallow < 0.07) > 0.5
    assert 0.005 < np.mean(shallow > 0.1) < 0.2


def test_heights_have_the_craters_of_the_list() -> None:
    craters = field(irregularity=0.0)
    listed = craters.list(PLACE, 3000.0, 50.0)
    fresh = listed[(listed["tau"] < 0.05) & (listed["kept"] == 1.0)]
    assert len(fresh) > 5
    centre, major = fresh["direction"], fresh["major"]
    angle = (0.5 * fresh["diameter_m"] / MOON_M)[:, None]
    rim = np.cos(angle) * centre + np.sin(angle) * major
    low = craters.heights(np.ascontiguousarray(centre), 2.0)
    high = craters.heights(np.ascontiguousarray(rim), 2.0)
    assert np.median((high - low) / fresh["depth_m"]) == pytest.approx(1.0, abs=0.2)


def test_laws_are_named() -> None:
    names = [row["name"] for row in _core.CRATER_LAWS]
    assert "neukum_equilibrium" in names
    table = [(1.0, 1e-2), (10.0, 1e-4), (1000.0, 1e-8)]
    for name in names:
        made = field(
            law=name,
            min_diameter_m=40.0,
            max_diameter_m=900.0,
            table=table,
            coefficient=0.01,
            exponent=-2.0,
        )
        assert len(made.list(PLACE, 3000.0)) > 0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"law": "neukum"}, "law.*neukum_2001"),
        ({"law": "neukum_2001", "min_diameter_m": 1.0}, "neukum_equilibrium"),
        ({"min_diameter_m": 0.0}, "craters of 0 to"),
        ({"surface_age_ga": 5.0}, "surface_age_ga = 5"),
        ({"seed": -1}, "seed must be"),
        ({"law": "table"}, "2 entries"),
        ({"table": [1.0, 2.0]}, "table"),
    ],
)
def test_errors(settings: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        field(**settings)


def test_errors_of_queries() -> None:
    craters = field()
    with pytest.raises(ValueError, match=r"can be listed: raise the least diameter"):
        craters.list(PLACE, 50e3, 0.5)
    with pytest.raises(ValueError, match="direction 1 is 0"):
        craters.heights(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    with pytest.raises(ValueError, match="footprint_m"):
        craters.heights(np.array([[1.0, 0.0, 0.0]]), -1.0)
    with pytest.raises(ValueError, match="radius_m"):
        _core.CraterField({})
