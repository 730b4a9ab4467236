"""Ground tracks: the points of a body below a spacecraft, over its colour map."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.show.plots import tracks
from perilune.show.plots.figures import PALETTE, color_map, new_figure
from perilune.world import World

if TYPE_CHECKING:
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]
_STEP_DEG = 1.0
_MOST_POINTS = 20_000


def plot_ground_track(
    sim: Simulation,
    frames: Iterable[int],
    body: str | None = None,
    names: Iterable[str] | None = None,
    figure: Any = None,
    place: Any = 111,
    title: str | None = None,
) -> Any:
    """East longitude and latitude below spacecraft, in the latitude of the body's maps: the point
    below along the surface normal (`latitudes: geodetic`), or on the line to the body's centre.

    frames: indices, each with a marker. Frames on one orbit are connected by the track between
    them, computed over time; frames with different orbits (drivers, new scenes) are not. body:
    default: the central body of the first spacecraft. names: spacecraft (default: all in orbit
    about the body). figure, place: as in plot_orbits. Returns the Figure."""
    worlds = [sim.world(index) for index in frames]
    if not worlds:
        raise ValueError("frames: at least one frame")
    ground = body if body is not None else _ground(sim)
    if ground not in sim.config.bodies:
        raise ValueError(f"body: no body '{ground}'; there are {', '.join(sim.config.bodies)}")
    if names is None:
        names = [n for n in sim.config.spacecraft if _is_under(sim, n, ground)]
    target = figure if figure is not None else new_figure(9.0, 5.0)
    axes = target.add_subplot(place)
    image = color_map(sim, ground)
    if image is not None:
        axes.imshow(image, extent=(-180, 180, -90, 90), aspect="equal", alpha=0.75)
    for number, name in enumerate(names):
        _add_track(axes, worlds, name, ground, PALETTE[number % len(PALETTE)])
    axes.set(xlim=(-180, 180), ylim=(-90, 90), aspect="equal")
    axes.set(xticks=range(-180, 181, 60), yticks=range(-90, 91, 30))
    axes.set_xlabel(f"east longitude on {ground} (deg)")
    axes.set_ylabel("latitude (deg)")
    axes.grid(alpha=0.3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=8, loc="lower left")
    axes.set_title(title if title is not None else f"Ground track on {ground}", fontsize=10)
    return target


def _ground(sim: Simulation) -> str:
    for name in sim.config.spacecraft:
        at: str | None = tracks.parent(sim.config, name)
        while at is not None and at not in sim.config.bodies:
            at = tracks.parent(sim.config, at)
        if at is not None:
            return at
    return sim.config.root


def _is_under(sim: Simulation, name: str, ground: str) -> bool:
    at = tracks.parent(sim.config, name)
    while at is not None and at != ground:
        at = tracks.parent(sim.config, at)
    return at == ground


def sub_point_deg(world: World, name: str, body: str, t_s: float) -> tuple[float, float]:
    """East longitude in [-180, 180] and latitude of the point of a body below a spacecraft, in the
    latitude of the body's maps."""
    poses = world.system.states(np.array([t_s])).poses
    from_center = poses[name][0, :3] - poses[body][0, :3]
    x, y, z = rotations.rotate_back(poses[body][0, 3:], from_center).tolist()
    lat = math.atan2(z, math.hypot(x, y))
    if world.config.bodies[body].is_geodetic:
        lat = _geodetic_rad(math.hypot(x, y), z, world.body_radii_m[body])
    return math.degrees(math.atan2(y, x)), math.degrees(lat)


def _geodetic_rad(rho: float, z: float, radii_m: F64) -> float:
    """Latitude of a spheroid's normal that passes through a point at distance rho from the axis and
    height z.

    Iterates the point on the spheroid with this normal, from Bowring's first guess along the
    point's own direction. A few steps reach full precision outside the body."""
    equator, pole = math.sqrt(float(radii_m[0] * radii_m[1])), float(radii_m[2])
    e2 = 1.0 - (pole / equator) ** 2
    lat = math.atan2(z, rho * (1.0 - e2))
    for _ in range(20):
        across = equator / math.sqrt(1.0 - e2 * math.sin(lat) ** 2)
        lat = math.atan2(z + e2 * across * math.sin(lat), rho)
    return lat


def wrapped(lon_deg: F64, lat_deg: F64) -> list[F64]:
    """A track cut at the date line: pieces (n, 2) that reach the map's edges.

    Steps of more than half a turn are taken in the other, shorter direction."""
    pieces: list[F64] = []
    piece = [(float(lon_deg[0]), float(lat_deg[0]))]
    for lon, lat in zip(lon_deg[1:].tolist(), lat_deg[1:].tolist(), strict=True):
        before_lon, before_lat = piece[-1]
        if abs(lon - before_lon) > 180.0:
            side = math.copysign(180.0, before_lon)
            ahead = lon + 2.0 * side  # unrolled beyond the edge that is left
            share = (side - before_lon) / (ahead - before_lon) if ahead != before_lon else 0.5
            middle = before_lat + share * (lat - before_lat)
            piece.append((side, middle))
            pieces.append(np.array(piece))
            piece = [(-side, middle)]
        piece.append((lon, lat))
    pieces.append(np.array(piece))
    return pieces


def _between(run: list[World], name: str, body: str) -> F64:
    """(n, 2) longitude and latitude between the frames of one orbit, computed over time."""
    points = [sub_point_deg(run[0], name, body, run[0].t_s)]
    for before, after in itertools.pairwise(run):
        span = after.t_s - before.t_s
        rate = _rate_deg_s(before, name, body)
        count = min(max(1, math.ceil(abs(span) * rate / _STEP_DEG)), _MOST_POINTS)
        for k in range(1, count + 1):
            points.append(sub_point_deg(before, name, body, before.t_s + span * k / count))
    return np.array(points)


def _rate_deg_s(world: World, name: str, body: str) -> float:
    """Angular speed of the ground point on the sphere of directions."""
    step = 1.0
    first = sub_point_deg(world, name, body, world.t_s)
    second = sub_point_deg(world, name, body, world.t_s + step)
    mean = math.radians(0.5 * (first[1] + second[1]))
    turn = math.remainder(second[0] - first[0], 360.0) * math.cos(mean)
    return math.hypot(turn, second[1] - first[1]) / step


def _add_track(axes: Any, worlds: list[World], name: str, body: str, color: str) -> None:
    for run in tracks.rows(worlds, name):
        if len(run) > 1:
            track = _between(run, name, body)
            for piece in wrapped(track[:, 0], track[:, 1]):
                axes.plot(piece[:, 0], piece[:, 1], color=color, linewidth=1.3)
    marks = np.array([sub_point_deg(world, name, body, world.t_s) for world in worlds])
    axes.plot(marks[:, 0], marks[:, 1], "o", color=color, markersize=3.5, label=name)
