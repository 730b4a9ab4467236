"""Exposures where they degenerate: no time at all, months, turns that keys must follow."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from tests.python.optics_scenes import FORWARD, RIGHT, STANDS_M, at, ball, opened, row, tree

import perilune
from perilune.base import rotations
from perilune.document.loader import read_tree

COLOUR = ["radiance"]


def satellite(rate_deg_s=0.0, place=None, **camera):
    scene = tree((32, 24), 40.0)
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "anchor", "position_km": place or at(6.0)},
        "attitude": {"spin_rate_deg_s": rate_deg_s},
    }
    scene["camera"] |= camera
    scene["render"] |= {"samples": 4}
    return scene


def sliding(speed_m_s, start_m=0.0):
    def poses(world):
        times = (world.t_s, world.t_s + world.window_s)
        places = [np.array([STANDS_M, 0, 0]) + (start_m + speed_m_s * t) * RIGHT for t in times]
        return np.stack([np.concatenate([place, FORWARD]) for place in places])

    return poses


def sound(sample):
    for name in sample:
        assert np.isfinite(sample[name]).all(), name
    return sample


def test_no_exposure_and_no_line_time(repo_dir):
    scene = satellite(90.0, exposure_time_s=0.0, line_time_us=0.0)
    sim = opened(scene, repo_dir)
    sample = sound(sim.frame(0, COLOUR))
    assert sim.request(0)["motion"] is None
    for effect in ("motion_blur", "rolling_shutter"):
        assert not row(sample, effect)["on"]


@pytest.mark.parametrize("forced", ["motion_blur", "rolling_shutter", "depth_of_field"])
def test_forced_on_where_there_is_nothing(repo_dir, forced):
    """A row that is forced on changes nothing where nothing moves and nothing focuses."""
    plain = opened(satellite(), repo_dir).frame(0, COLOUR)
    scene = satellite()
    scene["render"]["force_on"] = [forced]
    np.testing.assert_array_equal(
        opened(scene, repo_dir).frame(0, COLOUR)["radiance"], plain["radiance"]
    )


def test_a_million_seconds_in_orbit(repo_dir):
    """180 revolutions about the Earth: no more than 256 instants, each a place where the satellite
    was, none inside the Earth; the plan says that they are not enough."""
    scene = read_tree(repo_dir / "tests/python/scene.yaml")
    scene["camera"] |= {"width": 16, "height": 12, "exposure_time_s": 1e6}
    scene["camera"]["trajectory"]["distance_m"] = 14
    scene["render"]["samples"] = 4
    sim = perilune.open(scene, base=repo_dir / "tests/python")
    motion = sim.request(0)["motion"]
    assert motion["times"] == (1e6, 0.0, True)
    assert motion["camera"].shape == (257, 7)
    radius = np.linalg.norm(motion["objects"][0, :, :3], axis=1)
    assert radius.min() > 6.8e6
    sample = sound(sim.frame(0, COLOUR))
    blur = row(sample, "motion_blur")
    assert blur["value"] == 256
    assert "256, as many as there may be, leave" in blur["reason"]


@pytest.mark.parametrize("exposure_s", [1e-9, 1e12])
def test_shortest_and_longest(repo_dir, exposure_s):
    sound(opened(satellite(1e-3, exposure_time_s=exposure_s), repo_dir).frame(0, COLOUR))


@pytest.mark.parametrize("rate_deg_s", [190.0, 359.999, 360.0, 720.0, 5000.0])
def test_spins_beyond_half_a_turn(repo_dir, rate_deg_s):
    """Keys are so near that the shorter way from one to the next is the way it went."""
    sim = opened(satellite(rate_deg_s, exposure_time_s=1.0), repo_dir)
    keys = sim.request(0)["motion"]["objects"][0][:, 3:]
    total = 0.0
    for a, b in itertools.pairwise(keys):
        _, angle = rotations.to_axis_angle(rotations.multiply(rotations.conjugate(a), b))
        total += np.degrees(angle)
    assert total == pytest.approx(rate_deg_s, rel=1e-9)


def test_signs_of_quaternions(repo_dir):
    """q and -q are one rotation: keys of any signs give one image."""
    sim = opened(satellite(60.0, exposure_time_s=1.0), repo_dir)
    request = sim.request(0)
    renderer = sim._mine().renderer_of(sim.config)
    images = []
    for signs in ((1, 1, 1), (1, -1, 1), (-1, 1, -1)):
        motion = dict(request["motion"])
        for name in ("camera", "objects", "bodies"):
            keys = motion[name].copy()
            keys[..., 3:] *= np.array(signs)[:, None]
            motion[name] = keys
        image = np.empty((24, 32, 3), np.float32)
        renderer.render({**request, "motion": motion}, {"radiance": image})
        images.append(image)
    assert np.abs(images[0] - images[1]).max() < 1e-3 * images[0].max()
    np.testing.assert_array_equal(images[0], images[2])


@pytest.mark.parametrize("speed_px", [0.05, 0.09, 0.101, 1.0])
def test_about_a_tenth_and_a_pixel(repo_dir, speed_px):
    """A small ball 100 m away moves by so much, which is bounded to within 5 %; nothing that is
    below a tenth of a pixel is done."""
    scene = tree((32, 24), 100.0, glow=ball(at(100.0), 0.01))
    scene["camera"]["exposure_time_s"] = 1.0
    sample = opened(scene, repo_dir, trajectory=sliding(speed_px)).frame(0, COLOUR)
    blur = row(sample, "motion_blur")
    assert blur["on"] == (speed_px > 0.1)
    assert blur["bound_dn"] == 0.0 if speed_px < 0.1 else blur["bound_dn"] > 0.0


def test_entering_and_leaving_the_frame(repo_dir):
    """A ball that is in the frame for half of the exposure, and at neither its ends nor, at some
    speeds, its middle."""
    scene = tree((64, 48), 100.0, glow=ball(at(50.0), 2.0))
    scene["camera"]["exposure_time_s"] = 1.0
    for start, speed in ((-40.0, 80.0), (-30.0, 30.0), (0.0, 40.0), (-60.0, 80.0)):
        camera = sliding(speed, start)
        sample = opened(scene, repo_dir, trajectory=camera).frame(0, [*COLOUR, "depth"])
        image = sample["radiance"][:, :, 0].astype(float)
        places = 31.5 - 2.0 * (start + speed * (np.arange(1000) + 0.5) / 1000)
        half = np.clip(63.5 - places, -4, 4) - np.clip(-0.5 - places, -4, 4)
        inside = np.clip(half / 8.0, 0, 1).mean()
        assert image.sum() == pytest.approx(np.pi * 16.0 * inside, rel=0.15)


def test_camera_within_the_bounding_sphere(repo_dir):
    scene = satellite(20.0, at(1.6), exposure_time_s=0.2, line_time_us=1000.0)
    sample = sound(opened(scene, repo_dir).frame(0, [*COLOUR, "depth"]))
    assert row(sample, "motion_blur")["value"] == 256  # nothing bounds how far anything moves


def test_parts_move_within_the_exposure(repo_dir):
    """A panel that turns blurs, though the craft stands still; labels have it in the middle."""
    scene = satellite(exposure_time_s=1.0)
    scene["spacecraft"]["sat"]["articulation"] = [
        {"node": "panel_left", "axis": [1, 0, 0], "rate_deg_s": 300.0}
    ]
    names = [*COLOUR, "depth"]
    sample = sound(opened(scene, repo_dir).frame(0, names))
    assert row(sample, "motion_blur")["on"]
    scene["camera"]["exposure_time_s"] = 0.0
    scene["time"]["step_s"] = 0.5
    still = opened(scene, repo_dir).frame(1, names)
    np.testing.assert_array_equal(sample["depth"], still["depth"])
    assert np.abs(sample["radiance"] - still["radiance"]).max() > 1.0


def test_an_image_of_one_row(repo_dir):
    scene = tree((32, 1), 100.0, glow=ball(at(50.0), 2.0))
    scene["camera"] |= {"exposure_time_s": 0.1, "line_time_us": 1e6}
    sample = sound(opened(scene, repo_dir, trajectory=sliding(5.0)).frame(0, COLOUR))
    assert not row(sample, "rolling_shutter")["on"]
    assert row(sample, "motion_blur")["on"]


def test_readout_far_longer_than_the_exposure(repo_dir):
    """Rows of a microsecond, a second apart: a bounded number of instants, each row lit."""
    scene = tree((32, 24), 100.0, glow=ball(at(50.0), 20.0))
    scene["camera"] |= {"exposure_time_s": 1e-6, "line_time_us": 1e6}
    sample = sound(opened(scene, repo_dir, trajectory=sliding(0.01)).frame(0, COLOUR))
    np.testing.assert_allclose(sample["radiance"], 1.0, rtol=1e-5)
    scene["render"]["force_on"] = ["motion_blur"]
    sample = sound(opened(scene, repo_dir, trajectory=sliding(0.01)).frame(0, COLOUR))
    np.testing.assert_allclose(sample["radiance"], 1.0, rtol=1e-5)
