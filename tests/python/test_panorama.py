"""Equirectangular panoramas: what pinholes and rays aimed pixel by pixel show, parts of them, the
edge behind the camera, and refusals. The projection is written here once more, with NumPy."""

from __future__ import annotations

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.export.check import check
from perilune.export.writers import write, write_bop

WIDTH, HEIGHT = 96, 48
PANORAMA = {"model": "equirectangular"}
BEHIND = {"transformation": {"rotation_deg": [0.0, 180.0, 0.0]}}
FACES = {
    "front": [0, 0, 0],
    "right": [0, 90, 0],
    "back": [0, 180, 0],
    "left": [0, -90, 0],
    "down": [-90, 0, 0],
    "up": [90, 0, 0],
}
"""Turns of six cameras about x, y and z (x right, y down, z forward)."""


@pytest.fixture
def tree(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["camera"].update(width=WIDTH, height=HEIGHT, lens=PANORAMA)
    tree["camera"]["trajectory"]["distance_m"] = [5.0, 5.0]
    del tree["camera"]["fov_deg"]
    return tree


@pytest.fixture
def opened(tree, repo_dir):
    return lambda **changes: perilune.open(tree, overrides=changes, base=repo_dir / "tests/python")


def directions(width: int = WIDTH, height: int = HEIGHT) -> np.ndarray:
    """(H, W, 3): camera axes."""
    azimuth = (np.arange(width) + 0.5) / width * 2.0 * np.pi - np.pi
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)  # downwards
    azimuth, elevation = np.meshgrid(azimuth, elevation)
    level = np.cos(elevation)
    return np.stack([level * np.sin(azimuth), np.sin(elevation), level * np.cos(azimuth)], axis=2)


def test_pixels_are_rays_of_their_directions(opened):
    sim = opened()
    channels = ["instance", "part", "range", "position", "normal", "objects", "depth"]
    sample = sim.frame(0, channels)
    rays = np.concatenate([np.zeros((WIDTH * HEIGHT, 3)), directions().reshape(-1, 3)], axis=1)
    found = sim.trace(0, rays, ["instance", "part"])
    for name in ("instance", "part"):
        np.testing.assert_array_equal(sample[name].ravel(), found[name])
    hit = sample["instance"].ravel() > 0
    assert set(sample["instance"].ravel()) == {0, 1, 2}
    np.testing.assert_allclose(sample["range"].ravel()[hit], found["range_m"][hit], rtol=2e-6)
    row, column = np.nonzero(sample["instance"])
    pixels = sample.camera.project(sample["position"][row, column])
    assert np.abs(pixels - np.stack([column, row], 1)).max() < 1e-6
    seen = sample["position"][row, column] @ sample.camera.R_w2c.T + sample.camera.t_w2c
    np.testing.assert_allclose(sample["depth"][row, column], seen[:, 2], rtol=1e-6)
    assert seen[:, 2].min() < 0.0 < seen[:, 2].max()  # before and behind


def test_colours_are_those_of_six_pinholes(opened):
    """Pinholes of the same place, each towards a side of a cube, beside the panorama: colours and
    instances of pixels whose neighbours in the pinhole are of the same instance."""
    place = {name: {"transformation": {"rotation_deg": turn}} for name, turn in FACES.items()}
    pinhole = {"lens": {"model": "rectilinear"}, "fov_deg": 90.0, "width": 128, "height": 128}
    sim = opened(
        **{
            "sensors": {"around": {}} | {name: row | pinhole for name, row in place.items()},
            "time.step_s": 1e-6,
            "camera.exposure": {"mode": "fixed", "white_radiance_w_m2_sr": 250.0},
            "render.samples": 16,
        }
    )
    around = sim.frame(0, ["rgb", "instance"])
    compared = other = 0
    for k in range(1, 7):
        face = sim.frame(k, ["rgb", "instance"])
        rays = directions() @ (face.camera.R_w2c @ around.camera.R_w2c.T).T
        with np.errstate(divide="ignore", invalid="ignore"):
            pixel = 64.0 * rays[:, :, :2] / rays[:, :, 2:] + 63.5
        inside = (rays[:, :, 2] > 0) & (np.abs(pixel - 63.5) < 61.0).all(axis=2)
        x, y = np.rint(pixel[inside]).astype(int).T
        near = [face["instance"][y + dy, x + dx] for dy in (-2, 0, 2) for dx in (-2, 0, 2)]
        sure = (np.array(near) == near[4]).all(axis=0)
        other += np.count_nonzero(around["instance"][inside][sure] != near[4][sure])
        body = sure & (near[4] == 1)
        theirs = face["rgb"][y, x][body].astype(float)
        ours = around["rgb"][inside][body].astype(float)
        if body.any():
            assert np.abs(ours.mean(axis=0) - theirs.mean(axis=0)).max() < 1.5
            assert np.median(np.abs(ours - theirs)) <= 2.0
        compared += int(sure.sum())
    assert compared > 0.6 * WIDTH * HEIGHT
    assert other <= 3  # thin parts between the neighbours that were looked at


def test_what_lies_behind_is_on_both_edges(opened):
    """The spacecraft straight behind: half of it at the left edge, half at the right; what a view
    that is turned by half a circle has in the middle. Its box goes from edge to edge."""
    names = ["instance", "objects", "masks", "rgb"]
    sim = opened(**{"sensors": {"ahead": {}, "behind": BEHIND}, "time.step_s": 1e-6})
    ahead, behind = (sim.frame(index, names) for index in range(2))
    rolled = np.roll(behind["instance"], WIDTH // 2, axis=1)
    assert np.count_nonzero(rolled != ahead["instance"]) <= 4  # on edges: they move in a step
    assert (behind["instance"][:, 0] == 2).any()
    assert (behind["instance"][:, -1] == 2).any()
    (one,), (other,) = (
        frame.objects[frame.objects["instance_id"] == 2] for frame in (ahead, behind)
    )
    assert one["px_count_visib"] == one["px_count_all"] > 30
    assert other["px_count_visib"] == np.count_nonzero(behind["instance"] == 2)
    assert abs(int(other["px_count_all"]) - int(one["px_count_all"])) <= 2
    assert other["bbox_visib"][0] == 0
    assert other["bbox_visib"][2] == WIDTH - 1


def test_a_part_is_the_middle_of_the_whole(opened):
    names = ["instance", "part", "range", "objects", "rgb"]
    whole = opened().frame(0, names)
    focal = WIDTH / (2.0 * np.pi)
    part = opened(**{"camera.focal_px": focal, "camera.width": 48, "camera.height": 24})
    part = part.frame(0, names)
    for name in ("instance", "part"):
        np.testing.assert_array_equal(part[name], whole[name][12:36, 24:72])
    np.testing.assert_allclose(part["range"], whole["range"][12:36, 24:72], rtol=1e-6)


def test_same_bits_for_any_threads(opened):
    sim = opened()
    one, two = (sim.frame(1, ["rgb", "instance", "objects"], threads=n) for n in (1, 2))
    for name in one:
        np.testing.assert_array_equal(one[name], two[name])


def test_datasets_are_checked(opened, tmp_path):
    sim = opened(**{"render.channels": ["depth", "range", "position", "instance", "objects"]})
    write("npz", sim, range(2), tmp_path, threads=1)
    for report in check(tmp_path, alone=True):
        assert report.findings == [], report.folder


def test_refusals(opened, tmp_path):
    with pytest.raises(
        ConfigError, match=r"camera\.fov_deg: leave it out with camera\.lens\.model"
    ):
        opened(**{"camera.fov_deg": 90.0})
    with pytest.raises(ConfigError, match=r"camera\.lens\.focus_distance_m: a panorama has no"):
        opened(**{"camera.lens": {**PANORAMA, "focus_distance_m": 3.0, "aperture_mm": 1.0}})
    with pytest.raises(ConfigError, match=r"camera\.fov_deg: required"):
        opened(**{"sensors": {"eye": {"lens": {"model": "rectilinear"}}}})
    with pytest.raises(ValueError, match="an equirectangular image spans at most 360 by 180 deg"):
        opened(**{"camera.focal_px": 0.9 * WIDTH / (2.0 * np.pi)})[0]
    with pytest.raises(ConfigError, match=r"camera\.lens: .* a panorama is none"):
        write_bop(opened(), range(1), tmp_path)


def test_a_sensor_can_be_a_panorama(opened, tree):
    """Its own lens replaces the platform's field of view."""
    tree["camera"].update(fov_deg=60.0, lens=None)
    sim = opened(**{"sensors": {"eye": {}, "around": {"lens": PANORAMA}}, "time.step_s": 1e-6})
    eye, around = (sim.frame(index, ["instance"]) for index in range(2))
    np.testing.assert_allclose(np.diag(around.camera.K)[:2], WIDTH / (2.0 * np.pi))
    assert np.diag(eye.camera.K)[0] == pytest.approx(0.5 * WIDTH / np.tan(np.radians(30.0)))
