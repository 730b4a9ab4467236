"""Frames and tables of craters and rocks at their limits: size, number, density, place, age."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.test_terrain_frames import LAT_DEG, LON_DEG, MOON_M, in_body_axes, moon, over

import perilune
from perilune.config import ConfigError

DETAIL = {"seed": 3, "strength": 0.3}
ROUND = {"seed": 5, "diffusivity_m2_per_myr": 0.0, "irregularity": 0.0}
ROCKS = {"law": "haworth", "seed": 2}
CHANNELS = ["radiance", "range", "normal", "instance"]


def ground(
    trajectory: dict[str, Any], terrain: dict[str, Any], side: int = 32, **more: Any
) -> perilune.Simulation:
    camera = {"trajectory": trajectory, "width": side, "height": side}
    return moon({"detail": DETAIL} | terrain, camera, **more)


def unit(lat_deg: float, lon_deg: float) -> np.ndarray:
    lat, lon = np.radians([lat_deg, lon_deg])
    return np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])


# -- density, number and age -----------------------------------------------------------------------


@pytest.mark.parametrize("what", ["craters", "rocks"])
def test_density_0_is_as_without(what: str) -> None:
    view = over(40.0, 30.0)
    none, without = (ground(view, {what: given}) for given in ({"density": 0.0}, None))
    a, b = (sim.frame(0, CHANNELS) for sim in (none, without))
    for name in CHANNELS:
        np.testing.assert_array_equal(a[name], b[name])
    assert len(getattr(none, what)(0)) == 0


def test_saturation() -> None:
    """The ground of as many craters as there can be, 1.54 D^-2, has no holes; laws of 1.6 times
    as many are refused."""
    law = {"law": "power", "coefficient": 1.54, "exponent": -2.0, "min_diameter_m": 8.0,
           "max_diameter_m": 64.0, "seed": 1}  # fmt: skip
    sim = ground(over(300.0, 30.0), {"craters": law}, 24)
    sample = sim.frame(0, ["radiance", "position", "range"])
    assert (sample["range"] > 0.0).all()
    assert np.isfinite(sample["radiance"]).all()
    points = in_body_axes(sim, sample).reshape(-1, 3)
    away = np.linalg.norm(points, axis=1)
    off = np.abs(away - MOON_M - sim.terrain(0).heights(points / away[:, None]))
    pixel_m = sample["range"].ravel() * np.radians(50.0) / 24
    assert np.percentile(off / pixel_m, 99.0) < 0.6
    listed = sim.terrain(0).craters(points[0], 200.0)
    expected = 1.54 * (8.0**-2 - 64.0**-2) * np.pi * 200.0**2
    assert abs(len(listed) - expected) < 4.5 * np.sqrt(expected)
    with pytest.raises(ConfigError, match=r"moon\.terrain: .* what a surface can hold"):
        ground(over(300.0), {"craters": law | {"coefficient": 2.6}}).frame(0, ["range"])


def test_ten_thousand_craters_in_view() -> None:
    """All in one table, of distinct ids; one fewer allowed is an error that says what to do."""
    law = ROUND | {"law": "trask", "density": 3.0, "min_diameter_m": 6.0, "max_diameter_m": 12.0}
    sim = ground(over(1.7e3), {"craters": law, "detail": None}, 64)
    rows = sim.craters(0, least_px=0.1)
    assert len(rows) > 10_000
    assert len(np.unique(rows["id"])) == len(rows)
    assert np.isfinite(rows["bbox"]).all()
    assert (rows["inside_fract"] > 0.0).all()
    with pytest.raises(ValueError, match=r"more than 9999 craters .* raise least_px, or most"):
        sim.craters(0, least_px=0.1, most=9_999)


def test_craters_of_the_same_age() -> None:
    """On a surface so young that its craters share a few ages, ids tell which is younger: heights
    and pixels have the same bits in any order and for any threads."""
    law = ROUND | {"law": "trask", "density": 5.0, "min_diameter_m": 10.0,
                   "max_diameter_m": 200.0, "surface_age_ga": 1e-322}  # fmt: skip
    sim = ground(over(300.0), {"craters": law}, 48)
    terrain, middle = sim.terrain(0), unit(LAT_DEG, LON_DEG)
    rows = terrain.craters(middle, 300.0)
    assert len(rows) > 50 * len(np.unique(rows["age_ga"]))
    places = middle + np.random.default_rng(1).uniform(-2e-4, 2e-4, (2000, 3))
    order = np.random.default_rng(2).permutation(len(places))
    one_by_one = np.concatenate([terrain.heights(row[None]) for row in places[order]])
    np.testing.assert_array_equal(terrain.heights(places)[order], one_by_one)
    names = [*CHANNELS, "crater_id"]
    one, two = sim.frame(0, names, threads=1), sim.with_overrides({}).frame(0, names, threads=2)
    for name in names:
        np.testing.assert_array_equal(one[name], two[name])
    assert len(np.unique(one["crater_id"])) > 10


def test_laws_are_driven() -> None:
    """Density, law, age, burial and slopes of repose are drawn for each frame."""
    rocks: dict[str, Any] = {
        "coefficient": {"uniform": [0.06, 0.08]}, "exponent": {"uniform": [-2.2, -1.8]},
        "density": {"uniform": [0.8, 1.0]}, "min_diameter_m": {"uniform": [0.3, 0.5]},
        "max_diameter_m": 1.6, "least_burial": {"uniform": [0.1, 0.2]}, "law": "power",
        "most_burial": {"uniform": [0.4, 0.6]}, "repose_deg": {"uniform": [30.0, 40.0]},
    }  # fmt: skip
    craters: dict[str, Any] = {
        "law": "power", "coefficient": {"uniform": [0.1, 0.12]}, "max_diameter_m": 20.0,
        "exponent": {"uniform": [-2.2, -1.8]}, "density": {"uniform": [0.5, 1.0]},
        "surface_age_ga": {"uniform": [2.0, 4.0]}, "min_diameter_m": {"uniform": [2.0, 2.5]},
    }  # fmt: skip
    sim = ground(over(15.0), {"rocks": rocks, "craters": craters}, 32)
    found = [(sim.rocks(k), sim.craters(k, least_px=2)) for k in (0, 1)]
    for one, other in zip(*found, strict=True):
        assert len(one) > 0
        assert len(other) > 0
        assert set(one["diameter_m"].tolist()).isdisjoint(other["diameter_m"].tolist())


# -- rocks of any size -----------------------------------------------------------------------------


def test_rocks_of_a_hundredth_of_a_pixel() -> None:
    """They darken the ground by what they shade, and are in no table."""
    small = ROCKS | {"min_diameter_m": 0.02, "max_diameter_m": 0.03}
    view = over(100.0)
    sim = ground(view, {"rocks": small})
    sample, bare = sim.frame(0, [*CHANNELS, "rock_id"]), ground(view, {}).frame(0, CHANNELS)
    assert sample["range"].min() * np.radians(50.0) / 32 > 100.0 * 0.02
    assert np.isfinite(sample["radiance"]).all()
    assert not sample["rock_id"].any()
    assert len(sim.rocks(0)) == 0
    ratio = sample["radiance"].mean() / bare["radiance"].mean()
    assert 0.97 < ratio < 1.0


def _across(row: Any) -> list[np.ndarray]:
    """Eight unit vectors along the ground about a rock."""
    a = np.cross(row["up"], [0.0, 0.0, 1.0])
    a /= np.linalg.norm(a)
    b = np.cross(row["up"], a)
    return [np.cos(turn) * a + np.sin(turn) * b for turn in np.arange(8) * np.pi / 4.0]


@pytest.mark.parametrize("off_nadir_deg", [0.0, 40.0])
def test_rocks_of_50_m(off_nadir_deg: float) -> None:
    """From above and from the side: all in the table, each seated with its mask in its box and
    between the ground and its own top."""
    law = {"law": "table", "table": [[48.0, 1e-4], [50.0, 1e-6]], "max_diameter_m": 50.0,
           "cutoff_m": 0.0, "seed": 1}  # fmt: skip
    sim = ground(over(300.0, off_nadir_deg), {"rocks": law}, 64)
    sample, rows = sim.frame(0, ["rock_id", "position", "radiance"]), sim.rocks(0)
    assert len(rows) >= 3
    assert ((rows["diameter_m"] >= 48.0) & (rows["diameter_m"] <= 50.0)).all()
    ids, points = sample["rock_id"], in_body_axes(sim, sample)
    assert set(np.unique(ids).tolist()) - {0} == set(rows["id"].tolist())
    assert np.isfinite(sample["radiance"]).all()
    terrain = sim.terrain(0)
    for row in rows:
        lines, columns = np.nonzero(ids == row["id"])
        left, top, width, height = row["bbox_visib"]
        assert left <= columns.min()
        assert columns.max() < left + width
        assert top <= lines.min()
        assert lines.max() < top + height
        seen = points[lines, columns]
        away = np.linalg.norm(seen, axis=1)
        over_m = away - MOON_M - terrain.heights(seen / away[:, None])
        ring = row["direction"] + 0.5 * row["diameter_m"] / MOON_M * np.stack(_across(row))
        relief_m = np.ptp(terrain.heights(ring))
        # Rows of pixels are up to 9 m apart; from above, rocks are seen down to their widest.
        assert -1.0 < over_m.min() < max(10.0, 0.6 * row["height_m"])
        assert 0.0 < over_m.max() < 1.15 * row["height_m"] + relief_m
        assert np.linalg.norm(seen - row["center_m"], axis=1).max() < 1.2 * row["diameter_m"]
        assert 0.0 < row["burial"] < 1.0


def test_rocks_in_the_dark_have_pixels() -> None:
    """The Sun is below the horizon, or up: labels are the same."""
    rocks = {"rocks": ROCKS | {"min_diameter_m": 0.5, "density": 4.0}}
    day = ground(over(20.0), rocks, 48)
    night = day.with_overrides({"sun.at.elevation_deg": -20.0})
    a, b = (sim.frame(0, ["rock_id", "radiance"]) for sim in (day, night))
    assert a["radiance"].max() > 0.0
    assert b["radiance"].max() == 0.0
    np.testing.assert_array_equal(a["rock_id"], b["rock_id"])
    np.testing.assert_array_equal(day.rocks(0), night.rocks(0))
    assert len(day.rocks(0)) > 3


# -- places ----------------------------------------------------------------------------------------

LARGE = {"law": "table", "table": [[9.0, 6e-4], [12.0, 1e-5]], "cutoff_m": 0.0}
PLACES = {"north pole": (90.0, 0.0), "south pole": (-90.0, 50.0), "date line": (5.0, 180.0)}


def both_sides(place: str, rows: Any) -> bool:
    """Whether rows lie on both sides of the date line, or all about a pole."""
    lon = np.radians(rows["lon_deg"])
    if place == "date line":
        return bool((lon > 3.0).any() and (lon < -3.0).any())
    return len(np.unique(np.floor(lon / (0.5 * np.pi)))) == 4


@pytest.mark.parametrize("place", PLACES)
def test_over_poles_and_the_date_line(place: str, tmp_path: Path) -> None:
    """A catalogued crater that lies across them is a whole disc; drawn craters and rocks are on
    every side, as many as their laws say."""
    lat, lon = PLACES[place]
    at = over(300.0) | {"lat_deg": lat, "lon_deg": lon}
    middle = (lat - np.sign(lat) * 2e-4, lon) if abs(lat) == 90.0 else (lat, -lon + 2e-4)
    path = tmp_path / "craters.csv"
    path.write_text(f"lat,lon,diam\n{middle[0]},{middle[1]},0.15\n")
    terrain = {"detail": {"seed": 3, "strength": 0.01}, "crater_catalogue": str(path)}
    sim = ground(at, terrain, 64)
    sample = sim.frame(0, ["crater_id", "position", "depth"])
    (row,) = sim.craters(0)
    expected_px = 0.5 * sample.camera.K[0, 0] * 150.0 / sample["depth"].mean()
    np.testing.assert_allclose(row["semi_axes"], expected_px, rtol=0.02)
    off = in_body_axes(sim, sample) - row["center_m"]
    np.testing.assert_array_equal(
        (sample["crater_id"] == -1)[(away := np.abs(np.linalg.norm(off, axis=-1) - 75.0)) > 1.0],
        (np.linalg.norm(off, axis=-1) < 75.0)[away > 1.0],
    )
    law = {"craters": ROUND | {"min_diameter_m": 4.0}, "rocks": LARGE}
    drawn = ground(at, law, 64)
    assert both_sides(place, drawn.craters(0, least_px=2.0))
    assert both_sides(place, drawn.rocks(0))
    listed = drawn.terrain(0).craters(unit(lat, lon), 2000.0, 10.0)
    expected = drawn.terrain(0).craters(unit(10.0, 20.0), 2000.0, 10.0)
    spread = np.sqrt(len(listed) + len(expected))
    assert abs(len(listed) - len(expected)) < 4.5 * spread


@pytest.mark.parametrize("at_rim", [0.95, 1.0])
def test_a_crater_seen_from_orbit_is_in_a_rovers_frame(at_rim: float) -> None:
    """With the same id, from a mast 1.5 m high on its rim, or on its wall, that looks across."""
    craters = {"craters": ROUND | {"min_diameter_m": 20.0, "max_diameter_m": 2e3}}
    labels = {"craters": {"least_px": 3.0}}
    orbit = ground(over(20e3), craters, 64, labels=labels)
    rows = orbit.craters(0, least_px=3.0)
    row = rows[(rows["inside_fract"] == 1.0) & (rows["kept"] > 0.9)][0]
    away_m = 0.5 * at_rim * float(row["diameter_m"])
    mast = {"kind": "traverse", "target": "moon", "lon_deg": float(row["lon_deg"]),
            "lat_deg": float(row["lat_deg"]) - float(np.degrees(away_m / MOON_M)),
            "waypoints_m": [[0.0, 0.0], [0.0, 10.0]], "height_m": 1.5, "pitch_deg": -8.0,
            "positions": 2}  # fmt: skip
    rover = ground(mast, craters, 64, labels=labels)
    (found,) = (table := rover.craters(0, least_px=3.0))[table["id"] == row["id"]]
    for name in ("direction", "diameter_m", "depth_m", "age_ga", "kept"):
        np.testing.assert_array_equal(found[name], row[name])
    assert found["cut"]
    sample = rover.frame(0, ["crater_id", "position"])
    mine = in_body_axes(rover, sample)[sample["crater_id"] == row["id"]]
    assert len(mine) == found["px_count_visib"]
    assert len(mine) > (200 if at_rim < 1.0 else 0)
    chord = np.linalg.norm(mine / np.linalg.norm(mine, axis=1)[:, None] - row["direction"], axis=1)
    assert (MOON_M * chord < 0.501 * row["diameter_m"]).all()


@pytest.mark.parametrize("inside", [True, False])
def test_a_crater_larger_than_a_patch(inside: bool, tmp_path: Path) -> None:
    """It is listed and drawn around the patch of an elevation model, be it in its middle or on its
    wall, and nothing of it is left on the patch. The frame has no holes."""
    craters = ROUND | {"min_diameter_m": 200.0, "max_diameter_m": 4e3}
    rows = ground(over(20e3), {"craters": craters}, 64).craters(0, least_px=3.0)
    row = rows[rows["inside_fract"] == 1.0][0]
    up, major, radius = row["direction"], row["major"], 0.5 * row["diameter_m"] / MOON_M
    at = up if inside else up + 0.6 * radius * major
    lon, lat = float(np.degrees(np.arctan2(at[1], at[0]))), float(np.degrees(np.arctan2(
        at[2], np.hypot(at[0], at[1]))))  # fmt: skip
    np.save(tmp_path / "patch.npy", np.full((9, 9), -1000.0, np.float32))
    patch = {"kind": "orthographic", "center_lon_lat_deg": [lon, lat], "post_m": 20.0}
    model = {"file": str(tmp_path / "patch.npy"), "projection": patch}
    view = over(400.0) | {"lon_deg": lon, "lat_deg": lat}
    sim = ground(view, {"craters": craters, "elevation": [model]}, 48)
    sample = sim.frame(0, ["radiance", "range"])
    assert (sample["range"] > 0.0).all()
    assert np.isfinite(sample["radiance"]).all()
    listed = sim.terrain(0).craters(up, 100.0)
    (found,) = listed[listed["id"] == row["id"]]
    assert (found["kept"] == 0.0) == inside  # of the height at its centre
    assert sim.terrain(0).heights(np.atleast_2d(at / np.linalg.norm(at)))[0] == -1000.0
    rim = up + radius * np.stack([-major, np.cross(up, major), -np.cross(up, major)])
    plain = ground(view, {"craters": craters}).terrain(0).heights(rim)
    bare = ground(view, {}).terrain(0).heights(rim)
    assert (plain > bare + 10.0).all()
    drawn = sim.terrain(0).heights(rim)
    np.testing.assert_allclose(drawn, plain, atol=5.0)
