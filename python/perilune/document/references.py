"""Checks names from the core's tables: bodies, reflectances, effects."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from perilune import _core, materials
from perilune.bodies import photometry
from perilune.camera import bands, filters, imaging
from perilune.config.errors import ConfigError, named, nearest
from perilune.config.schema import Config
from perilune.drivers import Found

OBJECTS = "objects"
"""Name that requests a sample's object labels, along with pixel channels."""
MASKS = "masks"
"""Name that requests the full silhouettes, one image per spacecraft."""
KEYPOINTS = "keypoints"
"""Name that requests a sample's table of keypoints."""
HIERARCHY = "hierarchy"
"""Name that requests a sample's table of spacecraft, their nodes and parts."""
TABLES = (KEYPOINTS, HIERARCHY)
"""Names of tables of a sample."""
SENSOR_PICTURES = ("raw", "sensor_rgb")
OF_SENSOR = (*SENSOR_PICTURES, "glare")
"""Channels that only cameras with a section `sensor` have."""
OF_ONE_PLANE = ("sensor_rgb", "glare")
"""Those among them that sensors of planes do not have."""
TO_NEXT = ("flow", "flow_occlusion", "scene_flow")
TO_PREVIOUS = ("flow_backward", "flow_occlusion_backward")
OF_MOTION = (*TO_NEXT, *TO_PREVIOUS)
"""Channels that lead to other frames of a scene."""


def channel_names() -> list[str]:
    """All names allowed in `channels`."""
    return [*(channel["name"] for channel in _core.CHANNELS), OBJECTS, MASKS, *TABLES]


def has_keypoints(config: Config) -> bool:
    """Whether a spacecraft has keypoints, or a body landmarks."""
    crafts = (craft.keypoints for craft in config.spacecraft.values())
    return any(spec.points or spec.file or spec.nodes for spec in crafts) or any(
        body.landmarks for body in config.bodies.values()
    )


def pixel_channels(config: Config) -> list[str]:
    """The pixel channels that all cameras of a configuration have."""
    names = [channel["name"] for channel in _core.CHANNELS]
    if config.time.frames_per_scene == 1:
        names = [name for name in names if name not in OF_MOTION]
    if any(camera.sensor is None for camera in config.cameras.values()):
        names = [name for name in names if name not in OF_SENSOR]
    if any(bands.has_planes(camera) for camera in config.cameras.values()):
        names = [name for name in names if name not in OF_ONE_PLANE]
    return names


def check_channels(channels: Iterable[str], config: Config, where: str) -> None:
    """ConfigError for a channel that does not exist, or that a camera does not have."""
    known = channel_names()
    for name in channels:
        if name not in known:
            raise ConfigError(f"{where}: no channel '{name}'{nearest(name, known)}")
        if name == KEYPOINTS and not has_keypoints(config):
            told = "spacecraft.NAME.keypoints or bodies.NAME.landmarks"
            raise ConfigError(f"{where}: '{name}': there are none; {told} would say which")
        if name == "crater_id" and config.labels.craters is None:
            raise ConfigError(f"{where}: '{name}': labels.craters is null")
        for camera_name, camera in config.cameras.items():
            key = "camera" if camera_name is None else f"sensors.{camera_name}"
            if name in OF_SENSOR and camera.sensor is None:
                raise ConfigError(f"{where}: '{name}' needs the section {key}.sensor")
            if name in OF_ONE_PLANE and bands.has_planes(camera):
                raise ConfigError(f"{where}: '{name}': none where {key}.sensor.mosaic is planes")


def check_references(
    config: Config,
    source: str,
    drivers: Sequence[Found] = (),
    origins: Mapping[str, str] | None = None,
    checked: Config | None = None,
) -> None:
    """ConfigError that names the key, the nearest name and all allowed ones.

    drivers: all drivers of the configuration. origins: key path -> key path in another file that it
    comes from. checked: the same configuration with other values of drivers, already checked."""

    def known(path: str, name: str | None, allowed: list[str]) -> None:
        if name is not None and name not in allowed:
            raise ConfigError(f"{source}:\n  {path}: no '{name}'{nearest(name, allowed)}")

    bodies = [name for name in _core.BODIES if name != "sun"]
    reflectances = [row["name"] for row in _core.REFLECTANCES]
    effects = [row["name"] for row in _core.EFFECTS]
    for name, body in config.bodies.items():
        known(f"bodies.{name}.kind", body.kind, [*bodies, "ellipsoid"])
        known(f"bodies.{name}.ephemeris", body.ephemeris, bodies)
        known(f"bodies.{name}.reflectance", body.reflectance, reflectances)
    for name, craft in config.spacecraft.items():
        others = ["sun", *config.bodies, *(other for other in config.spacecraft if other != name)]
        for i, joint in enumerate(craft.articulation):
            known(f"spacecraft.{name}.articulation[{i}].towards", joint.towards, others)
    for table in (photometry, bands, filters, imaging):
        for key, complaint in table.check(config):
            raise ConfigError(f"{source}:\n  {key}: {complaint}")
    for problem in materials.check(config, drivers, checked):
        raise ConfigError(f"{source}:\n  {named(problem, origins or {})}")
    for key, names in (("on", config.render.force_on), ("off", config.render.force_off)):
        for name in names:
            known(f"render.force_{key}", name, effects)
    check_channels(config.render.channels, config, f"{source}:\n  render.channels")
