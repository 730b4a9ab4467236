"""Plot of orbits: bodies as ellipsoids, one revolution of every orbit, positions in frames."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from perilune.show.plots import tracks
from perilune.show.plots.figures import PALETTE, color_map, new_figure
from perilune.show.plots.scene3d import Scene3D
from perilune.world import World

if TYPE_CHECKING:
    from perilune.simulation import Simulation


def plot_orbits(
    sim: Simulation,
    frames: Iterable[int] = (0,),
    around: str | None = None,
    names: Iterable[str] | None = None,
    track: Literal["orbit", "frames"] = "orbit",
    elevation_deg: float = 25.0,
    azimuth_deg: float = -60.0,
    legend: bool = True,
    figure: Any = None,
    place: Any = 111,
    title: str | None = None,
) -> Any:
    """Orbits in three dimensions about one body, ICRF axes, with the same scale on all axes.

    frames: indices; every object is marked at its position in each. around: the body in the middle
    (default: the outermost central body). names: bodies and spacecraft to show (default: all that
    orbit it, directly or not). track: `orbit`, a whole revolution of each orbit in the frames,
    about the position of its central body in the last frame with this orbit; `frames`, a line from
    frame to frame. elevation, azimuth: the view. figure, place: draw into a part of an existing
    figure, as for Figure.add_subplot. Returns the Figure."""
    worlds = [sim.world(index) for index in frames]
    if not worlds:
        raise ValueError("frames: at least one frame")
    center = around if around is not None else _center(sim)
    if center not in sim.config.bodies and center not in sim.config.spacecraft:
        raise ValueError(f"around: no body or spacecraft '{center}'")
    shown = list(names) if names is not None else _below(sim, center)
    target = figure if figure is not None else new_figure(7.0, 6.5)
    scene = Scene3D(target, place, elevation_deg, azimuth_deg)
    last = worlds[-1]
    for name in [center, *shown]:
        if name in sim.config.bodies:
            _add_body(scene, sim, last, name, center)
    for number, name in enumerate(shown):
        # Several orbits of a single entity are told apart by colours of their own.
        colors = PALETTE if len(shown) == 1 else (PALETTE[number % len(PALETTE)],)
        _add_track(scene, worlds, name, center, track, colors)
    scene.draw(title if title is not None else f"Orbits about {center}, ICRF axes", legend)
    return target


def _center(sim: Simulation) -> str:
    """The outermost central body of the first spacecraft; the root without any."""
    for name in (*sim.config.spacecraft, *sim.config.bodies):
        at = name
        while (up := tracks.parent(sim.config, at)) is not None:
            at = up
        if at != name:
            return at
    return sim.config.root


def _below(sim: Simulation, center: str) -> list[str]:
    """All objects that orbit `center`, directly or not."""
    found = []
    for name in (*sim.config.bodies, *sim.config.spacecraft):
        at = tracks.parent(sim.config, name)
        while at is not None and at != center:
            at = tracks.parent(sim.config, at)
        if at == center:
            found.append(name)
    return found


def _add_body(scene: Scene3D, sim: Simulation, world: World, name: str, center: str) -> None:
    pose = world.poses[name][0]
    to_sun = world.sun_position_m - pose[:3]
    scene.add_ball(
        pose[:3] - world.position_m(center),
        world.body_radii_m[name],
        pose[3:],
        color_map(sim, name),
        to_sun / np.linalg.norm(to_sun),
    )


def _add_track(
    scene: Scene3D,
    worlds: list[World],
    name: str,
    center: str,
    track: str,
    colors: Sequence[str],
) -> None:
    middle = {id(world): world.position_m(center) for world in worlds}
    label = name
    for number, run in enumerate(tracks.rows(worlds, name)):
        color, last = colors[number % len(colors)], run[-1]
        up = tracks.parent(last.config, name)
        if track == "frames" or up is None:
            points = np.array([world.position_m(name) - middle[id(world)] for world in run])
        else:
            offset = last.position_m(up) - middle[id(last)]
            points = tracks.revolution_m(last, name, up) + offset
        if len(points) > 1:
            scene.add_line(points, label=label, color=color, linewidth=1.2)
            label = "_"
        for world in run:
            point = world.position_m(name) - middle[id(world)]
            style = {"color": color, "marker": "o", "markersize": 3.5, "linestyle": ""}
            scene.add_point(point, label=label, **style)
            label = "_"
