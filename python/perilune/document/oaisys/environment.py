"""ENVIRONMENT_EFFECTS_SETUP: the Sun of the sky, the planet's atmosphere, and a background picture.

If the section has a Sun, all frames have the same exposure, as in Blender: white is a white wall
that faces the Sun. Otherwise the date gives the Sun's position, and exposure is automatic."""

from __future__ import annotations

import math
from typing import Any

from perilune.document.oaisys import files
from perilune.document.oaisys.node import Node, varying
from perilune.document.oaisys.scene import Scene

_AU_KM = 149597870.7
_IRRADIANCE_W_M2 = 1361.0  # at that distance; the default of sun.irradiance_w_m2
_AIR = {
    "AirDensity": ("rayleigh_per_km", "rayleigh_scattering"),
    "DustDensity": ("mie_scattering_per_km", "mie_scattering"),
    "OzoneDensity": ("ozone_per_km", "ozone_absorption"),
}
"""Key -> Perilune's key, and the core's name."""
_PRESETS = ("earth", "mars")
_WHITE_W_M2_SR = _IRRADIANCE_W_M2 / math.pi
_BRIGHTNESS = ("SunIntensity", "SunStrength")


def _middle(params: Node, key: str) -> float:
    """Middle of a range, for values that do not vary here."""
    low, high = params.span(key, (1.0, 1.0))
    if low < 0.0:
        params.fail(key, f"must not be negative: {low:g}")
    if low != high:
        text = f"its middle, {0.5 * (low + high):g}, is applied: air does not vary"
        params.notes.warn(params.where(key), text)
    return 0.5 * (low + high)


def _air(params: Node, scene: Scene) -> None:
    """Blender's sky belongs to a planet: the first body that is an ellipsoid gets the atmosphere of
    its preset or the Earth's, scaled by the densities."""
    # They see the whole schema, which is not there yet when this file is read.
    from perilune.bodies import atmospheres
    from perilune.config.atmosphere import Atmosphere

    given = [key for key in _AIR if params.has(key)]
    bodies = (entity for entity in scene.entities.values() if entity.section == "bodies")
    planet = next((row for row in bodies if "shape" not in scene.tree["bodies"][row.name]), None)
    if planet is None or "atmosphere" in scene.tree["bodies"][planet.name]:
        why = "no ellipsoid is there" if planet is None else "the planet's `atmosphere` counts"
        for key in given:
            params.ignore(key, f"not applied: {why}")
        return
    factors = {key: _middle(params, key) for key in given}
    if not any(factors.values()):
        return
    preset = planet.table if planet.table in _PRESETS else "earth"
    air: dict[str, Any] = {"preset": preset}
    base = atmospheres.settings(Atmosphere(preset=preset))  # type: ignore[arg-type]
    for key, factor in factors.items():
        ours, core = _AIR[key]
        if not any(base[core]):  # type: ignore[literal-required]
            params.ignore(key, f"not applied: the air of {preset} has none of it")
        elif factor != 1.0:
            air[ours] = [factor * 1e3 * value for value in base[core]]  # type: ignore[literal-required]
        params.comes(f"bodies.{planet.name}.atmosphere.{ours}", key)
    scene.tree["bodies"][planet.name]["atmosphere"] = air
    text = f"the air about {planet.name}, with the densities as factors on that of {preset}"
    params.notes.warn(params.where(given[0]), text)


def _hdri(row: Node, scene: Scene) -> str | None:
    """Picture of an entry of HDRIList that can be read; None without one."""
    text = row.text("filePath")
    row.ignore("labelIDVec", "the background has class id 0 at every level")
    found = files.picture(text, scene.base)
    where = row.where("filePath")
    if found is None:
        row.notes.warn(
            where,
            "not applied: .hdr and .exr are not read, and no picture (PNG, JPEG, "
            "WebP) of the same name is beside it",
        )
    elif found != text:
        row.notes.warn(where, f"read from {found}, as .hdr and .exr are not")
    return found


def _picture(entry: Node, scene: Scene, interval: int) -> None:
    """A background picture with Blender's brightness: 1 is a white wall in sunlight."""
    from perilune.sky.skies import magnitude_arcsec2

    params = entry.child("environmentEffectsParams")
    owner = params if params.has("HDRIList") else entry
    local = params.choice("stepIntervalOption", ("GLOBAL", "LOCAL"), "GLOBAL") == "LOCAL"
    own = params.whole("stepInterval", 1, smallest=1)
    interval = own if local else interval
    entry.get("stepInterval")  # OAISYS reads the one of environmentEffectsParams
    for other in (entry, params):
        other.get("selectionOption")
        other.ignore("passParams", "the background has class id 0 at every level")
    rows = owner.children("HDRIList")
    found = [(row, _hdri(row, scene)) for row in rows]
    kept = [(row, picture) for row, picture in found if picture is not None]
    if not kept or "sky" in scene.tree:
        entry.leave("EnvHDRI: not applied: " + ("one is there already" if kept else "no picture"))
        for row in rows:
            row.skip()
        return
    strengths = [row.span("strength", (1.0, 1.0)) for row, _ in kept]
    if not min(low for low, _ in strengths) > 0.0:
        kept[0][0].fail("strength", "must be positive")
    first = strengths[0]
    if any(span != first for span in strengths):
        owner.notes.warn(owner.where("HDRIList"), "all have the strength of the first")
    magnitudes = [magnitude_arcsec2(value * _WHITE_W_M2_SR) for value in reversed(first)]
    pictures = [picture for _, picture in kept]
    scene.tree["sky"] = {
        "background": {
            "map": pictures[0]
            if len(pictures) == 1
            else {"choice": pictures, "interval": interval},
            "white_mag_arcsec2": varying((magnitudes[0], magnitudes[1]), interval),
        }
    }
    kept[0][0].comes("sky.background.map", "filePath")
    kept[0][0].comes("sky.background.white_mag_arcsec2", "strength")
    entry.notes.warn(entry.path, "EnvHDRI: a picture behind everything; it lights nothing")


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
    params.ignore("SunAltitude", "not applied: the camera's place says how high it is")
    _air(params, scene)
    scene.tree["sun"] = sun
    scene.tree["camera"]["exposure"] = {"mode": "fixed", "white_radiance_w_m2_sr": _WHITE_W_M2_SR}


def read(section: Node, scene: Scene) -> None:
    """To be called after the camera's section was read."""
    general = section.child("GENERAL")
    interval = general.whole("stepInterval", 1, smallest=1)
    general.ignore("backgroundStrength", "not applied: space is black but for an EnvHDRI")
    for entry in section.children("ENVIRONMENT_EFFECTS"):
        kind = entry.text("type")
        if kind == "EnvLightBlenderSky" and "sun" not in scene.tree:
            _sky(entry, scene, interval)
        elif kind == "EnvLightBlenderSky":
            entry.leave("not applied: there is one Sun, that of the first sky")
        elif kind == "EnvHDRI":
            _picture(entry, scene, interval)
        else:
            entry.leave(f"{kind}: has no counterpart here; it is not applied")
