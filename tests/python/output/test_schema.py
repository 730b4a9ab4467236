"""The JSON Schema of configurations: takes what the loader takes, refuses misspelt keys."""

from __future__ import annotations

import copy
import json

import jsonschema
import pytest
from tests.python.command_line import command

import perilune
from perilune.config import ConfigError
from perilune.document import load
from perilune.document.loader import read_tree


@pytest.fixture(scope="module")
def validator():
    done = command("schema", "--json")
    assert done.returncode == 0
    schema = json.loads(done.stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def test_every_configuration_of_the_repository_is_valid(validator, repo_dir):
    paths = [*sorted((repo_dir / "configs").glob("*.yaml")), repo_dir / "tests/python/scene.yaml"]
    assert len(paths) > 5
    for path in paths:
        assert [e.message for e in validator.iter_errors(read_tree(path))] == [], path


def changed(tree, path, value):
    tree = copy.deepcopy(tree)
    *parents, last = path.split(".")
    node = tree
    for key in parents:
        node = node.setdefault(key, {})
    if value is None:
        del node[last]
    else:
        node[last] = value
    return tree


DRIVER = {"ideal": 1.0, "jitter_variance": 0.1, "clip_min": 0.5, "clip_max": 2.0}

BAD = [
    ("camera.widht", 640),
    ("camera.width", "640"),
    ("camera.width", DRIVER),
    ("camera.width", 0),
    ("camera.trajectory.kind", "orbits"),
    ("camera.trajectory.distance", 3.0),
    ("camera.trajectory.distance_m", [1.0, 2.0, 3.0]),
    ("camera.trajectory", None),
    ("camera.trajectory", {"kind": "linear", "target": "smallsat", "positions": 2}),
    ("camera.trajectory", {"kind": "hover", "target": "planet", "height_m": 1e5, "interval": 0}),
    ("sensors", {"left": {"trigger_interval": 1.5}}),
    ("sensors", {"left": {"transformation": [0, 0, 0]}}),
    ("time.frames_per_scene", DRIVER),
    ("bodies.planet.kind", "moom"),
    ("bodies.planet.reflectance", "lamberts"),
    ("bodies.planet.map_center_lon_deg", DRIVER),
    ("bodies.planet.shape", 3),
    ("bodies.planet.shape", {"fle": "shape.obj"}),
    ("bodies", {}),
    ("spacecraft.smallsat.orbit.eccentricity", -0.1),
    ("spacecraft.smallsat.orbit.eccentricity", {**DRIVER, "variance": 1.0}),
    ("spacecraft.smallsat.orbit.eccentricity", {"ideal": 1.0}),
    ("spacecraft.smallsat.model", None),
    ("render.channels", ["rgb", "dept"]),
    ("render.force_on", ["shadows"]),
    ("labels.levels", ["2 kinds"]),
    ("drivers.strength", DRIVER),
    ("drivers.groups", {"g": {"jitter_strength": DRIVER}}),
    ("drivers.groups", {"g": {"members": [1], "correlation": [[1]]}}),
    ("drivers.groups", {"choice": [{}]}),
    ("camera.fov_deg", {**DRIVER, "ideal": [1.0, 1.0]}),
    ("camera.fov_deg", {"choice": []}),
    ("camera.fov_deg", {"choice": [30.0, 40.0], "weights": [1, -1]}),
    ("camera.fov_deg", {"median": 1.0, "log_variance": 1.0}),
    ("camera.fov_deg", {"hook": "math:sin"}),
    ("bodies.planet.reflectance", {"uniform": [0.0, 1.0]}),
    ("bodies.planet.albedo", {**DRIVER, "ideal": [1.0, "x", 1.0]}),
    ("version", 2),
    ("rendr", {}),
]


@pytest.mark.parametrize(("path", "value"), BAD)
def test_what_the_schema_refuses_the_loader_refuses(validator, repo_dir, path, value):
    demo = repo_dir / "configs" / "demo.yaml"
    tree = changed(read_tree(demo), path, value)
    assert not validator.is_valid(tree)
    with pytest.raises(ConfigError):
        perilune.open(tree, base=demo.parent)


LOG_NORMAL = {"median": 1.0, "log_variance": 0.1, "clip_min": 0.5, "clip_max": 2.0}
COLOUR = {**DRIVER, "ideal": [1.0, 0.9, 0.8], "jitter_variance": [0.0, 0.1, 0.2], "jointly": True}
HOOK = {"hook": "math:sin", "ideal": 1.0, "clip_min": 0.5, "clip_max": 2.0, "params": {}}
FLY = {"kind": "hover", "target": "planet", "height_m": 1e5}

GOOD = [
    ("bodies.planet.albedo", COLOUR),
    ("bodies.planet.albedo", {"uniform": [[0, 0, 0], [1, 1, 1]]}),
    ("bodies.planet.albedo", {"choice": [0.3, [0.1, 0.2, 0.3]], "weights": [1, 2]}),
    ("camera.fov_deg", LOG_NORMAL),
    ("camera.fov_deg", HOOK),
    ("camera.fov_deg", {"choice": [30.0, 40.0]}),
    ("bodies.planet.reflectance", {"choice": ["lambert", "metallic_roughness"]}),
    ("camera.trajectory", {"choice": [FLY, {**FLY, "height_m": DRIVER["ideal"]}]}),
    ("camera.trajectory.distance_m", {"uniform": [[1.0, 5.0], [2.0, 6.0]]}),
    ("drivers", {"groups": {"g": {"jitter_strength": 0, "step_interval": 3}}}),
    ("drivers", {"groups": {"g": {"members": ["seed"], "correlation": [[1]]}}}),
    ("bodies.planet.radii_km", 6378.0),
    ("bodies.planet.shape", "shape.obj"),
    ("bodies.planet.shape", {"file": "shape.obj", "smooth": False}),
    ("bodies.planet.shape", {"choice": ["shape.obj", {"file": "shape.glb"}]}),
    ("bodies.planet.albedo", [0.1, DRIVER, 0.3]),
    ("bodies.planet.albedo", DRIVER),
    ("bodies.planet.rotation", {"rotation_deg": [0.0, 10.0, DRIVER]}),
    ("camera.trajectory.distance_m", 9.0),
    ("camera.trajectory.distance_m", [DRIVER, 9.0]),
    ("camera.trajectory.distance_m", DRIVER),
    ("camera.fov_deg", {**DRIVER, "interval": 5, "strength": 0.5}),
    ("camera.exposure", {"mode": "auto"}),
    ("camera.trajectory", {"kind": "hover", "target": "planet", "height_m": 1e5, "lat_deg": 3}),
    (
        "camera.trajectory",
        {
            "kind": "linear",
            "target": "smallsat",
            "start": {"position_m": [DRIVER, 0, 30]},
            "end": {"position_m": [0, 0, 10]},
            "positions": 9,
            "roll_deg": [0, DRIVER],
        },
    ),
    ("sensors", {"left": {}, "right": {"transformation": [DRIVER, 0, 0, 1, 0, 0, 0]}}),
    ("sensors", {"tilted": {"transformation": {"rotation_deg": [DRIVER, 0, 0]}}}),
    ("time.frames_per_scene", 4),
    ("spacecraft.smallsat.class", "satellite"),
    ("spacecraft.smallsat.obj_id", 4),
    ("render.samples", 4),
]


@pytest.mark.parametrize(("path", "value"), GOOD)
def test_what_the_loader_takes_the_schema_takes(validator, repo_dir, path, value):
    demo = repo_dir / "configs" / "demo.yaml"
    plain = read_tree(demo)
    for key in ("ocean", "atmosphere", "clouds"):  # which not every shape and reflectance has
        del plain["bodies"]["planet"][key]
    tree = changed(plain, path, value)
    load(tree, base=demo.parent)
    assert [error.message for error in validator.iter_errors(tree)] == []


def test_keys_are_described(validator):
    camera = validator.schema["$defs"]["Camera"]["properties"]
    assert "field of view" in json.dumps(camera["fov_deg"])
    assert "x-perilune" not in json.dumps(validator.schema)
