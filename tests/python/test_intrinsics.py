"""A matrix K of another size of image: said where it is seen."""

from __future__ import annotations

import warnings

import pytest
from tests.python.oaisys.oaisys_files import FOLDER

from perilune import document as cfg
from perilune.config.errors import ConfigWarning
from perilune.document.loader import read_tree

K = [500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0]


@pytest.fixture
def scene(repo_dir):
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    for key in ("fov_deg", "focal_px", "K"):
        tree["camera"].pop(key, None)
    tree["camera"] |= {"width": 640, "height": 480, "K": K}
    return tree


def told(repo_dir, scene, **overrides) -> list[str]:
    with warnings.catch_warnings(record=True) as rows:
        warnings.simplefilter("always")
        cfg.load(scene, overrides, base=repo_dir / "tests/python")
    return [str(row.message) for row in rows if row.category is ConfigWarning]


def test_an_override_of_the_size(repo_dir, scene):
    assert told(repo_dir, scene) == []
    (line,) = told(repo_dir, scene, **{"camera.width": 320, "camera.height": 240})
    assert line == (
        "configuration: camera.K is that of 640x480, and the image now 320x240; change K too, or "
        "give fov_deg, which holds for any size"
    )
    half = [250.0, 0.0, 160.0, 0.0, 250.0, 120.0, 0.0, 0.0, 1.0]
    size = {"camera.width": 320, "camera.height": 240}
    assert told(repo_dir, scene, **size, **{"camera.K": half}) == []
    assert told(repo_dir, scene, **{"camera.width": 640}) == []
    fov = {"camera.width": 64, "camera.K": None, "camera.fov_deg": 30.0}
    assert told(repo_dir, scene, **fov) == []


def test_a_focal_length_in_pixels(repo_dir, scene):
    scene["camera"]["focal_px"] = scene["camera"].pop("K")[0]
    (line,) = told(repo_dir, scene, **{"camera.width": 320})
    assert "camera.focal_px is that of 640x480, and the image now 320x480" in line


def test_a_principal_point_outside(repo_dir, scene):
    scene["camera"]["width"] = 300
    (line,) = told(repo_dir, scene)
    assert "camera.K has its principal point at (320, 240), outside an image of 300x480" in line


def test_sensors(repo_dir, scene):
    scene["sensors"] = {
        "same": {},
        "small": {"width": 320, "height": 240},
        "own": {"width": 320, "height": 240, "fov_deg": 30.0},
        "wrong": {"width": 100, "K": K},
    }
    small, wrong = told(repo_dir, scene)
    assert "camera.K of sensors.small is that of 640x480, and the image of this sensor 320" in small
    assert "sensors.wrong.K has its principal point at (320, 240), outside" in wrong
    lines = told(repo_dir, scene, **{"camera.width": 600})
    expected = "camera.K of sensors.same is that of 640x480, and the image now 600"
    assert any(expected in line for line in lines)


def test_oaisys_files():
    with warnings.catch_warnings(record=True) as rows:
        warnings.simplefilter("always")
        cfg.load(FOLDER / "satellite_circular.json", {"camera.width": 64, "camera.height": 48})
    lines = [str(row.message) for row in rows if row.category is ConfigWarning]
    assert any("camera.K is that of 640x480, and the image now 64x48" in line for line in lines)
