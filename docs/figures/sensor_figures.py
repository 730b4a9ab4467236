"""What a sensor makes of hard light: `python docs/figures/make_figures.py glare moon_sensor`.

Foil under a hard sun, clean and through a lens that scatters; the Moon at five phase angles, each
exposed by the camera itself; a solar panel that mirrors the sun into a CCD without anti-blooming.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import moon_figures

import perilune

ROOT = Path(__file__).resolve().parents[2]
FOIL = ROOT / "configs" / "mli_randomised.yaml"
Shown = list[tuple[str, Any]]


def foil() -> Shown:
    """Gold foil close by: as it is, and as a CMOS camera has it, with one per cent of glare."""
    spread = {"core": "gauss", "sigma_px": 0.7, "wings": 0.02, "wing_beta": 1.3}
    sensor = {"preset": "cmv4000", "point_spread": spread, "exposure": {"percentile": 90.0}}
    changes: dict[str, Any] = {"camera.width": 440, "camera.height": 400, "camera.fov_deg": 17.0,
               "camera.sensor": sensor, "render.samples": 48,
               "sun.direction": [0.93, -0.3, 0.05]}  # fmt: skip
    sample = perilune.open(FOIL, overrides=changes).frame(3, channels=["rgb", "sensor_rgb"])
    return [("foil, clean", sample["rgb"]), ("through lens and sensor", sample["sensor_rgb"])]


def moon_sensor() -> Shown:
    """Phases of the Moon by a CCD, which chooses the time."""
    shown: Shown = []
    sensor = {"preset": "ccd47_20", "point_spread": {"core": "airy", "wings": 0.01},
              "exposure": {"percentile": 99.0, "key": 0.8}}  # fmt: skip
    height_m = moon_figures.DISTANCE_M - moon_figures.RADIUS_M
    for phase_deg in moon_figures.PHASES_DEG:
        config = moon_figures.scene(moon_figures.HAPKE, phase_deg, height_m, 0.56)
        sim = perilune.open(config, overrides={"camera.sensor": sensor})
        sample = sim.frame(0, channels=["sensor_rgb"])
        time_us = 1e6 * sample.meta["exposure_s"]
        shown.append((f"{phase_deg:g} deg, {time_us:.0f} us", sample["sensor_rgb"]))
    return shown


def panel() -> Shown:
    """A wing that mirrors the sun: clean, and in a CCD that is exposed for the rest of it."""
    sensor = {"preset": "ccd47_20", "exposure": {"percentile": 70.0, "key": 0.25},
              "point_spread": {"core": "airy", "wings": 0.005}}  # fmt: skip
    changes: dict[str, Any] = {"camera.width": 440, "camera.height": 400, "camera.fov_deg": 23.0,
               "camera.sensor": sensor, "render.samples": 48,
               "camera.trajectory.position_m": [-5.5, 4.5, -0.8],
               "camera.trajectory.aim_offset_m": [-1.25, -0.95, 0.05],
               "spacecraft.smallsat.orbit.altitude_km": 20000.0,
                              "sun.direction": [-0.682, 0.495, -0.538]}  # fmt: skip
    sample = perilune.open(FOIL, overrides=changes).frame(0, channels=["rgb", "sensor_rgb"])
    return [
        ("a wing mirrors the sun, clean", sample["rgb"]),
        ("in a CCD whose full pixels bloom", sample["sensor_rgb"]),
    ]
