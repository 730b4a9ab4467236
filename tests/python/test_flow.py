"""Channels of motion beside OpenCV's projection of the same points in the other frame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray
from tests.python.optics_scenes import FORWARD, RIGHT, STANDS_M, at, ball, opened, tree
from tests.python.test_terrain_frames import LAT_DEG, LON_DEG, moon

import perilune
from perilune.base import rotations
from perilune.config.errors import ConfigWarning
from perilune.frame import shutter

CONFIGS = Path(__file__).resolve().parents[2] / "configs"
F64 = NDArray[np.float64]
LABELS = ["flow", "flow_backward", "flow_occlusion", "flow_occlusion_backward", "scene_flow"]
GEOMETRY = ["object_coords", "instance", "part", "depth", "position"]
NEAR_PX = 1e-3
SMALL: dict[str, Any] = {"camera.width": 96, "camera.height": 64, "camera.fov_deg": 75.0}
BROWN = {"model": "brown_conrady", "k1": -0.21, "k2": 0.06, "p1": 2e-3, "p2": -1e-3, "k3": 0.01}
FISHEYE = {"model": "fisheye", "k1": -0.03, "k2": 0.004}


def opencv(points: F64, camera: perilune.camera.label.CameraLabel) -> F64:
    """(n, 2) pixels of points in camera axes, by OpenCV; behind a pinhole nan."""
    zero = np.zeros(3)
    if camera.lens is not None and camera.lens[0] == "fisheye":
        rows = points.reshape(-1, 1, 3)
        return cv2.fisheye.projectPoints(rows, zero, zero, camera.K, camera.lens[1])[0][:, 0]
    coefficients = None if camera.lens is None else camera.lens[1]
    pixels = cv2.projectPoints(points.reshape(-1, 1, 3), zero, zero, camera.K, coefficients)[0]
    pixels[points[:, 2] <= 0.0] = np.nan
    return np.asarray(pixels[:, 0])


def rays(camera: perilune.camera.label.CameraLabel) -> F64:
    """(H, W, 3) directions of the pixels' centres in camera axes, by OpenCV."""
    grid = np.stack(np.meshgrid(np.arange(camera.width), np.arange(camera.height)), axis=-1)
    pixels, exact = grid.reshape(-1, 1, 2).astype(np.float64), (3, 200, 1e-13)
    if camera.lens is not None and camera.lens[0] == "fisheye":
        plane = cv2.fisheye.undistortPoints(pixels, camera.K, camera.lens[1], criteria=exact)
    else:
        coefficients = np.zeros(5) if camera.lens is None else camera.lens[1]
        plane = cv2.undistortPoints(pixels, camera.K, coefficients, criteria=exact)
    return np.concatenate([plane, np.ones_like(plane[..., :1])], axis=-1).reshape(
        *grid.shape[:2], 3
    )


def seen_there(sim: perilune.Simulation, here: perilune.Sample, there: perilune.Sample) -> F64:
    """(H, W, 3): what the pixels of a frame see, in camera axes of another: points that move with
    their rigid object, directions where nothing is hit."""
    camera, other = here.camera, there.camera
    out = np.asarray(rays(camera) @ camera.R_w2c @ other.R_w2c.T)
    before, after = (shutter.middle(sim.world(sample.meta["index"])) for sample in (here, there))
    for name, number in sim.taxonomy.instances.items():
        mask = here["instance"] == number
        old, new = before.poses[name][0], after.poses[name][0]
        own = (here["position"][mask] - old[:3]) @ rotations.to_matrix(old[3:])
        root = own @ rotations.to_matrix(new[3:]).T + new[:3]
        out[mask] = root @ other.R_w2c.T + other.t_w2c
    return out


def beyond(found: F64, expected: F64) -> NDArray[np.bool_]:
    return ~(np.abs(found - expected).max(axis=-1) <= NEAR_PX) & ~(
        np.isnan(found).any(axis=-1) & np.isnan(expected).any(axis=-1)
    )


@pytest.fixture(scope="module")
def rendezvous() -> perilune.Simulation:
    return perilune.open(CONFIGS / "rendezvous.yaml", overrides=SMALL)


@pytest.mark.parametrize("lens", [None, BROWN, FISHEYE], ids=["pinhole", "brown", "fisheye"])
def test_flow_is_the_projected_motion(rendezvous: perilune.Simulation, lens: Any) -> None:
    """A station, a chaser's camera that moves and turns, and a planet that turns below it."""
    sim = rendezvous.with_overrides({"camera.lens": lens})
    first = sim.timeline.index_of(40, "left")
    second = sim.timeline.beside(first, 1)
    a, b = (sim.frame(index, [*LABELS, *GEOMETRY]) for index in (first, second))
    grid = np.stack(np.meshgrid(np.arange(96.0), np.arange(64.0)), axis=-1)
    for here, there, channel in ((a, b, "flow"), (b, a, "flow_backward")):
        points = seen_there(sim, here, there)
        expected = opencv(points.reshape(-1, 3), there.camera).reshape(64, 96, 2) - grid
        assert len(np.unique(here["instance"])) >= 3
        assert not beyond(here[channel], expected).any()
        assert np.nanmax(np.abs(expected)) > 1.0
    hit = a["instance"] > 0
    own = a["position"][hit] @ a.camera.R_w2c.T + a.camera.t_w2c
    assert np.abs(a["scene_flow"][hit] - (seen_there(sim, a, b)[hit] - own)).max() < 2e-3
    assert np.isnan(a["scene_flow"][~hit]).all()
    assert np.isfinite(a["flow"][~hit]).all()  # of the sky, by rotation


def around(image: NDArray[Any], flow: F64) -> F64:
    """(9, H, W, ...): the pixels of another frame about where the flow leads, nan out of it."""
    height, width = image.shape[:2]
    y, x = np.mgrid[:height, :width]
    out = np.full((9, *image.shape), np.nan)
    for k in range(9):
        u = np.rint(x + np.nan_to_num(flow[..., 0], nan=1e9)) + k % 3 - 1
        v = np.rint(y + np.nan_to_num(flow[..., 1], nan=1e9)) + k // 3 - 1
        inside = (u >= 0) & (v >= 0) & (u < width) & (v < height)
        out[k][inside] = image[v[inside].astype(int), u[inside].astype(int)]
    return out


def judge_occlusion(
    sim: perilune.Simulation, a: perilune.Sample, b: perilune.Sample, part: float, off: float
) -> None:
    """Points that the next frame is said to see are at their depth there, and what is said to be
    hidden has something nearer. part: of the depth that counts as the same. off: share of pixels
    that may be wrong, beside outlines."""
    depth = seen_there(sim, a, b)[..., 2]
    hit = a["instance"] > 0
    height, width = hit.shape
    there = np.argwhere(np.ones_like(hit)).reshape(height, width, 2)[..., ::-1] + a["flow"]
    inside = ((there > 0.5) & (there < np.array([width, height]) - 1.5)).all(axis=-1)
    outside = ((there < -0.6) | (there > np.array([width, height]) - 0.4)).any(axis=-1)
    assert a["flow_occlusion"][outside].all()
    depths = around(b["depth"].astype(np.float64), a["flow"])
    depths[depths == 0.0] = np.inf
    low, high = depths.min(axis=0), depths.max(axis=0)
    judged = hit & inside
    missed = judged & (a["flow_occlusion"] == 0)
    missed &= (low > depth * (1.0 + part)) | (high < depth * (1.0 - part))
    invented = judged & (a["flow_occlusion"] == 1) & (low > depth * (1.0 + part))
    assert missed.sum() + invented.sum() <= off * judged.sum(), (missed.sum(), invented.sum())


def test_occlusion_of_a_station_before_a_planet(rendezvous: perilune.Simulation) -> None:
    sim = rendezvous.with_overrides({"time.step_s": 60.0})  # so that much is hidden
    first = sim.timeline.index_of(80, "left")
    a, b = (sim.frame(i, [*LABELS, *GEOMETRY])
            for i in (first, sim.timeline.beside(first, 1)))  # fmt: skip
    judge_occlusion(sim, a, b, 1e-2, 1e-2)
    again = sim.frame(first, ["flow_occlusion", "flow"], threads=3)
    assert np.array_equal(again["flow_occlusion"], a["flow_occlusion"])
    assert np.array_equal(again["flow"], a["flow"], equal_nan=True)


def spinner(rate_deg_s: float = 30.0, **camera: Any) -> dict[str, Any]:
    """A satellite that turns before a body."""
    scene = tree((64, 48), 60.0, far=ball(at(30.0, -4.0, 2.0), 6.0, albedo=0.6))
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "anchor", "position_km": at(5.0, 0.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0], "spin_rate_deg_s": rate_deg_s},
    }
    scene["time"] |= {"step_s": 0.2, "frames_per_scene": 5}
    scene["camera"] |= camera
    return scene


def slid(t_s: float) -> F64:
    return np.array([STANDS_M, 0.0, 0.0]) + 0.6 * t_s * RIGHT


def test_what_turns_away_is_hidden(repo_dir: Path) -> None:
    sim = opened(spinner(90.0), repo_dir)
    a, b = (sim.frame(i, [*LABELS, *GEOMETRY]) for i in (1, 2))
    judge_occlusion(sim, a, b, 5e-3, 0.02)
    assert 0.03 < a["flow_occlusion"][a["instance"] == 3].mean() < 0.9
    assert a["flow_occlusion_backward"][a["instance"] == 3].any()


def test_rows_of_a_rolling_shutter(repo_dir: Path) -> None:
    """A point leaves at the time of its row, and is met at the time of the row that sees it."""
    line_s, exposure_s = 0.1 / 48, 0.01
    scene = spinner(60.0, line_time_us=1e6 * line_s, exposure_time_s=exposure_s)

    def moves(world: perilune.world.World) -> F64:
        times = (world.t_s, world.t_s + world.window_s)
        return np.stack([np.concatenate([slid(t_s), FORWARD]) for t_s in times])

    sim = opened(scene, repo_dir, trajectory=moves)
    a = sim.frame(1, [*LABELS, *GEOMETRY])
    assert "rolling_shutter" in [row["name"] for row in a.plan if row["on"]]
    K, axes = a.camera.K, rotations.to_matrix(FORWARD[-4:])
    for y, x in np.argwhere(a["instance"] == 3)[::7]:
        t_s = 0.2 + y * line_s + 0.5 * exposure_s
        old = sim.system(1).states(np.array([t_s])).poses["sat"][0]
        own = rotations.to_matrix(old[3:]).T @ (a["position"][y, x] - old[:3])
        row = 24.0
        for _ in range(50):
            t_s = 0.4 + row * line_s + 0.5 * exposure_s
            new = sim.system(1).states(np.array([t_s])).poses["sat"][0]
            seen = (rotations.to_matrix(new[3:]) @ own + new[:3] - slid(t_s)) @ axes
            pixel = (K @ seen)[:2] / seen[2]
            row = pixel[1]
        assert np.abs(a["flow"][y, x] - (pixel - [x, y])).max() < NEAR_PX
        assert abs(row - y) * line_s > 1e-4 or abs(pixel[0] - x) > 0.5


def test_moving_nodes() -> None:
    """Every part is carried by the nodes above it: the same point of the model at rest."""
    joints = [
        {"node": "array_left", "axis": [0, 1, 0], "rate_deg_s": 0.1},
        {"node": "array_right", "axis": [0, 1, 0], "rate_deg_s": -0.05},
        {"node": "robotic_arm", "axis": [1, 0, 0], "rate_deg_s": 0.2},
    ]
    changes = {"camera.width": 96, "camera.height": 72, "time.step_s": 50.0,
               "time.frames_per_scene": 4, "spacecraft.station.articulation": joints}  # fmt: skip
    sim = perilune.open(CONFIGS / "articulated.yaml", overrides=changes)
    a, b = (sim.frame(i, [*LABELS, *GEOMETRY]) for i in (1, 2))
    parts = [part for part in sim.taxonomy.parts if part.owner == "station"]
    worlds = [shutter.middle(sim.world(i)) for i in (1, 2)]
    old, new = (world.poses["station"][0] for world in worlds)
    turned = 0
    for part, nodes in zip(parts, sim.moving_nodes(["station"]), strict=True):
        mask = a["part"] == part.id
        if not mask.any():
            continue
        own = (a["position"][mask] - old[:3]) @ rotations.to_matrix(old[3:])
        if nodes:
            first, second = (s.meta["articulation"]["station"][nodes[0]]["motion"] for s in (a, b))
            carried = np.asarray(second) @ np.linalg.inv(first)
            turned += int(np.abs(carried - np.eye(4)).max() > 1e-3) * int(mask.sum())
            own = own @ carried[:3, :3].T + carried[:3, 3]
        root = own @ rotations.to_matrix(new[3:]).T + new[:3]
        y, x = np.nonzero(mask)
        expected = opencv(root @ b.camera.R_w2c.T + b.camera.t_w2c, b.camera)
        assert not beyond(a["flow"][mask], expected - np.stack([x, y], axis=-1)).any()
    assert turned > 20


def warped(image: NDArray[Any], flow: F64) -> F64:
    height, width = flow.shape[:2]
    y, x = np.mgrid[:height, :width].astype(np.float32)
    place = [(axis + flow[..., k]).astype(np.float32) for k, axis in enumerate((x, y))]
    return np.asarray(cv2.remap(image.astype(np.float32), *place, cv2.INTER_LINEAR))


def test_the_next_frame_warped_meets_this_one(repo_dir: Path) -> None:
    """A matt world with a map under a still Sun, and a camera that moves."""
    planet = ball(at(3.0), 2.0, albedo=1.0, emission_w_m2_sr=0.0, reflectance="lambert",
                  color_map="assets/maps/earth_like.jpg")  # fmt: skip
    scene = tree((160, 120), 150.0, planet=planet)
    scene["time"]["frames_per_scene"] = 9
    scene["camera"]["exposure"]["white_radiance_w_m2_sr"] = 250.0

    def moves(world: perilune.world.World) -> F64:
        return np.concatenate([slid(0.5 * world.step), FORWARD])

    sim = opened(scene, repo_dir, trajectory=moves)
    a, b = (sim.frame(i, ["rgb", *LABELS]) for i in (0, 1))
    both = (a["flow_occlusion"] == 0) & np.isfinite(a["scene_flow"][..., 0])
    inner = cv2.erode(both.astype(np.uint8), np.ones((5, 5))) == 1  # off the limb
    picture = a["rgb"].astype(float)
    error = np.abs(warped(b["rgb"], a["flow"]) - picture)[inner]
    still = np.abs(b["rgb"] - picture)[inner]
    assert inner.mean() > 0.3
    assert error.mean() < 1.5 < 4.0 < still.mean()


def test_ground_and_rocks() -> None:
    """Meshes of ground are chosen anew for each frame; flow and occlusion are of the ground."""
    terrain = {"detail": {"seed": 3}, "rocks": {"law": "viper", "density": 8.0, "seed": 3,
               "min_diameter_m": 0.1, "max_diameter_m": 3.0}}  # fmt: skip
    path = {"kind": "traverse", "target": "moon", "lon_deg": LON_DEG, "lat_deg": LAT_DEG,
            "waypoints_m": [[0.0, 0.0], [0.0, 4.0]], "height_m": 1.5, "speed_m_s": 0.4,
            "pitch_deg": -20.0}  # fmt: skip
    time = {"epoch": "2026-03-03T06:00:00Z", "step_s": 1.0, "frames_per_scene": 9}
    sim = moon(terrain, {"trajectory": path, "width": 96, "height": 72}, time=time)
    a, b = (sim.frame(i, [*LABELS, *GEOMETRY]) for i in (1, 2))
    expected = opencv(seen_there(sim, a, b).reshape(-1, 3), b.camera).reshape(72, 96, 2)
    grid = np.stack(np.meshgrid(np.arange(96.0), np.arange(72.0)), axis=-1)
    assert not beyond(a["flow"], expected - grid).any()
    judge_occlusion(sim, a, b, 0.02, 0.02)
    assert 0.01 < a["flow_occlusion"].mean() < 0.5


def test_ends_of_scenes(repo_dir: Path) -> None:
    """Frames before the first and after the last of a scene do not exist."""
    sim = opened(spinner(), repo_dir)
    for index, no_next, no_previous in ((0, False, True), (4, True, False), (5, False, True)):
        sample = sim.frame(index, LABELS)
        for missing, way in ((no_next, ""), (no_previous, "_backward")):
            assert np.isnan(sample["flow" + way]).all() == missing
            assert sample["flow_occlusion" + way].all() == missing
        assert np.isnan(sample["scene_flow"]).all() == no_next


def test_scenes_of_one_frame_are_told(repo_dir: Path) -> None:
    sim = opened(spinner(), repo_dir, overrides={"time.frames_per_scene": 1})
    with pytest.warns(ConfigWarning, match="frames_per_scene"):
        assert np.isnan(sim.frame(1, ["flow"])["flow"]).all()


def test_a_body_with_another_shape_has_no_motion(repo_dir: Path) -> None:
    """A choice gives the body another shape in every frame: no point of it is the same."""
    sim = opened(spinner(), repo_dir)
    request = sim._placed(sim.world(1))
    other = sim._placed(sim.world(2)) | {"changed_bodies": np.array([False, True])}
    request = sim.request(1) | {"next": other}
    out = {"flow": np.empty((48, 64, 2), np.float32), "instance": np.empty((48, 64), np.int32),
           "flow_occlusion": np.empty((48, 64), np.uint8)}  # fmt: skip
    sim._mine().renderer.render(request, out)
    far = out["instance"] == 2
    assert far.any()
    assert np.isnan(out["flow"][far]).all()
    assert out["flow_occlusion"][far].all()
    assert np.isfinite(out["flow"][~far]).all()


def test_a_point_behind_the_other_camera(repo_dir: Path) -> None:
    scene = spinner()

    def moves(world: perilune.world.World) -> F64:
        return np.concatenate([slid(0.0) + np.array([5.0 * world.step, 0.0, 0.0]), FORWARD])

    sample = opened(scene, repo_dir, trajectory=moves).frame(0, [*LABELS, "instance", "depth"])
    behind = sample["instance"] == 3
    behind &= sample["depth"] < 4.9
    assert behind.any()
    assert np.isnan(sample["flow"][behind]).all()
    assert sample["flow_occlusion"][behind].all()
    assert np.isfinite(sample["scene_flow"][behind]).all()


def test_labels_without_distortion(repo_dir: Path) -> None:
    """Both cameras of undistorted labels are pinholes."""
    lens = {"model": "brown_conrady", "k1": -0.2, "labels": "undistorted"}
    plain, bent = (opened(spinner(**more), repo_dir) for more in ({}, {"lens": lens}))
    a, b = (sim.frame(1, ["flow", "flow_backward", "rgb"]) for sim in (plain, bent))
    for name in ("flow", "flow_backward"):
        assert np.array_equal(a[name], b[name], equal_nan=True)
