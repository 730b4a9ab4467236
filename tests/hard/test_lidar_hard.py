"""Hard beams of a LiDAR beside exact answers: they graze, start inside, meet mirrors."""

from __future__ import annotations

import numpy as np
import pytest
from tests.python.optics_scenes import FORWARD, STANDS_M, at, ball, tree
from tests.python.test_lidar import boxed, scanner, source_of

from perilune import _core
from perilune.base import rotations

ONE = {"kind": "flash", "columns": 1, "rows": 1}
MIRROR = {"pbrMetallicRoughness": {"metallicFactor": 1.0, "roughnessFactor": 0.0,
                                   "baseColorFactor": [0.8, 0.8, 0.8, 1.0]}}  # fmt: skip

LEAST_COSINE = 1e-3
"""Of incidence, as normals are bent towards the viewer (csrc/render/vertex.c)."""


def beams_of(sim):
    """Origins and directions of all beams in the root frame."""
    rays = _core.source_rays(source_of(sim))[:, 0]
    return np.broadcast_to([STANDS_M, 0.0, 0.0], (len(rays), 3)), (
        rays[:, 3:6] @ rotations.to_matrix(FORWARD).T
    )


def walls(origins, directions, pose, half):
    """Distances to where rays enter and leave a cube, and the normal where they enter."""
    axes = rotations.to_matrix(pose[3:])
    o, d = (origins - pose[:3]) @ axes, directions @ axes
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = np.sort([(-half - o) / d, (half - o) / d], axis=0)
    entry, leave = low.max(axis=1), high.min(axis=1)
    side = low.argmax(axis=1)
    normal = -np.sign(np.take_along_axis(d, side[:, None], 1)) * axes.T[side]
    missed = (entry > leave) | (leave < 0.0)
    return np.where(missed, np.inf, entry), np.where(missed, np.inf, leave), normal


def to_ball(origins, directions, center, radius):
    """Distance to a ball from outside."""
    to = center - origins
    b = (to * directions).sum(axis=1)
    root = radius**2 - ((to - b[:, None] * directions) ** 2).sum(axis=1)
    with np.errstate(invalid="ignore"):
        return np.where((root > 0.0) & (b > 0.0), b - np.sqrt(root), np.inf)


def pose_of(sim, name):
    return sim.system(0).states(np.zeros(1)).poses[name][0]


def ranges_of(found, count):
    """By beam; inf for none."""
    out = np.full(count, np.inf)
    out[found["beam"]] = found["true_range_m"]
    return out


@pytest.mark.parametrize("exponent", [1, 3, 4, 5])
def test_beams_that_graze_a_face(repo_dir, tmp_path, exponent):
    """Over a block 20 m long, the sensor 10 cm above its middle and less: beams meet it at down to
    10^-6 rad. The cosine of incidence is that of the angle, or the least that is told."""
    scene = tree()
    craft = boxed(tmp_path / "box.glb", 10.0)
    height = 10.0**-exponent
    craft["orbit"]["position_km"] = at(0.0, 0.0, 10.0 + height)
    scene["spacecraft"]["box"] = craft
    far, near = np.degrees(np.arctan2(height, [9.9, 1.0]))
    elevations = [*np.linspace(-near, -far, 101), 0.0, far]
    pattern = {"kind": "spinning", "elevations_deg": elevations, "steps": 1, "rate_hz": 1.0,
               "from_deg": 20.0, "to_deg": 21.0}  # fmt: skip
    sim = scanner(scene, repo_dir, pattern)
    found = sim.lidar(0)
    origins, directions = beams_of(sim)
    expected, _, _ = walls(origins, directions, pose_of(sim, "box"), 10.0)
    assert np.isfinite(expected).sum() == 101
    assert found["beam"].tolist() == list(range(101))
    # rounding of places 15 m away, over the height
    np.testing.assert_allclose(found["range_m"], expected[:101], rtol=3e-15 / height + 1e-14)
    sine = np.maximum(-directions[:101, 2], LEAST_COSINE)
    np.testing.assert_allclose(np.cos(found["incidence_rad"].astype(float)), sine, atol=2e-7)


def test_beams_beside_a_limb(repo_dir):
    """From 1e-9 rad inside the limb of a ball to as much outside of it: the root of a difference
    that vanishes."""
    limb = np.arcsin(5.0 / 20.0)
    off = np.r_[-np.logspace(-2, -9, 30), np.logspace(-9, -2, 30)]
    pattern = {"kind": "spinning", "elevations_deg": np.degrees(limb + off).tolist(), "steps": 1,
               "rate_hz": 1.0, "from_deg": 0.0, "to_deg": 1.0}  # fmt: skip
    sim = scanner(tree(ball=ball(at(20.0), 5.0, albedo=0.5)), repo_dir, pattern)
    found = sim.lidar(0)
    angle = limb + off[:30]
    # r^2 - d^2 sin^2 as a product, which loses nothing
    root = 20.0 * np.sqrt(np.sin(-off[:30]) * np.sin(limb + angle))
    assert found["beam"].tolist() == list(range(30))
    np.testing.assert_allclose(found["range_m"], 20.0 * np.cos(angle) - root, rtol=1e-7)
    np.testing.assert_allclose(
        found["range_m"][:15], (20.0 * np.cos(angle) - root)[:15], rtol=1e-10
    )


def test_beams_that_start_inside_a_turned_hull(repo_dir, tmp_path):
    """In all directions, at the walls' distances from within, off its centre."""
    scene = tree()
    craft = boxed(tmp_path / "box.glb", 8.0)
    craft["orbit"]["position_km"] = at(3.0, -2.0, 1.0)
    craft["attitude"] = {"rotation_deg": [20.0, 30.0, 40.0]}
    scene["spacecraft"]["box"] = craft
    pattern = {"kind": "spinning", "elevations_deg": np.linspace(-89, 89, 22).tolist(),
               "steps": 40, "rate_hz": 1e9}  # fmt: skip
    sim = scanner(scene, repo_dir, pattern)
    found = sim.lidar(0)
    origins, directions = beams_of(sim)
    entry, leave, _ = walls(origins, directions, pose_of(sim, "box"), 8.0)
    assert (entry < 0.0).all()
    np.testing.assert_array_equal(found["beam"], np.arange(len(directions)))
    np.testing.assert_allclose(found["range_m"], leave, rtol=1e-6)
    assert (found["incidence_rad"] < np.pi / 2).all()


def test_a_sensor_inside_a_body_is_told(repo_dir):
    """Of a mounting too: its centre, its name and how deep."""
    scene = tree(ball=ball(at(20.0), 5.0, albedo=0.5))
    sim = scanner(scene, repo_dir, ONE, transformation={"position_m": [0.0, 0.0, 17.0]})
    with pytest.raises(ValueError, match="ball"):
        sim.lidar(0)


def reflected(directions, normal):
    return directions - 2.0 * (directions * normal).sum(axis=1, keepdims=True) * normal


@pytest.mark.parametrize("mirrors", [1, 2])
def test_ranges_by_mirrors_are_those_of_the_folded_way(repo_dir, tmp_path, mirrors):
    """One mirror, and a periscope of two: a ball is at the length of the way, in the direction of
    the beam."""
    scene = tree(ball=ball(at(60.0 if mirrors == 2 else 10.0, 30.0), 4.0, albedo=0.5))
    place = [at(10.0), at(10.0, 30.0)]
    for k in range(mirrors):
        craft = boxed(tmp_path / f"{k}.glb", 3.0, **MIRROR)
        craft["orbit"]["position_km"] = place[k]
        craft["attitude"] = {"rotation_deg": [0.0, 0.0, 45.0]}
        scene["spacecraft"][f"mirror_{k}"] = craft
    pattern = {"kind": "flash", "columns": 25, "rows": 15, "width_deg": 24.0, "height_deg": 15.0}
    sim = scanner(scene, repo_dir, pattern)
    found = sim.lidar(0)
    origins, directions = beams_of(sim)
    start, length = origins.copy(), np.zeros(len(origins))
    place, way = start, directions
    alive = np.ones(len(origins), dtype=bool)
    poses = [pose_of(sim, f"mirror_{k}") for k in range(mirrors)]
    for k in range(mirrors):
        met = [walls(place, way, pose, 3.0) for pose in poses]
        nearest = np.argmin([np.where(m[0] > 1e-9, m[0], np.inf) for m in met], axis=0)
        t, normal = met[k][0], met[k][2]
        alive &= (nearest == k) & np.isfinite(t) & (t > 1e-9)
        t = np.where(alive, t, 0.0)
        place, way, length = place + t[:, None] * way, reflected(way, normal), length + t
    center = 1e3 * np.array(scene["bodies"]["ball"]["orbit"]["position_km"])
    last = to_ball(place, way, center, 4.0)
    expected = np.where(alive & np.isfinite(last), length + last, np.inf)
    assert np.isfinite(expected).sum() > 5
    ghosts = found[(found["path"] == 2) & (found["instance"] == sim.taxonomy.instances["ball"])]
    by_beam = ranges_of(ghosts, len(origins))
    beams = np.flatnonzero(np.isfinite(expected))
    np.testing.assert_allclose(by_beam[beams], expected[beams], rtol=1e-6)
    folded = origins[ghosts["beam"]] + directions[ghosts["beam"]] * ghosts["range_m"][:, None]
    np.testing.assert_allclose(ghosts["position_m"], folded, atol=1e-6)


def test_a_beam_between_two_mirrors_ends(repo_dir, tmp_path):
    """Face to face: nothing is there but mirrors, however often the beam comes back."""
    scene = tree()
    for k, depth_m in enumerate((10.0, -10.0)):
        craft = boxed(tmp_path / f"{k}.glb", 3.0, **MIRROR)
        craft["orbit"]["position_km"] = at(depth_m)
        scene["spacecraft"][f"mirror_{k}"] = craft
    found = scanner(scene, repo_dir, ONE).lidar(0)
    names = ("range_m", "intensity", "reflectance")
    assert all(np.isfinite(found[name]).all() for name in names)
    assert 0 < len(found) <= 8
