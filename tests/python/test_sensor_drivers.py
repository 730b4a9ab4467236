"""Every number of the image sensor takes drivers, of every kind; and clean and degraded images of a
frame come together."""

from __future__ import annotations

import copy
from typing import get_args

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.camera.imaging import sensor_of
from perilune.config import ConfigError
from perilune.config.sensor import ImageSensor
from perilune.document.loader import read_tree

COUNTS = {"bits", "serial", "lag_frames"}
"""Keys that fix a count or an identity."""
CONSTANT = {"serial", "bits", "mosaic", "exposure_s", "quantum_efficiency"}
"""What the core is told of a sensor that no driver changes: the efficiency is in `band_share`."""
FULL = {
    "f_number": 3.0, "transmission": 0.8, "vignetting": 2.0,
    "vignetting_profile": [[5.0, 0.9], [20.0, 0.5]],
    "point_spread": {"sigma_px": 0.6, "wings": 0.02, "wing_radius_px": 3.0, "wing_beta": 1.6},
    "lens_flare": {"ghosts": [{"scale": -0.5, "radius_deg": 2.0, "intensity": [0.1, 0.2, 0.3]}],
                   "baffle_deg": [20.0, 40.0]},
    "exposure": {"percentile": 90.0, "key": 0.5, "window": [0.1, 0.1, 0.9, 0.9], "saturated": 0.3,
                 "min_ms": 0.02, "max_ms": 900.0, "step_ms": 0.01, "times_ms": [0.1, 5.0],
                 "gains": [1.0, 2.0]},
    "pixel_um": 6.0, "quantum_efficiency": [0.3, 0.4, 0.5],
    "bands_nm": [[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]],
    "prnu": 0.01, "dark_current_e_s": 50.0, "dark_reference_c": 21.0, "dark_doubling_k": 6.0,
    "temperature_c": 30.0, "dark_nonuniform": 0.2, "hot_pixels": 0.01, "hot_current_e_s": 1e4,
    "dead_pixels": 0.01, "shift_us": 1.0, "drain": 0.5, "reset_us": 1.0,
    "cosmic_rays": {"flux_cm2_s": 4.0, "electrons_um": 70.0, "depth_um": 12.0},
    "full_well_e": 2e4, "read_noise_e": 9.0, "column_noise_e": 2.0, "column_flicker_e": 3.0,
    "row_noise_e": 4.0, "gain_e_dn": 5.0, "black_level_dn": 60.0, "compression": {"quality": 70.0},
}  # fmt: skip
"""A sensor that has every number."""
KINDS = {
    "normal": lambda v: {"ideal": v, "jitter_variance": (0.02 * v) ** 2,
                         "clip_min": min(v, 0.96 * v), "clip_max": max(v, 0.96 * v)},
    "uniform": lambda v: {"uniform": [min(v, 0.97 * v), max(v, 0.97 * v)]},
    "log_normal": lambda v: {"median": 0.98 * v, "log_variance": 1e-4, "clip_min": 0.97 * v,
                             "clip_max": v},
    "choice": lambda v: {"choice": [0.97 * v, 0.98 * v, 0.99 * v, v]},
}  # fmt: skip


@pytest.fixture(scope="module")
def tree(request):
    """The small scene."""
    root = request.config.rootpath
    tree = read_tree(root / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(root / "assets/models/smallsat.glb")
    tree["drivers"] = {"interval": 1}
    return tree


def opened(tree, sensor):
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = sensor
    return perilune.open(tree)


def mapped(node, change, path=""):
    """A copy with every number changed: change(path, number)."""
    if isinstance(node, dict):
        return {k: mapped(v, change, f"{path}.{k}" if path else k) for k, v in node.items()}
    if isinstance(node, list):
        return [mapped(v, change, f"{path}[{i}]") for i, v in enumerate(node)]
    return change(path, node)


def numbers(node):
    found = {}
    mapped(node, lambda path, value: found.__setitem__(path, value))
    return found


def keys_of_numbers(annotation):
    """Names of the keys below a model that hold numbers of any value, not counts."""
    found = set()
    for name, field in annotation.model_fields.items():
        text = str(field.annotation)
        for inner in models(field.annotation):
            found |= keys_of_numbers(inner)
        if "float" in text:
            found.add(name)
    return found


def models(annotation):
    parts = [annotation, *get_args(annotation)]
    found = [p for p in parts if isinstance(p, type) and hasattr(p, "model_fields")]
    for part in parts[1:]:
        found += [m for m in models(part) if m not in found]
    return found


def test_the_sensor_of_these_tests_has_every_number():
    names = {part.split("[")[0] for path in numbers(FULL) for part in path.split(".")}
    wanted = keys_of_numbers(ImageSensor)
    assert len(wanted) > 45
    assert wanted - names == {"aperture_mm"}  # which stands in for f_number


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_takes_a_driver(tree, kind):
    """All at once: every one is drawn anew in each frame and arrives in the core."""

    def drive(path, value):
        return KINDS[kind](value) if kind != "log_normal" or value > 0.0 else value

    sim = opened(tree, mapped(FULL, drive))
    driven = {path for path, value in numbers(FULL).items() if kind != "log_normal" or value > 0.0}
    configs, meta = zip(*(sim.config_at(i) for i in range(6)), strict=True)
    for path in driven:
        values = {drawn[f"camera.sensor.{path}"] for drawn in meta}
        assert len(values) > 1, path
    dumps = [numbers(config.camera.sensor.model_dump(mode="json")) for config in configs]
    for path in driven:
        assert len({dump[path] for dump in dumps}) > 1, path
    requests = [sensor_of(config.camera) for config in configs]
    for key, value in requests[0].items():
        if value is not None and key not in CONSTANT:
            assert any(str(value) != str(other[key]) for other in requests[1:]) or isinstance(
                value, (bool, str)
            ), key
    assert sim.frame(1, ["raw"])["raw"].std() > 0.0


@pytest.mark.parametrize("key", sorted(COUNTS))
def test_counts_take_none(tree, key):
    driver = {"ideal": 2.0, "jitter_variance": 1.0, "clip_min": 1.0, "clip_max": 3.0}
    sensor = {"exposure": {key: driver}} if key == "lag_frames" else {key: driver}
    with pytest.raises(ConfigError, match=rf"{key}.*takes no driver"):
        opened(tree, sensor)


def test_an_aperture_takes_a_driver(tree):
    sim = opened(tree, {"aperture_mm": {"uniform": [0.05, 0.1]}})
    assert len({sim.request(i)["sensor"]["f_number"] for i in range(4)}) == 4


def test_the_second_frame_allocates_nothing(tree, tmp_path):
    """With every stage on, a measured kernel and a flat field."""
    np.save(tmp_path / "psf.npy", np.full((9, 9), 1.0 / 81.0))
    np.save(tmp_path / "flat.npy", np.ones((5, 5)))
    files = {"point_spread": {"kernel": str(tmp_path / "psf.npy")},
             "flat_field": str(tmp_path / "flat.npy")}  # fmt: skip
    plain = copy.deepcopy(tree)
    plain["camera"]["sensor"] = FULL | files
    sim = perilune.open(plain, overrides={"render.tolerance_dn": 0.0})
    first = sim.frame(2, ["raw", "sensor_rgb"], threads=1)
    arrays = {name: first[name] for name in first}
    kept = {name: array.tobytes() for name, array in arrays.items()}
    before = _core.allocations()
    second = sim.frame(2, ["raw", "sensor_rgb"], threads=1, out=arrays)
    assert _core.allocations() == before
    assert {name: second[name].tobytes() for name in second} == kept


def test_clean_and_degraded_images_come_together(tree):
    """One call gives all; each is what it is when it is asked for alone, where all pixels have all
    samples: else samples serve the pictures that are asked for."""
    render = tree.get("render", {}) | {"tolerance_dn": 0.0}
    tree = {**tree, "render": render}
    sim = opened(tree, FULL)
    together = sim.frame(2, ["rgb", "radiance", "raw", "sensor_rgb", "depth"])
    for name in ("rgb", "radiance", "raw", "sensor_rgb"):
        alone = sim.frame(2, [name])[name]
        assert alone.tobytes() == together[name].tobytes(), name
    clean = perilune.open({**tree, "camera": {**tree["camera"], "sensor": None}})
    assert np.array_equal(clean.frame(2, ["rgb"])["rgb"], together["rgb"])
    assert not np.array_equal(together["rgb"], together["sensor_rgb"])
    assert together["rgb"].shape == together["sensor_rgb"].shape == (*together["raw"].shape, 3)
