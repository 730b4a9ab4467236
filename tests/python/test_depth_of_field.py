"""Focus: against the circle of confusion, against pinholes all over the lens, and its limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from tests.python.optics_scenes import at, ball, opened, row, still, tree

import perilune
from perilune.config import ConfigError

COLOUR = ["radiance"]


def blurred(root, focus, aperture_mm, samples=2048, size=(40, 40), **bodies):
    scene = tree(size, **bodies)
    scene["camera"]["lens"] = {"focus_distance_m": focus, "aperture_mm": aperture_mm}
    scene["render"]["samples"] = samples
    return opened(scene, root).frame(0, COLOUR)


def second_moment(image):
    """Of the light about its own centre, px^2 along u and v."""
    v, u = np.mgrid[0 : image.shape[0], 0 : image.shape[1]]
    w = image / image.sum()
    return [float((w * (x - (w * x).sum()) ** 2).sum()) for x in (u, v)]


@pytest.mark.parametrize(
    ("depth_m", "focus"), [(50.0, 10.0), (4.0, 6.0), (10.0, "infinity"), (40.0, 8.0)]
)
def test_disc_of_confusion(repo_dir, depth_m, focus):
    """A ball of 1 px spreads over a disc of f D |1/z - 1/F| and keeps its energy; the second
    moments of discs (R^2/4 each way) and of the pixel (1/12) add up."""
    radius_px, focal_px, aperture_m = 1.0, 100.0, 1.0
    glow = ball(at(depth_m), radius_px * depth_m / focal_px)
    image = blurred(repo_dir, focus, 1e3 * aperture_m, glow=glow)["radiance"][:, :, 1]
    image = image.astype(float)
    near = 0.0 if focus == "infinity" else 1.0 / focus
    confusion_px = focal_px * aperture_m * abs(1.0 / depth_m - near)
    assert image.sum() == pytest.approx(np.pi * radius_px**2, rel=0.03)
    expected = confusion_px**2 / 16.0 + radius_px**2 / 4.0 + 1.0 / 12.0
    assert second_moment(image) == pytest.approx([expected] * 2, rel=0.03)
    v, u = np.mgrid[0:40, 0:40] - 19.5
    beyond = np.hypot(u, v) > 0.5 * confusion_px + radius_px + 1.0
    assert image[beyond].max() == 0.0
    inside = np.hypot(u, v) < 0.5 * confusion_px - radius_px - 1.0
    if inside.any():  # an even disc
        assert image[inside].mean() == pytest.approx(4 * radius_px**2 / confusion_px**2, rel=0.05)


def test_is_the_mean_of_pinholes_over_the_lens(repo_dir):
    """Brute force: pinhole cameras at points of the lens, their images shifted so that the plane of
    focus stays in place, have this mean. Meshes, a body that they shade, all in one picture."""
    scene = tree((48, 40), 60.0, far=ball(at(30.0, -4.0, 2.0), 6.0, albedo=0.6))
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 3.0,
        "orbit": {"around": "anchor", "position_km": at(5.0, 0.5)},
        "attitude": {"rotation_deg": [20.0, 30.0, 40.0]},
    }
    scene["camera"]["exposure"]["white_radiance_w_m2_sr"] = 900.0
    scene["render"] |= {"samples": 1024, "max_bounces": 1}
    focus_m, radius_m = 8.0, 0.2
    scene["camera"]["lens"] = {"focus_distance_m": focus_m, "aperture_mm": 2e3 * radius_m}
    lens = opened(scene, repo_dir).frame(0, COLOUR)["radiance"]
    del scene["camera"]["lens"], scene["camera"]["focal_px"]
    scene["render"]["samples"] = 4
    total, count = np.zeros(lens.shape), 100
    for i in range(count):  # Vogel's spiral: evenly over the disc
        r, a = radius_m * np.sqrt((i + 0.5) / count), i * np.pi * (3.0 - np.sqrt(5.0))
        x, y = r * np.cos(a), r * np.sin(a)
        shift = 60.0 / focus_m
        scene["camera"]["K"] = [60.0, 0, 23.5 + shift * x, 0, 60.0, 19.5 + shift * y, 0, 0, 1]
        sim = opened(scene, repo_dir, trajectory=still((x, y)))
        total += sim.frame(0, COLOUR)["radiance"]
    brute = total / count
    sharp = opened(scene, repo_dir).frame(0, COLOUR)["radiance"]
    error = np.abs(lens - brute)
    assert np.abs(sharp - brute).mean() > 10 * error.mean()  # the test would see no blur
    assert error.mean() < 0.01 * brute.max()
    # Glints of its foil, which one sample in thousands meets, are in a few pixels of either image.
    assert np.quantile(error, 0.99) < 0.06 * brute.max()
    assert np.quantile(error, 0.999) < 0.12 * brute.max()


@settings(max_examples=15, deadline=None)
@given(
    depth_m=st.floats(3.0, 300.0),
    focus_m=st.floats(3.0, 300.0),
    right_px=st.floats(-6.0, 6.0),
    aperture_m=st.floats(0.0, 0.5),
)
def test_energy_and_place_are_kept(request, depth_m, focus_m, right_px, aperture_m):
    glow = ball(at(depth_m, right_px * depth_m / 100.0), 0.015 * depth_m)
    sample = blurred(request.config.rootpath, focus_m, 1e3 * aperture_m, 256, glow=glow)
    image = sample["radiance"][:, :, 0].astype(float)
    assert image.sum() == pytest.approx(np.pi * 1.5**2, rel=0.1)
    u = (image * (np.arange(40) - 19.5)).sum() / image.sum()
    assert u == pytest.approx(right_px, abs=0.25)


def test_the_bound(repo_dir):
    """Leaving the blur out changes no pixel by more than the row says."""
    for aperture_mm in (5.0, 40.0, 200.0):
        scene = tree((40, 40), glow=ball(at(20.0), 3.0))
        scene["camera"]["lens"] = {"focus_distance_m": 10.0, "aperture_mm": aperture_mm}
        scene["render"]["samples"] = 256
        images, bound = [], 0.0
        for off in ([], ["depth_of_field"]):
            scene["render"]["force_off"] = off
            sample = opened(scene, repo_dir).frame(0, ["rgb"])
            bound = max(bound, row(sample, "depth_of_field")["bound_dn"])
            images.append(sample["rgb"].astype(int))
        if aperture_mm > 5.0:  # below a tenth of a pixel nothing is done
            assert 0 < np.abs(images[0] - images[1]).max() <= bound + 4.0
        else:
            np.testing.assert_array_equal(*images)


@pytest.mark.parametrize(
    "lens",
    [
        {},
        {"focus_distance_m": 5.0, "aperture_mm": 0.0},
        {"focus_distance_m": 50.0, "aperture_mm": 900.0},  # all that is seen is in focus
        {"focus_distance_m": "infinity", "aperture_mm": 40.0, "only": "far"},
        {"focus_distance_m": 50.0, "aperture_mm": 0.1},
    ],
)
def test_sharp_is_a_pinhole(repo_dir, lens):
    """To the bit, and the plan says why."""
    far = lens.pop("only", None)
    glow = ball(at(1e6, 1e3), 2e4) if far else ball(at(50.0, 1.0), 0.001)
    scene = tree(glow=glow)
    plain = opened(scene, repo_dir).frame(0, [*COLOUR, "depth"])
    scene["camera"]["lens"] = lens
    sample = opened(scene, repo_dir).frame(0, [*COLOUR, "depth"])
    assert not row(sample, "depth_of_field")["on"]
    assert row(sample, "depth_of_field")["reason"]
    for name in plain:
        np.testing.assert_array_equal(sample[name], plain[name])


def test_labels_stay_sharp(repo_dir):
    scene = tree(glow=ball(at(20.0), 2.0))
    names = ["depth", "instance", "radiance"]
    plain = opened(scene, repo_dir).frame(0, names)
    scene["camera"]["lens"] = {"focus_distance_m": 2.0, "aperture_mm": 300.0}
    sim = opened(scene, repo_dir)
    sample = sim.frame(0, names, threads=1)
    for name in names[:2]:
        np.testing.assert_array_equal(sample[name], plain[name])
    assert (sample["radiance"] > 0).sum() > 1.5 * (plain["radiance"] > 0).sum()
    assert sample.camera.lens is None
    again = sim.frame(0, names, threads=3)
    for name in names:
        np.testing.assert_array_equal(sample[name], again[name])


def test_near_side_and_inside_a_bounding_sphere(repo_dir):
    """The lens among the parts of a satellite, focus nearer than all of it: finite, no black tile
    where it is seen."""
    scene = tree((64, 48), 40.0)
    scene["spacecraft"]["sat"] = {
        "model": "assets/models/smallsat.glb",
        "size_m": 6.0,
        "orbit": {"around": "anchor", "position_km": at(2.0)},
    }
    scene["camera"]["lens"] = {"focus_distance_m": 0.05, "aperture_mm": 20.0}
    scene["render"]["samples"] = 32
    sample = opened(scene, repo_dir).frame(0, [*COLOUR, "instance"])
    assert row(sample, "depth_of_field")["on"]
    assert np.isfinite(sample["radiance"]).all()
    assert sample["radiance"].max() > 0.0


def test_with_distortion(repo_dir):
    """A lens that bends and focuses blurs about where the bent pinhole has its image."""
    bend = {"model": "brown_conrady", "k1": -0.3}
    scene = tree(glow=ball(at(20.0, 3.0, 1.5), 1.0))
    scene["render"]["samples"] = 512
    centres = []
    for focus in ({}, {"focus_distance_m": 4.0, "aperture_mm": 600.0}):
        scene["camera"]["lens"] = bend | focus
        image = opened(scene, repo_dir).frame(0, COLOUR)["radiance"][:, :, 1].astype(float)
        v, u = np.mgrid[0:48, 0:64]
        centres.append([(image * x).sum() / image.sum() for x in (u, v)])
        spread = second_moment(image)[0]
    assert np.hypot(*np.subtract(*centres)) < 0.2
    assert spread > 1.5 * 5.0**2 / 4.0  # of the ball alone, in a pinhole without distortion


def test_aperture_of_the_sensor(repo_dir):
    """f = 100 px of 10 um = 1 mm at f/2 is half a millimetre."""
    scene = tree(glow=ball(at(20.0), 2.0))
    scene["camera"] |= {
        "lens": {"focus_distance_m": 4.0},
        "sensor": {"f_number": 2.0, "pixel_um": 10.0},
    }
    assert opened(scene, repo_dir).request(0)["focus"] == pytest.approx((0.5e-3, 4.0))


def test_refusals(repo_dir):
    scene = tree()
    scene["camera"]["lens"] = {"focus_distance_m": 4.0}
    with pytest.raises(ConfigError, match=r"camera\.lens\.aperture_mm: required"):
        opened(scene, repo_dir)
    scene["camera"]["lens"] = {"model": "fisheye", "focus_distance_m": 4.0, "aperture_mm": 1.0}
    with pytest.raises(ConfigError, match="a fisheye lens has no plane of focus"):
        opened(scene, repo_dir)
    scene["camera"]["lens"] = {"focus_distance_m": 0.01, "aperture_mm": 20.0}
    with pytest.raises(ValueError, match="the distance in focus at least that"):
        opened(scene, repo_dir).frame(0, COLOUR)
    scene["camera"]["lens"] = {"labels": "distorted"}
    with pytest.raises(ConfigError, match="unknown key"):
        opened(scene, repo_dir)
    assert isinstance(opened(tree(), repo_dir), perilune.Simulation)
