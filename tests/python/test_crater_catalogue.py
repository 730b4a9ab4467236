"""Real craters in frames of the orbiter, beside their catalogue, the camera and LOLA's heights,
which are read and projected here by other means."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.test_terrain_frames import MOON_M, in_body_axes, moon, over

import perilune
from perilune.base import rotations
from perilune.config import ConfigError
from perilune.frame import shutter

CONFIG = Path(__file__).resolve().parents[2] / "configs/lunar_orbiter.yaml"
SMALL = {"camera.width": 128, "camera.height": 128, "bodies.moon.terrain.detail": None}
KEY = "bodies.moon.terrain.crater_catalogue"


@cache
def orbiter() -> perilune.Simulation:
    return perilune.open(CONFIG, overrides=SMALL)


def rows_of(data_dir: Path) -> Any:
    """(n, 3) latitude, longitude (degrees) and diameter (km)."""
    path = data_dir / "craters/robbins2018_moon_ge20km.csv"
    return np.genfromtxt(path, delimiter=",", skip_header=1)


def unit(lat_deg: Any, lon_deg: Any) -> Any:
    lat, lon = np.radians(lat_deg), np.radians(lon_deg)
    return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)


@pytest.mark.needs_data
def test_they_lie_where_catalogue_and_camera_say(data_dir: Path) -> None:
    """Within 1 km, by a projection in NumPy of a point on LOLA's heights."""
    catalogue = rows_of(data_dir)
    lola = np.fromfile(data_dir / "lunar_dem/ldem_4.img", "<i2").reshape(720, 1440)
    sim, checked = orbiter(), 0
    for index in range(3):
        rows = sim.craters(index)
        rows = rows[rows["source"] == "catalogue"]
        assert (rows["id"] < 0).all()
        camera = sim.frame(index, ["depth"]).camera
        pose = shutter.middle(sim.world(index)).poses["moon"][0]
        for row in rows[(rows["diameter_m"] < 60e3) & np.isfinite(rows["center"][:, 0])]:
            lat, lon, km = catalogue[-row["id"] - 1]
            assert row["diameter_m"] == 1e3 * km
            line, column = int((90.0 - lat) * 4.0), int((lon % 360.0) * 4.0)
            place = unit(lat, lon) * (MOON_M + 0.5 * float(lola[line, column]))
            root = rotations.to_matrix(pose[3:]) @ place + pose[:3]
            x, y, z = camera.R_w2c @ root + camera.t_w2c
            pixel = camera.K[:2, :2] @ np.array([x, y]) / z + camera.K[:2, 2]
            off_m = np.linalg.norm(row["center"] - pixel) * z / camera.K[0, 0]
            assert off_m < 1e3
            checked += 1
    assert checked >= 5


@pytest.mark.needs_data
def test_they_are_dips_of_the_ground(data_dir: Path) -> None:
    catalogue = rows_of(data_dir)
    large = catalogue[(catalogue[:, 2] > 50.0) & (catalogue[:, 2] < 120.0)][::5]
    ground = orbiter().terrain(0)
    center = unit(large[:, 0], large[:, 1])
    turn = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    east = np.cross([0.0, 0.0, 1.0], center)
    east /= np.linalg.norm(east, axis=1, keepdims=True)
    ring = np.einsum("k,nc->nkc", np.cos(turn), east)
    ring += np.einsum("k,nc->nkc", np.sin(turn), np.cross(center, east))
    ring = center[:, None, :] + 0.5e3 * large[:, 2, None, None] / MOON_M * ring
    rim_m = ground.heights(ring.reshape(-1, 3), 5e3).reshape(ring.shape[:2]).mean(axis=1)
    deep = rim_m - ground.heights(center, 5e3)
    assert len(large) > 50
    assert (deep > 0.0).mean() > 0.9
    assert np.median(deep) > 800.0


@pytest.mark.needs_data
def test_they_are_not_drawn_again() -> None:
    """None is drawn that the model shows, of 6 posts of 7.6 km or more; and with the catalogue none
    as large as its smallest, of 20 km."""
    plain = perilune.open(CONFIG, overrides=SMALL | {KEY: None}).terrain(0)
    with_them = orbiter().terrain(0)
    for direction in np.concatenate([np.eye(3), -np.eye(3)]):
        region = direction, 1.3 * MOON_M
        assert len(plain.craters(*region, 45.6e3)) == 0
        assert len(with_them.craters(*region, 20e3)) == 0
    assert len(plain.craters(*region, 20e3)) > 0
    assert len(with_them.craters(*region, 19e3)) > 0


@pytest.mark.needs_data
def test_pixels_have_the_smallest(data_dir: Path) -> None:
    sim = orbiter().with_overrides({"bodies.moon.terrain.craters": None})
    sample = sim.frame(0, ["crater_id", "position"])
    points, ids = in_body_axes(sim, sample)[::4, ::4], sample["crater_id"][::4, ::4]
    ways = points / np.linalg.norm(points, axis=-1, keepdims=True)
    lat, lon, km = rows_of(data_dir).T
    away = MOON_M * np.arccos(np.clip(ways @ unit(lat, lon).T, -1.0, 1.0)) / (500.0 * km)
    inside = away < 1.0
    size = np.where(inside, km, np.inf)
    expected = np.where(inside.any(axis=-1), -1 - size.argmin(axis=-1), 0)
    sure = (np.abs(away - 1.0) > 2e-3).all(axis=-1)
    np.testing.assert_array_equal(ids[sure], expected[sure])
    assert len(np.unique(expected)) > 2
    rows = sim.craters(0)
    assert set(np.unique(expected[sure]).tolist()) - {0} <= set(rows["id"].tolist())
    assert np.isnan(rows["depth_m"]).all()


def test_errors(tmp_path: Path) -> None:
    path = tmp_path / "craters.csv"
    path.write_text("lat,lon,diam,name\n10.0,20.0,0.03,Small\n10.01,20.0,bad,Other\n")
    terrain = {"detail": {"strength": 0.1}, "craters": {}, "crater_catalogue": str(path)}
    camera = {"trajectory": over(300.0)}
    with pytest.raises(ConfigError, match=r"crater_catalogue: .*craters\.csv: line 3: diam"):
        moon(terrain, camera).craters(0)
    with pytest.raises(FileNotFoundError, match=r"moon\.terrain\.crater_catalogue: no such file"):
        moon(terrain | {"crater_catalogue": str(tmp_path / "x.csv")}, camera).craters(0)
    path.write_text("lat,lon,diam,name\n10.0,20.0,0.03,Small\n")
    with pytest.raises(ConfigError, match=r"craters\.min_diameter_m: 50 m: must be below .* 30 m"):
        moon(terrain | {"craters": {"min_diameter_m": 50.0}}, camera).craters(0)
    (row,) = moon(terrain | {"craters": None}, camera | {"width": 96}).craters(0)
    assert (row["id"], row["name"], row["source"]) == (-1, "Small", "catalogue")
