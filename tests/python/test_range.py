"""Objects from half a metre to a million kilometres away: what labels say is what a ray caster in
double precision sees, and does not depend on what else is asked for."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.python.ray_caster import cast, corners_of, double_sided

import perilune
from perilune.document.loader import read_tree

LABELS = ["depth", "normal", "position", "object_coords", "semantic", "part", "instance"]
WIDTH = 96


def opened(
    repo_dir: Path,
    model: Path,
    size_m: float,
    distance_m: float,
    faces: str = "double_sided",
    **more: Any,
):
    """The model alone before the camera, which it fills by two thirds."""
    scene = read_tree(repo_dir / "tests/python/scene.yaml")
    scene["spacecraft"]["sat"] |= {"model": str(model), "size_m": size_m, "faces": faces}
    scene["camera"] |= {
        "width": WIDTH,
        "height": WIDTH,
        "fov_deg": math.degrees(2.0 * math.atan(0.75 * size_m / distance_m)),
        "trajectory": {"kind": "orbit_object", "target": "sat", "distance_m": distance_m},
    }
    return perilune.open(scene, base=repo_dir / "tests/python", overrides=more)


def check(
    repo_dir: Path, model: Path, size_m: float, distance_m: float, faces: str = "double_sided"
) -> None:
    """No pixel is wrong, and no place is off by a millionth of the object's radius. What sides are
    there is what the model says of itself: those of the file, or more."""
    sim = opened(repo_dir, model, size_m, distance_m, faces)
    sample = sim.frame(0, channels=[*LABELS, "objects"], threads=1)
    handle = sim.models["sat"]
    offset, scale = np.asarray(handle.offset), handle.metres_per_unit
    corners, both = corners_of(handle.model, scale, offset), handle.model.surfaces()["double_sided"]
    stated = double_sided(handle.model, model)
    assert (both == stated).all() if faces == "as_stated" else (both >= stated).all()
    turn, place = (np.asarray(sample.objects[0][key]) for key in ("R_m2c", "t_m2c"))
    found = cast(corners @ turn.T + place, both, np.asarray(sample.camera.K), WIDTH, WIDTH)
    assert found.mask.mean() > 0.03
    seen = np.isin(sample["instance"], sample.objects["instance_id"][:1])
    assert (seen != found.mask).sum() == 0
    expected = (found.position - place) @ turn
    error = np.linalg.norm(sample["object_coords"] - expected, axis=2)[seen]
    radius_m = 0.5 * scale * np.linalg.norm(np.ptp(handle.model.bounds, axis=0))
    assert error.max() < 1e-6 * radius_m
    depth = found.position[..., 2][seen]
    rounding = np.spacing(depth.astype(np.float32)).astype(np.float64)
    assert (np.abs(sample["depth"][seen] - depth) <= 0.5 * rounding + 1e-6 * radius_m).all()


@pytest.mark.parametrize("name", ["smallsat", "station"])
@pytest.mark.parametrize("fov_deg", [40.0, 5.0, 1.0, 0.2, 0.05])
def test_narrow_fields_of_view(repo_dir, name, fov_deg):
    distance_m = 0.75 * 10.0 / math.tan(math.radians(0.5 * fov_deg))
    check(repo_dir, repo_dir / f"assets/models/{name}.glb", 10.0, distance_m)


@pytest.mark.parametrize("name", ["iss", "voyager"])
@pytest.mark.parametrize(("fov_deg", "faces"), [(5.0, "double_sided"), (0.05, "as_stated")])
def test_published_models(repo_dir, data_dir, name, fov_deg, faces):
    distance_m = 0.75 * 50.0 / math.tan(math.radians(0.5 * fov_deg))
    check(repo_dir, data_dir / f"spacecraft/plain/{name}.glb", 50.0, distance_m, faces)


@pytest.mark.parametrize(
    ("size_m", "distance_m"), [(0.3, 0.5), (1e-6, 1e-3), (1.0, 1e3), (10.0, 1e6), (10.0, 1e9)]
)
def test_sizes_and_distances(repo_dir, size_m, distance_m):
    check(repo_dir, repo_dir / "assets/models/smallsat.glb", size_m, distance_m)


@pytest.mark.parametrize("distance_m", [30.0, 2e4])
def test_labels_do_not_depend_on_colour(repo_dir, distance_m):
    model = repo_dir / "assets/models/station.glb"
    plain = opened(repo_dir, model, 10.0, distance_m).frame(0, channels=LABELS, threads=1)
    for samples in (1, 8):
        for more in (
            {},
            {"render.force_on": ["antialiasing"]},
            {"render.force_off": ["antialiasing"]},
        ):
            sim = opened(repo_dir, model, 10.0, distance_m, **{"render.samples": samples} | more)
            found = sim.frame(0, channels=["rgb", *LABELS], threads=2)
            for label in LABELS:
                np.testing.assert_array_equal(found[label], plain[label], err_msg=label)


def test_light_does_not_depend_on_the_distance(repo_dir):
    """Shadow rays and bounces start at the object, wherever the camera is."""
    model = repo_dir / "assets/models/station.glb"
    views = []
    for distance_m in (3e4, 3e8):
        more = {"render.samples": 8, "render.force_off": ["planetshine"]}
        place = [distance_m * part for part in (0.48, -0.8, 0.36)]
        fixed = {"kind": "fixed", "target": "sat", "position_m": place, "frame": "lvlh"}
        more["camera.trajectory"] = fixed
        sim = opened(repo_dir, model, 10.0, distance_m, **more)
        views.append(sim.frame(0, channels=["rgb", "part"]))
    near, far = views
    same = (near["part"] == far["part"]) & (near["part"] > 0)
    assert same.sum() > 480
    off = np.abs(near["rgb"].astype(float) - far["rgb"])[same]
    assert off.mean() < 1.0
    assert near["rgb"][same].mean() > 10.0  # or there is nothing to compare
