"""Sections of the schema as in key_sections.py: cameras, their sensors and their ways."""

from __future__ import annotations

from tests.python.key_sections import Section, base

from perilune.config.camera import Camera, Exposure
from perilune.config.lens import BrownConrady, Equirectangular, Fisheye, Rectilinear
from perilune.config.lens_flare import LensFlare
from perilune.config.sensor import Compression, CosmicRays, ImageSensor, PointSpread, SensorExposure
from perilune.config.sensors import Sensor
from perilune.config.trajectory import (
    CentredTarget,
    Deterministic,
    Fixed,
    Flyby,
    Hover,
    Linear,
    OrbitObject,
    PoweredDescent,
    RandomBox,
    Relative,
    Spiral,
    Traverse,
)

AT_CAMERA = ("camera",)
CAMERA = base()["camera"]
AT_PLACES = (*AT_CAMERA, "trajectory")
BAND = {"center_um": 0.6, "width_um": 0.1}
WIDE = {"camera.sensor": {"f_number": 0.5, "pixel_um": 1e6}}
PLACE = {"position_m": [-3e5, -2.9e6, 4e5]}
POINTING = {
    "aim_jitter_deg": 1.0,
    "pointing_noise_deg": 1.0,
    "roll_deg": 30.0,
    "clearance_m": 1e7,
}
AIMED = POINTING | {
    "frame": "target",
    "aim_offset_m": [1e5, 0.0, 1e5],
    "up": [1.0, 0.7, 0.2],
}
OVER_GROUND = {
    "lon_deg": 240.0,
    "lat_deg": 20.0,
    "latitudes": "geodetic",
    "altitude_above": "datum",
}
RUN = {"positions": 5, "duration_s": 100.0, "after": "hold"}
LENS = {"focus_distance_m": 100.0, "aperture_mm": 5e4, "labels": "undistorted"}

EXPOSURE_KEYS = {
    "metering": "mean",
    "percentile": 50.0,
    "key": 0.3,
    "window": [0.3, 0.3, 0.7, 0.7],
    "saturated": 0.0,
    "min_ms": 100.0,
    "max_ms": 0.02,
    "step_ms": 7.0,
    "times_ms": [0.1, 100.0],
    "gains": [2.0, 4.0],
    "lag_frames": 1,
}

CAMERAS = [
    Section(
        CentredTarget,
        AT_PLACES,
        {"kind": "centred_target", "target": "b", "direction": [0.0, -1.0, 0.0]},
        RUN,
    ),
    Section(
        Camera,
        AT_CAMERA,
        CAMERA,
        {
            "focal_px": 20.0,
            "K": [20.0, 0.0, 11.5, 0.0, 20.0, 8.5, 0.0, 0.0, 1.0],
            "lens": {"model": "fisheye"},
            "exposure_time_s": 60.0,
            "line_time_us": 1e7,
            "bands": [BAND],
            "sensor": {},
        },
    ),
    Section(
        Exposure,
        (*AT_CAMERA, "exposure"),
        {},
        {
            "mode": "fixed",
            "percentile": 50.0,
            "key": 0.4,
            "min_white_radiance_w_m2_sr": 1e4,
            "white_radiance_w_m2_sr": 100.0,
        },
    ),
    Section(
        Exposure,
        (*AT_CAMERA, "exposure"),
        {"mode": "fixed", "white_radiance_w_m2_sr": 100.0},
        {"percentile": 50.0, "key": 0.4, "min_white_radiance_w_m2_sr": 1e4},
    ),
    Section(
        Rectilinear,
        (*AT_CAMERA, "lens"),
        {"model": "rectilinear"},
        {key: LENS[key] for key in ("focus_distance_m", "aperture_mm")},
        WIDE,
    ),
    Section(
        BrownConrady,
        (*AT_CAMERA, "lens"),
        {"model": "brown_conrady", "k1": 0.1},
        dict.fromkeys(("k2", "p1", "p2", "k3", "k4", "k5", "k6"), 0.05) | LENS,
        WIDE,
    ),
    Section(
        Fisheye,
        (*AT_CAMERA, "lens"),
        {"model": "fisheye"},
        dict.fromkeys(("k1", "k2", "k3", "k4"), 0.05) | LENS,
    ),
    Section(
        Equirectangular,
        (*AT_CAMERA, "lens"),
        {"model": "equirectangular"},
        {key: LENS[key] for key in ("focus_distance_m", "aperture_mm")},
        {"camera.fov_deg": None},
    ),
    Section(
        ImageSensor,
        (*AT_CAMERA, "sensor"),
        {},
        {
            "preset": "cmv4000",
            "f_number": 8.0,
            "aperture_mm": 0.05,
            "pupil": "plane",
            "transmission": 0.5,
            "vignetting": 1.0,
            "vignetting_profile": [[0.0, 1.0], [40.0, 0.5]],
            "flat_field": "kernel.npy",
            "point_spread": {"sigma_px": 2.0},
            "lens_flare": {},
            "pixel_um": 3.0,
            "mosaic": "mono",
            "quantum_efficiency": [0.2, 0.3, 0.2],
            "bands_nm": [[600, 650], [500, 600], [400, 450]],
            "serial": 5,
            "exposure": {"key": 0.3},
            "prnu": 0.2,
            "dark_current_e_s": 1e5,
            "dark_reference_c": 10.0,
            "dark_doubling_k": 2.0,
            "temperature_c": 100.0,
            "dark_nonuniform": 2.0,
            "hot_pixels": 0.2,
            "hot_current_e_s": 1e5,
            "dead_pixels": 0.2,
            "shift_us": 100.0,
            "reset_us": 100.0,
            "cosmic_rays": {"flux_cm2_s": 1e8},
            "full_well_e": 4000.0,
            "read_noise_e": 30.0,
            "column_noise_e": 30.0,
            "column_flicker_e": 30.0,
            "row_noise_e": 30.0,
            "gain_e_dn": 2.0,
            "black_level_dn": 30.0,
            "bits": 8,
            "compression": {"quality": 10.0},
        },
    ),
    Section(
        ImageSensor,
        (*AT_CAMERA, "sensor"),
        {"exposure": {"mode": "fixed"}},
        {"drain": 0.0},
        {"camera.exposure_time_s": 10.0},
    ),
    Section(
        SensorExposure,
        (*AT_CAMERA, "sensor", "exposure"),
        {},
        {
            "mode": "fixed",
            **EXPOSURE_KEYS,
        },
        {"camera.exposure_time_s": 0.01},
    ),
    Section(
        SensorExposure,
        (*AT_CAMERA, "sensor", "exposure"),
        {"mode": "fixed"},
        {
            **EXPOSURE_KEYS,
        },
        {"camera.exposure_time_s": 0.01},
    ),
    Section(
        SensorExposure,
        (*AT_CAMERA, "sensor", "exposure"),
        {"metering": "mean"},
        {"percentile": 50.0},
    ),
    *(
        Section(
            PointSpread,
            (*AT_CAMERA, "sensor", "point_spread"),
            {} if core == "gauss" else {"core": core},
            {
                **({"core": "airy"} if core == "gauss" else {}),
                "kernel": "kernel.npy",
                "sigma_px": 2.0,
                "wings": 0.3,
                "wing_radius_px": 4.0,
                "wing_beta": 3.0,
            },
        )
        for core in ("gauss", "point", "airy")
    ),
    Section(
        CosmicRays,
        (*AT_CAMERA, "sensor", "cosmic_rays"),
        {},
        {"flux_cm2_s": 1e8, "electrons_um": 500.0, "depth_um": 50.0},
    ),
    Section(
        LensFlare,
        (*AT_CAMERA, "sensor", "lens_flare"),
        {},
        {
            "ghosts": [{"scale": 0.5, "radius_deg": 5.0, "intensity": 0.1}],
            "baffle_deg": [80.0, 85.0],
        },
        {"sun.direction": [0.5, 1.0, 0.3]},
    ),
    Section(
        Compression,
        (*AT_CAMERA, "sensor", "compression"),
        {},
        {"quality": 20.0, "chroma": "444"},
    ),
    Section(
        Sensor,
        ("sensors", "eye"),
        {},
        {
            "width": 20,
            "height": 20,
            "fov_deg": 50.0,
            "focal_px": 20.0,
            "K": [20.0, 0.0, 11.5, 0.0, 20.0, 8.5, 0.0, 0.0, 1.0],
            "lens": {"model": "fisheye"},
            "exposure_time_s": 60.0,
            "line_time_us": 1e7,
            "exposure": {},
            "bands": [BAND],
            "sensor": {},
            "transformation": {"rotation_deg": [0.0, 0.0, 20.0]},
            "trigger_interval": 2,
        },
    ),
    Section(
        OrbitObject,
        AT_PLACES,
        {"kind": "orbit_object", "target": "s", "distance_m": 1e6},
        POINTING
        | {
            "clearance_m": 1e7,
            "interval": 5,
            "distance_noise_m": 1e5,
            "sun_angle_deg": [50.0, 60.0],
            "cone_axis": [1.0, 0.0, 0.0],
            "cone_angle_deg": [0.0, 10.0],
            "background": "b",
        },
    ),
    Section(Fixed, AT_PLACES, {"kind": "fixed", "target": "b", **PLACE}, AIMED),
    Section(
        RandomBox,
        AT_PLACES,
        {"kind": "random_box", "min_m": [-1e6, -3e6, 0], "max_m": [1e6, -2e6, 1e6], "target": "b"},
        POINTING
        | {
            "interval": 5,
            "around": "s",
            "frame": "target",
            "rotation_min_deg": [0, 0, 0],
            "rotation_max_deg": [0, 0, 0],
            "camera_axes": "opengl",
            "target_min_m": [0, 0, 0],
            "target_max_m": [0, 0, 0],
            "target_from": "camera",
            "up": [1.0, 0.7, 0.2],
        },
    ),
    Section(
        RandomBox,
        AT_PLACES,
        {
            "kind": "random_box",
            "min_m": [-1e6, -3e6, 0],
            "max_m": [1e6, -2e6, 1e6],
            "rotation_min_deg": [-90, 0, 0],
            "rotation_max_deg": [-80, 0, 0],
        },
        {"camera_axes": "opengl", "target_from": "camera", "up": [1.0, 0.7, 0.2]},
    ),
    Section(
        Hover,
        AT_PLACES,
        {"kind": "hover", "target": "b", "height_m": 2e6},
        POINTING
        | {
            "interval": 5,
            "lon_deg": 20.0,
            "lat_deg": 20.0,
            "latitudes": "geodetic",
            "altitude_above": "datum",
            "distance_noise_m": 1e5,
            "off_nadir_deg": 20.0,
            "azimuth_deg": 20.0,
        },
    ),
    Section(
        Linear,
        AT_PLACES,
        {
            "kind": "linear",
            "target": "b",
            "start": PLACE,
            "end": {"position_m": [0.0, -3e6, 1e6]},
        },
        AIMED | RUN | {"camera_axes": "opengl", "start_speed_m_s": 1.0, "end_speed_m_s": 1.0},
    ),
    Section(
        Linear,
        AT_PLACES,
        {
            "kind": "linear",
            "target": "b",
            "start": PLACE | {"rotation_deg": [-90, 0, 0]},
            "end": {"position_m": [0.0, -3e6, 1e6], "rotation_deg": [-80, 0, 0]},
        },
        {"camera_axes": "opengl", "up": [1.0, 0.7, 0.2], "aim_offset_m": [1e5, 0.0, 1e5]},
    ),
    Section(
        Spiral,
        AT_PLACES,
        {"kind": "spiral", "target": "b", "r_start_m": 3e6},
        AIMED
        | RUN
        | {
            "start_m": [3e6, 0.0, 0.0],
            "r_end_m": 2e6,
            "plane": "yz",
            "normal": [1.0, 0.0, 0.0],
            "start_angle_deg": 30.0,
            "rotations": 2.0,
            "distance_noise_m": 1e5,
        },
    ),
    Section(
        Flyby,
        AT_PLACES,
        {"kind": "flyby", "target": "b", "closest_m": 2e6, "before_m": 1e6},
        AIMED
        | RUN
        | {
            "direction": [0.0, 1.0, 0.0],
            "side": [0.0, 1.0, 1.0],
            "after_m": 3e6,
            "altitude_above": "datum",
        },
    ),
    Section(
        CentredTarget,
        AT_PLACES,
        {"kind": "centred_target", "target": "b"},
        AIMED
        | RUN
        | {
            "duration_s": 50.0,
            "direction": [0.0, -1.0, 0.0],
            "distance_m": 2.5e6,
            "distance_scale": 2.5,
            "landing": True,
            "final_distance_m": 1e6,
        },
    ),
    Section(
        Relative,
        AT_PLACES,
        {
            "kind": "relative",
            "target": "s",
            "state": {"position_m": [0.0, -9e5, 0.0], "velocity_m_s": [1.0, 10.0, 0.0]},
        },
        AIMED | RUN | {"frame": "lvlh", "ellipse": {"radial_m": 5e5}, "duration_s": 100.0},
    ),
    Section(
        Traverse,
        AT_PLACES,
        {
            "kind": "traverse",
            "target": "b",
            "lon_deg": 250.0,
            "lat_deg": 10.0,
            "waypoints_m": [[0.0, 0.0], [2e5, 0.0], [2e5, 1e5]],
            "height_m": 5e5,
            "positions": 4,
        },
        POINTING
        | OVER_GROUND
        | {
            "positions": 5,
            "duration_s": 100.0,
            "after": "hold",
            "speed_m_s": 100.0,
            "footprint_m": 6e5,
            "level": True,
            "yaw_deg": 40.0,
            "pitch_deg": -40.0,
            "waypoints_m": [[0.0, 0.0], [2e5, 0.0], [1e5, 3e5]],
        },
    ),
    Section(
        Traverse,
        AT_PLACES,
        {
            "kind": "traverse",
            "target": "b",
            "lon_deg": 250.0,
            "lat_deg": 10.0,
            "waypoints_m": [[0.0, 0.0], [2e5, 0.0]],
            "height_m": 5e5,
        },
        {"duration_s": 100.0, "speed_m_s": 100.0},
    ),
    Section(
        PoweredDescent,
        AT_PLACES,
        {
            "kind": "powered_descent",
            "target": "b",
            "lon_deg": 250.0,
            "lat_deg": 10.0,
            "height_m": 1e4,
            "start_height_m": 2e4,
            "horizontal_speed_m_s": 400.0,
        },
        POINTING
        | OVER_GROUND
        | {
            "place": "start",
            "heading_deg": 40.0,
            "descent_speed_m_s": 100.0,
            "touchdown_speed_m_s": 30.0,
            "final_height_m": 1e4,
            "specific_impulse_s": 150.0,
            "max_acceleration_m_s2": 0.1,
            "look": "thrust",
            "tilt_deg": 30.0,
            "positions": 5,
            "after": "repeat",
        },
    ),
    Section(
        Deterministic,
        AT_PLACES,
        {"kind": "deterministic", "file": "poses.csv"},
        POINTING
        | {
            "target": "s",
            "frame": "target",
            "metres_per_unit": 1.1,
            "offset_m": [1e5, 0.0, 0.0],
            "camera_axes": "opengl",
            "first_frame": 1,
            "after": "hold",
        },
    ),
]
