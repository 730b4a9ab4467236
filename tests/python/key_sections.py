"""Sections of the schema with nothing but what they require, and a value for each other key: what
there is to see. What sees it is in key_cameras.py."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from perilune.config.atmosphere import Atmosphere
from perilune.config.attitude import Inertial
from perilune.config.body import Body
from perilune.config.clouds import CloudNoise, Clouds
from perilune.config.ground import NightLights, Ocean, Relief
from perilune.config.keypoints import Keypoints
from perilune.config.orbit import Circular
from perilune.config.photometry import Photometry
from perilune.config.rings import Rings
from perilune.config.shape import Shape
from perilune.config.sky import Background, Sky, Stars
from perilune.config.spacecraft import Spacecraft
from perilune.config.sun import SiteSun, Sun
from perilune.config.terrain import Detail, Terrain
from perilune.config.types import Strict
from perilune.config.volumes import BoxVolume, ConeVolume, EllipsoidVolume

SATELLITE = Path(__file__).parents[2] / "assets" / "models" / "smallsat.glb"
Tree = dict[str, Any]


TRACK: Tree = {
    "lat_deg": 0.0,
    "waypoints_m": [[-5e6, 1e5], [5e6, 0.0]],
    "gauge_m": 8e5,
    "wheel_width_m": 4e5,
    "depth_m": 1e5,
}


class Section(NamedTuple):
    """A section with nothing but what it requires, and a value for each of its other keys."""

    model: type[Strict]
    at: tuple[str, ...]
    """Where it stands."""
    required: Any
    keys: Tree
    around: Mapping[str, Any] = MappingProxyType({})
    """Dotted key -> value: what must stand elsewhere for the section to be seen."""


def base() -> Tree:
    """A body of 1000 km with a spacecraft before it; the sun is to the right of the camera."""
    return {
        "version": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60.0, "frames_per_scene": 2},
        "root": "b",
        "bodies": {
            "b": {
                "kind": "ellipsoid",
                "radii_km": [1000.0, 990.0, 980.0],
                "gm_km3_s2": 4000.0,
                "albedo": 0.3,
                "rotation": {"rotation_deg": [10.0, 20.0, 30.0]},
            }
        },
        "spacecraft": {
            "s": {
                "model": str(SATELLITE),
                "metres_per_unit": 1e5,
                "orbit": {
                    "around": "b",
                    "state": {"position_km": [300.0, -2000.0, 400.0], "velocity_km_s": [1.4, 0, 0]},
                },
            }
        },
        "camera": {
            "width": 24,
            "height": 18,
            "fov_deg": 60.0,
            "trajectory": {"kind": "fixed", "target": "b", "position_m": [0.0, -3e6, 1e6]},
            "exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 150.0},
        },
        "render": {"samples": 2, "max_bounces": 1, "tolerance_dn": 0.0},
    }


def put(tree: Tree, dotted: str, value: Any) -> None:
    *folders, last = dotted.split(".")
    for name in folders:
        tree = tree.setdefault(name, {})
    tree[last] = value


BODY = base()["bodies"]["b"]
CRAFT = base()["spacecraft"]["s"]
AT_BODY, AT_CRAFT = ("bodies", "b"), ("spacecraft", "s")
MAP = "map.png"
GREY_MAP = "grey.png"
LAMBERT = {"nodes": {"skin": {"type": "lambert", "base_color": 0.7}}}
FOG = {"nodes": {"fog": {"type": "lambert", "base_color": 0.7, "alpha": 0.5}}}
RINGLET = {
    "inner_radius_km": 1200.0,
    "outer_radius_km": 1250.0,
    "optical_depth": 1.0,
    "albedo": 0.5,
}
MIST = {"parent": "b", "extinction_per_m": 1e-6, "position_m": [3e5, -1.5e6, 4e5]}
MIST_KEYS: Tree = {
    "parent": "s",
    "position_m": [2e5, -1.6e6, 3e5],
    "rotation_deg": [10.0, 20.0, 30.0],
    "extinction_per_m": 2e-6,
    "albedo": 0.5,
    "g": 0.5,
    "emission_w_m3_sr": 1e-4,
    "material": "fog",
    "material_drivers": {"drivers": {"x": 1.0}},
    "core_m": 1e4,
}
SPIN: Tree = {
    "rotation_deg": [0.0, 0.0, 30.0],
    "spin_axis": [1.0, 0.0, 0.0],
    "spin_rate_deg_s": 1.0,
    "rotation_deg_step_v": 10.0,
    "rotation_mode": "global",
}

LAW_KEYS = {
    "maps": ["none.tif"],
    "b": 0.5,
    "c": -0.5,
    "b_s0": 0.1,
    "h_s": 0.5,
    "b_c0": 0.5,
    "h_c": 0.5,
    "filling": 0.4,
    "roughness_deg": 40.0,
    "k": 0.7,
    "h_function": "simple",
    "coherent_surge": "2012",
}

SITE_SUN = {"lon_deg": 250.0, "lat_deg": 20.0, "azimuth_deg": 90.0, "elevation_deg": 50.0}

HEIGHTS = {
    "file": GREY_MAP,
    "scale_m": 400.0,
    "projection": {"kind": "cylindrical", "west_deg": -180.0},
}
AREAS = {
    "file": GREY_MAP,
    "projection": {"kind": "cylindrical", "west_deg": -180.0},
    "classes": {"dark": [0, 127]},
}

THINGS = [
    Section(
        Body,
        AT_BODY,
        {key: value for key, value in BODY.items() if key != "albedo"} | {"material": "m"},
        {
            "color_map": MAP,
            "albedo_contrast": 2.0,
            "emission_w_m2_sr": 20.0,
            "reflectance": "lunar_lambert",
            "photometry": {"b": 0.2},
            "albedo": 0.4,
        },
        {"materials.m": LAMBERT},
    ),
    Section(
        Photometry,
        (*AT_BODY, "photometry"),
        {"b_c0": 0.5},
        {"h_c": 0.5, "coherent_surge": "2012"},
        {"bodies.b.reflectance": "hapke"},
    ),
    Section(
        Body,
        AT_BODY,
        BODY,
        {
            "ephemeris": "mars",
            "shape": "ball.obj",
            "terrain": {"elevation": [HEIGHTS], "detail": None},
            "color_map": MAP,
            "map_center_lon_deg": 30.0,
            "albedo_contrast": 2.0,
            "emission_w_m2_sr": 20.0,
            "reflectance": "lunar_lambert",
            "photometry": {"b": 0.2},
            "relief": {"height_map": MAP, "height_m": 1e5},
            "ocean": {"map": MAP},
            "night_lights": {"map": MAP, "radiance_w_m2_sr": 30.0},
            "atmosphere": {"preset": "earth"},
            "clouds": {},
            "rings": {
                "inner_radius_km": 1300.0,
                "outer_radius_km": 1900.0,
                "optical_depth": 1.0,
                "albedo": 0.5,
            },
            "material": "m",
            "material_drivers": {"drivers": {"x": 1.0}},
            "material_mode": "wrap",
            "orbit": {"around": "b", "altitude_km": 100.0, "mean_anomaly_deg": 0.0},
            "class": "rock",
            "landmarks": {"x": {"lon_deg": 1.0, "lat_deg": 2.0}},
        },
        {"materials.m": LAMBERT},
    ),
    Section(
        Body, AT_BODY, {**BODY, "color_map": MAP}, {"latitudes": "geodetic", "albedo_contrast": 2.0}
    ),
    Section(Body, AT_BODY, BODY, {"classes": {"origin": "found"}}, {"labels.levels": ["origin"]}),
    Section(Body, AT_BODY, BODY, {"areas": [AREAS]}),
    Section(Body, AT_BODY, BODY, {"annotate": True}),
    Section(Body, AT_BODY, {**BODY, "annotate": True}, {"obj_id": 7}),
    Section(Clouds, (*AT_BODY, "clouds"), {"map": MAP}, {"latitudes": "geodetic"}),
    Section(
        Shape,
        (*AT_BODY, "shape"),
        {"file": "ball.obj"},
        {"metres_per_unit": 900.0, "smooth": False},
    ),
    Section(
        Terrain,
        (*AT_BODY, "terrain"),
        {},
        {
            "elevation": [HEIGHTS],
            "detail": None,
            "albedo": [{"file": GREY_MAP, "scale": 0.01, "projection": HEIGHTS["projection"]}],
            "roughness": [{"file": GREY_MAP, "scale": 0.3, "projection": HEIGHTS["projection"]}],
            "mask": [{"file": GREY_MAP, "projection": HEIGHTS["projection"]}],
            "patch": {"center_lon_lat_deg": [0.0, 0.0], "side_m": 1e3},
            "craters": {"density": 30.0},
            "rocks": {
                "law": "power",
                "coefficient": 0.02,
                "exponent": -2.0,
                "cutoff_m": 0.0,
                "min_diameter_m": 2e4,
                "max_diameter_m": 2e5,
            },
            "textures": [
                {"size_m": 6e4, "displacement": {"file": GREY_MAP, "high_m": 4e4}},
            ],
            "tracks": [{**TRACK, "lon_deg": lon} for lon in (0.0, 90.0, 180.0, 270.0)],
            "cells_per_pixel": 0.25,
            "finest_cell_m": 4e4,
        },
        {"camera.fov_deg": 2.0, "bodies.b.reflectance": "hapke"},
    ),
    Section(
        Terrain,
        (*AT_BODY, "terrain"),
        {},
        {"roughness_baseline_m": 0.0},
        {
            "camera.fov_deg": 2.0,
            "bodies.b.reflectance": "hapke",
            "bodies.b.photometry": {"roughness_deg": 25.0},
        },
    ),
    Section(
        Terrain,
        (*AT_BODY, "terrain"),
        {},
        {"crater_catalogue": "craters.csv"},
        {
            "labels.levels": ["kind", "ground"],
            "camera.fov_deg": 2.0,
            "labels.craters": {"least_px": 1.0},
        },
    ),
    Section(
        Detail,
        (*AT_BODY, "terrain", "detail"),
        {},
        {
            "method": "diamond_square",
            "seed": 5,
            "baseline_m": 100.0,
            "deviation_m": 100.0,
            "hurst": 0.9,
            "ranges": [{"from_m": 0.0, "hurst": 0.9}],
            "from_elevation": True,
            "strength": 2.0,
            "longest_m": 1e5,
            "finest_m": 3e5,
        },
    ),
    Section(
        Relief,
        (*AT_BODY, "relief"),
        {"height_map": MAP, "height_m": 1e5},
        {"normal_map": MAP, "normal_green": "south", "normal_strength": 2.0},
    ),
    Section(
        Relief,
        (*AT_BODY, "relief"),
        {"height_map": GREY_MAP, "height_unit_m": 1e3},
        {},
    ),
    Section(Ocean, (*AT_BODY, "ocean"), {"map": MAP}, {"wind_m_s": 2.0, "albedo": 0.1}),
    Section(
        NightLights,
        (*AT_BODY, "night_lights"),
        {"map": MAP, "radiance_w_m2_sr": 30.0},
        {"black": 0.3, "detail_km": 2000.0},
    ),
    Section(
        Clouds,
        (*AT_BODY, "clouds"),
        {},
        {
            "map": MAP,
            "map_center_lon_deg": 30.0,
            "altitude_km": 30.0,
            "thickness_km": 10.0,
            "longitude_deg": 30.0,
            "rotation_deg_h": 300.0,
            "opacity": 0.5,
            "optical_depth": 3.0,
            "color": 0.5,
            "noise": {},
        },
    ),
    Section(
        CloudNoise,
        (*AT_BODY, "clouds", "noise"),
        {},
        {
            "coverage": 0.3,
            "size_km": 700.0,
            "octaves": 3.0,
            "roughness": 0.3,
            "softness": 0.1,
            "warp": 0.5,
            "phase": 2.0,
            "depth_spread": 0.0,
            "relief_km": 2.0,
            "seed": 5,
        },
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {},
        {
            "preset": "earth",
            "rayleigh_per_km": 0.01,
            "rayleigh_height_km": 20.0,
            "mie_scattering_per_km": 0.01,
            "mie_extinction_per_km": 0.02,
            "mie_height_km": 20.0,
            "mie_g": 0.1,
            "ozone_per_km": 0.01,
            "ozone_center_km": 30.0,
            "ozone_width_km": 10.0,
        },
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {"preset": "earth", "rayleigh_upper_height_km": 6.0},
        {"rayleigh_upper_from_km": 20.0},
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {"preset": "earth", "rayleigh_upper_from_km": 6.0},
        {"rayleigh_upper_height_km": 20.0},
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {"preset": "earth", "mie_upper_height_km": 6.0},
        {"mie_upper_from_km": 20.0},
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {"preset": "earth", "mie_upper_from_km": 6.0},
        {"mie_upper_height_km": 20.0},
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {"rayleigh_per_km": 0.01},
        {"top_km": 50.0, "ground_albedo": 0.9, "multiple_scattering": False},
    ),
    Section(
        Atmosphere,
        (*AT_BODY, "atmosphere"),
        {"preset": "earth", "multiple_scattering": False},
        {"ground_albedo": 0.9},
    ),
    Section(Atmosphere, (*AT_BODY, "atmosphere"), {"preset": "mars"}, {"ozone_center_km": 30.0}),
    Section(
        Rings,
        (*AT_BODY, "rings"),
        {
            "inner_radius_km": 1300.0,
            "outer_radius_km": 1900.0,
            "optical_depth": 1.0,
            "albedo": 0.5,
        },
        {
            "color_map": MAP,
            "ringlets": [RINGLET],
            "phase_exponent": 1.0,
            "dust_share": 0.5,
            "dust_g": 0.1,
        },
    ),
    Section(
        Photometry,
        (*AT_BODY, "photometry"),
        {},
        LAW_KEYS,
        {"bodies.b.reflectance": "hapke"},
    ),
    Section(
        Photometry,
        (*AT_BODY, "photometry"),
        {},
        LAW_KEYS,
        {"bodies.b.reflectance": "minnaert"},
    ),
    Section(
        Spacecraft,
        AT_CRAFT,
        CRAFT,
        {
            "size_m": 4e5,
            "centre": "origin",
            "attitude": {"rotation_deg": [0.0, 0.0, 30.0]},
            "obj_id": 7,
            "class": "rock",
            "parts": {"split": "none"},
            "part_classes": {"panel": ["*panel*"]},
            "materials": [{"material": "*", "use": "m"}],
            "material_drivers": {"drivers": {"x": 1.0}},
            "articulation": [{"node": "panel_left", "axis": [1, 0, 0], "angle_deg": 30.0}],
            "animation": {"index": 0},
            "symmetries": {"discrete_deg": [[0, 0, 180]]},
            "keypoints": {"points": {"x": [0.0, 0.0, 1.0]}},
        },
        {"materials.m": LAMBERT},
    ),
    Section(
        Spacecraft, AT_CRAFT, CRAFT, {"classes": {"origin": "made"}}, {"labels.levels": ["origin"]}
    ),
    Section(
        Spacecraft,
        AT_CRAFT,
        CRAFT,
        {"gm_km3_s2": 1.0},
        {
            "spacecraft.t": CRAFT
            | {"orbit": {"around": "s", "semi_major_axis_km": 500.0, "mean_anomaly_deg": 0.0}},
        },
    ),
    Section(
        Keypoints,
        (*AT_CRAFT, "keypoints"),
        {"points": {"inside": [5e4, 0.0, -1e4]}},
        {"nodes": ["panel_left"], "file": "points.csv", "depth_m": 1e9},
    ),
    Section(Spacecraft, AT_CRAFT, CRAFT | {"model": "graphs.glb"}, {"model_graphs": False}),
    Section(Spacecraft, AT_CRAFT, CRAFT | {"model": "melted.glb"}, {"crease_angle_deg": 180.0}),
    Section(Spacecraft, AT_CRAFT, CRAFT | {"model": "sheet.gltf"}, {"faces": "as_stated"}),
    Section(Inertial, (*AT_CRAFT, "attitude"), {"pointing": "inertial"}, SPIN),
    Section(
        Circular,
        (*AT_CRAFT, "orbit"),
        {"kind": "circular", "around": "b", "scale": 2.1, "v_step": 0.0},
        {"v_step": 0.01, "orbit_start": 0.02, "rotation_deg": [30.0, 0.0, 270.0]},
    ),
    Section(
        Sun,
        ("sun",),
        {},
        {
            "radius_km": 2e7,
            "irradiance_w_m2": 700.0,
            "spectrum": {"file": "sun.csv", "irradiance_unit": "relative"},
            "band_wavelengths_um": [0.7, 0.6, 0.5],
            "direction": [1.0, -1.0, 0.0],
            "at": SITE_SUN,
            "distance_au": 0.5,
        },
        {"bodies.b.atmosphere": {"preset": "earth"}},
    ),
    Section(
        SiteSun,
        ("sun", "at"),
        SITE_SUN,
        {
            "lon_deg": 200.0,
            "lat_deg": -40.0,
            "latitudes": "geodetic",
            "azimuth_deg": 20.0,
            "elevation_deg": 80.0,
        },
    ),
    Section(
        Sky,
        ("sky",),
        {},
        {"stars": {"catalogue": "stars.csv"}, "background": {"image": MAP}},
    ),
    Section(
        Stars,
        ("sky", "stars"),
        {"catalogue": "stars.csv"},
        {"limit_magnitude": -8.9, "catalogue_year": 1800.0, "aberration": False},
    ),
    Section(
        Background,
        ("sky", "background"),
        {"map": MAP},
        {
            "frame": "galactic",
            "center_lon_deg": 90.0,
            "east": "right",
            "white_mag_arcsec2": 1.0,
            "image": MAP,
            "fit": "stretch",
            "brightness": 0.5,
        },
        {"sky.stars": {"catalogue": "stars.csv"}},
    ),
    Section(
        Background,
        ("sky", "background"),
        {"image": MAP},
        {
            "map": MAP,
            "frame": "galactic",
            "center_lon_deg": 90.0,
            "east": "right",
            "white_mag_arcsec2": 1.0,
            "fit": "stretch",
            "brightness": 0.5,
        },
    ),
    Section(
        BoxVolume,
        ("volumes", "v"),
        {"shape": "box", "size_m": 5e5, **MIST},
        MIST_KEYS,
        {"materials.fog": FOG},
    ),
    Section(
        BoxVolume,
        ("volumes", "v"),
        {"shape": "box", "size_m": 5e5, "parent": "b", "emission_w_m3_sr": 1e-4},
        {"albedo": 0.5, "g": 0.5},
        {"materials.fog": FOG},
    ),
    Section(
        EllipsoidVolume,
        ("volumes", "v"),
        {"shape": "ellipsoid", "radii_m": [3e5, 2e5, 1e5], **MIST},
        MIST_KEYS,
        {"materials.fog": FOG},
    ),
    Section(
        ConeVolume,
        ("volumes", "v"),
        {"shape": "cone", "end_radius_m": 3e5, "length_m": 6e5, **MIST},
        {"start_radius_m": 1e5, **MIST_KEYS},
        {"materials.fog": FOG},
    ),
]
"""Of some more than one entry, where another key says which of the keys are read."""
