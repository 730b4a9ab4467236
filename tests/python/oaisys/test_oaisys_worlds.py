"""OAISYS files: sizes of planets, air, pictures around, glare, focus and levels of classes."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pytest
from PIL import Image
from tests.python.oaisys.oaisys_files import EARTH_M, FOLDER, SENSOR, failure, translated

import perilune
from perilune import _core
from perilune.bodies import atmospheres
from perilune.config.atmosphere import Atmosphere

MESHES = "ASSET_SETUP.MESHES"
ENVIRONMENT = "ENVIRONMENT_EFFECTS_SETUP.ENVIRONMENT_EFFECTS"


def ball(rows=24, columns=48):
    """Vertices and faces (quads as two triangles) of a closed unit ball."""
    lat = np.linspace(-90, 90, rows + 1)[1:-1]
    lon = np.arange(columns) * 360.0 / columns
    lon_rad, lat_rad = np.radians(np.meshgrid(lon, lat))
    ring = np.stack(
        [np.cos(lat_rad) * np.cos(lon_rad), np.cos(lat_rad) * np.sin(lon_rad), np.sin(lat_rad)], -1
    ).reshape(-1, 3)
    vertices = np.concatenate([ring, [[0, 0, -1], [0, 0, 1]]])
    south, north, faces = len(ring), len(ring) + 1, []
    for i in range(columns):
        j = (i + 1) % columns
        faces.append((south, j, i))
        top = (rows - 2) * columns
        faces.append((north, top + i, top + j))
        for row in range(rows - 2):
            a, b = row * columns + i, row * columns + j
            c, d = b + columns, a + columns
            faces += [(a, b, c), (a, c, d)]
    return vertices, np.array(faces)


def write_obj(path, scale=1.0):
    vertices, faces = ball()
    lines = [f"v {x} {y} {z}" for x, y, z in (scale * vertices).tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    path.write_text("\n".join(lines))


def write_gltf(path):
    """As exported: y up."""
    vertices, faces = ball()
    x, y, z = vertices.T
    positions = np.stack([x, z, -y], axis=-1).astype("<f4")
    indices = faces.astype("<u4").reshape(-1)
    data = positions.tobytes() + indices.tobytes()
    count = {"POSITION": 0}
    path.with_suffix(".bin").write_bytes(data)
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": positions.nbytes},
        {"buffer": 0, "byteOffset": positions.nbytes, "byteLength": indices.nbytes},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(positions), "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": len(indices), "type": "SCALAR"},
    ]
    tree = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": count, "indices": 1}]}],
        "buffers": [{"uri": path.with_suffix(".bin").name, "byteLength": len(data)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    path.write_text(json.dumps(tree))


def opened(tree, **overrides):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return perilune.open(tree, base=FOLDER, overrides=overrides)


def test_a_planet_in_gltf_has_the_radius_of_its_surface(tree, planet, iss, tmp_path):
    """Of a unit ball, as any orbit sampler sees it; the corner of its box is at 1.73."""
    write_gltf(tmp_path / "earth.gltf")
    planet["meshFilePath"] = str(tmp_path / "earth.blend")
    orbit = iss["orbit_params"]
    iss["orbit_params"] = {
        "type": "orbit_database", "orbit_type": "LEO", "parent": orbit["parent"], "v_step": 0.01,
    }  # fmt: skip
    sim = opened(tree)
    assert "planet" in sim.config.spacecraft
    assert sim.models["planet"].radius_m == pytest.approx(EARTH_M, rel=1e-6)
    world = sim.world(0)
    height_km = np.linalg.norm(world.position_m("iss") - world.position_m("planet")) / 1e3 - 6378
    assert 150.0 < height_km < 2000.0  # 4600 km more, by the corner
    iss["orbit_params"]["orbit_type"] = "GEO"
    world = opened(tree).world(0)
    distance = np.linalg.norm(world.position_m("iss") - world.position_m("planet"))
    assert distance == pytest.approx(42164e3, rel=1e-3)
    planet["meshFilePath"], planet["meshInstanceName"] = str(tmp_path / "mars.blend"), "mars"
    write_gltf(tmp_path / "mars.gltf")
    found, _ = translated(tree)
    assert found["spacecraft"]["planet"]["metres_per_unit"] == pytest.approx(3389.5e3, rel=1e-4)


def test_a_planet_in_gltf_scaled_by_axis_is_a_body(tree, planet, tmp_path):
    write_gltf(tmp_path / "earth.gltf")
    planet["meshFilePath"], planet["scale"] = str(tmp_path / "earth.gltf"), [1.0, 1.0, 0.9]
    found, told = translated(tree)
    body = found["bodies"]["planet"]
    assert body["radii_km"] == pytest.approx([6378.0, 6378.0, 5740.2], rel=2e-3)
    assert "a body of the shape" in told
    sim = opened(tree)
    low, high = sim.shapes["planet"].model.bounds
    assert high[2] == pytest.approx(0.9 * EARTH_M, rel=1e-6)
    assert (high - low)[2] / (high - low)[0] == pytest.approx(0.9, rel=1e-6)


def test_a_spacecraft_scaled_by_axis_is_stretched(tree, planet, iss):
    """Along the model's axes, z up, which are Blender's."""
    iss["meshParams"]["scale"] = [1e-6, 3e-6, 2e-6]
    found, told = translated(tree)
    by_axis = found["spacecraft"]["iss"]["metres_per_unit"]
    assert by_axis == pytest.approx([1e-6 * EARTH_M, 3e-6 * EARTH_M, 2e-6 * EARTH_M])
    assert "meshParams.scale" not in told
    sim = opened(tree)
    row = sim.models["iss"]
    mesh = _core.Model(row.model.path).mesh()["positions"]
    low, high = mesh.min(axis=0) * by_axis, mesh.max(axis=0) * by_axis
    assert row.metres_per_unit * row.model.bounds == pytest.approx(np.array([low, high]), rel=1e-6)
    reach_m = np.linalg.norm(mesh * by_axis, axis=1).max()
    assert row.radius_m == pytest.approx(reach_m, rel=1e-6)
    for wrong in (0.0, -3e-6):  # a mirrored craft is a model of its own
        iss["meshParams"]["scale"] = [1e-6, wrong, 1e-6]
        assert f"{MESHES}[1].meshParams.scale: must be positive" in failure(tree)


@pytest.mark.parametrize("name", ["rock.obj", "rock.blend"])
def test_an_obj_is_a_body(tree, planet, tmp_path, name):
    write_obj(tmp_path / "rock.obj", 2.0)
    planet["meshFilePath"], planet["scale"] = str(tmp_path / name), [0.1, 0.1, 0.05]
    tree["metres_per_unit"] = 1000.0
    found, told = translated(tree)
    body = found["bodies"]["planet"]
    assert body["shape"]["metres_per_unit"] == pytest.approx([100.0, 100.0, 50.0])
    assert body["radii_km"] == pytest.approx([0.2, 0.2, 0.1])
    assert f"{MESHES}[0].meshParams.meshFilePath: planet is a body of the shape" in told
    sim = opened(tree)
    assert sim.shapes["planet"].radius_m == pytest.approx(200.0, rel=1e-6)
    (tmp_path / "rock.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3")
    assert f"{MESHES}[0].meshParams.meshFilePath: " in failure(tree)
    assert "is not closed" in failure(tree)


def test_all_levels_of_classes(tree, planet, iss):
    for params, ids in ((planet, [1, 7, 10]), (iss["meshParams"], [2, 7, 20])):
        params["passParams"]["semantic_label"]["labelIDVec"] = [ids]
    found, told = translated(tree)
    assert "labelIDVec" not in told
    assert found["labels"]["levels"] == ["level_0", "level_1", "object", "part", "kind"]
    sim = opened(tree, **{"camera.width": 64, "camera.height": 48, "camera.K": None,
                          "camera.fov_deg": 30.0})  # fmt: skip
    sample = sim.frame(0, ["semantic", "instance"])
    names = sim.taxonomy.names("instance")
    seen = {names[k]: sample["semantic"][sample["instance"] == k][0][:3].tolist()
            for k in np.unique(sample["instance"]).tolist()}  # fmt: skip
    expected = {"background": [0, 0, 0], "planet": [1, 7, 10], "iss": [2, 7, 20]}
    assert {"iss"} <= seen.keys()
    assert seen == {name: expected[name] for name in seen}
    # One with fewer levels: its last stands for the finer ones; 0 is the background.
    planet["passParams"]["semantic_label"]["labelIDVec"] = [[0, 5]]
    found, told = translated(tree)
    where = f"{MESHES}[0].meshParams.passParams.semantic_label.labelIDVec"
    assert f"{where}: has 2 of 3 levels" in told
    assert f"{where}[0][0]: not applied" in told
    assert found["bodies"]["planet"]["classes"] == {"level_1": "class_5"}
    assert found["labels"]["ids"]["object"] == {"earth": 5, "iss": 20}


def sky(**params):
    return {"type": "EnvLightBlenderSky", "environmentEffectsParams": params}


def environment(tree, *effects):
    tree["ENVIRONMENT_EFFECTS_SETUP"] = {"ENVIRONMENT_EFFECTS": list(effects)}


def test_air(tree, planet):
    environment(tree, sky(AirDensity=[1.0], DustDensity=[0.0, 1.0], OzoneDensity=0, SunAltitude=5))
    found, told = translated(tree)
    air = found["bodies"]["planet"]["atmosphere"]
    assert air["preset"] == "earth"
    assert "rayleigh_per_km" not in air
    haze = atmospheres.settings(Atmosphere(preset="earth"))["mie_scattering"]
    assert air["mie_scattering_per_km"] == pytest.approx([500.0 * value for value in haze])
    assert air["ozone_per_km"] == [0.0] * 3
    params = f"{ENVIRONMENT}[0].environmentEffectsParams"
    assert f"{params}.DustDensity: its middle, 0.5, is applied" in told
    assert f"{params}.AirDensity: the air about planet" in told
    assert f"{params}.SunAltitude: not applied" in told
    assert "yet" not in told
    opened(tree)
    environment(tree, sky(AirDensity=0.0, DustDensity=0.0))
    assert "atmosphere" not in translated(tree)[0]["bodies"]["planet"]
    planet["meshFilePath"], planet["meshInstanceName"] = "mars.blend", "mars"
    environment(tree, sky(AirDensity=2.0, OzoneDensity=1.0))
    found, told = translated(tree)
    assert f"{params}.OzoneDensity: not applied: the air of mars has none of it" in told
    assert found["bodies"]["planet"]["atmosphere"].keys() == {"preset", "rayleigh_per_km"}
    environment(tree, sky(AirDensity=-1.0))
    assert f"{params}.AirDensity: must not be negative" in failure(tree)


def test_our_keys_of_a_planet(tree, planet, iss):
    planet["clouds"] = {"noise": {"coverage": 0.4}}
    planet["rings"] = {"inner_km": 7000.0}
    assert f"{MESHES}[0].meshParams.rings" in failure(tree)
    del planet["rings"]
    iss["meshParams"]["clouds"] = {}
    found, told = translated(tree)
    assert found["bodies"]["planet"]["clouds"] == {"noise": {"coverage": 0.4}}
    assert f"{MESHES}[1].meshParams.clouds: not applied: only a body has it" in told


def hdri(*rows, **more):
    return {"type": "EnvHDRI", "environmentEffectsParams": {"HDRIList": list(rows), **more}}


def test_a_picture_around(tree, iss, tmp_path):
    Image.new("RGB", (64, 32), (255, 255, 255)).save(tmp_path / "stars.png")
    environment(
        tree,
        sky(SunElevation=[20.0]),
        hdri({"filePath": str(tmp_path / "stars.hdr"), "strength": [0.25]}),
    )
    found, told = translated(tree)
    assert found["sky"]["background"]["map"] == str(tmp_path / "stars.png")
    assert f"{ENVIRONMENT}[1].environmentEffectsParams.HDRIList[0].filePath: read from" in told
    assert "it lights nothing" in told
    sim = opened(tree)
    sample = sim.frame(0, ["rgb", "instance"])
    behind = sample["rgb"][sample["instance"] == 0]
    # A quarter of a white wall in sunlight, in sRGB: 137.
    assert np.abs(behind.reshape(-1, 3).astype(int).mean(axis=0) - 137).max() < 3
    rows = [{"filePath": str(tmp_path / name)} for name in ("stars.png", "a.exr")]
    environment(tree, hdri(*rows))
    _, told = translated(tree)
    assert "HDRIList[1].filePath: not applied: .hdr and .exr are not read" in told


def test_several_pictures_are_drawn(tree, tmp_path):
    for name in ("a", "b"):
        Image.new("RGB", (8, 4)).save(tmp_path / f"{name}.png")
    environment(tree, hdri(*({"filePath": str(tmp_path / f"{n}.png")} for n in "ab")))
    sim = opened(tree)
    assert len({sim.config_at(k)[0].sky.background.map for k in range(9)}) == 2
    params = tree["ENVIRONMENT_EFFECTS_SETUP"]["ENVIRONMENT_EFFECTS"][0]["environmentEffectsParams"]
    params |= {"stepIntervalOption": "LOCAL", "stepInterval": 10}
    sim = opened(tree)
    assert len({sim.config_at(k)[0].sky.background.map for k in range(10)}) == 1


def test_bloom(tree):
    effects = tree["RENDER_POST_PROCESSING_EFFECTS_SETUP"]
    effects["POST_EFFECTS"] = [
        {"type": "BloomEffect", "quality": "HIGH", "threshold": 1.0, "mix": 0.0, "size": 8},
        {"type": "CombineEffect"},
    ]
    found, told = translated(tree)
    at = "RENDER_POST_PROCESSING_EFFECTS_SETUP.POST_EFFECTS[0]"
    assert f"{at}: BloomEffect: the glare of a lens" in told
    assert f"{at}.threshold: not applied" in told
    assert "POST_EFFECTS[1]" not in told
    spread = found["camera"]["sensor"]["point_spread"]
    assert spread == {"core": "point", "wings": 0.015, "wing_radius_px": 2.0}
    small = {"camera.width": 80, "camera.height": 60, "camera.K": None, "camera.fov_deg": 40.0}
    sim = opened(tree, **small)
    bloomed = sim[0]["sensor_rgb"].astype(float)
    effects["POST_EFFECTS"][0]["mix"] = -1.0
    clean = opened(tree, **small)[0]["sensor_rgb"].astype(float)
    sky = clean.max(axis=2) == 0
    assert sky.any()
    assert bloomed[sky].max() >= 2.0  # it glows beside what is bright


def test_focus(tree):
    sensor = tree["SENSOR_SETUP"]["SENSORS"][0]["sensorParams"]
    sensor["depthOfField"] = {"distance": 0.002, "fStop": 1.4, "blades": 6}
    found, told = translated(tree)
    lens = found["camera"]["lens"]
    assert lens["focus_distance_m"] == pytest.approx(0.002 * EARTH_M)
    assert lens["aperture_mm"] == pytest.approx(541.14 / 640 * 36.0 / 1.4)
    assert f"{SENSOR}.depthOfField.blades: not applied: the aperture is a disc" in told
    assert f"{SENSOR}.depthOfField.fStop: an aperture of 21.7 mm" in told
    opened(tree)
    sensor["depthOfField"]["fStop"] = 0
    assert f"{SENSOR}.depthOfField.fStop: must be positive" in failure(tree)
