"""Sunlight at a place over time: eclipses by bodies, and the distance from the Sun."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.config.errors import nearest
from perilune.config.motion import sections
from perilune.config.orbit import Drawn
from perilune.orbits import radii_m, sun_position_m
from perilune.orbits.solar_system import AU_M

if TYPE_CHECKING:
    from perilune.simulation import Simulation

F64 = NDArray[np.float64]

CAMERA = "camera"
"""Name of the camera that takes the frame, unless an entry has this name."""


@dataclass(frozen=True)
class LightCurve:
    """Sunlight at an object or the camera in n frames."""

    name: str
    """Name of the body or spacecraft, or `camera`."""
    frames: NDArray[np.int64]
    """(n,) frame indices."""
    t_s: F64
    """(n,) seconds after the epoch."""
    fraction: F64
    """(n, 3): fraction of the Sun's light that bodies let through, 0 to 1, by colour band. Bands
    differ only in penumbrae, because the disc is redder at its edge."""
    irradiance_w_m2: F64
    """(n, 3): irradiance on a surface that faces the Sun, by colour band."""
    bodies: tuple[str, ...]
    """Names of the bodies that may eclipse the Sun."""
    hides: NDArray[np.bool_]
    """(n, bodies): whether a body covers part of the disc, even if behind another body."""


@dataclass(frozen=True)
class _Places:
    """Positions in some frames; root frame, m."""

    points: F64
    sun: F64
    poses: F64
    radii: F64


def light_curve(
    sim: Simulation,
    name: str,
    frames: Iterable[int],
    limb_darkening: bool = True,
    at: float = 0.5,
    nodes: int = 16,
) -> LightCurve:
    """Sunlight at the centre of a body or spacecraft, or at the camera, frame by frame.

    name: an entry of the configuration, or `camera`. A body does not shade itself, and spacecraft
    (meshes) shade nothing here. limb_darkening: false assumes a uniform disc. at: instant as a
    fraction of the exposure, 0 at the opening of the shutter, 1 at its closing. nodes: number of
    quadrature nodes, 1 to 64 (benchmarks/eclipse.py). With 16 the error is below 1e-12, except 1e-8
    for bodies that nearly touch a darkened limb from inside. Positions are geometric, as everywhere
    in Perilune; bodies are ellipsoids without an atmosphere; the union of all bodies before the
    disc is exact. Raises ValueError for an unknown name, for `at` or `nodes` out of range, and for
    a position inside the Sun."""
    indices = np.array([operator.index(index) for index in frames], dtype=np.int64)
    config = sim.config
    known = list(sections(config))
    if name not in known and name != CAMERA:
        raise ValueError(f"no body or spacecraft '{name}'{nearest(name, [*known, CAMERA])}")
    bodies = tuple(body for body in config.bodies if body != name)
    if not 0.0 <= at <= 1.0:
        raise ValueError(f"at is {at:g}, but must be from 0 to 1")
    wavelengths = np.array(config.sun.wavelengths_um) if limb_darkening else np.zeros(3)
    t_s = np.empty(len(indices))
    fraction = np.empty((len(indices), len(wavelengths)))
    hides = np.empty((len(indices), len(bodies)), dtype=np.bool_)
    irradiance = np.empty_like(fraction)
    for rows in _runs(sim, indices):
        places = _places(sim, name, bodies, indices[rows].tolist(), at, t_s[rows])
        sun = sim.config_at(int(indices[rows.start]))[0].sun
        fraction[rows], hides[rows] = _core.sunlight(
            places.points, places.sun, sun.radius_km * 1e3, places.poses, places.radii,
            wavelengths, nodes,
        )  # fmt: skip
        square = np.sum((places.sun - places.points) ** 2, axis=1)
        irradiance[rows] = fraction[rows] * (sun.irradiance_w_m2 * AU_M**2 / square)[:, None]
    return LightCurve(name, indices, t_s, fraction, irradiance, bodies, hides)


def _runs(sim: Simulation, indices: NDArray[np.int64]) -> list[slice]:
    """Runs of frames that share a configuration and its orbits."""
    entries = sections(sim.config).values()
    by_scene = sim.has_orbit_hooks or any(isinstance(entry.orbit, Drawn) for _, entry in entries)
    drawn = bool(sim.document.drivers)
    key = [i if drawn else sim.timeline.at(i).scene if by_scene else 0 for i in indices.tolist()]
    starts = [row for row in range(len(key)) if row == 0 or key[row] != key[row - 1]]
    return [slice(a, b) for a, b in zip(starts, [*starts[1:], len(key)], strict=False)]


def _places(
    sim: Simulation, name: str, bodies: Sequence[str], run: list[int], at: float, t_s: F64
) -> _Places:
    """Positions in the frames of a run; writes their times into t_s."""
    system = sim.system(run[0])
    config, epoch = system.setting.config, system.setting.epoch
    cameras = config.cameras
    for row, index in enumerate(run):
        moment = sim.timeline.at(index)
        exposure_s = cameras[moment.sensor].exposure_time_s
        t_s[row] = config.time.step_s * moment.step + at * exposure_s
    states = system.states(t_s)
    if name in states.poses:
        points = states.poses[name][:, :3]
    else:
        ends = np.array([sim.camera_poses(index)[:, :3] for index in run])
        points = ends[:, 0] + at * (ends[:, 1] - ends[:, 0])
    sun = np.array([sun_position_m(config, epoch, t) for t in t_s.tolist()])
    poses = [states.poses[body] for body in bodies]
    return _Places(
        points=np.ascontiguousarray(points),
        sun=sun,
        poses=np.stack(poses, axis=1) if poses else np.empty((len(run), 0, 7)),
        radii=np.array([radii_m(config.bodies[body]) for body in bodies]).reshape(-1, 3),
    )
