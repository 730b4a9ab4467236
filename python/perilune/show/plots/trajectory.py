"""Plot of the camera's path relative to its target, with the frusta of the frames."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.show.plots.figures import PALETTE, color_map, new_figure
from perilune.show.plots.scene3d import Scene3D
from perilune.world import World

if TYPE_CHECKING:
    from perilune._core import FrameRequest
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]
_MOST_TRIANGLES = 4000
_FRUSTUM = 0.16
"""Length of a frustum, relative to the largest distance of a camera."""
_ARROW = 0.45
"""Length of an arrow, relative to the same."""


def plot_trajectory(
    sim: Simulation,
    frames: Iterable[int],
    target: str | None = None,
    axes: Literal["icrf", "target"] = "icrf",
    path: bool = True,
    every: int = 1,
    legend: bool = True,
    elevation_deg: float = 25.0,
    azimuth_deg: float = -60.0,
    figure: Any = None,
    place: Any = 111,
    title: str | None = None,
) -> Any:
    """Camera positions relative to the target's centre, each with its frustum, from dark to bright.

    frames: indices. target: a spacecraft or body (default: the trajectory's). axes: `icrf`, or
    those of the `target`, in which it is at rest. path: whether to connect positions in the order
    of the frames. every: interval between frames with a frustum. Arrows point to the Sun and to the
    target's central body in the first frame. figure, place: as in plot_orbits. Returns the
    Figure."""
    indices = list(frames)
    if not indices:
        raise ValueError("frames: at least one frame")
    worlds = [sim.world(index) for index in indices]
    requests = [sim.request(index) for index in indices]
    name = target if target is not None else _target(sim)
    if name not in worlds[0].poses:
        raise ValueError(f"target: no body or spacecraft '{name}'")
    figure = figure if figure is not None else new_figure(7.0, 6.5)
    scene = Scene3D(figure, place, elevation_deg, azimuth_deg)
    cameras = [
        _relative(world, request["camera_pose"][0], name, axes)
        for world, request in zip(worlds, requests, strict=True)
    ]
    places = np.array([place for place, _ in cameras])
    reach = float(np.linalg.norm(places, axis=1).max())
    if path and len(places) > 1:
        scene.add_line(places, color="0.35", linewidth=1.0, label="camera")
    for number, ((where, turn), request) in enumerate(zip(cameras, requests, strict=True)):
        if number % every:
            continue
        shade = _shade(number, len(worlds))
        for line in _frustum(where, turn, request, _FRUSTUM * reach):
            scene.add_line(line, color=shade, linewidth=0.9)
        scene.add_point(where, color=shade, marker="o", markersize=2.5, linestyle="")
    _add_target(scene, sim, worlds[0], name, axes)
    _add_arrows(scene, worlds[0], name, axes, _ARROW * reach)
    shown_axes = "ICRF axes" if axes == "icrf" else f"axes of {name}"
    heading = title if title is not None else f"Camera relative to {name}, {shown_axes}"
    scene.draw(heading, legend)
    return figure


def _target(sim: Simulation) -> str:
    name = getattr(sim.config.camera.trajectory, "target", None)
    if name is not None:
        return str(name)
    return next(iter(sim.config.spacecraft), sim.config.root)


def _axes(world: World, name: str, axes: str) -> F64:
    """From root axes to those of the plot, (3, 3)."""
    if axes == "icrf":
        return np.eye(3)
    return rotations.to_matrix(world.poses[name][0, 3:]).T


def _relative(world: World, pose: F64, name: str, axes: str) -> tuple[F64, F64]:
    """Position and axes of a camera (columns right, down, forward) at shutter opening."""
    turn = _axes(world, name, axes)
    where = turn @ (pose[:3] - world.position_m(name))
    return where, turn @ rotations.to_matrix(pose[3:])


def _frustum(where: F64, turn: F64, request: FrameRequest, length: float) -> list[F64]:
    """Edges of the image at the distance `length`, and the four lines to it from the camera."""
    right, bottom = request["width"] - 0.5, request["height"] - 0.5
    corners = np.array([[-0.5, -0.5, 1], [right, -0.5, 1], [right, bottom, 1], [-0.5, bottom, 1]])
    rays = corners @ np.linalg.inv(request["K"]).T
    edge = where + length * rays @ turn.T
    return [np.vstack([edge, edge[:1]]), *(np.stack([where, corner]) for corner in edge)]


def _shade(number: int, count: int) -> tuple[float, float, float, float]:
    from matplotlib import colormaps

    share = number / (count - 1) if count > 1 else 0.5
    red, green, blue, alpha = colormaps["viridis"](0.05 + 0.85 * share)
    return float(red), float(green), float(blue), float(alpha)


def _add_target(scene: Scene3D, sim: Simulation, world: World, name: str, axes: str) -> None:
    turn = _axes(world, name, axes) @ rotations.to_matrix(world.poses[name][0, 3:])
    if name in world.body_radii_m:
        q = rotations.from_matrix(turn)
        to_sun = _axes(world, name, axes) @ (world.sun_position_m - world.position_m(name))
        to_sun /= np.linalg.norm(to_sun)
        scene.add_ball(np.zeros(3), world.body_radii_m[name], q, color_map(sim, name), to_sun)
        return
    entry = sim.models[name]
    mesh = entry.model.mesh()
    triangles = mesh["positions"].astype(np.float64)[mesh["indices"]]
    sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    # A plot of some hundred points wants the large faces; bolts would be dust.
    largest = np.argsort(-np.linalg.norm(sides, axis=1), kind="stable")[:_MOST_TRIANGLES]
    places = entry.metres_per_unit * (triangles[largest] - entry.offset) @ turn.T
    scene.add_mesh(places, mesh["triangle_color"][largest] / 255.0)
    scene.add_point(np.zeros(3), color="black", marker="+", markersize=5, linestyle="", label=name)


def _add_arrows(scene: Scene3D, world: World, name: str, axes: str, length: float) -> None:
    """Arrows to the Sun and to the target's central body."""
    entry = world.config.spacecraft.get(name) or world.config.bodies[name]
    around = entry.orbit.around if entry.orbit is not None else None
    goals = [("to the Sun", world.sun_position_m, PALETTE[2])]
    if around is not None:
        goals.append((f"to {around}", world.position_m(around), PALETTE[5]))
    for label, place, color in goals:
        direction = _axes(world, name, axes) @ (place - world.position_m(name))
        tip = length * direction / np.linalg.norm(direction)
        scene.add_line(np.stack([np.zeros(3), tip]), color=color, linewidth=1.6, label=label)
        scene.add_point(tip, color=color, marker="D", markersize=3, linestyle="")
