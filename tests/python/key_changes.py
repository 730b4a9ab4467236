"""What a key of the schema changes: which parts of a frame must and which may differ, and for keys
whose effect has a direction, whether the picture gets brighter or darker."""

from __future__ import annotations

from typing import NamedTuple

PARTS = {
    "light": ("rgb", "radiance", "bands"),
    "depth": ("depth",),
    "ids": ("semantic", "instance", "part"),
    "sensor": ("raw", "sensor_rgb"),
    "mask": ("ground_mask",),
}
"""Part of a frame -> channels. Besides: camera (K and pose), objects (their labels), stars,
exposure, names (taxonomy and models), meta."""


class Rule(NamedTuple):
    """Parts of a frame."""

    must: frozenset[str]
    """All of these differ."""
    may: frozenset[str]
    """Nothing but these differs."""


def rule(must: str, may: str = "") -> Rule:
    required = frozenset(must.split())
    return Rule(required, required | frozenset(may.split()))


SEEN = "light depth ids objects mask"
LIGHT = rule("light")
PLACED = rule("light depth", "ids objects")
MOVES = rule("camera", SEEN)
EXPOSED = rule("", "exposure sensor light")  # samples serve the sensor's exposure: their noise
LENS = rule("depth", SEEN + " sensor")
FOCUS = rule("light", "sensor")

MODELS = {
    **dict.fromkeys(
        ("Body", "Photometry", "Relief", "Ocean", "NightLights", "Clouds", "CloudNoise",
         "Atmosphere", "Rings", "Sun", "SiteSun", "Sky", "Background", "BoxVolume",
         "EllipsoidVolume", "ConeVolume"),
        LIGHT,
    ),
    "Stars": rule("light stars"),
    **dict.fromkeys(("Shape", "Terrain", "Detail"), PLACED),
    "Spacecraft": rule("names", "ids objects"),
    "Keypoints": rule("keypoints"),
    "Inertial": PLACED,
    "Circular": rule("objects", SEEN),
    "Camera": MOVES,
    "Sensor": MOVES,
    "Exposure": rule("light exposure"),
    **dict.fromkeys(("Rectilinear", "BrownConrady", "Fisheye", "Equirectangular"), LENS),
    **dict.fromkeys(("ImageSensor", "SensorExposure"), EXPOSED),
    **dict.fromkeys(("PointSpread", "CosmicRays", "LensFlare", "Compression"), rule("sensor")),
    **dict.fromkeys(
        ("CentredTarget", "OrbitObject", "Fixed", "RandomBox", "Hover", "Linear", "Spiral",
         "Flyby", "Relative", "Deterministic", "Traverse", "PoweredDescent"),
        MOVES,
    ),
}  # fmt: skip
"""By the section's class."""

KEYS = {
    ("Body", "shape"): PLACED,
    ("Body", "terrain"): PLACED,
    ("Terrain", "albedo"): LIGHT,
    ("Terrain", "roughness"): LIGHT,
    ("Terrain", "crater_catalogue"): rule("ids"),
    ("Terrain", "mask"): rule("mask"),
    ("Terrain", "roughness_baseline_m"): LIGHT,
    ("Body", "class"): rule("names"),
    ("Body", "areas"): rule("ids names"),
    ("Body", "annotate"): rule("objects"),
    ("Body", "obj_id"): rule("objects"),
    ("Shape", "smooth"): LIGHT,
    ("Body", "landmarks"): rule("keypoints"),
    ("Spacecraft", "keypoints"): rule("keypoints"),
    ("Spacecraft", "centre"): PLACED,
    ("Spacecraft", "crease_angle_deg"): LIGHT,
    ("Spacecraft", "faces"): PLACED,
    ("Spacecraft", "attitude"): PLACED,
    ("Spacecraft", "parts"): rule("ids names"),
    ("Spacecraft", "part_classes"): rule("ids names"),
    ("Spacecraft", "materials"): LIGHT,
    ("Spacecraft", "articulation"): rule("light depth meta", "ids objects"),
    ("Spacecraft", "model_graphs"): LIGHT,
    ("Sky", "stars"): rule("light stars"),
    ("Sun", "spectrum"): rule("light meta"),
    ("Camera", "lens"): LENS,
    ("Camera", "bands"): rule("light meta"),
    ("Camera", "sensor"): rule("exposure sensor"),
    ("Sensor", "lens"): LENS,
    ("Sensor", "exposure"): rule("light exposure"),
    ("Sensor", "bands"): rule("light meta"),
    ("Sensor", "sensor"): rule("exposure sensor"),
    ("Sensor", "trigger_interval"): rule("", SEEN),
    ("Rectilinear", "focus_distance_m"): FOCUS,
    ("BrownConrady", "focus_distance_m"): FOCUS,
    ("BrownConrady", "labels"): rule("depth", "ids objects"),
    ("Fisheye", "labels"): rule("depth", "ids objects"),
}
"""Where a key of a section is not as the others."""

BRIGHTER, DARKER = (1.0, 1e9), (0.0, 1.0)

RATIOS = {
    ("Body", "emission_w_m2_sr"): BRIGHTER,
    ("Body", "night_lights"): BRIGHTER,
    ("Body", "clouds"): BRIGHTER,  # over a dark ground
    ("Body", "rings"): BRIGHTER,
    ("Body", "relief"): (0.8, 1.25),  # bends light, makes none
    ("NightLights", "black"): DARKER,
    ("Clouds", "map"): DARKER,
    ("Clouds", "opacity"): DARKER,
    ("Clouds", "optical_depth"): DARKER,
    ("Clouds", "color"): DARKER,
    ("Clouds", "noise"): DARKER,
    ("CloudNoise", "coverage"): DARKER,
    ("Atmosphere", "ground_albedo"): BRIGHTER,
    ("Atmosphere", "multiple_scattering"): DARKER,
    ("Photometry", "roughness_deg"): DARKER,
    ("Sun", "irradiance_w_m2"): (700.0 / 1361.0 - 1e-3, 700.0 / 1361.0 + 1e-3),
    ("Sun", "radius_km"): (0.95, 1.05),  # the same light from a larger disc
    ("Sky", "stars"): BRIGHTER,
    ("Sky", "background"): BRIGHTER,
    ("Stars", "limit_magnitude"): DARKER,
    ("Background", "white_mag_arcsec2"): BRIGHTER,
    ("Background", "brightness"): DARKER,
    **{(name, "extinction_per_m"): BRIGHTER for name in
       ("BoxVolume", "EllipsoidVolume", "ConeVolume")},
    **{(name, "emission_w_m3_sr"): BRIGHTER for name in
       ("BoxVolume", "EllipsoidVolume", "ConeVolume")},
    **{(name, "albedo"): DARKER for name in
       ("BoxVolume", "EllipsoidVolume", "ConeVolume")},
}  # fmt: skip
"""By what the sum of a frame's radiance is multiplied, between two limits, by the value that
key_sections.py gives in the place of the default."""

RAW_RATIOS = {
    ("ImageSensor", "vignetting_profile"): DARKER,
    ("ImageSensor", "dark_current_e_s"): BRIGHTER,
    ("ImageSensor", "temperature_c"): BRIGHTER,
    ("ImageSensor", "hot_pixels"): BRIGHTER,
    ("ImageSensor", "dead_pixels"): DARKER,
    ("ImageSensor", "shift_us"): BRIGHTER,
    ("ImageSensor", "cosmic_rays"): BRIGHTER,
    ("ImageSensor", "black_level_dn"): DARKER,
    ("ImageSensor", "bits"): DARKER,
    ("ImageSensor", "drain"): BRIGHTER,
    ("ImageSensor", "point_spread"): (0.9, 1.02),  # light that leaves the picture at most
    ("SensorExposure", "key"): DARKER,
    ("SensorExposure", "percentile"): BRIGHTER,
    ("SensorExposure", "min_ms"): BRIGHTER,
    ("SensorExposure", "max_ms"): DARKER,
    ("PointSpread", "sigma_px"): (0.9, 1.02),
    ("PointSpread", "wings"): DARKER,
    ("CosmicRays", "flux_cm2_s"): BRIGHTER,
    ("LensFlare", "ghosts"): BRIGHTER,
}
"""The same of the mean of `raw`."""


def rule_of(model: str, key: str) -> Rule:
    return KEYS.get((model, key), MODELS[model])
