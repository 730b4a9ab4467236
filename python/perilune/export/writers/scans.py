"""What datasets hold of measurements beside pictures: render.scans as tables of a frame."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from numpy.lib.recfunctions import repack_fields
from numpy.typing import NDArray

from perilune.config.errors import ConfigError
from perilune.config.schema import Config
from perilune.frame.scans import POINT_CHANNELS, points_of
from perilune.sample import Sample
from perilune.simulation import Simulation

Array = NDArray[Any]

POINTS, LIDAR, FLIGHT, EVENTS = "points", "lidar", "time_of_flight", "events"
_OF_LIDAR = f"{LIDAR}_"
_DOCS = {
    POINTS: "surface points that the pixels show, a row each, as Simulation.points gives them",
    LIDAR: "returns of a LiDAR, as Simulation.lidar gives them",
    FLIGHT: "pixels of the time-of-flight camera, as Simulation.time_of_flight gives them; nan "
    "where there is none",
    EVENTS: "events until the next frame, as Simulation.events gives them",
}


def is_scan(name: str) -> bool:
    """Whether a channel of a dataset is one of these tables."""
    return name in (POINTS, FLIGHT, EVENTS) or name.startswith(_OF_LIDAR)


def is_cloud(name: str) -> bool:
    """Whether it is a cloud of points."""
    return name == POINTS or name.startswith(_OF_LIDAR)


def scan_doc(name: str) -> str:
    """What a table is."""
    return _DOCS[LIDAR if name.startswith(_OF_LIDAR) else name]


def scan_names(config: Config, source: str) -> list[str]:
    """Names of the tables that render.scans asks for: one for each LiDAR.

    ConfigError for a sensor that the configuration does not have."""
    names: list[str] = []
    for name in dict.fromkeys(config.render.scans):
        missing = {
            LIDAR: not config.lidars,
            FLIGHT: config.time_of_flight is None,
            EVENTS: config.events is None,
        }
        if missing.get(name):
            section = "lidars" if name == LIDAR else name
            raise ConfigError(f"{source}:\n  render.scans: '{name}' needs the section {section}")
        names += [f"{_OF_LIDAR}{own}" for own in config.lidars] if name == LIDAR else [name]
    return names


def channels_of_scan(sim: Simulation, name: str) -> tuple[str, ...]:
    """Channels that a frame must hold for a table."""
    if name != POINTS:
        return ()
    return (*POINT_CHANNELS, *(("rgb",) if "rgb" in sim.config.render.channels else ()))


def scans(
    sim: Simulation, sample: Sample, names: Iterable[str], threads: int | None = None
) -> dict[str, Array]:
    """Tables of a frame by name, without gaps between fields; other names are passed over."""
    index, found = sample.meta["index"], {}
    for name in names:
        if name == POINTS:
            levels = len(sim.config.labels.levels)
            own = {key: sample[key] for key in channels_of_scan(sim, name)}
            found[name] = points_of(own, sample.camera, levels, sample.meta.get("rows", ()))
        elif name == FLIGHT:
            found[name] = sim.time_of_flight(index, threads=threads)
        elif name == EVENTS:
            found[name] = sim.events(index, threads=threads)
        elif name.startswith(_OF_LIDAR):
            found[name] = sim.lidar(index, name.removeprefix(_OF_LIDAR), threads=threads)
    return {name: repack_fields(table) for name, table in found.items()}
