"""The loader, the schema, overrides, paths and the texts of errors."""

from __future__ import annotations

import json
import math
import pickle
from pathlib import Path

import pytest

import perilune
from perilune import document as cfg
from perilune.config import Config, ConfigError
from perilune.document import parse_override
from perilune.document.loader import parse_json, parse_yaml, read_tree


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


def load(scene, **overrides):
    return cfg.load(scene, overrides)


def failure(scene, **overrides) -> str:
    with pytest.raises(ConfigError) as error:
        load(scene, **overrides)
    return str(error.value)


def test_wrong_items_make_no_list_too_short(scene):
    flare = {"ghosts": [{"scale": 3.0, "radius_deg": 1.0, "intensity": 0.1}]}
    text = failure(scene, **{"camera.sensor": {"lens_flare": flare}})
    assert text.splitlines()[1:] == [
        "  camera.sensor.lens_flare.ghosts[0].scale = 3.0: must be less than or equal to 2"
    ]
    text = failure(scene, **{"camera.sensor": {"lens_flare": {"ghosts": []}}})
    assert "lens_flare.ghosts: must have at least 1 item" in text


def test_units_and_defaults(scene):
    config = load(scene).config
    assert config.spacecraft["sat"].orbit.altitude_km == 500.0
    assert config.camera.exposure.mode == "auto"
    assert config.labels.levels == ("kind", "object", "part")
    assert config.sun.irradiance_w_m2 == 1361.0


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("camera.widht", 3, ["camera.widht", "unknown key", "did you mean 'width'?", "height"]),
        ("camera.width", 0, ["camera.width = 0", "greater than or equal to 1"]),
        ("camera.width", 64.0, ["camera.width = 64.0", "whole number"]),
        ("camera.width", "64", ["camera.width = '64'", "whole number", "quotes"]),
        ("camera.fov_deg", True, ["camera.fov_deg = True", "number"]),
        ("camera.fov_deg", 180, ["camera.fov_deg = 180", "less than 180"]),
        ("camera.focal_px", 100.0, ["camera", "only one of fov_deg, focal_px"]),
        ("camera.fov_deg", None, ["exactly one of fov_deg, focal_px, K"]),
        ("camera.trajectory.kind", "orbit_objekt", ["'orbit_objekt'", "did you mean 'orbit_obj"]),
        ("camera.trajectory.target", "sta", ["camera.trajectory.target", "did you mean 'sat'?"]),
        ("camera.trajectory.distance_m", [3, 1], ["distance_m", "[smallest, largest]"]),
        ("camera.trajectory.distance_m", -1, ["distance_m", "greater than 0"]),
        ("camera.trajectory.distance_m", math.nan, ["distance_m", "finite"]),
        ("camera.trajectory.sun_angle_deg", [0, 200], ["sun_angle_deg", "180"]),
        ("camera.trajectory.background", "mars", ["background", "'mars'", "allowed: earth"]),
        ("camera.K", [1.0, 2.0], ["camera.K"]),
        ("root", "erth", ["root", "did you mean 'earth'?"]),
        ("time.epoch", "20 March 2026", ["time.epoch", "ISO 8601"]),
        ("time.epoch", "1905-01-01", ["time.epoch", "1960 to 2100"]),
        ("time", None, ["time: required"]),
        ("version", 2, ["version = 2", "must be 1"]),
        ("seed", -1, ["seed = -1"]),
        ("bodies.earth.rotation", "bodi", ["bodies.earth.rotation = 'bodi'", "'body'"]),
        ("bodies.earth.rotation", {"spin_axis": [0, 0, 0]}, ["spin_axis", "not be zero"]),
        ("bodies.earth.albedo", -0.1, ["bodies.earth.albedo"]),
        ("bodies.earth.kind", "ellipsoid", ["bodies.earth.radii_km", "required"]),
        ("bodies.earth.kind", "sun", ["always there"]),
        ("bodies.sat", {"kind": "moon"}, ["spacecraft.sat", "same name"]),
        ("bodies.2nd", {"kind": "moon"}, ["bodies.2nd", "no digit first"]),
        ("spacecraft.sat.metres_per_unit", 1.0, ["only one of size_m, metres_per_unit"]),
        ("spacecraft.sat.orbit.around", "sat", ["sat.orbit.around: a cycle: sat is around itself"]),
        ("spacecraft.sat.orbit.eccentricity", -0.1, ["orbit.eccentricity = -0.1"]),
        ("spacecraft.sat.orbit.inclination_deg", 181, ["inclination_deg = 181", "180"]),
        ("spacecraft.sat.orbit.periapsis_km", 7e3, ["only one of altitude_km, periapsis_km"]),
        ("spacecraft.sat.orbit.eccentricity", 1.0, ["mean_anomaly_deg", "parabola"]),
        ("spacecraft.sat.orbit.position_km", [7e3, 0, 0], ["orbit.altitude_km", "position_km"]),
        ("spacecraft.sat.orbit.kind", "keppler", ["orbit", "'keppler'", "did you mean 'kepler'?"]),
        (
            "spacecraft.sat.orbit.state",
            {"position_km": [7e3, 0, 0], "velocity_km_s": [0, 7, 0]},
            ["sat.orbit.altitude_km", "does not go with state"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "circular", "around": "earth"},
            ["orbit.scale: required"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "circular", "around": "earth", "scale": 1.1},
            ["orbit.v_step: required"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "database", "around": "earth", "class": "LEO", "propagator": "circular"},
            ["orbit.v_step: required for propagator: circular (0: it stands still)"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "tle", "around": "earth"},
            ["exactly one of lines, file"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "hook", "around": "earth", "hook": "x"},
            ["orbit.hook = 'x'", "module:function"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "database", "around": "earth", "class": "LOE"},
            ["orbit.class = 'LOE'", "LEO"],
        ),
        (
            "spacecraft.sat.orbit",
            {"kind": "database", "around": "earth", "class": "LEO", "v_step": 1},
            ["orbit.v_step", "only for propagator: circular"],
        ),
        ("spacecraft.sat.attitude.pointing", "lvhl", ["'lvhl'", "did you mean 'lvlh'?"]),
        (
            "spacecraft.sat.attitude",
            {"pointing": "target", "target": "erth"},
            ["sat.attitude.target", "did you mean 'earth'?"],
        ),
        (
            "spacecraft.sat.attitude",
            {"pointing": "tumble", "rate_deg_s": [0, 0, 1]},
            ["attitude.inertia_kg_m2: required"],
        ),
        ("spacecraft.sat.attitude.rotation_deg_step_v", 1, ["does not go with spin_rate_deg_s"]),
        ("render.force_off", ["bounces"], ["render.force_off", "force_on"]),
        ("labels.levels", ["kind", "kind"], ["labels.levels", "twice"]),
        ("camera.sensor", {"compression": 80}, ["sensor.compression = 80: must be a mapping"]),
        ("camera.lens", {"aperture_mm": 5.0}, ["lens.aperture_mm: blurs nothing without focus"]),
        ("camera.exposure.mode", "fixed", ["white_radiance_w_m2_sr", "required"]),
        ("bodies.earth.radii_km", 1e16, ["bodies.earth.radii_km", "1000000000000000"]),
        (
            "bodies.earth.relief",
            {"height_map": "x.png", "height_m": 1e30},
            ["bodies.earth.relief.height_m = 1e+30", "less than or equal to 1000000000"],
        ),
        ("spacecraft.sat.size_m", 1e19, ["sat.size_m = 1e+19", "1000000000000000000"]),
        (
            "volumes.mist",
            {"parent": "sat", "shape": "box", "size_m": 1e30, "g": 0.5},
            ["volumes.mist.size_m", "1000000000000000"],
        ),
        (
            "volumes.mist",
            {"parent": "sat", "shape": "box", "size_m": 1, "extinction_per_m": 1e31},
            ["volumes.mist.extinction_per_m", "less than or equal to 1" + "0" * 30],
        ),
        (
            "volumes.mist",
            {
                "parent": "sat",
                "shape": "cone",
                "end_radius_m": 1e-12,
                "length_m": 1,
                "extinction_per_m": 1,
            },
            ["volumes.mist.end_radius_m", "at least 1e-09"],
        ),
        (
            "volumes.mist",
            {"parent": "sat", "shape": "box", "size_m": 1.0},
            [
                "volumes.mist.extinction_per_m: "
                "give extinction_per_m, emission_w_m3_sr or a material"
            ],
        ),
    ],
)
def test_errors_say_where_and_what(scene, key, value, expected):
    if key == "render.force_off":
        scene["render"]["force_on"] = ["bounces"]
    text = failure(scene, **{key: value})
    for part in expected:
        assert part in text, text


@pytest.mark.parametrize("unit", [1e30, 1e-30])
def test_absurd_units_are_refused_by_name(scene, repo_dir, unit):
    scene["spacecraft"]["sat"] |= {"size_m": None, "metres_per_unit": unit}
    scene["spacecraft"]["sat"]["model"] = str(repo_dir / "assets/models/smallsat.glb")
    with pytest.raises(ConfigError, match=r"sat\.metres_per_unit: .* allowed: 1e-09 to 1e\+18 m"):
        _ = perilune.open(scene).models


def test_cycles_are_printed(scene):
    orbit = {"altitude_km": 900.0, "mean_anomaly_deg": 0.0}
    scene["spacecraft"]["sat"]["orbit"]["around"] = "b"
    scene["bodies"]["a"] = {"kind": "moon", "orbit": {"around": "b", **orbit}}
    scene["bodies"]["b"] = {"kind": "phobos", "orbit": {"around": "c", **orbit}}
    scene["bodies"]["c"] = {"kind": "mars", "orbit": {"around": "a", **orbit}}
    text = failure(scene)
    assert "bodies.a.orbit.around: a cycle" in text
    assert "a -> b -> c -> a" in text
    scene["spacecraft"]["sat"]["orbit"]["around"] = "sat"
    assert "sat.orbit.around: a cycle: sat is around itself: sat -> sat" in failure(scene)


def test_spacecraft_as_parents(scene):
    scene["spacecraft"]["mate"] = {
        "model": "x.glb",
        "size_m": 1.0,
        "orbit": {"around": "sat", "semi_major_axis_km": 1.0, "mean_anomaly_deg": 0.0},
    }
    text = "mate.orbit.around: an orbit about a spacecraft needs spacecraft.sat.gm_km3_s2"
    assert text in failure(scene)
    scene["spacecraft"]["sat"]["gm_km3_s2"] = 1e-9
    assert load(scene).config.spacecraft["mate"].orbit.around == "sat"
    scene["spacecraft"]["mate"]["orbit"] = {"around": "sat", "position_km": [0.1, 0.0, 0.0]}
    del scene["spacecraft"]["sat"]["gm_km3_s2"]
    load(scene)


def test_counting_by_steps_needs_a_step(scene):
    scene["time"]["step_s"] = 0
    scene["spacecraft"]["sat"]["attitude"] = {"rotation_deg_step_v": [0.0, 0.0, 1.0]}
    assert "sat.attitude.rotation_deg_step_v: counts by steps" in failure(scene)
    scene["spacecraft"]["sat"]["attitude"] = {"rotation_deg_step_v": 0}
    load(scene)
    orbit = {"kind": "circular", "around": "earth", "scale": 1.1, "v_step": 0.01}
    scene["spacecraft"]["sat"]["orbit"] = orbit
    assert "sat.orbit.v_step: counts by steps" in failure(scene)


def test_every_fault_is_listed_once(scene):
    text = failure(scene, **{"camera.width": 0, "seed": "x", "bodies.earth.albedo": -1})
    assert len(text.splitlines()) == 4, text


@pytest.mark.parametrize(
    ("semi_major_axis_km", "eccentricity", "valid"),
    [
        (7000.0, 0.0, True),
        (7000.0, 1.2, False),
        (-9000.0, 1.8, True),
        (-9000.0, 0.5, False),
        (0.0, 0.5, False),
    ],
)
def test_size_and_eccentricity_agree(scene, semi_major_axis_km, eccentricity, valid):
    orbit = scene["spacecraft"]["sat"]["orbit"]
    del orbit["altitude_km"]
    orbit |= {"semi_major_axis_km": semi_major_axis_km, "eccentricity": eccentricity}
    if valid:
        load(scene)
    else:
        assert "does not go with eccentricity" in failure(scene)


def test_yaml_and_json_give_the_same(scene, tmp_path):
    import yaml

    (tmp_path / "a.json").write_text(json.dumps(scene))
    (tmp_path / "a.yaml").write_text(yaml.safe_dump(scene))
    first, second = cfg.load(tmp_path / "a.json"), cfg.load(tmp_path / "a.yaml")
    assert first.config == second.config
    assert first.config.name == "a"
    assert first.base == tmp_path.resolve()


def test_yaml_scalars():
    tree = parse_yaml(
        "a: 1e3\nb: 12:30:00\nc: 2026-03-20T12:00:00Z\nd: on\ne: 010\nf: -.5\ng: ~\nh: true\n"
        "i: 1.\nj: .inf\nk: 0x10\n",
        "x",
    )
    assert tree == {
        "a": 1000.0,
        "b": "12:30:00",
        "c": "2026-03-20T12:00:00Z",
        "d": "on",
        "e": 10,
        "f": -0.5,
        "g": None,
        "h": True,
        "i": 1.0,
        "j": math.inf,
        "k": "0x10",
    }
    assert parse_yaml("a: &x {b: 1}\nc: {<<: *x, d: 2}", "x")["c"] == {"b": 1, "d": 2}


def test_duplicate_keys_are_refused():
    with pytest.raises(ConfigError, match=r"f\.yaml: line 3.*'a' occurs twice \(lines 1 and 3\)"):
        parse_yaml("a: 1\nb: 2\na: 3\n", "f.yaml")
    with pytest.raises(ConfigError, match="'a' occurs twice"):
        parse_json('{"b": {"a": 1, "a": 2}}', "f.json")


@pytest.mark.parametrize(
    "text",
    ["a: [1, 2", "- 1\n- 2", "", "1: 2\nversion: 1", "a: &a [*a]", "!!python/name:os.system x"],
)
def test_broken_yaml_names_the_file(tmp_path, text):
    path = tmp_path / "broken.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"broken\.yaml"):
        cfg.load(path)


def test_a_small_file_cannot_become_a_large_tree(tmp_path):
    lines = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 10)]
    path = tmp_path / "bomb.yaml"
    path.write_text("\n".join(lines))
    with pytest.raises(ConfigError, match="too large"):
        cfg.load(path)


def test_missing_file(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"nothing\.yaml"):
        cfg.load(tmp_path / "nothing.yaml")


def test_overrides(scene):
    document = load(
        scene,
        **{
            "camera.width": 64,
            "render.tolerance_dn": 0,
            "camera.trajectory.distance_m.1": 30,
            "labels.other_part": "rest",
            "camera.fov_deg": None,
            "camera.focal_px": 50.0,
        },
    )
    config = document.config
    assert (config.camera.width, config.camera.focal_px, config.camera.fov_deg) == (64, 50.0, None)
    assert config.camera.trajectory.distance_m == (12.0, 30.0)
    assert config.labels.other_part == "rest"
    assert scene["camera"]["width"] == 48  # the caller's mapping is left alone


@pytest.mark.parametrize(
    ("section", "changes", "left"),
    [
        (
            {"percentile": 90.0, "key": 0.5},
            {"mode": "fixed", "white_radiance_w_m2_sr": 3.0},
            {"mode": "fixed", "white_radiance_w_m2_sr": 3.0},
        ),
        ({"mode": "fixed", "white_radiance_w_m2_sr": 3.0}, {"mode": "auto"}, {"mode": "auto"}),
        (
            {"mode": "fixed", "white_radiance_w_m2_sr": 3.0},
            {"mode": "auto", "key": 0.5},
            {"mode": "auto", "key": 0.5},
        ),
    ],
)
def test_an_override_of_a_mode_leaves_out_what_the_other_mode_reads(scene, section, changes, left):
    scene["camera"]["exposure"] = section
    document = load(scene, **{f"camera.exposure.{key}": value for key, value in changes.items()})
    assert document.tree["camera"]["exposure"] == left
    assert document.config == cfg.load(document.tree).config


def test_an_override_leaves_out_what_is_unread_in_several_sections(scene):
    scene["camera"]["sensor"] = {
        "point_spread": {"core": "gauss", "sigma_px": 0.9},
        "exposure": {"mode": "auto", "metering": "mean", "max_ms": 5.0},
    }
    document = load(
        scene,
        **{"camera.sensor.point_spread.core": "airy", "camera.sensor.exposure.mode": "fixed"},
    )
    sensor = document.tree["camera"]["sensor"]
    assert sensor == {"point_spread": {"core": "airy"}, "exposure": {"mode": "fixed"}}


def test_keys_without_effect_are_refused_where_no_override_explains_them(scene):
    fixed = {"camera.exposure.mode": "fixed", "camera.exposure.white_radiance_w_m2_sr": 3.0}
    unread = "camera.exposure.percentile: does nothing without mode: auto"
    assert unread in failure(scene, **fixed, **{"camera.exposure.percentile": 90.0})
    whole = {"mode": "fixed", "white_radiance_w_m2_sr": 3.0, "percentile": 90.0}
    assert unread in failure(scene, **{"camera.exposure": whole})
    scene["camera"]["exposure"] = whole
    assert unread in failure(scene)
    assert unread in failure(scene, **{"camera.width": 64})


def test_a_choice_of_a_mode_goes_with_what_one_of_its_values_reads(scene):
    spread = {"core": {"choice": ["gauss", "airy"]}, "sigma_px": 0.9}
    scene["camera"]["sensor"] = {"point_spread": spread}
    document = load(scene)
    found = {
        (spread.core, spread.sigma_px)
        for spread in (document.at(k)[0].camera.sensor.point_spread for k in range(20))
    }
    default = cfg.load({**scene, "camera": scene["camera"] | {"sensor": {}}})
    assert found == {("gauss", 0.9), ("airy", default.config.camera.sensor.point_spread.sigma_px)}
    assert document.tree["camera"]["sensor"]["point_spread"] == spread


def test_faulty_overrides(scene):
    assert "is no index" in failure(scene, **{"camera.trajectory.distance_m.2": 1})
    assert "below a single value" in failure(scene, **{"camera.width.x": 1})
    assert "unknown key" in failure(scene, **{"camera.with": 1})


def test_parse_override():
    assert parse_override("camera.width=64") == ("camera.width", 64)
    assert parse_override("a.b = [1, 2e1]") == ("a.b", [1, 20.0])
    assert parse_override("a=") == ("a", None)
    with pytest.raises(ConfigError, match="key=value"):
        parse_override("camera.width")


def test_paths(scene, tmp_path, monkeypatch):
    document = cfg.load(scene, base=tmp_path)
    (tmp_path / "a.glb").touch()
    assert document.path("a.glb", "k") == tmp_path / "a.glb"
    with pytest.raises(FileNotFoundError, match=r"spacecraft\.sat\.model: no such file.*b\.glb"):
        document.path("b.glb", "spacecraft.sat.model")
    monkeypatch.delenv("PERILUNE_DATA", raising=False)
    with pytest.raises(FileNotFoundError, match="set the environment variable PERILUNE_DATA"):
        document.path("data:a.glb", "k")
    monkeypatch.setenv("PERILUNE_DATA", str(tmp_path))
    assert document.path("data:a.glb", "k") == tmp_path / "a.glb"
    with pytest.raises(FileNotFoundError, match=r"no such file: .*c\.glb; did you mean .a\.glb."):
        document.path("data:c.glb", "k")


def test_document_pickles(scene, tmp_path):
    document = cfg.load(scene, base=tmp_path)
    again = pickle.loads(pickle.dumps(document))
    assert (again.config, again.base, again.source) == (document.config, tmp_path, document.source)


def test_every_physical_key_has_its_unit():
    """Numbers without a unit in their name are ratios, counts or identities listed here."""
    units = (
        "_m",
        "_km",
        "_s",
        "_hz",
        "_deg",
        "_deg_s",
        "_px",
        "_dn",
        "_au",
        "_km3_s2",
        "_w_m2",
        "_km_s",
        "_m_s2",
        "_ga",
        "_m2_per_myr",
        "_per_m2",
        "_m2_kg",
        "_kg_m2",
        "_h",
        "_us",
        "_cm2_s",
        "_um",
        "_nm",
        "_ms",
        "_e",
        "_e_s",
        "_e_dn",
        "_c",
        "_k",
        "_mm",
    )
    plain = {
        "version", "seed", "width", "height", "K", "eccentricity", "albedo", "samples", "layers",
        "max_bounces", "metres_per_unit", "obj_id", "percentile", "key", "strength", "interval",
        "direction", "spin_axis", "cone_axis", "up", "axis", "ids", "white_radiance_w_m2_sr",
        "min_white_radiance_w_m2_sr",
        "emission_w_m2_sr", "min", "max", "merge_below",  # of parts: model units, triangles
        "frames_per_scene", "transformation", "trigger_interval", "positions", "rotations",
        "distance_scale", "normal", "side", "index", "speed",
        "v_step", "orbit_start", "scale", "j2", "cd", "cr", "rtol", "degree", "order", "number",
        "k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2",  # of lenses
        "f_number", "transmission", "quantum_efficiency", "serial", "bits",
        "vignetting_profile",  # degrees, and parts of the light
        "hot_pixels", "dead_pixels", "intensity", "quality",
        "window", "saturated", "gains", "lag_frames",  # of automatic exposure
        "vignetting", "drain", "wings", "wing_beta", "depth_spread",
        "prnu", "dark_nonuniform",  # relative deviations
        "jitter_strength", "step_interval", "correlation", "first_frame",
        "drivers",  # of the inputs of nodes, which say their units
        "rotation_deg_step_v",  # the paper's name: degrees in a step
        "catalogue_year", "limit_magnitude", "white_mag_arcsec2", "brightness",  # of the sky
        "b", "c", "b_s0", "h_s", "b_c0", "h_c", "filling", "k",  # of photometric laws
        "mie_g", "ground_albedo",  # of atmospheres
        "optical_depth", "phase_exponent", "dust_share", "dust_g",  # of rings
        "g", "emission_w_m3_sr", "volume_steps",  # of volumes
        "target_confidence",  # a probability
        "coverage", "octaves", "roughness", "softness", "warp", "phase", "opacity",  # of clouds
        "color",
        "normal_strength", "radiance_w_m2_sr", "black", "wind_m_s",  # of the ground
        "hurst", "cells_per_pixel", "border_posts", "missing",  # of terrain
        "coefficient", "exponent", "density", "ellipticity", "irregularity", "model_posts",
        "diffusivity_exponent", "table", "terraces",  # of craters
        "low", "high",  # of factors
        "pixels", "cover", "border",  # of samples of ground
        "block", "cube", "wedge", "slab", "tablet", "shard", "split", "cobble", "boulder", "egg",
        "breccia", "pitted", "model", "abundance", "least_burial", "most_burial",
        "fillet",  # rocks
        "least_depth", "least_kept", "classes",  # of labels
        "points",  # of discs
        "columns", "rows", "pulses", "steps", "pattern", "sub_rays", "instants", "max_returns",
        "min_intensity", "dropout", "intensity_noise", "contrast", "time_of_flight", "lidars",
        "events", "dark_radiance_w_m2_sr", "on_threshold", "off_threshold",
        "mismatch", "max_halvings", "tolerance", "tolerated_pixels",
        "albedo_contrast", "band", "offset", "reach", "at_rim",  # of maps, and of rays and blocks
    }  # fmt: skip
    schema = Config.model_json_schema()
    found = 0
    for section in [schema, *schema["$defs"].values()]:
        for name, entry in section.get("properties", {}).items():
            text = json.dumps(entry)
            if '"number"' in text or '"integer"' in text:
                found += 1
                assert name in plain or name.endswith(units), name
    assert found > 40


def test_own_scenes_load(repo_dir: Path):
    paths = sorted((repo_dir / "configs").glob("*.yaml"))
    assert paths, "no configurations"
    for path in paths:
        cfg.load(path)
