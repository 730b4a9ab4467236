"""Motion blur and rolling shutters: against frames of single instants, and what they keep."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from tests.python.optics_scenes import FORWARD, RIGHT, STANDS_M, at, ball, opened, row, tree

import perilune
from perilune.config import ConfigError

COLOUR = ["radiance"]


def sliding(speed_m_s, start_m=0.0):
    """A camera that moves to the right; the image goes to the left."""

    def poses(world):
        times = (world.t_s, world.t_s + world.window_s)
        places = [np.array([STANDS_M, 0, 0]) + (start_m + speed_m_s * t) * RIGHT for t in times]
        return np.stack([np.concatenate([place, FORWARD]) for place in places])

    return poses


def spinning(rate_deg_s=30.0, size=(48, 40), **camera):
    """A satellite that turns, before a body; one second a step."""
    scene = tree(size, 60.0, far=ball(at(30.0, -4.0, 2.0), 6.0, albedo=0.6))
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "anchor", "position_km": at(5.0, 0.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0], "spin_rate_deg_s": rate_deg_s},
    }
    scene["camera"] |= camera
    scene["camera"]["exposure"]["white_radiance_w_m2_sr"] = 900.0
    scene["render"] |= {"samples": 64, "max_bounces": 1}
    return scene


INSTANT = {"camera.exposure_time_s": 0.0, "camera.line_time_us": 0.0}


def at_instant(sim, t_s, channels, **changes):
    """A frame of no exposure, number 1: its step is as long as it takes."""
    return sim.with_overrides(INSTANT | {"time.step_s": float(t_s)}, **changes).frame(1, channels)


def test_blur_is_the_mean_of_256_instants(repo_dir):
    """A spinning satellite with its shadows and glints, a body behind it, the camera moving: what
    differs is what two seeds of the same frame differ by. Glints that last less than an instant are
    met by few of a pixel's 64 samples, and make up most of it."""
    scene = spinning(60.0, exposure_time_s=1.0)
    sim = opened(scene, repo_dir, trajectory=sliding(0.6))
    blurred = []
    for seed in (0, 1):
        sample = sim.with_overrides(seed=seed).frame(0, COLOUR)
        assert row(sample, "motion_blur")["on"]
        blurred.append(sample["radiance"])
    sharp = at_instant(sim, 0.5, COLOUR)["radiance"]
    mean = np.zeros(sharp.shape)
    for i in range(256):  # seeds differ, so that their noise does not add up
        few = {"seed": i, "render.samples": 4}
        frame = at_instant(sim, (i + 0.5) / 256, COLOUR, **few)
        mean += frame["radiance"] / 256
    noise = np.abs(blurred[0] - blurred[1]).mean()
    error = blurred[0] - mean
    assert np.abs(sharp - mean).mean() > 3 * noise  # the test would see no blur
    assert np.abs(error).mean() < 1.15 * noise
    assert abs(error.mean()) < 0.01 * mean.mean()


def test_rows_are_those_of_instants(repo_dir):
    """Each row is the row of a frame without exposure at the middle of its own: labels and colour.
    Poses between keys are within a tenth of a pixel of theirs."""
    scene = spinning(size=(48, 12), line_time_us=1e6 / 24, exposure_time_s=0.0)
    scene["render"]["samples"] = 4
    scene["time"]["step_s"] = 1e-9
    names = ["radiance", "depth", "instance"]
    sim = opened(scene, repo_dir, trajectory=sliding(0.6))
    rolled = sim.frame(1, names)
    assert row(rolled, "rolling_shutter")["value"] == 12
    total = 0.0
    for y in range(12):
        still = at_instant(sim, y / 24 + 1e-9, names)
        assert (rolled["instance"][y] != still["instance"][y]).sum() <= 2
        same = rolled["instance"][y] == still["instance"][y]
        depth, expected = rolled["depth"][y][same], still["depth"][y][same]
        assert np.median(np.abs(depth - expected)) < 1e-3
        total += np.abs(rolled["radiance"][y] - still["radiance"][y]).mean() / 12
    middle = at_instant(sim, 11 / 48, names)
    skew = np.abs(rolled["radiance"] - middle["radiance"]).mean()
    assert total < 0.1 * skew


def test_rolling_rows_blur_about_their_own_middle(repo_dir):
    """A ball that crosses: rows shift by the line time, and each is as wide as its exposure."""
    scene = tree((64, 48), 100.0, glow=ball(at(50.0), 3.0))
    scene["camera"] |= {"exposure_time_s": 0.4, "line_time_us": 1e6 / 47}
    image = opened(scene, repo_dir, trajectory=sliding(5.0, -3.5)).frame(0, ["radiance", "depth"])
    u = np.arange(64)
    for y in range(19, 29):
        line = image["radiance"][y, :, 1].astype(float)
        half = np.sqrt(6.0**2 - (y - 23.5) ** 2)
        middle = 31.5 - 2.0 * (5.0 * (y / 47 + 0.2) - 3.5)
        assert (line * u).sum() / line.sum() == pytest.approx(middle, abs=0.15)
        assert line.sum() == pytest.approx(2 * half, rel=0.1)
        spread = (line * (u - middle) ** 2).sum() / line.sum()
        # Variances of the exposure, of the ball's row and of the pixel add up.
        assert spread == pytest.approx(4.0**2 / 12 + (2 * half) ** 2 / 12 + 1 / 12, rel=0.08)
        seen = np.flatnonzero(image["depth"][y])
        assert seen.mean() == pytest.approx(middle, abs=0.6)


@settings(max_examples=12, deadline=None)
@given(
    speed=st.floats(-8.0, 8.0),
    exposure_s=st.floats(0.0, 1.0),
    line_s=st.floats(0.0, 0.02),
    samples=st.sampled_from([5, 16, 40]),
)
def test_energy_is_kept(request, speed, exposure_s, line_s, samples):
    """A bright ball that stays in the frame has its light, wherever it spreads. Rows that see it
    later see it elsewhere: lines have their own length."""
    root = request.config.rootpath
    scene = tree((64, 24), 100.0, glow=ball(at(50.0), 2.0))
    scene["camera"] |= {"exposure_time_s": exposure_s, "line_time_us": 1e6 * line_s}
    scene["render"]["samples"] = samples
    window_s = exposure_s + 23 * line_s
    sim = opened(scene, root, trajectory=sliding(speed, -0.5 * speed * window_s))
    image = sim.frame(0, COLOUR)["radiance"][:, :, 0].astype(float)
    assert image.sum() == pytest.approx(np.pi * 4.0**2, rel=0.12)


@settings(max_examples=10, deadline=None)
@given(exposure_s=st.floats(1e-6, 100.0), line_s=st.floats(0.0, 1.0))
def test_nothing_moves_is_a_still_image(request, exposure_s, line_s):
    root = request.config.rootpath
    scene = spinning(0.0, (32, 24))
    scene["render"]["samples"] = 4
    names = ["radiance", "depth"]
    still = opened(scene, root).frame(0, names)
    scene["camera"] |= {"exposure_time_s": exposure_s, "line_time_us": 1e6 * line_s}
    sample = opened(scene, root).frame(0, names)
    for effect in ("motion_blur", "rolling_shutter"):
        assert not row(sample, effect)["on"]
    for name in names:
        np.testing.assert_array_equal(sample[name], still[name])


@pytest.mark.parametrize("speed", [0.004, 0.1, 0.5, 2.0])
def test_bound_of_the_blur(repo_dir, speed):
    """Leaving the blur out changes no pixel by more than the row says."""
    scene = tree((40, 24), 100.0, glow=ball(at(50.0), 3.0))
    scene["camera"]["exposure_time_s"] = 1.0
    scene["render"]["samples"] = 256
    images, bound = [], 0.0
    for off in ([], ["motion_blur"]):
        scene["render"]["force_off"] = off
        sample = opened(scene, repo_dir, trajectory=sliding(speed, -0.5 * speed)).frame(0, ["rgb"])
        bound = max(bound, row(sample, "motion_blur")["bound_dn"])
        images.append(sample["rgb"].astype(int))
    difference = np.abs(images[0] - images[1]).max()
    if speed < 0.05:  # 2 px of the image a metre: below a tenth of a pixel nothing is done
        assert difference == 0
    else:
        assert 0 < difference <= bound + 255 / 16


@pytest.mark.parametrize("tolerance_dn", [0.0, 50.0, 90.0])
def test_bound_of_the_bands(repo_dir, tolerance_dn):
    """Bands of several rows are within what the row says they leave of rows by themselves."""
    scene = tree((40, 24), 100.0, glow=ball(at(50.0), 3.0))
    scene["camera"]["line_time_us"] = 1e6 / 23
    scene["render"] |= {"samples": 64, "force_on": ["antialiasing"]}
    found = []
    for tolerance in (0.0, tolerance_dn):
        scene["render"]["tolerance_dn"] = tolerance
        sim = opened(scene, repo_dir, trajectory=sliding(0.25, -0.125))
        found.append(sim.frame(0, ["rgb"]))
    exact, bands = (row(sample, "rolling_shutter") for sample in found)
    assert exact["value"] == 24
    assert bands["value"] < 24 or tolerance_dn == 0.0
    difference = np.abs(found[0]["rgb"].astype(int) - found[1]["rgb"]).max()
    assert difference <= bands["residual_dn"] + (255 / 16 if tolerance_dn else 0)


def test_same_bits_for_any_threads_and_order(repo_dir):
    scene = spinning(60.0, (40, 36), exposure_time_s=0.3, line_time_us=4000.0)
    scene["render"]["samples"] = 6
    names = ["radiance", "depth", "instance", "masks", "objects"]
    sim = opened(scene, repo_dir, trajectory=sliding(0.3))
    one = [sim.frame(i, names, threads=1) for i in (0, 1)]
    for threads in (2, 5):
        for i in (1, 0):
            again = sim.frame(i, names, threads=threads)
            for name in again:
                np.testing.assert_array_equal(again[name], one[i][name])
            np.testing.assert_array_equal(again.objects, one[i].objects)


def test_poses_are_of_the_middle(repo_dir):
    scene = spinning(30.0, exposure_time_s=0.5, line_time_us=0.5e6 / 39)
    camera = sliding(0.4)
    sample = opened(scene, repo_dir, trajectory=camera).frame(0, ["objects"])
    scene["time"]["step_s"] = 0.5
    scene["camera"] |= {"exposure_time_s": 0.0, "line_time_us": 0.0}
    still = opened(scene, repo_dir, trajectory=camera).frame(1, ["objects"])
    np.testing.assert_allclose(sample.camera.R_w2c, still.camera.R_w2c, atol=1e-12)
    np.testing.assert_allclose(sample.camera.t_w2c, still.camera.t_w2c, atol=1e-9)
    for name in ("R_m2c", "t_m2c"):
        np.testing.assert_allclose(sample.objects[name], still.objects[name], atol=1e-9)


def test_refusals(repo_dir):
    scene = tree()
    scene["camera"]["line_time_us"] = -1.0
    with pytest.raises(ConfigError, match=r"camera\.line_time_us"):
        opened(scene, repo_dir)
    sim = opened(tree(), repo_dir)
    request = sim.request(0)
    renderer = sim._mine().renderer_of(sim.config)
    out = {"radiance": np.empty((48, 64, 3), np.float32)}
    for motion, text in (
        ({"times": (-1.0, 0.0, False)}, "exposure and line time must be"),
        ({"times": (1.0, float("nan"), False)}, "exposure and line time must be"),
        ({"times": (1.0, 0.0, False), "camera": np.zeros((4, 7))}, "odd, 3"),
        ({"times": (1.0, 0.0, False), "camera": np.zeros((3, 7))}, "lacks 'objects'"),
    ):
        with pytest.raises((ValueError, KeyError), match=text):
            renderer.render({**request, "motion": motion}, out)
    assert isinstance(sim, perilune.Simulation)
