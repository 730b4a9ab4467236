"""SENSOR_SETUP.SENSORS: cameras; movement.py reads their common movement."""

from __future__ import annotations

from typing import Any

from perilune.document.oaisys import movement
from perilune.document.oaisys.node import Node
from perilune.document.oaisys.render import PASSES
from perilune.document.oaisys.scene import Scene, clean_name

_IDENTITY = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]


def _transformation(params: Node, scene: Scene) -> list[float]:
    """Sensor to base, converted from Blender's camera axes (y up, looking along -z) to ours.

    With F the half turn about x between the two, p' = F p and R' = F R F, which changes the signs
    of a quaternion's y and z."""
    x, y, z, qw, qx, qy, qz = params.numbers("transformation", 7, _IDENTITY)
    if not any((qw, qx, qy, qz)):
        where = params.where("transformation")
        params.notes.warn(where, "a zero quaternion is read as no rotation")
        qw = 1.0
    x, y, z = scene.lengths_m([x, y, z])
    return [value + 0.0 for value in (x, -y, -z, qw, qx, -qy, -qz)]  # no -0


def _passes(params: Node, scene: Scene) -> None:
    section = params.child("renderPasses")
    for name in section.raw:
        row = section.child(name)
        if name not in PASSES:
            row.leave(f"{name}: has no counterpart here; it is not applied")
            continue
        slots = row.get("activationSlot", [1])
        depth = row.flag("DepthEnabled", True)
        if name == "RGBDPass" and not depth:
            text = "channels are those of all sensors; leave depth out by render.channels"
            row.notes.warn(row.where("DepthEnabled"), text)
        if isinstance(slots, list) and any(slots):
            scene.passes.add(name)
        else:
            text = "channels are those of all sensors; this one does not ask for the pass"
            row.notes.warn(row.where("activationSlot"), text)


def _optics(params: Node, ours: str) -> dict[str, Any]:
    width, height = params.numbers("imageResolution", 2)
    for value in (width, height):
        if not value.is_integer() or value < 1:
            params.fail("imageResolution", f"must be whole numbers of pixels: {value:g}")
    for name in ("width", "height"):
        params.comes(f"{ours}.{name}", "imageResolution")
    params.comes(f"{ours}.K", "KMatrix")
    return {"width": int(width), "height": int(height), "K": params.numbers("KMatrix", 9)}


_SENSOR_MM = 36.0
"""Width of Blender's sensor, which gives the focal length of a K in millimetres."""


def _focus(params: Node, scene: Scene, focal_widths: float, ours: str) -> dict[str, Any]:
    """A round aperture. focal_widths: the focal length in widths of the sensor."""
    section = params.child("depthOfField")
    for key in ("blades", "rotationDeg", "ratio"):
        section.ignore(key, "not applied: the aperture is a disc")
    distance, stop = section.number("distance", 10.0), section.number("fStop", 2.8)
    for key, value in (("distance", distance), ("fStop", stop)):
        if not value > 0.0:
            section.fail(key, f"must be positive, not {value:g}")
    aperture_mm = focal_widths * _SENSOR_MM / stop
    section.comes(f"{ours}.lens")
    section.comes(f"{ours}.lens.focus_distance_m", "distance")
    section.comes(f"{ours}.lens.aperture_mm", "fStop")
    text = f"an aperture of {aperture_mm:.3g} mm, before a sensor {_SENSOR_MM:g} mm wide"
    section.notes.warn(section.where("fStop"), text)
    return {"focus_distance_m": scene.metres_per_unit * distance, "aperture_mm": aperture_mm}


def _sensor(entry: Node, scene: Scene, taken: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    entry.choice("type", ("SensorCameraRGBD",))
    params = entry.child("sensorParams")
    name = clean_name(params.text("outputBaseName", "sensor"), taken)
    ours = f"sensors.{name}"
    found = _optics(params, ours)
    found["transformation"] = _transformation(params, scene)
    found["trigger_interval"] = params.whole("triggerInterval", 1, smallest=1)
    params.comes(f"{ours}.transformation", "transformation")
    params.comes(f"{ours}.trigger_interval", "triggerInterval")
    _passes(params, scene)
    if params.has("depthOfField"):
        found["lens"] = _focus(params, scene, found["K"][0] / found["width"], ours)
    return name, found


def read(section: Node, scene: Scene) -> None:
    """Our `camera` is the base with the optics of the first sensor; `sensors` is used only if
    needed.

    A single sensor at the base that is always triggered is the camera itself."""
    general = section.child("GENERAL")
    sensors: dict[str, Any] = {}
    for entry in section.children("SENSORS"):
        name, found = _sensor(entry, scene, sensors)
        sensors[name] = found
    if not sensors:
        section.fail("SENSORS", "needs a sensor at least")
    name, first = next(iter(sensors.items()))
    plain = first["transformation"] == _IDENTITY and first["trigger_interval"] == 1
    alone = plain and len(sensors) == 1
    keys = ("width", "height", "K", *(("lens",) if alone and "lens" in first else ()))
    ours = {f"sensors.{name}.{key}": f"camera.{key}" for key in keys}
    for path, source in list(scene.notes.origins.items()):
        for own, base in ours.items():
            if path == own or path.startswith(f"{own}."):
                scene.notes.origins[base + path.removeprefix(own)] = source
    optics = {key: first[key] for key in keys}
    scene.tree["camera"] = {**optics, "trajectory": movement.read(general, scene)}
    if not alone:
        scene.tree["sensors"] = sensors
