"""Values that a simulation reads once, from the ideal configuration; no driver may change them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from perilune.config.body import Body
from perilune.config.camera import Camera
from perilune.config.schema import Config
from perilune.config.spacecraft import Spacecraft


def _orbit(entity: Body | Spacecraft) -> tuple[str, str] | None:
    """Keys of an orbit that decide the order of placement and what is drawn once a scene."""
    return None if entity.orbit is None else (entity.orbit.kind, entity.orbit.around)


def _of_body(body: Body) -> dict[str, Any]:
    return {
        "kind": body.kind,
        "class": body.class_,
        "classes": body.classes,
        "areas": body.areas,
        "annotate": body.annotate,
        "obj_id": body.obj_id,
        "map_center_lon_deg": body.map_center_lon_deg,
        "orbit.kind": _orbit(body),
    }


def _of_craft(craft: Spacecraft) -> dict[str, Any]:
    joints = [
        (row.node, row.kind, row.axis, row.axes, row.pivot_m, row.towards, row.normal)
        for row in craft.articulation
    ]
    play = craft.animation
    return {
        "model": craft.model,
        "metres_per_unit": craft.stretch,
        "crease_angle_deg": craft.crease_angle_deg,
        "faces": craft.faces,
        "centre": craft.centre,
        "obj_id": craft.obj_id,
        "class": craft.class_,
        "classes": craft.classes,
        "parts": craft.parts,
        "part_classes": craft.part_classes,
        "articulation": joints,
        "animation": None if play is None else (play.name, play.index),
        "symmetries": craft.symmetries,
        "orbit.kind": _orbit(craft),
    }


def _of_camera(camera: Camera) -> dict[str, Any]:
    return {"width": camera.width, "height": camera.height}


def fixed(config: Config) -> Mapping[str, Any]:
    """Key path -> value of everything that is fixed when the scene is built."""
    rows: dict[str, Any] = {
        "version": config.version,
        "name": config.name,
        "description": config.description,
        "seed": config.seed,
        "time.epoch": config.time.epoch,
        "time.frames_per_scene": config.time.frames_per_scene,
        "root": config.root,
        "bodies": list(config.bodies),
        "spacecraft": list(config.spacecraft),
        "volumes": list(config.volumes),
        "sensors": [(name, row.trigger_interval) for name, row in config.sensors.items()],
        "render.channels": config.render.channels,
        "render.amodal": config.render.amodal,
        "labels": config.labels,
        "drivers": config.drivers,
    }
    for name, body in config.bodies.items():
        rows |= {f"bodies.{name}.{key}": value for key, value in _of_body(body).items()}
    for name, craft in config.spacecraft.items():
        rows |= {f"spacecraft.{name}.{key}": value for key, value in _of_craft(craft).items()}
    for camera_name, camera in config.cameras.items():
        at = "camera" if camera_name is None else f"sensors.{camera_name}"
        rows |= {f"{at}.{key}": value for key, value in _of_camera(camera).items()}
    return rows
