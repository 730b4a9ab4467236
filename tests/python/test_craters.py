"""Craters of a body from Python: lists, relief, errors."""

from __future__ import annotations

from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from pydantic import ValidationError

from perilune import _core
from perilune.bodies.craters import crater_field, read_catalogue
from perilune.config.craters import CraterLaw, Craters

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
    """Half of all are below 0.07 D, a fifth above 0.1 D: the classes of Basilevsky (1976), of
    craters that are 0.2 D deep when fresh. Those below 100 m are shallower."""
    for from_m, radius_m, shallow, deep in ((5.0, 1.5e3, 0.73, 0.09), (250.0, 6e4, 0.59, 0.22)):
        craters = field().list(PLACE, radius_m, from_m)
        depth = craters["depth_m"] / craters["diameter_m"]
        assert np.mean(depth < 0.07) == pytest.approx(shallow, abs=0.03)
        assert np.mean(depth > 0.1) == pytest.approx(deep, abs=0.03)
        assert depth.min() > 0.015  # what is worn down further is not counted as a crater


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


def walls(terraces: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Heights (craters, azimuths, radii) of young craters of 30 to 60 km, round, and those of their
    rims and floors."""
    keys = {"law": "power", "coefficient": 1e-3, "exponent": -2.0, "terraces": terraces}
    sizes = {"min_diameter_m": 30e3, "max_diameter_m": 60e3}
    made = field(irregularity=0.0, diffusivity_m2_per_myr=0.1, **keys, **sizes)
    found = made.list(PLACE, 1500e3)
    found = found[found["kept"] == 1.0]
    apart = np.linalg.norm(found["direction"][:, None] - found["direction"], axis=-1) * MOON_M
    np.fill_diagonal(apart, np.inf)
    found = found[apart.min(axis=1) > 200e3]  # alone within their reach
    x, turn = np.linspace(0.0, 1.0, 161), np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    minor = np.cross(found["direction"], found["major"])
    way = (
        np.cos(turn)[None, :, None] * found["major"][:, None]
        + np.sin(turn)[None, :, None] * minor[:, None]
    )
    angle = (0.5 * found["diameter_m"] / MOON_M)[:, None, None, None] * x[None, None, :, None]
    to = np.cos(angle) * found["direction"][:, None, None] + np.sin(angle) * way[:, :, None]
    heights = made.heights(np.ascontiguousarray(to.reshape(-1, 3)), 50.0).reshape(to.shape[:-1])
    return heights, heights[..., -1], heights[..., 0]


def test_terraces() -> None:
    """Steps of the wall: treads that are less than half as steep as the smooth wall, scarps that
    are steeper, and the rim and the floor of the smooth one. Simple craters have none."""
    smooth, rim, floor = walls(0.0)
    stairs, same_rim, same_floor = walls(1.0)
    assert len(smooth) >= 5
    np.testing.assert_allclose(same_rim, rim, atol=1e-9)
    np.testing.assert_allclose(same_floor, floor, atol=1e-9)
    wall = np.diff(smooth[..., 110:], axis=-1)
    ratio = np.diff(stairs[..., 110:], axis=-1)[wall > 1.0] / wall[wall > 1.0]
    assert np.mean(ratio < 0.5) > 0.05
    assert np.mean(ratio > 1.5) > 0.05
    assert np.ptp(np.diff(stairs, axis=-1).max(axis=-1), axis=1).min() > 1.0  # by azimuth
    simple = {"law": "trask", "min_diameter_m": 200.0, "max_diameter_m": 9e3}
    at = field(**simple).list(PLACE, 20e3)["direction"][:50]
    np.testing.assert_array_equal(
        field(terraces=0.0, **simple).heights(at), field(terraces=1.0, **simple).heights(at)
    )


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


def test_configured_laws_are_those_of_the_core() -> None:
    assert list(get_args(CraterLaw)) == [row["name"] for row in _core.CRATER_LAWS]


def test_defaults_are_those_of_the_core() -> None:
    ours = crater_field(Craters(), MOON_M).list(PLACE, 1000.0, 3.0)
    np.testing.assert_array_equal(
        ours, _core.CraterField({"radius_m": MOON_M}).list(PLACE, 1000.0, 3.0)
    )


def test_every_key_acts() -> None:
    def seen(**keys: object) -> tuple[object, ...]:
        made = crater_field(Craters(**keys), MOON_M)
        craters = made.list(PLACE, 400.0, 4.0)
        return (craters.tobytes(), made.heights(craters["direction"][:50], 1.0).tobytes())

    plain = seen()
    changes: list[dict[str, object]] = [
        {"law": "trask", "surface_age_ga": 1.0},
        {"surface_age_ga": 0.05},
        {"density": 1.2},
        {"law": "power", "coefficient": 0.07, "exponent": -1.9},
        {"law": "table", "table": ((1.0, 0.05), (300.0, 1e-6))},
        {"min_diameter_m": 5.0},
        {"max_diameter_m": 5.0},
        {"seed": 1},
        {"diffusivity_m2_per_myr": 3.0},
        {"diffusivity_exponent": 0.8},
        {"ellipticity": 0.2},
        {"irregularity": 0.0},
    ]  # of terraces: test_terraces
    for change in changes:
        assert seen(**change) != plain, change


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"law": "power", "coefficient": 1.0}, "required by law: power"),
        ({"law": "table"}, "required by law: table"),
        ({"exponent": -2.0}, "does nothing without law: power"),
        ({"law": "table", "table": ((2.0, 1.0), (1.0, 0.5))}, "diameters rise"),
        ({"law": "table", "table": ((1.0, 1.0), (2.0, 1.5))}, "numbers do not rise"),
        ({"min_diameter_m": 5.0, "max_diameter_m": 5.0}, "must be below max_diameter_m, 5"),
        ({"law": "neukum"}, "neukum_equilibrium"),
        ({"ages": 1}, "unknown key"),
    ],
)
def test_configuration_errors(keys: dict[str, object], words: str) -> None:
    with pytest.raises(ValidationError, match=words):
        Craters(**keys)


def test_catalogues(tmp_path: Path) -> None:
    """Columns of Robbins, of Povilaitis et al., of Head et al. with carriage returns, and in m."""
    texts = [
        "lat,lon,diam\n-10.0,350.0,7.5\n",
        ",Unnamed: 0,Diameter (km),Long,Lat,tag\n0,0,7.5,-10.0,-10.0,standard\n",
        "Lon,Lat,Diam_km\r-10.0,-10.0,7.5\r",
        "Name,Latitude,Longitude,Diameter (m)\nBiot,-10.0,-10.0,7500.0\n\n",
    ]
    for k, text in enumerate(texts):
        path = tmp_path / f"{k}.csv"
        path.write_bytes(text.encode())
        (crater,) = read_catalogue(path)
        assert crater["id"] == 1
        assert crater["name"] == ("Biot" if k == 3 else "")
        assert crater["diameter_m"] == 7500.0
        a = np.radians(10.0)
        there = [np.cos(a) ** 2, -np.cos(a) * np.sin(a), -np.sin(a)]
        np.testing.assert_allclose(crater["direction"], there, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("lat,lon\n1,2\n", "no column of diam: must be named diam or diameter"),
        ("lat,lon,diam\n1,2,3\n95,0,1\n", "line 3: lat is '95'; must be -90 to 90"),
        ("lat,lon,diam\n1,2,wide\n", "line 2: diam is 'wide'"),
        ("lat,lon,diam\n1,2\n", "line 2: 2 of 3 columns"),
    ],
)
def test_catalogue_errors(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "craters.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=words) as error:
        read_catalogue(path)
    assert str(path) in str(error.value)


def test_real_catalogues(data_dir: Path) -> None:
    """Of Tycho, 85 km across at 43.3 S, 11.4 W, in Robbins (2018) and in Head et al. (2010)."""
    for name in ("robbins2018_moon_ge20km.csv", "head2010_craters_ge20km.csv"):
        craters = read_catalogue(data_dir / "craters" / name)
        lat, lon = np.radians(-43.3), np.radians(-11.4)
        tycho = [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
        near = craters[craters["direction"] @ tycho > np.cos(10e3 / MOON_M)]
        assert len(near) > 0
        assert np.abs(near["diameter_m"] - 85e3).min() < 5e3


def test_ground_lists_the_craters_that_it_draws() -> None:
    radii_m = np.full(3, MOON_M)
    craters = field()
    bare = _core.Terrain(radii_m, craters=craters)
    np.testing.assert_array_equal(
        bare.craters(PLACE, 3000.0, 100.0), craters.list(PLACE, 3000.0, 100.0)
    )
    posts = np.zeros((64, 128), np.float32)
    step = 2e-5  # 35 m: craters of 210 m and more are left to the model
    lat, lon = np.arcsin(PLACE[2]), np.arctan2(PLACE[1], PLACE[0])
    raster = _core.Raster(posts, "cylindrical", lon - 64 * step, lat + 32 * step, step, -step)
    shown = _core.Terrain(radii_m, [(raster, "cubic", 0.0, 0.0)], craters=craters)
    listed = shown.craters(PLACE, 500.0, 20.0)
    assert listed["diameter_m"].max() < 6.0 * step * MOON_M
    expected = craters.list(PLACE, 500.0, 20.0, 6.0 * step * MOON_M)
    np.testing.assert_array_equal(listed, expected)
    assert len(_core.Terrain(radii_m).craters(PLACE, 500.0)) == 0


def test_a_small_fine_model_in_a_large_crater() -> None:
    """Posts keep their heights to the bit, the crater is drawn beside them without a cliff."""
    radii_m, step = np.full(3, MOON_M), 2e-6  # 3.5 m, 220 by 220 m
    craters = field(min_diameter_m=300.0, max_diameter_m=3000.0)
    found = craters.list(PLACE, 100e3, 1500.0)
    crater = found[np.argmax(found["depth_m"] * (found["kept"] == 1.0))]
    at, across = crater["direction"], crater["major"]
    lat, lon = np.arcsin(at[2]), np.arctan2(at[1], at[0])
    posts = np.random.default_rng(2).normal(0.0, 3.0, (64, 64)).astype(np.float32)
    east = step / np.cos(lat)
    raster = _core.Raster(posts, "cylindrical", lon - 32 * east, lat + 32 * step, east, -step)
    shown = _core.Terrain(radii_m, [(raster, "cubic", 8.0, 0.0)], craters=craters)
    columns, rows = np.meshgrid(np.arange(12.0, 52.0), np.arange(12.0, 52.0))
    inner = raster.directions(np.stack([columns.ravel(), rows.ravel()], axis=1))
    np.testing.assert_array_equal(shown.heights(inner), posts[12:52, 12:52].ravel())
    assert crater["id"] in shown.craters(at, 10.0, 1500.0)["id"]  # and it is in the list
    away = np.linspace(0.0, 2.0, 4000) * 0.5 * crater["diameter_m"] / MOON_M
    way = np.ascontiguousarray(np.cos(away)[:, None] * at + np.sin(away)[:, None] * across)
    plain, ground = craters.heights(way), shown.heights(way)
    beyond = away * MOON_M > 0.5 * 1.5 * 225.0 + 0.26 * crater["diameter_m"]
    np.testing.assert_array_equal(ground[beyond], plain[beyond])
    outside = away * MOON_M > 0.5 * 1.5 * 225.0
    slopes = np.diff(ground[outside]) / np.diff(away[outside] * MOON_M)
    assert np.abs(slopes).max() < 2.0 * 0.5  # of the crater's own walls: below 0.5


def test_images_of_rims() -> None:
    """A rim seen from above is a circle; seen by a camera behind it, nothing."""
    rim = np.array([[[0.0, 0.0, 100.0], [10.0, 0.0, 0.0], [0.0, -10.0, 0.0]]])
    camera = (1000.0, 1000.0, 320.0, 240.0, 0.0)
    (image,) = _core.rim_images(rim, camera, 1.0)
    assert image["kind"] == 2
    np.testing.assert_allclose(image["centre"], [320.0, 240.0])
    np.testing.assert_allclose(image["semi_axes"], [100.0, 100.0])
    np.testing.assert_allclose(image["box"], [220.0, 140.0, 420.0, 340.0])
    assert image["facing"] == 1.0
    (behind,) = _core.rim_images(-rim, camera, 1.0)
    assert behind["kind"] == 0
    assert len(_core.rim_images(np.zeros((0, 3, 3)), camera, 1.0)) == 0
    with pytest.raises(ValueError, match="near_m"):
        _core.rim_images(rim, camera, 0.0)
