"""Frames as a pure function: threads, order, processes, pickling; samples, labels, arguments."""

from __future__ import annotations

import hashlib
import math
import multiprocessing
import pickle

import numpy as np
import pytest

import perilune
from perilune import _core
from perilune.base import processors, rotations
from perilune.config import ConfigError
from perilune.document.loader import read_tree
from perilune.frame import shutter

ALL = [channel["name"] for channel in _core.CHANNELS] + ["masks", "objects"]
SMALL = {"camera.width": 64, "camera.height": 48, "render.samples": 2, "render.max_bounces": 1}


@pytest.fixture
def scene(repo_dir):
    """The tree of the small scene, free to be changed."""
    return read_tree(repo_dir / "tests/python/scene.yaml")


@pytest.fixture
def base(repo_dir):
    """What its paths refer to."""
    return repo_dir / "tests/python"


@pytest.fixture(scope="module")
def sim(request):
    """The small scene, opened; its satellite has drivers, so that they are part of the tests."""
    path = request.config.rootpath / "tests/python/scene.yaml"
    return perilune.open(
        path,
        overrides={
            "camera.exposure_time_s": 0.01,
            "camera.sensor": {},
            "camera.fov_deg": {
                "ideal": 40.0, "jitter_variance": 9.0, "clip_min": 30.0, "clip_max": 50.0
            },
        },
    )  # fmt: skip


def digest(sample) -> str:
    """SHA-256 of every array and label of a sample."""
    state = hashlib.sha256()
    for name in sorted(sample):
        state.update(name.encode() + np.ascontiguousarray(sample[name]).tobytes())
    for array in (sample.objects, sample.camera.K, sample.camera.R_w2c, sample.camera.t_w2c):
        state.update(np.ascontiguousarray(array).tobytes())
    state.update(repr(sorted(sample.meta["drivers"].items())).encode())
    state.update(repr(sample.meta["white_radiance"]).encode())
    return state.hexdigest()


def digests(simulation_, frames=range(4), threads=1):
    return [digest(simulation_.frame(i, channels=ALL, threads=threads)) for i in frames]


def send_digests(simulation_, queue):
    queue.put(digests(simulation_))


@pytest.fixture(scope="module")
def reference(sim):
    return digests(sim)


def test_two_threads(sim, reference):
    assert digests(sim, threads=2) == reference
    assert len(set(reference)) == 4


def test_reversed_order_and_again(sim, reference):
    assert digests(sim, reversed(range(4)))[::-1] == reference


def test_pickled(sim, reference):
    assert digests(pickle.loads(pickle.dumps(sim))) == reference


@pytest.mark.parametrize("method", ["spawn", "fork"])
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_second_process(sim, reference, method):
    """The parent has rendered before: a forked child must not touch its renderer."""
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    process = context.Process(target=send_digests, args=(sim, queue))
    process.start()
    try:
        assert queue.get(timeout=120) == reference
    finally:
        process.join(timeout=30)
    assert process.exitcode == 0


def test_frames_do_not_depend_on_the_channels_asked_for(sim):
    whole = sim.frame(1, channels=ALL)
    for name in ALL[:-1]:
        part = sim.frame(1, channels=[name])
        assert list(part) == [name]
        assert part[name].tobytes() == whole[name].tobytes()


def test_other_seeds_give_other_frames(scene, base):
    frames = [
        digest(perilune.open(scene, seed, {"camera.sensor": {}}, base=base).frame(0, channels=ALL))
        for seed in (1, 2)
    ]
    assert frames[0] != frames[1]


def test_the_target_is_in_the_middle(sim):
    for index in range(4):
        sample = sim[index]
        (label,) = sample.objects
        projected = sample.camera.K @ label["t_m2c"]
        assert np.abs(projected[:2] / projected[2] - [23.5, 15.5]).max() < 1e-3
        assert 12.0 <= label["t_m2c"][2] <= 20.0
        assert label["px_count_visib"] == (sample["instance"] == label["instance_id"]).sum() > 0


def test_camera_and_object_labels_agree_with_the_world(sim):
    place, sample = shutter.middle(sim.world(2)), sim[2]
    target = place.poses["sat"][0, :3]
    camera = sample.camera
    assert np.abs(camera.R_w2c @ target + camera.t_w2c - sample.objects[0]["t_m2c"]).max() < 1e-6
    assert np.abs(camera.R_w2c @ camera.R_w2c.T - np.eye(3)).max() < 1e-12
    q = place.poses["sat"][0, 3:]
    assert np.abs(
        camera.R_w2c @ rotations.to_matrix(q) - sample.objects[0]["R_m2c"]
    ).max() < 1e-9  # fmt: skip
    keys = sim.request(2)["motion"]["camera"]
    assert np.abs(camera.position_m - keys[len(keys) // 2, :3]).max() < 1e-6


def test_labels_alone_are_those_beside_colour(sim):
    names = ["depth", "normal", "instance", "incidence", "emission", "phase"]
    both, alone = sim.frame(3, channels=[*names, "rgb"]), sim.frame(3, channels=names)
    for name in names:
        np.testing.assert_array_equal(both[name], alone[name])
    assert both.meta["white_radiance"] > 0.0
    assert alone.meta["white_radiance"] is None  # nothing shows it: it is not measured


def test_intrinsics(scene, base):
    K = perilune.open(scene, base=base).request(0)["K"]
    # Horizontal field of view, edge to edge: the edge of pixel 0 is at -0.5.
    left = math.degrees(math.atan2(-0.5 - K[0, 2], K[0, 0]))
    assert abs(left + 20.0) < 1e-12
    assert K[0, 0] == K[1, 1]
    assert K[1, 2] == 15.5
    rows = [60.0, 0.5, 20.0, 0.0, 61.0, 10.0, 0.0, 0.0, 1.0]
    changes = {"camera.fov_deg": None, "camera.K": rows}
    assert (perilune.open(scene, 0, changes, base=base).request(0)["K"].ravel() == rows).all()


def test_meta_and_repr(sim):
    sample = sim[3]
    assert sample.meta["seed"] == 7
    assert sample.meta["index"] == 3
    assert sample.meta["time_utc"] == "2026-03-20T12:03:00.000Z"
    assert 30.0 <= sample.meta["drivers"]["camera.fov_deg"] <= 50.0
    assert sample.meta["white_radiance"] > 0.0
    assert set(sample.meta["timings_s"]) >= {"render"}
    assert "Sample 3" in repr(sample)
    assert "rgb: uint8 (32, 48, 3)" in repr(sample)
    assert "seed 7" in repr(sim)
    with pytest.raises(KeyError, match="'normal' was not asked for"):
        sample["normal"]
    with pytest.raises(AttributeError, match="ask for the channel 'objects'"):
        _ = sim.frame(0, channels=["depth"]).objects


def test_plan(sim):
    planned = sim.plan(1)
    assert [row["name"] for row in planned] == [row["name"] for row in _core.EFFECTS]
    assert all(row["reason"] for row in planned)
    rendered = sim[1].plan
    for a, b in zip(planned, rendered, strict=True):
        assert (a["name"], a["on"]) == (b["name"], b["on"])


def test_taxonomy_and_label_images_agree(sim):
    labels = sim.taxonomy
    assert labels.levels == ("kind", "object", "part")
    assert labels.instances == {"earth": 1, "sat": 2}
    sample = sim[0]
    assert set(np.unique(sample["instance"])) <= {0, 1, 2}
    for pixels, name in ((sample["instance"] == 1, "earth"), (sample["instance"] == 2, "sat")):
        kinds = {labels.names("kind")[i] for i in np.unique(sample["semantic"][pixels, 0])}
        assert kinds <= {"body" if name == "earth" else "spacecraft"}
        objects = {labels.names("object")[i] for i in np.unique(sample["semantic"][pixels, 1])}
        assert objects <= {name}
        owners = {p.owner for p in labels.parts if p.id in np.unique(sample["part"][pixels])}
        assert owners <= {name}
    assert len(labels.parts) == 1 + len(sim.models["sat"].model.parts)
    assert labels.channel_names["semantic/1"] == {0: "background", 1: "earth", 2: "sat"}
    with pytest.raises(ValueError, match="did you mean 'part'"):
        labels.names("parts")


def test_part_classes(scene, base):
    first = perilune.open(scene, base=base)
    names = sorted({p["name"] for p in first.models["sat"].model.parts})
    scene["labels"] = {
        "part_classes": {"chosen": [names[0].upper()]},
        "ids": {"part": {"chosen": 40}, "kind": {"spacecraft": 1}},
    }
    labels = perilune.open(scene, base=base).taxonomy
    assert labels.classes["part"] == {"surface": 1, "chosen": 40, "other": 2}
    assert labels.classes["kind"] == {"spacecraft": 1, "body": 2}
    for part in labels.parts[1:]:
        assert (part.class_name == "chosen") == (part.name == names[0])
    scene["labels"]["ids"] = {"part": {"chose": 40}}
    with pytest.raises(ConfigError, match="did you mean 'chosen'"):
        _ = perilune.open(scene, base=base).taxonomy


def test_model_scale(scene, base):
    model = perilune.open(scene, base=base).models["sat"]
    low, high = model.model.bounds
    assert abs((high - low).max() * model.metres_per_unit - 6.0) < 1e-6
    assert (model.offset == 0.5 * (low + high)).all()
    assert model.radius_m <= 0.5 * math.sqrt(3.0) * 6.0
    scene["spacecraft"]["sat"] |= {"centre": "origin", "metres_per_unit": 2.0}
    del scene["spacecraft"]["sat"]["size_m"]
    model = perilune.open(scene, base=base).models["sat"]
    assert (model.offset == 0.0).all()
    assert model.metres_per_unit == 2.0


def test_obj_ids(scene, base):
    craft = scene["spacecraft"]["sat"]
    ahead = {**craft["orbit"], "mean_anomaly_deg": 20.1}
    scene["spacecraft"] = {
        "a": craft,
        "b": {**craft, "orbit": ahead, "obj_id": 1},
        "c": {**craft, "obj_id": 1},
    }
    scene["camera"]["trajectory"]["target"] = "a"
    models = perilune.open(scene, base=base).models
    assert {name: row.obj_id for name, row in models.items()} == {"a": 2, "b": 1, "c": 1}
    scene["spacecraft"]["c"] = {**craft, "obj_id": 1, "size_m": 7.0}
    with pytest.raises(ConfigError, match=r"spacecraft\.c\.obj_id = 1: b has it too"):
        _ = perilune.open(scene, base=base).models


def test_out_is_written_in_place(sim):
    first = sim.frame(0, channels=ALL)
    out = {**first, "objects": first.objects}
    second = sim.frame(1, channels=ALL, out=out)
    assert second["rgb"] is out["rgb"]
    assert second.objects is out["objects"]
    assert digest(second) == digest(sim.frame(1, channels=ALL))
    with pytest.raises(ValueError, match=r"out\['rgb'\]: must be a C-contiguous uint8 array"):
        sim.frame(0, out={"rgb": out["rgb"][:, ::2]})


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda s: s[-1], IndexError, "indices run from 0"),
        (lambda s: s[1.5], TypeError, "an integer"),
        (lambda s: s.frame(0, channels=["rgbb"]), ConfigError, "did you mean 'rgb'"),
        (lambda s: s.frame(0, threads=0), ValueError, "threads = 0"),
    ],
)
def test_arguments(sim, call, error, text):
    with pytest.raises(error, match=text):
        call(sim)


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("bodies.earth.kind", "eart", "did you mean 'earth'"),
        ("bodies.earth.reflectance", "lambrt", "did you mean 'lambert'"),
        ("render.force_off", ["bounce"], "did you mean 'bounces'"),
        ("render.channels", ["rgb", "dept"], "did you mean 'depth'"),
        ("spacecraft.sat.orbit.semi_major_axis_km", 6000.0, r"spacecraft\.sat: the periapsis"),
        ("bodies.rock", {"kind": "ellipsoid", "radii_km": 1, "gm_km3_s2": 1, "albedo": 0.1},
         r"bodies\.rock: its place is not known"),
        ("bodies.terra", {"kind": "earth"}, r"bodies\.terra: it stands where the root"),
    ],
)  # fmt: skip
def test_names_are_checked_when_opened(scene, base, key, value, text):
    changes = {key: value}
    if "semi_major" in key:
        changes["spacecraft.sat.orbit.altitude_km"] = None
    with pytest.raises(ConfigError, match=text):
        perilune.open(scene, 0, changes, base=base)


def test_missing_model_names_the_key(scene, base):
    sim = perilune.open(scene, 0, {"spacecraft.sat.model": "nothing.glb"}, base=base)
    with pytest.raises(FileNotFoundError, match=r"spacecraft\.sat\.model.*nothing\.glb"):
        _ = sim.models


def test_moon_is_where_the_ephemeris_puts_it(scene, base):
    scene["bodies"]["moon"] = {"kind": "moon"}
    place = perilune.open(scene, base=base).world(0)
    distance = np.linalg.norm(place.position_m("moon"))
    assert 356e6 < distance < 407e6
    from_moon = perilune.open(
        scene, 0, {"root": "moon"}, base=base
    ).world(0)  # fmt: skip
    assert np.abs(from_moon.position_m("earth") + place.position_m("moon")).max() < 1e-3
    shift = from_moon.position_m("sat") - from_moon.position_m("earth")
    assert np.abs(shift - place.position_m("sat")).max() < 1e-3
    sun_shift = from_moon.sun_position_m - place.sun_position_m
    assert np.abs(sun_shift + place.position_m("moon")).max() < 1e-3


def test_orbit_elements(scene, base):
    """Radius, speed and plane of an eccentric orbit, against the two-body formulas."""
    orbit = {
        "around": "earth", "periapsis_km": 7000.0, "eccentricity": 0.3, "inclination_deg": 40.0,
        "raan_deg": 25.0, "arg_periapsis_deg": 70.0, "true_anomaly_deg": 50.0,
    }  # fmt: skip
    changes = {"spacecraft.sat.orbit": orbit, "camera.exposure_time_s": 1e-3}
    place = perilune.open(scene, 0, changes, base=base).world(0)
    opening, closing = place.poses["sat"][:, :3]
    radius = 7000e3 * 1.3 / (1.0 + 0.3 * math.cos(math.radians(50.0)))
    assert abs(np.linalg.norm(opening) - radius) < 1e-3
    gm = _core.BODIES["earth"]["gm_m3_s2"]
    speed = math.sqrt(gm * (2.0 / radius - 0.7 / 7000e3))
    velocity = (closing - opening) / 1e-3
    assert abs(np.linalg.norm(velocity) / speed - 1.0) < 1e-5
    normal = np.cross(opening, velocity) / np.linalg.norm(np.cross(opening, velocity))
    tilt, node = math.radians(40.0), math.radians(25.0)
    expected = [math.sin(tilt) * math.sin(node), -math.sin(tilt) * math.cos(node), math.cos(tilt)]
    assert np.abs(normal - expected).max() < 1e-5
    latitude = math.degrees(math.asin(opening[2] / radius))
    sine = math.sin(tilt) * math.sin(math.radians(120.0))
    assert abs(latitude - math.degrees(math.asin(sine))) < 1e-6


@pytest.mark.parametrize(
    ("eccentricity", "true_anomaly_deg"), [(0.0, 200.0), (0.6, -100.0), (1.0, 80.0), (1.7, 100.0)]
)
def test_true_anomaly_on_every_conic(scene, base, eccentricity, true_anomaly_deg):
    orbit = {
        "around": "earth", "periapsis_km": 8000.0, "eccentricity": eccentricity,
        "true_anomaly_deg": true_anomaly_deg,
    }  # fmt: skip
    place = perilune.open(scene, 0, {"spacecraft.sat.orbit": orbit}, base=base).world(0)
    x, y, z = place.position_m("sat")
    radius = (
        8000e3 * (1 + eccentricity) / (1 + eccentricity * math.cos(math.radians(true_anomaly_deg)))
    )
    assert abs(math.hypot(x, y, z) - radius) < 1e-3
    assert abs(math.remainder(math.atan2(y, x) - math.radians(true_anomaly_deg), math.tau)) < 1e-10


def test_beyond_the_asymptote_is_refused(scene, base):
    orbit = {
        "around": "earth", "periapsis_km": 8000.0, "eccentricity": 2.0, "true_anomaly_deg": 130.0,
    }  # fmt: skip
    with pytest.raises(ConfigError, match="between -120 and 120 deg"):
        perilune.open(scene, 0, {"spacecraft.sat.orbit": orbit}, base=base)


def test_sun_direction_can_be_stated(scene, base):
    changes = {"sun.direction": [0, 0, -2], "sun.distance_au": 2.0}
    request = perilune.open(scene, 0, changes, base=base).request(0)
    assert np.abs(request["sun_position"] - [0, 0, -2 * 149597870700.0]).max() < 1e-3


def test_demo(repo_dir):
    """The configuration of the repository renders, small, and shows its spacecraft."""
    sim = perilune.open(repo_dir / "configs/demo.yaml", overrides=SMALL)
    for index in range(2):
        sample = sim.frame(index, channels=["rgb", "instance", "objects"])
        assert (sample.objects["px_count_visib"] > 20).any()
        assert sample["rgb"].max() > 100


def test_default_threads_is_what_the_process_may_use():
    assert 1 <= processors.default_threads() <= 4096
