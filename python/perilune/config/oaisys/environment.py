"""ENVIRONMENT_EFFECTS_SETUP: the Sun of the sky; there is no air, no sky and no picture around.

With a Sun from here frames are exposed alike, as Blender's are: what shows as white is a white wall
that faces the Sun. Without one the date says where the Sun is, and exposure is automatic.
"""

from __future__ import annotations

import math
from typing import Any

from perilune.config.oaisys.node import Node, varying
from perilune.config.oaisys.scene import Scene

_AU_KM = 149597870.7
_IRRADIANCE_W_M2 = 1361.0  # at that distance; the default of sun.irradiance_w_m2
_AIR = ("SunAltitude", "AirDensity", "DustDensity", "OzoneDensity")
_BRIGHTNESS = ("SunIntensity", "SunStrength")


def _sky(entry: Node, scene: Scene, interval: int) -> None:
    """Blender's sky texture: the Sun's elevation, and its rotation from +y towards +x."""
    params = entry.child("environmentEffectsParams")
    own = params.whole("stepInterval", 1, smallest=1)
    if params.choice("stepIntervalOption", ("GLOBAL", "LOCAL"), "GLOBAL") == "LOCAL":
        interval = own
    entry.get("stepInterval")  # OAISYS reads the one of environmentEffectsParams
    params.ignore("passParams", "the background has class id 0 at every level")
    elevation = params.span("SunElevation", (0.0, 0.0))
    rotation = params.span("SunRotation", (0.0, 0.0))
    azimuth = (90.0 - rotation[1], 90.0 - rotation[0])
    direction = {
        "azimuth_deg": varying(azimuth, interval),
        "elevation_deg": varying(elevation, interval),
    }
    sun: dict[str, Any] = {"direction": direction}
    params.comes("sun.direction.azimuth_deg", "SunRotation")
    params.comes("sun.direction.elevation_deg", "SunElevation")
    if params.has("SunSize"):
        size = params.span("SunSize")
        if not 0.0 < size[0] <= size[1] < 180.0:
            params.fail("SunSize", "must be an angle between 0 and 180 deg, edge to edge")
        low, high = (_AU_KM * math.sin(0.5 * math.radians(angle)) for angle in size)
        sun["radius_km"] = varying((low, high), interval)
        params.comes("sun.radius_km", "SunSize")
    for key in _BRIGHTNESS:
        params.ignore(key, "not applied: the Sun has its own irradiance, 1361 W/m2")
    for key in _AIR:
        if params.has(key):
            values = params.span(key)
            if key == "SunAltitude" or any(values):
                params.ignore(key, "not applied: there is no atmosphere yet")
    scene.tree["sun"] = sun
    white = _IRRADIANCE_W_M2 / math.pi
    scene.tree["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": white}


def read(section: Node, scene: Scene) -> None:
    """After the camera's section."""
    general = section.child("GENERAL")
    interval = general.whole("stepInterval", 1, smallest=1)
    general.ignore("backgroundStrength", "not applied: space is black")
    for entry in section.children("ENVIRONMENT_EFFECTS"):
        kind = entry.text("type")
        if kind == "EnvLightBlenderSky" and "sun" not in scene.tree:
            _sky(entry, scene, interval)
        elif kind == "EnvLightBlenderSky":
            entry.leave("not applied: there is one Sun, that of the first sky")
        elif kind == "EnvHDRI":
            entry.leave("EnvHDRI: not applied: no picture is around the scene; space is black")
        else:
            entry.leave(f"{kind}: has no counterpart here; it is not applied")
