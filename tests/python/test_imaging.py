"""The image sensor through the Python layer: configuration, channels, exposure, drivers."""

from __future__ import annotations

import copy

import numpy as np
import pytest

import perilune
from perilune.camera.imaging import sensor_of
from perilune.config import ConfigError
from perilune.config.sensor import ImageSensor
from perilune.config.sensor_presets import PRESETS
from perilune.document.loader import read_tree

CLEAN = ["rgb", "radiance", "depth"]


@pytest.fixture(scope="module")
def tree(request):
    """The small scene."""
    root = request.config.rootpath
    tree = read_tree(root / "tests/python/scene.yaml")
    tree["spacecraft"]["sat"]["model"] = str(root / "assets/models/smallsat.glb")
    return tree


def opened(tree, sensor, **overrides):
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = sensor
    return perilune.open(tree, **overrides)


def value_of(plan, name):
    return next(row["value"] for row in plan if row["name"] == name)


def test_presets_say_where_they_are_from():
    assert len(PRESETS) >= 4
    for preset in PRESETS.values():
        assert len(preset.source) > 40
        assert preset.assumed


def test_clean_channels_do_not_know_of_the_sensor(tree):
    # Adaptive sampling serves the most demanding of the pictures that are asked for.
    exact = {"render.tolerance_dn": 0.0}
    plain = perilune.open(tree, overrides=exact).frame(0, CLEAN)
    assert "exposure_s" not in plain.meta
    sim = opened(tree, {}, overrides=exact)
    beside = sim.frame(0, [*CLEAN, "raw", "sensor_rgb"])
    alone = sim.frame(0, ["raw"])
    for name in CLEAN:
        assert np.array_equal(plain[name], beside[name])
    assert beside["raw"].dtype == np.uint16
    assert beside["raw"].shape == plain["rgb"].shape[:2]
    assert beside["sensor_rgb"].dtype == np.uint8
    assert np.array_equal(alone["raw"], beside["raw"])
    assert beside.meta["exposure_s"] > 0.0
    assert value_of(plain.plan, "shot_noise") == 0
    assert value_of(beside.plan, "shot_noise") == 1


ROCK = {
    "version": 1,
    "time": {"epoch": "2026-03-20T12:00:00Z", "step_s": 60},
    "root": "rock",
    "bodies": {"rock": {"kind": "ellipsoid", "radii_km": 10.0, "gm_km3_s2": 0.1, "albedo": 0.2}},
    "sun": {"direction": [1.0, 1.0, 0.2]},
    "camera": {
        "width": 192, "height": 128, "fov_deg": 30.0,
        "trajectory": {"kind": "fixed", "target": "rock", "position_m": [50e3, 0.0, 0.0]},
    },
    "render": {"max_bounces": 0},
}  # fmt: skip


@pytest.mark.parametrize("percentile", [25.0, 50.0, 90.0])
def test_automatic_exposure_brings_the_percentile_to_the_key(percentile):
    """The meter sees the light of the Sun alone; here there is no other."""
    times = []
    for key in (0.25, 0.5):
        exposure = {"percentile": percentile, "key": key}
        sensor = {"exposure": exposure, "mosaic": "mono", "bits": 16, "vignetting": 0.0,
                  "gain_e_dn": 0.5, "full_well_e": 20000.0}  # fmt: skip
        sample = opened(ROCK, sensor).frame(0, ["raw", "radiance"])
        electrons = 0.5 * (sample["raw"][sample["radiance"].sum(2) > 0.0].astype(float) - 64.0)
        assert len(electrons) > 5000
        assert np.percentile(electrons, percentile) == pytest.approx(key * 20000.0, rel=0.01)
        times.append(sample.meta["exposure_s"])
    assert times[1] == pytest.approx(2.0 * times[0], rel=1e-12)


def test_fixed_exposure_is_the_shutters(tree):
    sensor = {"exposure": {"mode": "fixed"}}
    times = [0.0, 1e-4, 2e-4]
    samples = [
        opened(tree, sensor, overrides={"camera.exposure_time_s": time}).frame(0, ["raw"])
        for time in times
    ]
    assert [sample.meta["exposure_s"] for sample in samples] == times
    means = [sample["raw"].astype(float).mean() - 64.0 for sample in samples]
    assert abs(means[0]) < 0.5  # read noise of 1.6 DN in 1536 pixels: 10 standard errors
    assert means[2] == pytest.approx(2.0 * means[1], rel=0.05)


def test_every_number_carries_a_driver(tree):
    noise = {"ideal": 50.0, "jitter_variance": 400.0, "clip_min": 1.0, "clip_max": 200.0}
    sim = opened(tree, {"read_noise_e": noise})
    samples = [sim.frame(i, ["raw"]) for i in range(4)]
    values = [sample.meta["drivers"]["camera.sensor.read_noise_e"] for sample in samples]
    assert len(set(values)) == 4
    dark = [np.std(np.sort(sample["raw"].ravel())[:500].astype(float)) for sample in samples]
    assert np.argsort(values)[-1] == np.argsort(dark)[-1]


def test_dark_current_doubles_with_warmth(tree):
    camera = opened(tree, {"temperature_c": 34.0, "dark_doubling_k": 7.0}).config.camera
    assert sensor_of(camera)["dark_current"] == pytest.approx(4.0 * 5.0)


def test_without_a_sensor_there_are_no_digital_numbers(tree):
    with pytest.raises(ConfigError, match=r"'raw' needs the section camera\.sensor"):
        perilune.open(tree).frame(0, ["raw"])
    with pytest.raises(ConfigError, match=r"render\.channels: 'sensor_rgb' needs the section"):
        perilune.open(tree, overrides={"render.channels": ["sensor_rgb"]})


@pytest.mark.parametrize(
    ("sensor", "text"),
    [
        ({"fnumber": 4.0}, "f_number"),
        ({"mosaic": "rgbg"}, "mosaic"),
        ({"bands_nm": [[700.0, 600.0], [500.0, 600.0], [400.0, 500.0]]}, "bands_nm"),
        ({"black_level_dn": 4095.0}, "black_level_dn"),
        ({"quantum_efficiency": [0.0, 0.0, 0.0]}, "quantum_efficiency"),
        ({"exposure": {"min_ms": 3.0, "max_ms": 2.0}}, "min_ms"),
        ({"bits": 17}, "bits"),
    ],
)
def test_what_is_no_sensor_is_refused_by_name(tree, sensor, text):
    with pytest.raises(ConfigError, match=f"camera.sensor.*{text}"):
        opened(tree, sensor)


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_presets_are_defaults(tree, name):
    """Their values, but for what is given beside them; the full well fits the digits."""
    values = PRESETS[name].values
    sensor = opened(tree, {"preset": name}).config.camera.sensor
    alone = ImageSensor.model_validate(values)
    for key in values:
        assert getattr(sensor, key) == getattr(alone, key)
    assert opened(tree, {"preset": name, "read_noise_e": 1.5}).config.camera.sensor == (
        sensor.model_copy(update={"read_noise_e": 1.5})
    )
    digits = (2**sensor.bits - 1 - sensor.black_level_dn) * sensor.gain_e_dn
    assert 0.98 < digits / sensor.full_well_e < 1.4
    assert opened(tree, {"preset": name}).frame(0, ["raw"])["raw"].max() > sensor.black_level_dn


def test_an_unknown_preset_is_refused(tree):
    text = r"camera\.sensor\.preset.*no sensor 'cmv400'; did you mean 'cmv4000'\?.*msl_mardi"
    with pytest.raises(ConfigError, match=text):
        opened(tree, {"preset": "cmv400"})
    with pytest.raises(ConfigError, match=r"camera\.sensor\.preset"):
        opened(tree, {"preset": 3})


def test_sensors_of_a_platform_have_their_own(tree):
    tree = copy.deepcopy(tree)
    tree["camera"]["sensor"] = {}
    tree["sensors"] = {"left": {}, "right": {"sensor": {"mosaic": "mono", "bits": 8,
                                                        "black_level_dn": 4.0}}}  # fmt: skip
    sim = perilune.open(tree)
    assert sim.frame(0, ["raw"])["raw"].max() > 255
    assert sim.frame(1, ["raw"])["raw"].max() <= 255
