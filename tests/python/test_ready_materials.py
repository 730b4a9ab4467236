"""The materials of assets/materials: they load, their drivers drive, and they keep their mean."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

import perilune

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "assets" / "materials"
NAMES = (
    *("anodised_aluminium", "black_paint", "carbon", "gold_mli", "mirror", "nozzle"),
    *("silver_mli", "solar_cells", "white_paint"),
)
NEAR_M = 30.0


def scene(material: dict[str, Any], distance_m: float = 3.6, **camera: Any) -> dict[str, Any]:
    """The test object, wholly of a material, over a planet that is not in sight."""
    place = [0.0, -distance_m, 0.1 * distance_m]
    still = {"time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60.0}, "root": "planet"}
    planet = {"kind": "ellipsoid", "radii_km": 6378.0, "gm_km3_s2": 398600.4418, "albedo": 0.4}
    thing = {
        "model": str(ROOT / "assets" / "models" / "test_object.glb"),
        "metres_per_unit": 1.0,
        "centre": "origin",
        "orbit": {"around": "planet", "kind": "kepler", "position_km": [0.0, 0.0, 6900.0]},
        "materials": [{"material": "*", "use": "m"}],
    }
    view = {"kind": "fixed", "target": "object", "position_m": place}
    exposure = {"mode": "fixed", "white_radiance_w_m2_sr": 380.0}
    return {
        "version": 1,
        "name": "ready",
        **still,
        "sun": {"direction": [0.75, -0.52, 0.42]},
        "bodies": {"planet": planet},
        "materials": {"m": material},
        "spacecraft": {"object": thing},
        "camera": {"width": 24, "height": 13, "fov_deg": 33.0, "trajectory": view}
        | {"exposure": exposure}
        | camera,
        "render": {"samples": 2, "max_bounces": 1},
    }


def opened(material: dict[str, Any], seed: int = 1, **more: Any) -> perilune.Simulation:
    return perilune.open(scene(material, **more), base=ROOT, seed=seed)


def of_file(name: str, **beside: Any) -> dict[str, Any]:
    return {"file": str(FOLDER / f"{name}.yaml"), **beside}


def rgb(material: dict[str, Any], frame: int = 0) -> NDArray[np.uint8]:
    return opened(material)[frame]["rgb"]


def radiance(material: dict[str, Any]) -> NDArray[np.float32]:
    """Before it is rounded: a grain of paint is less than a digital number."""
    return opened(material).frame(0, channels=["radiance"])["radiance"]


def held(name: str) -> dict[str, Any]:
    content = yaml.safe_load((FOLDER / f"{name}.yaml").read_text())
    assert isinstance(content, dict)
    return content


def test_all_files_are_tested() -> None:
    assert sorted(path.name for path in FOLDER.iterdir()) == [f"{name}.yaml" for name in NAMES]


@pytest.mark.parametrize("name", NAMES)
def test_without_jitter_a_material_is_its_ideal_to_the_bit(name: str) -> None:
    plain = held(name)
    drivers = plain.pop("drivers")
    assert drivers["jitter_strength"] == 0.0
    driven = {f"OAISYS_{key}" for key in drivers["drivers"]}
    assert driven == {key for key in plain["nodes"] if key.startswith("OAISYS_")}
    for key, driver in drivers["drivers"].items():
        value = plain["nodes"][f"OAISYS_{key}"]["value"]
        assert driver["clip_min"] <= driver["ideal"] == value <= driver["clip_max"]
    ideal = rgb(plain)
    assert np.array_equal(rgb(of_file(name)), ideal)
    assert not np.array_equal(rgb(of_file(name, drivers={"jitter_strength": 1.0})), ideal)


@pytest.mark.parametrize("name", NAMES)
def test_every_driver_changes_the_picture(name: str) -> None:
    drivers = held(name)["drivers"]["drivers"]
    for key, driver in drivers.items():
        low, high = (
            radiance(of_file(name, drivers={"drivers": {key: driver[end]}}))
            for end in ("clip_min", "clip_max")
        )
        assert not np.array_equal(low, high), key


SEEDS = 6  # of fewer the scatter of glints is not known


@pytest.mark.parametrize("name", NAMES)
def test_receding_materials_keep_their_mean(name: str) -> None:
    """The same view from farther and farther away, in pixels of 7 cm, 28 cm and 1.1 m."""
    means, errors = [], []
    for factor in (1, 4, 16):
        camera = {"width": 32 // factor, "height": max(16 // factor, 1)}
        frames = []
        for seed in range(SEEDS):
            tree = scene(of_file(name), NEAR_M * factor, **camera, fov_deg=4.4 / factor)
            tree["render"] |= {"samples": 10 * factor**2, "tolerance_dn": 0.0}
            sim = perilune.open(tree, base=ROOT, seed=seed)
            frames.append(sim.frame(0, channels=["radiance"])["radiance"].mean(axis=(0, 1)))
        means.append(np.mean(frames, axis=0))
        errors.append(np.std(frames, axis=0, ddof=1) / np.sqrt(SEEDS))
    assert (means[0] > 0.0).all()
    for far, error in zip(means[1:], errors[1:], strict=True):
        noise = np.hypot(error, errors[0])
        assert (np.abs(far - means[0]) < 4.0 * noise + 0.04 * means[0]).all(), (means, errors)
