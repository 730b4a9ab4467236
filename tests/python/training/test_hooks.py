"""Hooks of cameras and drivers: what moves with what, what is held, what a name means."""

from __future__ import annotations

import jsonschema
import numpy as np
import pytest
from tests.python.training import camera_hooks

import perilune
from perilune.base import rotations
from perilune.cli.json_schema import config_schema
from perilune.config import ConfigError
from perilune.document.loader import read_tree

HOOKS = "tests.python.training.camera_hooks"


def opened(scene_file, trajectory=None, **changes):
    small = {"camera.width": 48, "camera.height": 32, "render.samples": 2}
    if trajectory is not None:
        small["camera.trajectory"] = trajectory
    return perilune.open(scene_file, overrides={**small, **changes})


def in_camera(sim, index, when):
    """The satellite's place in the camera's axes as the shutter opens or closes."""
    camera, world = sim.camera_poses(index)[when], sim.world(index)
    turn = rotations.conjugate(camera[3:])
    return rotations.rotate(turn, world.poses["sat"][when, :3] - camera[:3])


@pytest.mark.parametrize("way", ["file", "code"])
def test_one_pose_moves_with_its_target(scene_file, way):
    """In a tenth of a second a satellite moves 760 m; beside it, the camera sees it stand."""
    exposure = {"camera.exposure_time_s": 0.1, "render.samples": 8}
    if way == "file":
        sim = opened(scene_file, {"kind": "hook", "hook": f"{HOOKS}:still"}, **exposure)
    else:
        small = {"camera.width": 48, "camera.height": 32, **exposure}
        sim = perilune.open(scene_file, overrides=small, trajectory=camera_hooks.still)
    assert np.linalg.norm(np.diff(sim.camera_poses(3)[:, :3], axis=0)) > 700.0
    opening, closing = (in_camera(sim, 3, when) for when in range(2))
    assert np.allclose(opening, closing, atol=1e-6)
    still = opened(scene_file, {"kind": "hook", "hook": f"{HOOKS}:still"})
    moved, sharp = (s.frame(3, ["objects", "rgb"]) for s in (sim, still))
    assert (moved.objects["bbox_visib"] == sharp.objects["bbox_visib"]).all()
    assert np.abs(moved["rgb"].astype(float) - sharp["rgb"]).mean() < 4.0


def test_what_one_pose_moves_with(scene_file):
    """What is nearest, or what the key `target` names."""
    hook = {"kind": "hook", "hook": f"{HOOKS}:still"}
    exposure = {"camera.exposure_time_s": 0.1}
    far = opened(scene_file, {**hook, "target": "earth"}, **exposure)
    assert np.linalg.norm(np.diff(far.camera_poses(3)[:, :3], axis=0)) == 0.0
    with pytest.raises(ConfigError, match=r"trajectory\.target.*no entry named 'stat'.*sat"):
        opened(scene_file, {**hook, "target": "stat"})


def test_look_at(scene_file):
    sim = opened(scene_file, {"kind": "hook", "hook": f"{HOOKS}:riding"})
    for index in (0, 5):
        assert np.allclose(in_camera(sim, index, 0), [0.0, 0.0, 12.0], atol=1e-6)
    own = [sim.frame(index, ["objects"]).objects[0] for index in (0, 5)]
    assert np.allclose(own[0]["R_m2c"], own[1]["R_m2c"], atol=1e-9)  # it turns with the satellite
    world = sim.world(0)
    for arguments, text in (
        (("stat", [1, 0, 0]), "no entry named 'stat'"),
        (("sat", [0, 0, 0]), "at the point that it looks at"),
        (("sat", [1, 0]), "position_m: must be three"),
        (("sat", "here"), "position_m: must be three"),
    ):
        with pytest.raises(ValueError, match=text):
            perilune.look_at(world, *arguments)
    with pytest.raises(ValueError, match="frame: no 'rws'; did you mean 'rsw'"):
        perilune.look_at(world, "sat", [1, 0, 0], frame="rws")


DEFAULTS = {
    "orbit_object": {"target": "sat", "distance_m": 15},
    "fixed": {"target": "sat", "position_m": [10, 8, 6]},
    "random_box": {"around": "sat", "min_m": [-14] * 3, "max_m": [-8] * 3, "target": "sat"},
    "linear": {
        "target": "sat", "start": {"position_m": [30, 0, 4]}, "end": {"position_m": [10, 2, 2]},
    },
    "spiral": {"target": "sat", "r_start_m": 15},
    "spiral-yz": {"target": "sat", "r_start_m": 15, "plane": "yz"},
    "spiral-normal": {"target": "sat", "r_start_m": 15, "normal": [0.1, 1, 0]},
    "flyby": {"target": "sat", "closest_m": 10, "before_m": 20},
    "centred_target": {"target": "sat"},
    "relative": {"target": "sat", "ellipse": {"radial_m": 12}, "positions": 9},
    "relative-lvlh": {"target": "sat", "frame": "lvlh", "ellipse": {"radial_m": 12},
                      "positions": 9},
    "relative-ahead": {"target": "sat", "state": {"position_m": [0, 15, 0]}, "positions": 9},
    "relative-normal": {"target": "sat", "state": {"position_m": [0, 0, 15]}, "positions": 9,
                        "duration_s": 300.0},
    "hook": {"hook": f"{HOOKS}:riding"},
}  # fmt: skip


@pytest.mark.parametrize("name", DEFAULTS)
def test_defaults_show_the_target(scene_file, name):
    """In all frames of a run; the image does not roll over."""
    kind = name.partition("-")[0]
    times = {"time.frames_per_scene": 9, "time.step_s": 20}
    sim = opened(scene_file, {"kind": kind, **DEFAULTS[name]}, **times)
    smooth = kind in ("linear", "spiral", "flyby", "relative", "centred_target")
    before = None
    for index in range(9):
        row = sim.frame(index, ["objects"]).objects[0]
        assert row["in_view"]
        assert row["px_count_visib"] > 10, index
        pose = sim.camera_poses(index)[0]
        if smooth and before is not None:
            turn = rotations.multiply(rotations.conjugate(before), pose[3:])
            _, angle = rotations.to_axis_angle(turn)
            assert np.degrees(angle) < 75.0, index  # rolling over is half a turn
        before = pose[3:]


def test_exposures_of_defaults_are_sharp(scene_file):
    """Where the view was along `up` the camera rolled while the shutter was open: a ghost."""
    trajectory = {"kind": "relative", "target": "sat", "ellipse": {"radial_m": 12}}
    sim = opened(scene_file, trajectory, **{"camera.exposure_time_s": 0.2})
    ends = sim.camera_poses(0)
    turn = rotations.multiply(rotations.conjugate(ends[0, 3:]), ends[1, 3:])
    assert np.degrees(rotations.to_axis_angle(turn)[1]) < 0.1


def test_one_word_for_functions(scene_file):
    """`function`, the name before, is understood; both are not."""
    sims = [
        opened(scene_file, {"kind": "hook", key: f"{HOOKS}:riding"}) for key in ("hook", "function")
    ]
    assert sims[0].config.camera == sims[1].config.camera
    assert (sims[0].camera_poses(2) == sims[1].camera_poses(2)).all()
    tree = read_tree(scene_file)
    schema = jsonschema.Draft202012Validator(config_schema())  # test_schema.py checks it itself
    for key in ("hook", "function"):
        tree["camera"]["trajectory"] = {"kind": "hook", key: "m:f"}
        tree["spacecraft"]["sat"]["orbit"] = {"kind": "hook", "around": "earth", key: "m:f"}
        schema.validate(tree)
    both = {"kind": "hook", "hook": f"{HOOKS}:riding", "function": f"{HOOKS}:still"}
    with pytest.raises(ConfigError, match=r"trajectory\.function.*was the name of `hook`"):
        opened(scene_file, both)
    with pytest.raises(ConfigError, match=r"trajectory\.hoook: unknown key; did you mean 'hook'"):
        opened(scene_file, {"kind": "hook", "hoook": f"{HOOKS}:riding"})


def test_driver_hooks_are_held(scene_file):
    """Called once a draw, told the first step of it, and held for `interval` steps."""
    driver = {"hook": f"{HOOKS}:counted", "ideal": 30.0, "clip_min": 20.0, "clip_max": 60.0}
    changes = {"camera.fov_deg": {**driver, "interval": 4}, "time.frames_per_scene": 8}
    camera_hooks.CALLS.clear()
    sim = opened(scene_file, **changes)
    found = [sim.frame(i, ["depth"]).meta["drivers"]["camera.fov_deg"] for i in range(9)]
    assert found == [30.0] * 4 + [34.0] * 4 + [38.0]
    assert camera_hooks.CALLS == [0, 4, 8]
    later = opened(scene_file, **changes).frame(6, ["depth"])
    assert later.meta["drivers"]["camera.fov_deg"] == 34.0  # in any order


GREY = {
    "materials.paint": {
        "hook": f"{HOOKS}:grey",
        "ideal": {"nodes": {"skin": {"type": "principled", "base_color": [0.5] * 3}}},
    },
    "spacecraft.sat.materials": [{"material": "*", "use": "paint"}],
}


def test_reflectance_of_a_hook(scene_file):
    """A graph of any structure, drawn once a scene; the same in any order, recorded, replayed."""
    changes = {**GREY, "time.frames_per_scene": 2}
    sim = opened(scene_file, **changes)
    samples = [sim.frame(index, ["rgb"]) for index in range(8)]
    drawn = [sample.meta["drivers"]["materials.paint"] for sample in samples]
    assert drawn[0] == drawn[1] != drawn[2] == drawn[3]
    assert {len(graph["nodes"]) for graph in drawn} == {1, 3}
    again = opened(scene_file, **changes)
    for index in (6, 1, 7, 0):
        assert (again.frame(index, ["rgb"])["rgb"] == samples[index]["rgb"]).all()
    without = opened(scene_file, **{**changes, "drivers.strength": 0.0})
    plain = {"materials.paint": GREY["materials.paint"]["ideal"]}
    ideal = opened(scene_file, **{**changes, **plain})
    assert (without.frame(3, ["rgb"])["rgb"] == ideal.frame(3, ["rgb"])["rgb"]).all()
    assert (samples[3]["rgb"] != ideal.frame(3, ["rgb"])["rgb"]).any()
    small = {"camera.width": 48, "camera.height": 32, "render.samples": 2}
    replayed = perilune.open(scene_file, overrides={**small, **changes}, replay=samples[5].meta)
    assert (replayed.frame(5, ["rgb"])["rgb"] == samples[5]["rgb"]).all()


def test_faulty_reflectance_of_a_hook(scene_file):
    bad = {**GREY["materials.paint"], "hook": f"{HOOKS}:broken"}
    sim = opened(scene_file, **{**GREY, "materials.paint": bad})
    with pytest.raises(ConfigError, match=r"materials\.paint\.nodes\.skin\.base_colour: unknown"):
        sim.frame(0, ["rgb"])
    with pytest.raises(ConfigError, match=r"materials\.paint\.hook: 'math:gcd' must return a sec"):
        opened(scene_file, **{**GREY, "materials.paint": {**bad, "hook": "math:gcd"}})
    fog = {"shape": "ellipsoid", "parent": "sat", "radii_m": [5, 5, 5], "material": "paint"}
    with pytest.raises(ConfigError, match=r"volumes\.fog\.material: 'paint' is drawn by a hook"):
        opened(scene_file, **{**GREY, "volumes.fog": fog})
