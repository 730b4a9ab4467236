"""Geodetic and planetocentric latitudes: of maps, clouds, graphs, trajectories and tracks, against
SOFA's conversions (pyerfa) and maps whose features sit at known latitudes."""

from __future__ import annotations

import json
import math

import erfa
import numpy as np
import pytest
from PIL import Image

import perilune
from perilune import document as cfg
from perilune.config import ConfigError
from perilune.orbits.ground import surface
from perilune.show.plots.ground import sub_point_deg

A_M, F = 6378137.0, 1.0 / 298.257223563
C_M = A_M * (1.0 - F)
HEIGHT_M = 20e3


def line_map(path, lat_deg: float, rows: int = 7200) -> None:
    """White north of a latitude, black south of it, a row being 0.025 deg."""
    edge = round((90.0 - lat_deg) / 180.0 * rows)
    image = np.zeros((rows, 8), np.uint8)
    image[:edge] = 255
    Image.fromarray(image).save(path)


@pytest.fixture
def scene(tmp_path):
    """A camera straight over latitude 45 of an oblate body of no name, north up."""
    line_map(tmp_path / "line.png", 45.0)
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z"},
        "root": "world",
        "sun": {"direction": [1.0, 0.0, 1.0]},
        "bodies": {
            "world": {
                "kind": "ellipsoid",
                "radii_km": [A_M / 1e3, A_M / 1e3, C_M / 1e3],
                "gm_km3_s2": 398600.0,
                "color_map": str(tmp_path / "line.png"),
                "rotation": {"rotation_deg": [0, 0, 0]},
                "latitudes": "geodetic",
            }
        },
        "camera": {
            "width": 33,
            "height": 201,
            "focal_px": 400.0,
            "trajectory": {
                "kind": "hover",
                "target": "world",
                "lon_deg": 0.0,
                "lat_deg": 45.0,
                "height_m": HEIGHT_M,
                "azimuth_deg": 0.0,
            },
        },
        "render": {"samples": 4, "channels": ["rgb", "position"]},
    }


def opened(scene, **overrides):
    return perilune.open(scene, overrides=overrides)


def edge_lat_deg(sample) -> float:
    """Geodetic latitude (SOFA's) where the middle column turns from white to black."""
    column = (sample["rgb"][:, 16, 0] / 255.0) ** 2.2  # linear, as the map is filtered
    row = int(np.argmax(column < 0.5 * column.max()))
    points = sample["position"][row - 1 : row + 1, 16].astype(float)
    lat = [math.degrees(erfa.gc2gde(A_M, F, point)[1]) for point in points]
    return float(np.mean(lat))


def centric_deg(geodetic_deg: float) -> float:
    """Planetocentric latitude of a point of the surface, by SOFA."""
    x, y, z = erfa.gd2gce(A_M, F, 0.3, math.radians(geodetic_deg), 0.0)
    return math.degrees(math.atan2(z, math.hypot(x, y)))


PIXEL_DEG = math.degrees(HEIGHT_M / 400.0 / A_M)  # 50 m: 0.00045 deg
ROW_DEG = 180.0 / 7200


def test_a_map_by_geodetic_latitudes(scene):
    """The edge is at 45 deg to a pixel, where planetocentric maps have it 21.4 km north."""
    assert edge_lat_deg(opened(scene)[0]) == pytest.approx(45.0, abs=1.5 * PIXEL_DEG)
    scene["bodies"]["world"]["latitudes"] = "geocentric"
    scene["camera"]["trajectory"]["latitudes"] = "geocentric"
    sample = opened(scene)[0]
    lat = edge_lat_deg(sample)
    assert centric_deg(lat) == pytest.approx(45.0, abs=1.5 * PIXEL_DEG)
    assert lat - 45.0 == pytest.approx(0.1924, abs=1e-3)
    assert math.radians(lat - 45.0) * A_M == pytest.approx(21.4e3, rel=0.01)


@pytest.mark.parametrize("part", ["material", "night_lights", "clouds", "lon_lat"])
def test_all_maps_of_a_body_do(scene, tmp_path, part):
    body = scene["bodies"]["world"]
    file = body.pop("color_map")
    skin = {"type": "principled", "roughness": 1.0, "specular": 0.0}
    if part == "material":
        image = {"type": "image", "file": file}
        nodes = {"i": image, "skin": {**skin, "base_color": "i.color"}}
        scene["materials"] = {"m": {"nodes": nodes}}
        body["material"] = "m"
    elif part == "lon_lat":
        nodes = {
            "at": {"type": "coordinates", "space": "lon_lat_deg"},
            "lat": {"type": "vector_math", "function": "dot", "a": "at", "b": [0, 1, 0]},
            "north": {"type": "math", "function": "greater_than", "a": "lat.value", "b": 45.0},
            "skin": {**skin, "base_color": "north"},
        }
        scene["materials"] = {"m": {"nodes": nodes}}
        body["material"] = "m"
    elif part == "night_lights":
        lights = {"map": file, "radiance_w_m2_sr": 1.0, "detail_km": 0.0}
        body |= {"albedo": 0.0, "night_lights": lights}
        scene["sun"]["direction"] = [-1.0, 0.0, -1.0]
    else:
        body |= {"albedo": 0.0, "clouds": {"map": file, "altitude_km": 1e-3, "thickness_km": 1e-3}}
    assert edge_lat_deg(opened(scene)[0]) == pytest.approx(45.0, abs=2.5 * PIXEL_DEG)


def test_clouds_may_count_otherwise(scene):
    body = scene["bodies"]["world"]
    clouds = {"map": body.pop("color_map"), "altitude_km": 1e-3, "thickness_km": 1e-3}
    body |= {"albedo": 0.0, "clouds": {**clouds, "latitudes": "geocentric"}}
    scene["camera"]["trajectory"]["latitudes"] = "geocentric"
    lat = edge_lat_deg(opened(scene)[0])
    assert centric_deg(lat) == pytest.approx(45.0, abs=2.5 * PIXEL_DEG)


def test_relief_is_where_the_map_has_it(scene, tmp_path):
    """A ramp between two latitudes alone leans: its edges, by the brightness."""
    rows = 7200
    heights = np.zeros((rows, 8), np.uint8)
    first, last = round((90 - 45.0) / 180 * rows) - 1, round((90 - 45.0) / 180 * rows)
    heights[: first + 1] = 255
    Image.fromarray(heights).save(tmp_path / "relief.png")
    body = scene["bodies"]["world"]
    del body["color_map"]
    body |= {
        "albedo": 0.3,
        "relief": {"height_map": str(tmp_path / "relief.png"), "height_m": 800.0},
    }
    scene["camera"]["focal_px"] = 300.0
    scene["sun"]["direction"] = [1.0, 0.0, 0.0]
    scene["render"]["texture_filter"] = "bilinear"
    sample = opened(scene)[0]
    column = sample["rgb"][:, 16, 0].astype(float)
    different = np.flatnonzero(np.abs(column - np.median(column)) > 3)
    points = sample["position"][different, 16].astype(float)
    lat = np.degrees([erfa.gc2gde(A_M, F, point)[1] for point in points])
    assert last == first + 1
    assert np.abs(lat - 45.0).max() < 2.5 * ROW_DEG
    assert np.mean(lat) == pytest.approx(45.0, abs=0.5 * ROW_DEG)


@pytest.mark.parametrize("lat_deg", [-89.9, -60.0, -12.5, 0.0, 33.3, 45.0, 71.0, 90.0])
def test_hover_agrees_with_sofa(scene, lat_deg):
    scene["camera"]["trajectory"] |= {"lat_deg": lat_deg, "lon_deg": 20.0}
    place = opened(scene).camera_poses(0)[0, :3]
    lon = math.radians(20.0)
    expected = erfa.gd2gce(A_M, F, lon, math.radians(lat_deg), HEIGHT_M)
    assert np.abs(place - expected).max() < 1e-6
    scene["camera"]["trajectory"]["latitudes"] = "geocentric"
    sim = opened(scene)
    place = sim.camera_poses(0)[0, :3]
    foot_lon, foot_lat, height = erfa.gc2gde(A_M, F, place)
    foot = erfa.gd2gce(A_M, F, foot_lon, foot_lat, 0.0)
    assert height == pytest.approx(HEIGHT_M, abs=1e-5)
    assert math.degrees(math.atan2(foot[2], math.hypot(*foot[:2]))) == pytest.approx(lat_deg)
    assert surface(np.array([A_M, A_M, C_M]), np.array([1.0, 0, 0])) == pytest.approx([A_M, 0, 0])


def test_defaults(scene):
    """Published maps of the Earth are geodetic, of other bodies planetocentric."""
    bodies = scene["bodies"]
    bodies["earth"] = {"kind": "earth"}
    for name in ("mars", "moon", "jupiter"):
        bodies[name] = {"kind": name}
    bodies["mine"] = {**bodies["world"], "orbit": {"around": "world", "position_km": [1e5, 0, 0]}}
    del bodies["mine"]["latitudes"]
    found = cfg.load(scene).config.bodies
    assert {name: body.is_geodetic for name, body in found.items()} == {
        "world": True, "earth": True, "mars": False, "moon": False, "jupiter": False, "mine": False,
    }  # fmt: skip
    bodies["world"]["latitudes"] = "planetographic"
    with pytest.raises(ConfigError, match=r"bodies\.world\.latitudes"):
        cfg.load(scene)


def test_ground_tracks_count_as_maps_do(scene, repo_dir):
    place_m = erfa.gd2gce(A_M, F, 0.4, math.radians(52.0), 700e3)
    scene["spacecraft"] = {
        "sat": {
            "model": str(repo_dir / "assets/models/smallsat.glb"),
            "size_m": 2.0,
            "orbit": {"around": "world", "position_km": (np.asarray(place_m) / 1e3).tolist()},
        }
    }
    sim = opened(scene)
    lon, lat = sub_point_deg(sim.world(0), "sat", "world", 0.0)
    assert (lon, lat) == (pytest.approx(math.degrees(0.4)), pytest.approx(52.0, abs=1e-9))
    sim = opened(scene, **{"bodies.world.latitudes": "geocentric"})
    x, y, z = place_m
    _, lat = sub_point_deg(sim.world(0), "sat", "world", 0.0)
    assert lat == pytest.approx(math.degrees(math.atan2(z, math.hypot(x, y))), abs=1e-9)


def test_a_configuration_of_json_keeps_it(scene, tmp_path):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    assert perilune.open(path).config.bodies["world"].is_geodetic
