"""LiDARs against closed forms, an independent ray caster and the statistics of their noise."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from tests.hard.glb import cube, write_glb
from tests.python.optics_scenes import FORWARD, RIGHT, STANDS_M, at, ball, opened, tree
from tests.python.ray_caster import corners_of
from tests.python.test_shutter import sliding, spinning

import perilune
from perilune import _core
from perilune.base import rotations
from perilune.config import ConfigError

FLASH = {"kind": "flash", "columns": 33, "rows": 25, "width_deg": 20.0, "height_deg": 15.0}
SLOW = {"kind": "raster", "columns": 60, "rows": 40, "width_deg": 28.0, "height_deg": 28.0,
        "rate_hz": 2400.0}  # fmt: skip
PATTERNS = [
    FLASH,
    {"kind": "spinning", "elevations_deg": [-8.0, 0.0, 8.0], "steps": 720, "rate_hz": 7200.0},
    {"kind": "raster", "columns": 50, "rows": 20, "width_deg": 30.0, "height_deg": 20.0},
    {"kind": "lissajous", "pulses": 2000, "height_deg": 8.0},
    {"kind": "rosette", "pulses": 2000},
]


def scanner(scene, root, pattern=FLASH, trajectory=None, **keys):
    """The simulation of a scene with one LiDAR."""
    scene["lidars"] = {"top": {"pattern": pattern, **keys}}
    return opened(scene, root, **({} if trajectory is None else {"trajectory": trajectory}))


def boxed(path: Path, half: float, side=(0.0, 0.0, 0.0), **keys):
    """A cube ten metres before the camera; its material's keys."""
    points, faces = cube(half)
    write_glb(path, points + np.float32(side), faces)
    if keys:
        data = path.read_bytes()
        length = int.from_bytes(data[12:16], "little")
        document = json.loads(data[20 : 20 + length])
        document["materials"][0] |= keys
        extra = keys.get("extensions", {})
        document |= {"extensionsUsed": list(extra)} if extra else {}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        rest = data[20 + length :]
        head = (
            b"glTF" + (2).to_bytes(4, "little") + (20 + len(text) + len(rest)).to_bytes(4, "little")
        )
        path.write_bytes(head + len(text).to_bytes(4, "little") + b"JSON" + text + rest)
    return {
        "model": str(path),
        "metres_per_unit": 1.0,
        "orbit": {"around": "anchor", "position_km": at(10.0)},
        "attitude": {"rotation_deg": [0.0, 0.0, 0.0]},
    }


@pytest.mark.parametrize("depth_m", [50.0, 1e9])
@pytest.mark.parametrize("pattern", PATTERNS, ids=lambda p: p["kind"])
def test_ranges_to_a_ball_are_exact(repo_dir, pattern, depth_m):
    """Every beam that meets the ball has its distance in closed form, and no other has a return."""
    radius = 0.1 * depth_m
    sim = scanner(tree(ball=ball(at(depth_m), radius, albedo=0.5)), repo_dir, pattern)
    found = sim.lidar(0)
    rays = _core.source_rays(source_of(sim))[:, 0]
    b = rays[:, 5] * depth_m
    inside = radius**2 - (depth_m**2 - b**2)
    meets = (inside > 0.0) & (b > 0.0)
    sure = np.abs(inside) > 1e-9 * radius**2
    assert 20 < meets.sum() < len(rays)
    hit = np.isin(np.arange(len(rays)), found["beam"])
    np.testing.assert_array_equal(hit[sure], meets[sure])
    expected = b[found["beam"]] - np.sqrt(np.maximum(inside[found["beam"]], 0.0))
    np.testing.assert_allclose(found["range_m"], expected, rtol=1e-9)
    np.testing.assert_array_equal(found["range_m"], found["true_range_m"])
    np.testing.assert_array_equal(found["time_s"], rays[found["beam"], 6])


def source_of(sim):
    from perilune.frame import scans

    return scans.source_of(next(iter(sim.config.lidars.values())))


def nearest_triangle(origins, directions, corners):
    """(n,) distances to triangles (n, t, 3, 3) by Cramer's rule in double; inf for none. And how
    near the ray passes to an edge, as a weight."""
    a, e1, e2 = (
        corners[:, :, 0],
        corners[:, :, 1] - corners[:, :, 0],
        corners[:, :, 2] - corners[:, :, 0],
    )
    d, o = directions[:, None], origins[:, None]
    p = np.cross(d, e2)
    det = (e1 * p).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = o - a
        u = (s * p).sum(-1) / det
        q = np.cross(s, e1)
        v = (d * q).sum(-1) / det
        t = (e2 * q).sum(-1) / det
    in_it = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return np.where(in_it, t, np.inf).min(axis=1)


def at_the_times(sim, name, times):
    """Triangles (n, t, 3, 3) of a spacecraft in the root frame, and its poses (n, 7)."""
    row = sim.models[name]
    corners = corners_of(row.model, row.metres_per_unit, row.offset)
    poses = sim.system(0).states(times).poses[name]
    return np.stack([p[:3] + corners @ rotations.to_matrix(p[3:]).T for p in poses]), poses


def test_ranges_are_exact_while_all_moves(repo_dir):
    """The satellite turns by 90 degrees during a scan of a second and the sensor moves 0.6 m: every
    range is that of the triangles where they are at the time of the beam, to 1e-6, and no beam
    misses what is there, with a single instant too."""
    scene = spinning(90.0)
    del scene["bodies"]["far"]
    sim = scanner(scene, repo_dir, SLOW, sliding(0.6), instants=1)
    rays = _core.source_rays(source_of(sim))[:, 0]
    found = sim.lidar(0)
    found = found[found["instance"] == sim.taxonomy.instances["sat"]]
    assert len(found) > 150
    ranges = np.full(len(rays), np.inf)
    ranges[found["beam"]] = found["range_m"]
    some = np.unique(np.r_[found["beam"][::12], np.arange(0, len(rays), 100)])
    times = rays[some, 6]
    origins = np.array([STANDS_M, 0, 0]) + 0.6 * times[:, None] * RIGHT
    directions = rays[some, 3:6] @ rotations.to_matrix(FORWARD).T
    expected = nearest_triangle(origins, directions, at_the_times(sim, "sat", times)[0])
    assert 15 < np.isfinite(expected).sum() < len(some) - 10
    np.testing.assert_allclose(ranges[some], expected, rtol=1e-9)
    at_beam = {beam: k for k, beam in enumerate(found["beam"])}
    hits = np.array([at_beam[b] for b in some if b in at_beam])
    np.testing.assert_allclose(found["origin_m"][hits], origins[np.isfinite(expected)], atol=1e-9)
    more = scanner(scene, repo_dir, SLOW, sliding(0.6), instants=5).lidar(0)
    more = more[more["instance"] == sim.taxonomy.instances["sat"]]
    np.testing.assert_array_equal(more["beam"], found["beam"])
    np.testing.assert_allclose(more["range_m"], found["range_m"], rtol=1e-9)


def test_compensated_points_are_on_the_model(repo_dir):
    """In the satellite's axes at the time of each beam the points are on its surface, and those
    that are not compensated are not."""
    scene = spinning(90.0)
    sim = scanner(scene, repo_dir, SLOW, sliding(0.6))
    found = sim.lidar(0)
    found = found[found["instance"] == sim.taxonomy.instances["sat"]][::25]
    placed, poses = at_the_times(sim, "sat", found["time_s"])

    def height(points):
        """Least height over a triangle whose interior is below the point."""
        outward = np.cross(placed[:, :, 1] - placed[:, :, 0], placed[:, :, 2] - placed[:, :, 0])
        square = np.maximum((outward**2).sum(-1), 1e-30)
        rest = points[:, None, None] - placed
        weights = np.cross(rest[:, :, [1, 2, 0]], rest[:, :, [2, 0, 1]])
        inside = ((weights * outward[:, :, None]).sum(-1) / square[..., None] > -1e-3).all(-1)
        off = np.abs((rest[:, :, 0] * outward).sum(-1)) / np.sqrt(square)
        return np.where(inside, off, np.inf).min(axis=1)

    assert height(found["position_m"]).max() < 1e-6
    own = [rotations.rotate(rotations.conjugate(poses[0, 3:]), point - poses[0, :3])
           for point in found["position_m"]]  # fmt: skip
    drift = np.array([p[:3] + rotations.rotate(p[3:], x) for x, p in zip(own, poses, strict=True)])
    assert np.linalg.norm(drift - found["position_m"], axis=1).max() > 0.1
    assert np.median(height(drift)) > 1e-3


def test_threads_and_orders_change_nothing(repo_dir):
    scene = spinning(90.0)
    keys = {"range_noise_m": 0.01, "dropout": 0.1, "sub_rays": 5, "divergence_deg": 0.5}
    sim = scanner(scene, repo_dir, SLOW, sliding(0.6), **keys)
    later = sim.lidar(3, threads=1).tobytes()
    first = sim.lidar(0, threads=1)
    assert first.tobytes() == sim.lidar(0, threads=3).tobytes()
    assert later == sim.lidar(3, threads=2).tobytes()
    other = sim.with_overrides(seed=1).lidar(0)
    assert (other["true_range_m"][:50] == first["true_range_m"][:50]).any()
    assert first.tobytes() != other.tobytes()


def test_range_noise_has_its_distribution(repo_dir):
    """A Kolmogorov-Smirnov test with a false-alarm rate of 1e-4, for both noises together, and the
    rate of lost returns within four standard deviations."""
    pattern = FLASH | {"columns": 100, "rows": 80, "width_deg": 5.0, "height_deg": 5.0}
    keys = {"range_noise_m": 0.02, "shot_noise_m": 0.001, "dropout": 0.25, "intensity_noise": 0.1}
    scene = tree(wall=ball(at(40.0), 10.0, albedo=0.8))
    sim = scanner(scene, repo_dir, pattern, reference_range_m=1.0, **keys)
    found = sim.lidar(0)
    clean = scanner(scene, repo_dir, pattern).lidar(0)
    assert len(clean) == 8000
    assert abs(len(found) - 6000) < 4 * np.sqrt(8000 * 0.25 * 0.75)
    exact = clean[found["beam"]]
    np.testing.assert_array_equal(found["true_range_m"], exact["range_m"])
    sigma = np.hypot(0.02, 0.001 / np.sqrt(exact["intensity"].astype(float)))
    off = (found["range_m"] - found["true_range_m"]) / sigma
    assert stats.kstest(off, "norm").pvalue > 1e-4
    gain = (found["intensity"] / exact["intensity"] - 1.0) / 0.1
    assert stats.kstest(gain, "norm").pvalue > 1e-4
    assert abs(np.corrcoef(off, gain)[0, 1]) < 4 / np.sqrt(len(off))
    assert abs(np.corrcoef(off[1:], off[:-1])[0, 1]) < 4 / np.sqrt(len(off))


def test_intensity_is_that_of_the_reflectance(repo_dir):
    """A Lambert ball: albedo times the cosine, over the square of the range; and Hapke's model at
    zero phase, which is brighter by its opposition surge."""
    scene = tree(ball=ball(at(20.0), 5.0, albedo=0.6))
    found = scanner(scene, repo_dir, reference_range_m=10.0).lidar(0)
    cosine = np.cos(found["incidence_rad"].astype(float))
    np.testing.assert_allclose(found["reflectance"], 0.6 * cosine, rtol=1e-5, atol=1e-6)
    ratio = found["intensity"] / found["reflectance"]
    np.testing.assert_allclose(ratio, (10.0 / found["range_m"]) ** 2, rtol=1e-5)
    # the incidence of a beam on a ball
    sine = np.linalg.norm(np.cross(found["direction"], [15.0 + 5.0, 0.0, 0.0]), axis=1) / 5.0
    np.testing.assert_allclose(np.sin(found["incidence_rad"]), sine, atol=1e-5)

    def hapke(surge):
        photometry = {
            "b": 0.2,
            "c": 0.3,
            "b_s0": surge,
            "h_s": 0.05,
            "roughness_deg": 0.0,
        }
        body = ball(at(20.0), 5.0, albedo=0.3, reflectance="hapke", photometry=photometry)
        return scanner(tree(ball=body), repo_dir).lidar(0)["reflectance"]

    with_surge, without = hapke(1.0), hapke(0.0)
    assert with_surge.max() > 1.3 * without.max()


def test_beams_at_an_edge_have_several_returns(repo_dir, tmp_path):
    """A wide beam half on a cube, half on what is behind: two returns, whose powers are the parts
    of the disc; those nearer than the resolution are one at their mean."""
    scene = tree(far=ball(at(60.0), 20.0, albedo=0.5))
    scene["spacecraft"]["box"] = boxed(tmp_path / "box.glb", 1.0)
    # through the edge of the cube's front at 9 m, which spans 1 m to the right
    edge = np.degrees(np.arctan2(1.0, 9.0))
    pattern = {"kind": "spinning", "elevations_deg": [0.0], "steps": 1, "from_deg": edge,
               "to_deg": edge + 1, "rate_hz": 1.0}  # fmt: skip
    keys = {"divergence_deg": 0.4, "sub_rays": 256}
    found = scanner(scene, repo_dir, pattern, **keys).lidar(0)
    assert list(found["return_number"]) == [1, 2]
    assert list(found["return_count"]) == [2, 2]
    sim = scanner(scene, repo_dir, pattern, **keys)
    names = {number: name for name, number in sim.taxonomy.instances.items()}
    assert [names[i] for i in found["instance"]] == ["box", "far"]
    box = scanner(scene, repo_dir, pattern, **keys, returns="first").lidar(0)
    assert box["range_m"] == found["range_m"][0]
    last = scanner(scene, repo_dir, pattern, **keys, returns="last").lidar(0)
    assert last["range_m"] == found["range_m"][1]
    strongest = scanner(scene, repo_dir, pattern, **keys, returns="strongest").lidar(0)
    assert strongest["intensity"] == found["intensity"].max()
    merged = scanner(scene, repo_dir, pattern, **keys, range_resolution_m=100.0).lidar(0)
    weight = found["intensity"].astype(float)
    mean = (weight * found["range_m"]).sum() / weight.sum()
    assert len(merged) == 1
    assert merged["range_m"][0] == pytest.approx(mean, rel=1e-6)
    assert merged["intensity"][0] == pytest.approx(weight.sum(), rel=1e-6)


def test_a_clear_wall_gives_two_returns_and_a_mirror_a_ghost(repo_dir, tmp_path):
    """Through a cube of glass the ball behind is seen, at its own range. In a mirror that faces the
    beam at 45 degrees a ball beside it is seen at the length of the way."""
    glass = {
        "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.02},
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.9}},
    }
    scene = tree(far=ball(at(60.0), 20.0, albedo=0.5))
    scene["spacecraft"]["box"] = boxed(tmp_path / "glass.glb", 1.0, **glass)
    one = {"kind": "flash", "columns": 1, "rows": 1}
    found = scanner(scene, repo_dir, one).lidar(0)
    through = found[found["path"] == 1]
    assert through["range_m"][-1] == pytest.approx(40.0, rel=1e-6)
    assert (found["path"][-1] & 1) == 1

    mirror = {"pbrMetallicRoughness": {"metallicFactor": 1.0, "roughnessFactor": 0.0,
                                       "baseColorFactor": [0.8, 0.8, 0.8, 1.0]}}  # fmt: skip
    scene = tree(beside=ball(at(10.0, 30.0), 5.0, albedo=0.5))
    craft = boxed(tmp_path / "mirror.glb", 1.0, **mirror)
    craft["attitude"] = {"rotation_deg": [0.0, 0.0, 45.0]}
    scene["spacecraft"]["box"] = craft
    narrow = {"kind": "flash", "columns": 2, "rows": 1, "width_deg": 4.0, "height_deg": 4.0}
    ghosts = scanner(scene, repo_dir, narrow).lidar(0)
    ghosts = ghosts[ghosts["path"] == 2]
    # Of the two beams, one is mirrored to the ball on the right, the other away from it.
    assert len(ghosts) == 1
    direct = scanner(tree(beside=ball(at(10.0, 30.0), 5.0, albedo=0.5)), repo_dir, narrow)
    assert ghosts["instance"] == direct.taxonomy.instances["beside"]
    assert 30.0 < ghosts["range_m"][0] < 45.0


def test_limits_and_ambiguity(repo_dir):
    scene = tree(ball=ball(at(100.0), 20.0, albedo=0.5))
    whole = scanner(scene, repo_dir).lidar(0)
    cut = scanner(scene, repo_dir, range_m=[82.0, 85.0]).lidar(0)
    keeps = (whole["range_m"] >= 82.0) & (whole["range_m"] <= 85.0)
    assert 0 < keeps.sum() < len(whole)
    np.testing.assert_array_equal(cut["beam"], whole["beam"][keeps])
    folded = scanner(scene, repo_dir, unambiguous_range_m=30.0).lidar(0)
    np.testing.assert_allclose(folded["range_m"], whole["range_m"] % 30.0, rtol=1e-12)
    np.testing.assert_array_equal(folded["true_range_m"], whole["range_m"])
    weak = float(np.median(whole["intensity"]))
    bright = scanner(scene, repo_dir, min_intensity=weak).lidar(0)
    np.testing.assert_array_equal(bright["beam"], whole["beam"][whole["intensity"] >= weak])


def test_an_empty_scene_has_no_returns(repo_dir):
    scene = tree()
    found = scanner(scene, repo_dir).lidar(0)
    assert len(found) == 0
    assert found.dtype["semantic"].shape == (len(perilune.open(scene).config.labels.levels),)


def test_a_beam_that_starts_inside_a_hull_meets_it_from_within(repo_dir, tmp_path):
    scene = tree()
    scene["spacecraft"]["box"] = boxed(tmp_path / "box.glb", 30.0)
    found = scanner(scene, repo_dir, {"kind": "flash", "columns": 1, "rows": 1}).lidar(0)
    assert found["range_m"][0] == pytest.approx(40.0, rel=1e-9)


def test_a_grazing_beam_is_finite(repo_dir):
    """Beams at and beside the limb of a ball: a range and an intensity, or none."""
    limb = np.degrees(np.arcsin(5.0 / 20.0))
    steps = 2001
    pattern = {"kind": "spinning", "elevations_deg": [0.0], "steps": steps, "rate_hz": 1e9,
               "from_deg": limb - 1e-6, "to_deg": limb + 1e-6}  # fmt: skip
    scene = tree(ball=ball(at(20.0), 5.0, albedo=0.5))
    found = scanner(scene, repo_dir, pattern).lidar(0)
    assert 0.3 * steps < len(found) < 0.6 * steps
    for name in ("range_m", "intensity", "reflectance", "incidence_rad"):
        assert np.isfinite(found[name]).all()
    assert (found["incidence_rad"] <= np.pi / 2 + 1e-6).all()


def test_the_mounting_places_and_turns_the_sensor(repo_dir):
    scene = tree(ball=ball(at(20.0), 5.0, albedo=0.5))
    one = {"kind": "flash", "columns": 1, "rows": 1}
    sim = scanner(scene, repo_dir, one, transformation={"position_m": [1.0, 2.0, 3.0]})
    found = sim.lidar(0)
    assert found["range_m"][0] == pytest.approx(17.0 - np.sqrt(25.0 - 5.0), rel=1e-12)
    turned = scanner(scene, repo_dir, one, transformation={"rotation_deg": [0.0, 90.0, 0.0]})
    assert len(turned.lidar(0)) == 0


def test_rays_of_pixels_have_the_labels_of_pixels(repo_dir):
    """The same bits as the picture's channels, with a mesh, a body and nothing behind them."""
    sim = opened(spinning(0.0), repo_dir)
    names = ["depth", "range", "normal", "geometric_normal", "position", "object_coords",
             "semantic", "part", "instance", "incidence", "emission", "phase"]  # fmt: skip
    sample = sim.frame(0, names)
    request, handles = sim.request(0), sim._mine()
    out = {name: np.empty_like(sample[name]).reshape(1, -1, *sample[name].shape[2:])
           for name in names}  # fmt: skip
    source = {"kind": "pixels", "sub_rays": 1, "divergence_rad": 0.0, "aperture_m": 0.0}
    found = handles.renderer.trace(request, source, out, threads=2)
    for name in names:
        assert out[name].tobytes() == sample[name].tobytes(), name
    seen = np.nan_to_num(found["range_m"]).astype(np.float32)
    np.testing.assert_allclose(seen, sample["range"].ravel(), rtol=1e-6)
    assert len(np.unique(sample["instance"])) == 3


def test_rays_of_ones_own(repo_dir):
    scene = tree(ball=ball(at(20.0), 5.0, albedo=0.5))
    sim = opened(scene, repo_dir)
    rays = [[0, 0, 0, 0, 0, 2], [1, 0, 0, 0, 0, 1], [0, 0, 0, 0, -1, 0]]
    found = sim.trace(0, rays, ["instance", "depth"], reflectance=True)
    np.testing.assert_allclose(found["range_m"], [15.0, 20 - np.sqrt(24.0), np.nan], rtol=1e-12)
    assert found["instance"].tolist() == [sim.taxonomy.instances["ball"]] * 2 + [0]
    np.testing.assert_allclose(found["reflectance"][0], 0.5, rtol=1e-6)
    np.testing.assert_allclose(found["surface_normal"][0], [-1, 0, 0], atol=1e-6)
    for wrong in ([[0, 0, 0]], [[0, 0, 0, 0, 0, 0]], [[0, 0, 0, 0, 0, np.nan]]):
        with pytest.raises(ValueError, match="rays"):
            sim.trace(0, wrong)
    with pytest.raises(ValueError, match="depth"):
        sim.trace(0, rays, ["depht"])
    for name in ("rgb", "coverage", "cloud_opacity", "slope_baseline"):
        with pytest.raises(ValueError, match="only channels that a single ray fills"):
            sim.trace(0, rays, [name])


def test_beams_are_timed(repo_dir):
    """Beside raw Embree: all rays of all beams."""
    scene = tree(ball=ball(at(20.0), 5.0, albedo=0.5))
    sim = scanner(scene, repo_dir, sub_rays=3, divergence_deg=0.1)
    rays, ours_s, raw_s = sim.measure_scan(0, 1)
    assert rays == 33 * 25 * 3
    assert min(ours_s, raw_s) > 0.0


def test_points_are_those_of_the_pixels(repo_dir):
    sim = opened(spinning(0.0), repo_dir)
    sample = sim.frame(0, ["depth", "position", "rgb", "instance"])
    found = sim.points(0, colour=True)
    assert len(found) == (sample["depth"] > 0).sum()
    at_pixel = found["v"], found["u"]
    np.testing.assert_array_equal(found["position_m"], sample["position"][at_pixel])
    np.testing.assert_array_equal(found["rgb"], sample["rgb"][at_pixel])
    np.testing.assert_allclose(found["camera_m"][:, 2], sample["depth"][at_pixel], rtol=1e-6)
    pixels = sample.camera.project(found["position_m"])
    np.testing.assert_allclose(pixels, np.stack([found["u"], found["v"]], axis=1), atol=1e-6)
    toward = sample.camera.position_m - found["position_m"]
    assert ((toward * found["normal"]).sum(axis=1) > 0).all()


CHANGES = {
    "transformation": {"position_m": [1.0, 0.0, 0.0]},
    "divergence_deg": 2.0,
    "sub_rays": 7,
    "band": "blue",
    "returns": "last",
    "max_returns": 1,
    "range_resolution_m": 1000.0,
    "range_m": [0.0, 30.0],
    "unambiguous_range_m": 7.0,
    "reference_range_m": 2.0,
    "min_intensity": 0.01,
    "dropout": 0.5,
    "range_noise_m": 0.1,
    "shot_noise_m": 0.1,
    "intensity_noise": 0.1,
    "aperture_m": 0.5,
    "pattern": FLASH | {"columns": 7},
}


@pytest.mark.parametrize("key", CHANGES)
def test_every_key_changes_the_scan(repo_dir, key):
    scene = tree(
        near=ball(at(9.0), 1.0, albedo=[0.5, 0.4, 0.3]), far=ball(at(60.0), 20.0, albedo=0.5)
    )
    base = {"divergence_deg": 1.0, "sub_rays": 4}
    before = scanner(scene, repo_dir, **base).lidar(0)
    keys = {"pattern": FLASH, **base, key: CHANGES[key]}
    after = scanner(scene, repo_dir, **keys).lidar(0)
    assert before.tobytes() != after.tobytes()


def test_mistakes_are_named(repo_dir):
    scene = tree()
    with pytest.raises(ValueError, match=r"lidars.*empty"):
        opened(scene, repo_dir).lidar(0)
    with pytest.raises(ValueError, match=r"named 'tpo'.*'top'"):
        scanner(scene, repo_dir).lidar(0, "tpo")
    for keys, match in (
        ({"range_m": [5.0, 2.0]}, "lidars.top.range_m"),
        ({"sub_rays": 4}, "lidars.top.sub_rays"),
        ({"dropout": 1.5}, "lidars.top.dropout"),
        ({"pattern": {"kind": "flahs"}}, "lidars.top.pattern"),
    ):
        with pytest.raises(ConfigError, match=match):
            scanner(scene, repo_dir, **keys)
