"""The reader of OAISYS files: what becomes of their keys, what is told, which errors name what."""

from __future__ import annotations

import copy
import json
import pickle
import re
import warnings

import numpy as np
import pytest
from tests.python.model_files import with_graphs
from tests.python.oaisys.oaisys_files import EARTH_M, FOLDER, SENSOR, failure, translated

import perilune
from perilune import document as cfg
from perilune.config import ConfigError
from perilune.document import oaisys

MESHES = "ASSET_SETUP.MESHES"


def test_it_is_known_by_its_sections(tree):
    assert oaisys.is_oaisys(tree)
    assert oaisys.is_oaisys({"SENSOR_SETUP": {}})
    assert not oaisys.is_oaisys({"version": 1, "camera": {}})


def test_the_fourth_listing(tree):
    found, _ = translated(tree)
    assert found["time"]["frames_per_scene"] == 10
    assert found["root"] == "planet"
    body = found["bodies"]["planet"]
    assert (body["kind"], body["radii_km"]) == ("earth", [6378.0] * 3)
    assert body["color_map"].endswith("earth_like.jpg")
    assert body["rotation"] == {
        "rotation_deg": [23.0, 0.0, 0.0],
        "rotation_deg_step_v": 0.1,
        "rotation_mode": "local",
    }
    craft = found["spacecraft"]["iss"]
    assert craft["metres_per_unit"] == pytest.approx(0.0000169332079 * EARTH_M, rel=1e-15)
    assert craft["attitude"] == {"rotation_deg": [30.0, 0.0, 0.0], "rotation_deg_step_v": 0.1}
    assert craft["orbit"] == {
        "kind": "circular",
        "around": "planet",
        "scale": [1.06396989] * 3,
        "rotation_deg": [30.0, 30.0, 0.0],
        "v_step": 0.01,
        "orbit_start": 0.3,
    }
    assert found["camera"]["K"] == [541.14, 0, 320, 0, 541.14, 240, 0, 0, 1]
    assert "sensors" not in found
    assert found["render"]["samples"] == 16
    assert found["render"]["max_bounces"] == 4
    assert found["render"]["channels"] == ["rgb", "depth", "semantic", "instance", "objects"]
    assert found["labels"]["ids"] == {
        "level_0": {"class_1": 1, "class_2": 2},
        "object": {"earth": 10, "iss": 20},
    }


def test_orbit_params_inside_and_beside_are_the_same(tree, iss):
    beside, _ = translated(tree)
    iss["meshParams"]["orbit_params"] = iss.pop("orbit_params")
    assert translated(tree)[0] == beside


def test_the_database(tree, iss):
    iss["orbit_params"] = {
        "type": "orbit_database",
        "orbit_type": "LEO",
        "parent": "planet",
        "v_step": 0.01,
        "orbit_start": 0.3,
    }
    assert translated(tree)[0]["spacecraft"]["iss"]["orbit"] == {
        "kind": "database",
        "class": "LEO",
        "around": "planet",
        "propagator": "circular",
        "v_step": 0.01,
        "orbit_start": [0.3, 0.3],
    }
    iss["orbit_params"]["orbit_type"] = "LEOO"
    text = failure(tree)
    assert f"{MESHES}[1].orbit_params.orbit_type: no 'LEOO'; did you mean 'LEO'?" in text


def test_a_custom_orbit_is_a_hook(tree, iss):
    params = {"type": "custom", "function": "m:f", "parent": "planet", "v_step": 0.01}
    iss["orbit_params"] = {**params, "params": {"a": 1}}
    orbit = translated(tree)[0]["spacecraft"]["iss"]["orbit"]
    assert orbit["kind"] == "hook"
    assert (orbit["hook"], orbit["params"]) == ("m:f", {"a": 1})
    assert cfg.load(translated(tree)[0], base=FOLDER).config.spacecraft["iss"].orbit.v_step == 0.01
    for wrong in ("ab", [1], 7):
        iss["orbit_params"]["params"] = wrong
        assert "orbit_params.params: must be a mapping, not " in failure(tree)


def test_metres_per_unit(tree, planet, general):
    """As stated; else the mean radius of what is orbited (science data of the core's table)."""
    tree["metres_per_unit"] = 1000.0
    found, _ = translated(tree)
    assert found["bodies"]["planet"]["radii_km"] == [1.0] * 3
    assert found["camera"]["trajectory"]["distance_m"] == [2.0, 2.0]
    del tree["metres_per_unit"]
    planet["meshFilePath"], planet["meshInstanceName"] = "mars.blend", "red"
    found, _ = translated(tree)
    mars_km = found["bodies"]["planet"]["radii_km"][0]
    assert mars_km == pytest.approx(3389.5, abs=0.1)
    assert found["camera"]["trajectory"]["distance_m"][0] == pytest.approx(2.0 * mars_km)
    tree["metres_per_unit"] = 0
    assert "metres_per_unit: must be positive" in failure(tree)


def test_a_scaled_planet(tree, planet):
    """Orbits are in scene units, whatever the planet's size; ours are in its radii."""
    planet["scale"] = [0.5, 0.25, 0.5]
    found, _ = translated(tree)
    assert found["bodies"]["planet"]["radii_km"] == [3189.0, 1594.5, 3189.0]
    scale = found["spacecraft"]["iss"]["orbit"]["scale"]
    assert scale == pytest.approx([2.12793978, 4.25587956, 2.12793978])


@pytest.mark.parametrize("name", ["planet", "earth"])
def test_names_and_instance_names(tree, iss, general, name):
    iss["orbit_params"]["parent"] = name
    iss["name"], iss["meshParams"]["meshInstanceName"] = "station 1", "iss"
    found, _ = translated(tree)
    assert found["spacecraft"]["station_1"]["orbit"]["around"] == "planet"
    assert found["camera"]["trajectory"]["target"] == "station_1"


def test_a_name_wins_over_an_instance_name(tree, planet, iss):
    moon = copy.deepcopy(iss)
    moon["name"], moon["meshParams"]["meshFilePath"] = "earth", "moon.blend"
    moon["meshParams"]["scale"] = [0.27] * 3
    moon["orbit_params"]["scale"] = [60.0] * 3
    tree["ASSET_SETUP"]["MESHES"].append(moon)
    iss["orbit_params"]["parent"] = "earth"
    found, _ = translated(tree)
    assert found["spacecraft"]["iss"]["orbit"]["around"] == "earth"
    assert found["bodies"]["earth"]["kind"] == "moon"
    assert found["bodies"]["earth"]["orbit"]["around"] == "planet"


def test_an_unknown_parent(tree, iss):
    iss["orbit_params"]["parent"] = "plant"
    text = failure(tree)
    assert f"{MESHES}[1].orbit_params.parent: no mesh named 'plant'; did you mean 'planet'" in text


def test_blend_files_become_gltf_beside_them(tree, iss):
    _, told = translated(tree)
    assert f"{MESHES}[1].meshParams.meshFilePath: read from ../../assets/models/station.glb" in told
    iss["meshParams"]["meshFilePath"] = "../../assets/models/station.glb"
    _, told = translated(tree)
    assert f"{MESHES}[1].meshParams.meshFilePath" not in told
    iss["meshParams"]["meshFilePath"] = "nowhere.blend"
    assert f"{MESHES}[1].meshParams.meshFilePath: no such file:" in failure(tree)


def test_a_planet_with_a_model_is_a_mesh(tree, planet):
    planet["meshFilePath"] = "../../assets/models/tango_like.glb"
    found, _ = translated(tree)
    assert list(found["spacecraft"]) == ["planet", "iss"]
    assert found["root"] == "origin"
    orbit = found["spacecraft"]["planet"]["orbit"]
    assert orbit["around"] == "origin"
    assert orbit["position_km"] == pytest.approx([0.0] * 3, abs=1e-11)  # a few nm from a speck
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sim = perilune.open(tree, base=FOLDER)
    # A circle in scene units about a mesh, whose bounding radius is what the schema scales by.
    place = sim.world(0).position_m("iss") - sim.world(0).position_m("planet")
    assert np.linalg.norm(place) == pytest.approx(1.06396989 * EARTH_M, rel=1e-9)


def test_an_asteroid_alone(tree, planet):
    """The kind of scene of OAISYS's own example: a mesh, and a camera on a line to it."""
    mesh = tree["ASSET_SETUP"]["MESHES"][0]
    mesh["type"] = "MeshAsteroid"
    mesh["meshParams"] = {
        "meshFilePath": "../../assets/models/tango_like.blend",
        "meshInstanceName": "asteroid",
        "location": "trajectory_simulation",
        "activationProbability": 0.3,
    }
    mesh["name"] = "asteroid"
    del tree["ASSET_SETUP"]["MESHES"][1]
    tree["SENSOR_SETUP"]["GENERAL"] = {
        "sensorMovementType": "centeredTarget",
        "targetObject": "asteroid",
        "sensorDistanceScale": [1.5, 3.0],
    }
    found, told = translated(tree)
    assert f"{MESHES}[0].meshParams.activationProbability: not applied" in told
    assert found["spacecraft"]["asteroid"]["metres_per_unit"] == 1.0
    sim = perilune.open(found, base=FOLDER, overrides={"render.samples": 1})
    sample = sim.frame(1, channels=["rgb", "instance", "objects"])
    assert sample.objects["visib_fract"][0] == 1.0
    assert sample["rgb"].max() > 20
    assert set(np.unique(sample["instance"])) == {0, sample.objects["instance_id"][0]}


def test_an_alien_planet_is_an_ellipsoid(tree, planet):
    planet["meshFilePath"], planet["meshInstanceName"] = "alien.blend", "alien"
    found, told = translated(tree)
    assert found["bodies"]["planet"]["kind"] == "ellipsoid"
    assert found["bodies"]["planet"]["radii_km"] == [6378.0] * 3
    assert f"{MESHES}[0].meshParams.meshFilePath: no alien.blend in glTF" in told
    cfg.load(found, base=FOLDER)


def test_a_body_away_from_the_origin(tree, planet):
    planet["position"] = [2.0, 0.0, -1.0]
    found, _ = translated(tree)
    assert found["root"] == "origin"
    assert found["bodies"]["planet"]["orbit"]["position_km"] == [12756.0, 0.0, -6378.0]
    cfg.load(found, base=FOLDER)


def test_passes(tree):
    passes = tree["RENDER_SETUP"]["RENDER_PASSES"]
    passes[0]["passParams"] |= {"renderDepthActive": False, "renderSamples": 7}
    del passes[1:]
    render = translated(tree)[0]["render"]
    assert (render["channels"], render["samples"]) == (["rgb", "objects"], 7)
    passes[0]["type"] = "FlowPass"
    assert "RENDER_PASSES[0]: FlowPass: has no counterpart" in translated(tree)[1]
    del tree["RENDER_SETUP"]
    channels = translated(tree)[0]["render"]["channels"]
    assert channels == ["rgb", "depth", "semantic", "instance", "objects"]


def test_labels(tree, planet, iss):
    iss["meshParams"]["passParams"]["semantic_label"]["labelIDVec"] = [[10]]
    found, _ = translated(tree)
    assert found["labels"]["ids"]["object"] == {"earth": 10}
    assert found["spacecraft"]["iss"]["class"] == "earth"
    iss["meshParams"]["passParams"]["semantic_label"]["labelIDVec"] = [[0]]
    found, told = translated(tree)
    assert found["labels"]["ids"]["object"] == {"earth": 10}
    assert f"{MESHES}[1].meshParams.passParams.semantic_label.labelIDVec[0][0]: not applied" in told
    iss["meshParams"]["passParams"]["semantic_label"]["labelIDVec"] = [["x"]]
    assert "semantic_label.labelIDVec[0]: must be whole numbers" in failure(tree)


def listing_5():
    """The section of the paper's listing 5, of one driver."""
    driver = {"clip_min": 0.1, "clip_max": 10.0, "ideal": 1.0, "jitter_variance": 10.0}
    return {"drivers": {"scale": driver}, "jitter_strength": 1.0, "step_interval": 1}


GRAPH = {
    "nodes": {
        "OAISYS_scale": {"type": "value", "value": 0.5},
        "noise": {"type": "noise", "scale": "OAISYS_scale"},
        "skin": {"type": "principled", "base_color": "noise"},
    }
}


def test_material_drivers_without_graphs_are_told_of(tree, iss):
    drivers = listing_5()
    iss["meshParams"]["material_drivers"] = drivers
    tree["material_drivers"] = listing_5()
    found, told = translated(tree)
    path = f"{MESHES}[1].meshParams.material_drivers.drivers.scale"
    assert f"{path}: not applied: no graph is on the mesh" in told
    assert "f.json: material_drivers.drivers.scale: not applied: the file has no `mater" in told
    assert "material_drivers" not in found["spacecraft"]["iss"]
    for key, value, text in (
        ("ideal", 11.0, "11 is outside [clip_min, clip_max]"),
        ("jitter_variance", -1.0, "must not be negative"),
        ("clip_min", 20.0, "20 is above clip_max = 10"),
        ("ideal", None, "required, but missing"),
    ):
        drivers["drivers"]["scale"] = {**listing_5()["drivers"]["scale"], key: value}
        assert f"{path}.{key}: {text}" in failure(tree)


@pytest.mark.parametrize("place", ["mesh", "file"])
def test_material_drivers_drive_the_graphs_of_a_mesh(tree, iss, repo_dir, place):
    tree["materials"] = {"foil": copy.deepcopy(GRAPH)}
    iss["meshParams"]["meshFilePath"] = str(repo_dir / "assets/models/smallsat.glb")
    iss["meshParams"]["materials"] = [{"material": "*", "use": "foil"}]
    owner = iss["meshParams"] if place == "mesh" else tree
    owner["material_drivers"] = drivers = listing_5()
    found, told = translated(tree)
    assert "material_drivers" not in told
    section = found["spacecraft"]["iss"] if place == "mesh" else found
    assert section["material_drivers"] == drivers
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", oaisys.OaisysWarning)
        sim = perilune.open(tree, base=FOLDER, overrides={"camera.width": 16, "camera.height": 16})
        key = "spacecraft.iss.material_drivers" if place == "mesh" else "material_drivers"
        values = [sim.config_at(index)[1][f"{key}.drivers.scale"] for index in range(4)]
        assert len(set(values)) > 1  # some are clipped
        request = [sim.request(index)["graph_parameters"][0, 0] for index in range(4)]
        assert request == values
        drivers["drivers"]["scal"] = drivers["drivers"].pop("scale")
        at = f"{MESHES}[1].meshParams.material_drivers" if place == "mesh" else "material_drivers"
        text = rf"{re.escape(at)}\.drivers\.scal\b.*: drives nothing: .* did you mean 'scale'"
        with pytest.raises(ConfigError, match=text):
            perilune.open(tree, base=FOLDER)


def test_material_drivers_drive_the_graphs_of_a_model(tree, iss, tmp_path):
    model = with_graphs(tmp_path / "iss.glb", mli_gold=GRAPH)
    iss["meshParams"] |= {"meshFilePath": str(model), "material_drivers": listing_5()}
    found, told = translated(tree)
    assert "material_drivers" not in told
    assert "materials" not in found
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", oaisys.OaisysWarning)
        sim = perilune.open(tree, base=FOLDER, overrides={"camera.width": 16, "camera.height": 16})
    key = "spacecraft.iss.material_drivers.drivers.scale"
    values = [sim.config_at(index)[1][key] for index in range(4)]
    assert [sim.request(index)["graph_parameters"][0, 0] for index in range(4)] == values


def test_material_drivers_of_a_planet(tree, planet):
    tree["materials"] = {"clouds": copy.deepcopy(GRAPH)}
    planet["material"] = "clouds"
    planet["material_drivers"] = listing_5()
    found, told = translated(tree)
    assert "material" not in told.replace("materialParams", "")
    body = found["bodies"]["planet"]
    assert (body["material"], body["material_mode"]) == ("clouds", "wrap")
    document = cfg.load(found, base=FOLDER)
    key = "bodies.planet.material_drivers.drivers.scale"
    assert len({document.at(index)[1][key] for index in range(4)}) > 1
    planet["material_drivers"]["drivers"]["scal"] = listing_5()["drivers"]["scale"]
    path = f"{MESHES}[0].meshParams.material_drivers.drivers.scal"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", oaisys.OaisysWarning)
        with pytest.raises(ConfigError, match=rf"{re.escape(path)}\b.*: drives nothing"):
            perilune.open(tree, base=FOLDER)


def test_what_has_no_counterpart_is_told_by_its_key(tree, planet, iss):
    tree["SIMULATION_SETUP"]["numBatches"] = 3
    tree["SIMULATION_SETUP"]["outputPath"] = "/tmp/x"
    tree["NEW_SECTION"] = {"a": 1}
    planet["colour"] = "blue"
    iss["meshParams"]["position"] = [1, 0, 0]
    stage = {"name": "s", "type": "StageBlenderLandscape", "stageParams": {"a": 1}}
    tree["ASSET_SETUP"]["STAGES"] = [stage]
    material = {"name": "m", "type": "MaterialTerrain", "materialParams": {"general": {}}}
    tree["ASSET_SETUP"]["MATERIALS"] = [material]
    rocks = {"name": "r", "type": "MeshMultipleRandom", "meshParams": {"numberInstances": 3}}
    tree["ASSET_SETUP"]["MESHES"].append(rocks)
    effects = [{"type": "BloomEffect", "quality": "HIGH"}]
    tree["RENDER_POST_PROCESSING_EFFECTS_SETUP"]["POST_EFFECTS"] = effects
    tree["SENSOR_SETUP"]["SENSORS"][0]["sensorParams"]["depthOfField"] = {"fStop": 1.4}
    _, told = translated(tree)
    for path in (
        "SIMULATION_SETUP.numBatches: batches are scenes of 10 steps; render them with --frames 0",
        "SIMULATION_SETUP.outputPath: not applied",
        "NEW_SECTION: has no counterpart",
        f"{MESHES}[0].meshParams.colour: has no counterpart",
        f"{MESHES}[1].meshParams.position: not applied: the orbit",
        "ASSET_SETUP.STAGES[0]: StageBlenderLandscape: terrain is not there yet",
        "ASSET_SETUP.MATERIALS[0]: MaterialTerrain",
        f"{MESHES}[2]: MeshMultipleRandom: scattered meshes",
        "RENDER_POST_PROCESSING_EFFECTS_SETUP.POST_EFFECTS[0]: BloomEffect: the glare of a lens",
        "RENDER_SETUP.GENERAL.renderEngine: has no counterpart",
        f"{SENSOR}.depthOfField.fStop: an aperture of",
    ):
        assert f"f.json: {path}" in told, path


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("SENSOR_SETUP.SENSORS", [], "SENSOR_SETUP.SENSORS: needs a sensor"),
        ("SENSOR_SETUP.GENERAL", 3, "SENSOR_SETUP.GENERAL: must be a mapping"),
        ("SENSOR_SETUP.GENERAL.orbit_mesh", None, "GENERAL.orbit_mesh: required"),
        ("SENSOR_SETUP.GENERAL.orbit_radius", -1, "GENERAL.orbit_radius: must be positive"),
        ("SENSOR_SETUP.GENERAL.sensorMovementType", "orbit_objects", "did you mean 'orbit_object'"),
        ("ASSET_SETUP.MESHES", [], "ASSET_SETUP.MESHES: holds no mesh"),
        ("ASSET_SETUP.MESHES", {}, "ASSET_SETUP.MESHES: must be a list"),
        ("SIMULATION_SETUP.numSamplesPerBatch", 0, "numSamplesPerBatch: must be a whole number"),
    ],
)
def test_errors_name_the_key(tree, path, value, expected):
    *sections, last = path.split(".")
    node = tree
    for section in sections:
        node = node[section]
    node[last] = value
    assert expected in failure(tree)


def test_errors_of_the_schema_name_the_files_key(tree, iss):
    params = tree["SENSOR_SETUP"]["SENSORS"][0]["sensorParams"]
    params["KMatrix"][0] = -1.0
    params["imageResolution"] = [640, 100000]
    tree["RENDER_SETUP"]["RENDER_PASSES"][0]["passParams"]["renderSamples"] = 70000
    iss["meshParams"]["scale"] = [1e-40] * 3
    text = failure(tree)
    assert f"{SENSOR}.imageResolution (here: camera.height) = 100000: must be less" in text
    assert "passParams.renderSamples (here: render.samples) = 70000: must be less" in text
    assert f"{MESHES}[1].meshParams.scale (here: spacecraft.iss.metres_per_unit)" in text
    assert f"{SENSOR}.KMatrix (here: camera.K)" not in text  # checked once the numbers are valid


def test_errors_of_orbits_and_files_name_the_files_key(tree, iss, tmp_path):
    iss["orbit_params"]["scale"] = [0.5] * 3
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(ConfigError) as error:
            perilune.open(tree, base=FOLDER)
        assert f"{MESHES}[1].orbit_params (here: spacecraft.iss.orbit): at " in str(error.value)
        assert "below the surface of planet" in str(error.value)
        tree["SENSOR_SETUP"]["GENERAL"] = {
            "sensorMovementType": "deterministic",
            "sensorMovementPose": "nowhere.csv",
        }
        with pytest.raises(FileNotFoundError) as missing:
            cfg.load(tree, base=FOLDER)
    assert "SENSOR_SETUP.GENERAL.sensorMovementPose (here: camera.traj" in str(missing.value)


def test_overrides_are_of_our_keys_and_documents_pickle(tree):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        document = cfg.load(tree, {"camera.width": 64}, base=FOLDER)
    assert document.config.camera.width == 64
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # told once, not by every worker
        again = pickle.loads(pickle.dumps(document))
    assert again.config == document.config
    assert again.origins == document.origins


def test_a_file_of_the_command_line(tree, tmp_path, capsys):
    from perilune.cli import main

    tree["ASSET_SETUP"]["MESHES"][0]["meshParams"]["meshFilePath"] = "earth.blend"
    tree["ASSET_SETUP"]["MESHES"][1]["meshParams"]["meshFilePath"] = str(
        FOLDER / "../../assets/models/tango_like.blend"
    )
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(tree))
    assert main(["parts", str(path)]) == 0
    told = capsys.readouterr().err
    assert f"perilune: warning: {path}: RENDER_SETUP.GENERAL.renderEngine" in told
    assert "__init__.py" not in told
