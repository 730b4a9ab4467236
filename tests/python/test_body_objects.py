"""Bodies as objects: poses, boxes and silhouettes of ellipsoids by quadratic equations in NumPy, of
shapes and terrain by the picture of a larger camera."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from tests.python.shape_scenes import ball, write_obj

import perilune
from perilune.base import rotations
from perilune.config import ConfigError

WIDTH, HEIGHT = 24, 18
RADII_M = np.array([6.0e5, 5.0e5, 4.0e5])
CHANNELS = ["instance", "depth", "objects", "masks"]


def tree(**bodies):
    """A body in the root's place and another beside it; annotated as asked."""
    return {
        "version": 1,
        "seed": 1,
        "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 10},
        "root": "rock",
        "bodies": {
            "rock": {
                "kind": "ellipsoid",
                "radii_km": (RADII_M / 1e3).tolist(),
                "gm_km3_s2": 10.0,
                "albedo": 0.2,
                "annotate": True,
                "rotation": {"spin_rate_deg_s": 0.01, "spin_axis": [0.3, 0.5, 0.8]},
                **bodies.pop("rock", {}),
            },
            **bodies,
        },
        "camera": {
            "width": WIDTH,
            "height": HEIGHT,
            "fov_deg": 50,
            "trajectory": {"kind": "fixed", "position_m": [0, 0, 1e9], "target": "rock"},
        },
        "render": {"samples": 1, "max_bounces": 0},
    }


def camera_at(place_m, towards, roll_rad=0.0):
    """A pose (7,) that looks along `towards`."""
    z = np.asarray(towards, dtype=np.float64)
    z /= np.linalg.norm(z)
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    y = np.cross(z, x)
    x, y = np.cos(roll_rad) * x + np.sin(roll_rad) * y, np.cos(roll_rad) * y - np.sin(roll_rad) * x
    return np.concatenate([place_m, rotations.from_matrix(np.stack([x, y, z], axis=1))])


def canvas_rays(K):
    """Directions through the pixels of the canvas, three times as large as the image."""
    v, u = np.mgrid[-HEIGHT : 2 * HEIGHT, -WIDTH : 2 * WIDTH].astype(np.float64)
    return np.stack([u, v, np.ones_like(u)], axis=-1) @ np.linalg.inv(K).T


def met(row, K, radii_m=RADII_M):
    """(3 H, 3 W): where rays meet the ellipsoid of a row, before the camera."""
    rays = canvas_rays(K) @ row["R_m2c"] / radii_m
    start = -row["R_m2c"].T @ row["t_m2c"] / radii_m
    a, b = (rays**2).sum(axis=-1), rays @ start
    return (b**2 >= a * (start @ start - 1.0)) & (b < 0.0)


def box(mask):
    y, x = np.nonzero(mask)
    low, high = (x.min() - WIDTH, y.min() - HEIGHT), (x.max() - WIDTH, y.max() - HEIGHT)
    return [low[0], low[1], high[0] - low[0], high[1] - low[1]]


def image_of(canvas):
    return canvas[HEIGHT : 2 * HEIGHT, WIDTH : 2 * WIDTH]


def assert_row(row, mask, visible, canvas):
    """The label of a row whose silhouette on the canvas is known."""
    assert np.array_equal(mask != 0, image_of(canvas))
    assert not (visible & (mask == 0)).any()
    assert row["px_count_visib"] == np.count_nonzero(visible)
    assert row["px_count_all"] == np.count_nonzero(canvas)
    assert row["px_count_valid"] == np.count_nonzero(mask)
    share = row["px_count_visib"] / max(row["px_count_all"], 1)
    assert row["visib_fract"] == pytest.approx(share, abs=1e-15)
    seen = visible.any()
    assert row["bbox_obj"].tolist() == (box(canvas) if seen else [-1] * 4)
    if seen:
        y, x = np.nonzero(visible)
        ends = [x.min(), y.min(), x.max() - x.min(), y.max() - y.min()]
        assert row["bbox_visib"].tolist() == ends


def shot(world, pose, index=0, **changes):
    sim = perilune.open(world, overrides=changes, trajectory=lambda _: pose)
    return sim, sim.frame(index, CHANNELS, threads=1)


@settings(max_examples=60, deadline=None)
@given(
    place=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    away=st.floats(-6.0, 3.0),
    aim=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    off=st.sampled_from([0.0, 0.2, 1.0, 5.0]),
    roll=st.floats(0.0, 6.0),
    index=st.integers(0, 5),
)
def test_an_ellipsoid_by_quadratic_equations(place, away, aim, off, roll, index):
    """From a metre over the ground, where it fills the frame or is behind, to a part of a pixel."""
    up = np.array(place) + np.array([0.0, 0.0, 1e-3])
    up /= np.linalg.norm(up)
    ground_m = 1.0 / np.linalg.norm(up / RADII_M.min())  # inside of none: the least radius differs
    at = up * (RADII_M.max() + ground_m * 10.0**away)
    towards = -up + off * np.array(aim)
    if np.linalg.norm(towards) < 1e-3:
        return
    sim, sample = shot(tree(), camera_at(at, towards, roll), index)
    (row,), (mask,) = sample.objects, sample["masks"]
    canvas = met(row, sample.camera.K)
    assert_row(row, mask, sample["instance"] == row["instance_id"], canvas)
    state = sample.meta["states"]["rock"]
    turned = sample.camera.R_w2c @ rotations.to_matrix(np.array(state["q_wxyz"]))
    np.testing.assert_allclose(row["R_m2c"], turned, atol=1e-12)
    centre = sample.camera.R_w2c @ np.array(state["position_m"]) + sample.camera.t_w2c
    np.testing.assert_allclose(row["t_m2c"], centre, rtol=1e-12, atol=1e-6)
    assert row["obj_id"] == sim.obj_ids["rock"] == 1


def test_camera_just_above_the_ground_with_a_lens():
    """The horizon bends with the lens; rays of the canvas without a pixel count as sky."""
    lens = {"model": "brown_conrady", "k1": -0.1, "k2": 0.01}
    at = np.array([0.0, 0.0, 4.02e5])
    world = tree()
    world["camera"]["lens"] = lens
    _, sample = shot(world, camera_at(at, [1.0, 0.0, -0.1]))
    (row,), (mask,) = sample.objects, sample["masks"]
    assert np.array_equal(mask != 0, sample["instance"] == row["instance_id"])
    assert 0.2 < np.count_nonzero(mask) / mask.size < 0.95


OTHER = {
    "kind": "ellipsoid",
    "radii_km": [100.0, 100.0, 100.0],
    "gm_km3_s2": 0.0001,
    "albedo": 0.5,
    "annotate": True,
    "orbit": {"around": "rock", "semi_major_axis_km": 2000.0, "mean_anomaly_deg": 0.0},
}


def test_one_body_before_another_and_order_of_rows():
    """The whole silhouette knows nothing of what hides it; rows are in the order of the file."""
    world = tree(moon=OTHER, silent={**OTHER, "annotate": False})
    world["bodies"]["silent"]["orbit"] = {**OTHER["orbit"], "mean_anomaly_deg": 20.0}
    moon_m = perilune.open(world).world(0).poses["moon"][0, :3]
    at = 2.0 * moon_m + np.array([0.0, 0.0, 1e5])
    sim, sample = shot(world, camera_at(at, -moon_m))
    assert sim.config.objects == ("rock", "moon")
    assert len(sample.objects) == len(sample["masks"]) == 2
    for name, row, mask in zip(sim.config.objects, sample.objects, sample["masks"], strict=True):
        assert row["instance_id"] == sim.taxonomy.instances[name]
        radii_m = RADII_M if name == "rock" else np.full(3, 1e5)
        visible = sample["instance"] == row["instance_id"]
        assert_row(row, mask, visible, met(row, sample.camera.K, radii_m))
    rock, moon = sample.objects
    assert rock["visib_fract"] < 1.0 == moon["visib_fract"]


def larger(sim, pose, **changes):
    """The instance in a camera of three times the size, whose middle is the image."""
    K = np.array(sim.frame(0, ["instance"]).camera.K)
    K[:2, 2] += WIDTH, HEIGHT
    keys = {
        "camera.width": 3 * WIDTH,
        "camera.height": 3 * HEIGHT,
        "camera.fov_deg": None,
        "camera.K": K.ravel().tolist(),
    }
    wide = sim.with_overrides({**keys, **changes})
    return wide.frame(0, ["instance"])["instance"]


def test_the_silhouette_of_a_shape(tmp_path):
    vertices, faces = ball(12)
    write_obj(tmp_path / "ball.obj", vertices * [13.0, 11.4, 9.1], faces)
    world = tree(rock={"shape": str(tmp_path / "ball.obj"), "radii_km": [13.0, 11.4, 9.1]})
    pose = camera_at([2.0e4, 5e3, 2.2e4], [-2.0e4, -1e3, -1.8e4])
    sim, sample = shot(world, pose)
    (row,), (mask,) = sample.objects, sample["masks"]
    canvas = larger(sim, pose) == row["instance_id"]
    assert_row(row, mask, sample["instance"] == row["instance_id"], canvas)
    assert row["px_count_all"] > row["px_count_visib"]


def test_the_silhouette_of_terrain_with_rocks():
    """Meshes of ground differ between cameras, by less than a pixel."""
    terrain = {"detail": {}, "rocks": {}}
    world = tree(rock={"terrain": terrain, "radii_km": [500.0, 500.0, 500.0]})
    pose = camera_at([0.0, 0.0, 5.2e5], [1.0, 0.0, -0.2])
    sim, sample = shot(world, pose)
    (row,), (mask,) = sample.objects, sample["masks"]
    visible = sample["instance"] == row["instance_id"]
    assert np.array_equal(mask != 0, visible)
    canvas = larger(sim, pose) == row["instance_id"]
    assert abs(row["px_count_all"] - np.count_nonzero(canvas)) <= 3 * WIDTH
    assert np.abs(row["bbox_obj"] - box(canvas)).max() <= 1


def test_threads_do_not_change_a_bit():
    sim = perilune.open(tree(moon=OTHER), trajectory=lambda _: camera_at([0, 0, 2.5e6], [0, 0, -1]))
    one, three = (sim.frame(0, CHANNELS, threads=n) for n in (1, 3))
    assert one.objects.tobytes() == three.objects.tobytes()
    assert np.array_equal(one["masks"], three["masks"])


def test_ids_of_models():
    stated = tree(moon=OTHER, third={**OTHER, "obj_id": 1})
    assert dict(perilune.open(stated).obj_ids) == {"rock": 2, "moon": 3, "third": 1}
    seven = {**OTHER, "obj_id": 7}
    clash = perilune.open(tree(moon=seven, third=seven))
    with pytest.raises(ConfigError, match=r"bodies\.third\.obj_id = 7: moon has it too"):
        len(clash.obj_ids)
    with pytest.raises(ConfigError, match=r"obj_id: only with annotate: true"):
        perilune.open(tree(moon={**OTHER, "annotate": False, "obj_id": 7}))
