"""Worlds of the small scene with a trajectory, and what its cameras see; for tests of poses."""

from __future__ import annotations

import numpy as np

from perilune import document as cfg, world
from perilune.base import rotations
from perilune.camera import trajectories
from perilune.orbits import solar_system

RADIUS_M = 4.0
"""Bounding sphere that is taken for every spacecraft."""
PLACE_M = 3e-9
"""Rounding of positions at 7e6 m, a few of 9e-10."""


def worlds(scene, trajectory, frames, **overrides):
    """The worlds of some frames of the small scene with a trajectory."""
    scene["camera"]["trajectory"] = trajectory
    document = cfg.load(scene, overrides)
    epoch = solar_system.date_from_utc(document.config.time.utc_fields())
    radii = dict.fromkeys(document.config.spacecraft, RADIUS_M)
    return [world.build(document.at(i)[0], {}, i, epoch, radii) for i in frames]


def offsets(places, target="sat", when=0):
    """Camera places from the target, root axes."""
    poses = [trajectories.camera_poses(w)[when] for w in places]
    return np.array([p[:3] - w.poses[target][when, :3] for p, w in zip(poses, places, strict=True)])


def columns(pose):
    """The camera's axes right, down, forward in the root frame."""
    return rotations.to_matrix(pose[3:])


def orbit_axes(place, when=0):
    """Outward, forward, normal of the satellite's orbit around the Earth at the origin."""
    r, v = place.poses["sat"][when, :3], place.velocities_m_s["sat"][when]
    h = np.cross(r, v)
    h /= np.linalg.norm(h)
    r = r / np.linalg.norm(r)
    return np.column_stack([r, np.cross(h, r), h])


def close(a, b, tolerance=PLACE_M):
    return np.abs(np.asarray(a) - b).max() <= tolerance
