"""Frames replayed from their metadata: the same bits, whatever the drivers would draw."""

from __future__ import annotations

import json

import numpy as np
import pytest

import perilune
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.export.check import check_bop

CHANNELS = ["rgb", "depth", "objects"]
NORMAL = {"ideal": 40.0, "jitter_variance": 4.0, "clip_min": 30.0, "clip_max": 50.0}
FOV = "camera.fov_deg"


@pytest.fixture
def scene(repo_dir):
    """The small scene with drivers of several kinds, some drawn at each step."""
    tree = read_tree(repo_dir / "tests/python/scene.yaml")
    tree["time"]["frames_per_scene"] = 4
    tree["camera"]["fov_deg"] = {**NORMAL, "group": "g"}
    tree["camera"]["trajectory"]["distance_m"] = [{"uniform": [12, 14], "group": "g"}, 16]
    tree["bodies"]["earth"]["albedo"] = {"uniform": [[0.1, 0.1, 0.1], [0.5, 0.6, 0.7]]}
    tree["sun"] = {"irradiance_w_m2": {"choice": [1361, 900.5], "weights": [1, 3]}}
    tree["spacecraft"]["sat"]["orbit"] = {
        "kind": "hook",
        "function": f"{__name__}:orbit",
        "around": "earth",
        "params": {"inclination_deg": {**NORMAL, "interval": 1}},
    }
    members = ["camera.fov_deg", "camera.trajectory.distance_m[0]"]
    matrix = [[1, 0.5], [0.5, 1]]
    group = {"members": members, "correlation": matrix, "step_interval": 1}
    tree["drivers"] = {"groups": {"g": group}}
    return tree


def orbit(rng, params):
    """A hook whose orbit, drawn at the scene's first step, takes a driven value."""
    return {
        "altitude_km": 500.0,
        "inclination_deg": params["inclination_deg"],
        "raan_deg": 90.0,
        "mean_anomaly_deg": float(rng.uniform(0.0, 360.0)),
    }


def same(first, second):
    return all(first[name].tobytes() == second[name].tobytes() for name in ("rgb", "depth")) and (
        first.objects.tobytes() == second.objects.tobytes()
    )


def test_replayed_frames_have_the_same_bits(scene, repo_dir):
    base = repo_dir / "tests/python"
    sim = perilune.open(scene, base=base, seed=11)
    assert "scene_drivers" in sim.frame(0, ["depth"]).meta
    for index in (0, 2, 5):
        sample = sim.frame(index, CHANNELS)
        meta = json.loads(json.dumps({k: v for k, v in sample.meta.items() if _plain(v)}))
        again = perilune.open(scene, base=base, replay=meta).frame(index, CHANNELS)
        assert same(sample, again)
        assert again.meta["drivers"] == sample.meta["drivers"]
        assert again.meta["scene_drivers"] == sample.meta["scene_drivers"]
        assert bool(sample.meta["scene_drivers"]) == (index % 4 != 0)


def _plain(value):
    try:
        json.dumps(value)
    except TypeError:
        return False
    return True


def test_the_recorded_values_win_over_the_seed(scene, repo_dir):
    """Replay takes the values, not the draws: another seed changes nothing that is driven."""
    base = repo_dir / "tests/python"
    meta = perilune.open(scene, base=base, seed=11).frame(2, CHANNELS).meta
    other = perilune.open(scene, base=base, seed=12, replay=meta)
    assert other.config_at(2)[1] == meta["drivers"]
    assert other.config_at(0)[1] == {**meta["drivers"], **meta["scene_drivers"]}
    assert other.config_at(4)[1] != meta["drivers"]


def test_values_as_overrides(scene, repo_dir):
    """Where no orbit is drawn once a scene from what varies faster, overrides are enough."""
    base = repo_dir / "tests/python"
    scene["spacecraft"]["sat"]["orbit"]["params"] = {"inclination_deg": 97.4}
    sim = perilune.open(scene, base=base)
    sample = sim.frame(6, CHANNELS)
    assert len(sample.meta["drivers"]) == 4
    again = perilune.open(scene, base=base, overrides=sample.meta["drivers"])
    assert not again.document.drivers
    assert same(sample, again.frame(6, CHANNELS))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"drivers": None}, "a key 'drivers'"),
        ({"index": -1}, "replay: index"),
        ({"drivers": {FOV: 40.0}}, "no value of the driver"),
        ({"scene_drivers": {"camera.fov": 40.0}}, "no driver 'camera.fov'; did you mean"),
    ],
)
def test_faulty_metadata(scene, repo_dir, change, text):
    base = repo_dir / "tests/python"
    sim = perilune.open(scene, base=base)
    meta = {"index": 2, "drivers": sim.config_at(2)[1], **change}
    meta = {key: value for key, value in meta.items() if value is not None}
    with pytest.raises(ConfigError, match=text):
        perilune.open(scene, base=base, replay=meta)


def test_values_of_a_bop_dataset(scene, repo_dir, tmp_path):
    sim = perilune.open(scene, base=repo_dir / "tests/python", seed=3)
    out = tmp_path / "driven"
    perilune.write_bop(sim, range(2), out, threads=1)
    cameras = json.loads((out / "train/000000/scene_camera.json").read_text())
    seed = json.loads((out / "dataset_info.json").read_text())["seed"]
    replay = cameras["1"]["frame"]
    assert replay["index"] == 1
    again = perilune.open(scene, seed, base=repo_dir / "tests/python", replay=replay)
    sample = again.frame(replay["index"], CHANNELS)
    assert same(sample, sim.frame(1, CHANNELS))
    assert np.allclose(np.ravel(sample.camera.K), cameras["1"]["cam_K"], rtol=1e-12)
    assert check_bop(out).findings == []
