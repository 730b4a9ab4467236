"""Faults of what not every dataset has: moving parts, rolling shutters, sensors, channels."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from tests.python.output.faults import edit, json_fault, read, removed
from tests.python.output.planted import copied, moved, swapped, turn, turned, without_end, write
from tests.python.output.retrace import write_sheets

import perilune
from perilune.export.check import check_bop

S = "val/000000"
GT, CAMERA = f"{S}/scene_gt.json", f"{S}/scene_camera.json"
PARTS = "models_parts"
CHANNELS = ["sensor_rgb", "raw", "normal", "instance", "semantic", "part"]


def kinds(small_scene, folder):
    """Two sensors with rolling shutters, blur, noise and electronics, drivers, a moving part."""
    model = write_sheets(
        folder / "sheets.gltf",
        bus={"place": [0, 0, 0], "material": {"doubleSided": True}},
        wing={"place": [0, 2, 0], "half": 0.8, "material": {"doubleSided": True}},
    )
    joints = [{"node": "wing", "axis": [0, 0, 1], "rate_deg_s": 9.0}]
    return perilune.open(
        small_scene,
        overrides={
            "spacecraft.probe.model": str(model),
            "spacecraft.probe.articulation": joints,
            "spacecraft.probe.attitude": {"spin_rate_deg_s": 7.0},
            "camera.width": 48,
            "camera.height": 36,
            "camera.fov_deg": {"uniform": [25, 35]},
            "camera.sensor": {},
            "camera.line_time_us": 30000.0,
            "camera.exposure_time_s": 0.02,
            "sensors": {"left": {}, "right": {"transformation": [0.5, 0, 0, 1, 0, 0, 0]}},
            "sun.irradiance_w_m2": {"uniform": [1300, 1400]},
            "render.samples": 8,
            "render.tolerance_dn": 0.0,
            "render.channels": CHANNELS,
        },
    )


@pytest.fixture(scope="module")
def good(small_scene, tmp_path_factory):
    folder = tmp_path_factory.mktemp("kinds")
    out = folder / "out"
    perilune.write_bop(kinds(small_scene, folder), range(3), out, threads=1, split="val")
    return out


def entry(change, name=GT, image="1"):
    """change: of what a file says of an image; of its first instance."""

    def mutate(root):
        def set_value(value):
            row = value[image]
            change(row[0] if isinstance(row, list) else row)

        edit(root / name, set_value)

    return mutate


def wing(change):
    """change: (4, 4) -> (4, 4) of the motion of the wing."""

    def set_value(row):
        motion = np.reshape(row["articulation"]["wing"], (4, 4))
        row["articulation"]["wing"] = np.ravel(change(motion)).tolist()

    return entry(set_value)


def block(R):
    out = np.eye(4)
    out[:3, :3] = R
    return out


def slid(motion):
    moved_on = motion.copy()
    moved_on[:3, 3] += [5.0, 0, 0]
    return moved_on


def row(change, name=GT, number=1):
    """change: of what is told of one of the rows."""
    return entry(lambda at: change(at["rows"][number]), name)


def array(folder, change, image=1):
    def mutate(root):
        path = root / S / folder / f"{image:06d}.npy"
        np.save(path, change(np.load(path)))

    return mutate


def image(folder, change):
    def mutate(root):
        path = root / S / folder / "000001.png"
        write(path, np.ascontiguousarray(change(read(path))))

    return mutate


def set_key(key, change):
    return lambda row: row.update({key: change(row[key])})


def frame(**changes):
    return entry(lambda row: row["frame"].update(changes), CAMERA)


def driver(name, value):
    return entry(lambda row: row["frame"]["drivers"].update({name: value}), CAMERA)


def info(change, name="dataset_info.json"):
    return json_fault(name, lambda value: change(value) and None)


FAULTS = {
    "part turned": (wing(lambda m: m @ block(turn(0.5, 2))), GT, "articulation"),
    "part turned slightly": (wing(lambda m: m @ block(turn(1e-3, 0))), GT, "articulation"),
    "part moved": (wing(slid), GT, "articulation"),
    "part at rest": (wing(lambda m: np.eye(4)), GT, "articulation"),
    "part's motion inverted": (wing(np.linalg.inv), GT, "articulation"),
    "no articulation": (entry(lambda row: row.pop("articulation")), GT, "articulation"),
    "articulation of another node": (
        entry(lambda row: row.update(articulation={"bus": row["articulation"]["wing"]})),
        GT,
        "articulation",
    ),
    "articulation of another image": (
        json_fault(GT, lambda v: v["1"][0].update(articulation=v["2"][0]["articulation"])),
        GT,
        "articulation",
    ),
    "a row turned": (row(set_key("cam_R_m2c", turned(0.1, 2))), GT, "rows[1].cam_R_m2c"),
    "a row moved": (row(set_key("cam_t_m2c", moved(0, 1, 0))), GT, "rows[1].cam_t_m2c"),
    "a row's part": (row(lambda at: at.pop("articulation")), GT, "rows[1].articulation"),
    "a row of another number": (row(lambda at: at.update(row=at["row"] + 1)), GT, "rows[1].row"),
    "rows reversed": (entry(lambda at: at["rows"].reverse()), GT, "rows"),
    "rows lost": (entry(lambda at: at.pop("rows")), GT, "rows"),
    "a row lost": (entry(lambda at: at["rows"].pop(1)), GT, "rows"),
    "a camera's row moved": (
        row(set_key("cam_t_w2c", moved(1, 0, 0)), CAMERA),
        CAMERA,
        "rows[1].cam_t_w2c",
    ),
    "a camera's row turned": (
        row(set_key("cam_R_w2c", turned(0.1, 0)), CAMERA),
        CAMERA,
        "rows[1].cam_R_w2c",
    ),
    "a driver's value": (driver("sun.irradiance_w_m2", 1350.0), CAMERA, "drivers"),
    "a driver lost": (
        entry(lambda at: at["frame"]["drivers"].pop("camera.fov_deg"), CAMERA),
        CAMERA,
        "camera.fov_deg",
    ),
    "a driver too many": (driver("camera.width", 48), CAMERA, "drivers"),
    "drivers of another image": (
        json_fault(
            CAMERA,
            lambda v: v["1"].update(
                frame={**v["1"]["frame"], "drivers": v["2"]["frame"]["drivers"]}
            ),
        ),
        CAMERA,
        "drivers",
    ),
    "index of the frame": (frame(index=2), CAMERA, "frame.index"),
    "scene's drivers": (frame(scene_drivers={"camera.fov_deg": 30.0}), CAMERA, "scene_drivers"),
    "no frame": (entry(lambda row: row.pop("frame"), CAMERA), CAMERA, "frame"),
    "the other sensor": (entry(lambda row: row.update(sensor="left"), CAMERA), CAMERA, "sensor"),
    "no sensor": (entry(lambda row: row.pop("sensor"), CAMERA), CAMERA, "sensor"),
    "sensors swapped": (info(lambda v: v["sensors"].reverse()), "", "sensor"),
    "sensor's interval": (
        info(lambda v: v["sensors"][1].update(trigger_interval=2)),
        "dataset_info",
        "trigger_interval",
    ),
    "raw brighter by one": (image("raw", lambda a: a + 1), f"{S}/raw", "differ"),
    "raw of another image": (
        copied(f"{S}/raw/000002.png", f"{S}/raw/000001.png"),
        "raw",
        "that of",
    ),
    "raw black": (image("raw", np.zeros_like), f"{S}/raw", "black"),
    "raw with bytes swapped": (image("raw", lambda a: a.byteswap()), f"{S}/raw", "differ"),
    "raw mirrored": (image("raw", lambda a: a[:, ::-1]), f"{S}/raw", "mirrored"),
    "raw of 8 bits": (image("raw", lambda a: (a >> 8).astype(np.uint8)), f"{S}/raw", "8-bit"),
    "sensor's picture mirrored": (image("rgb", lambda a: a[:, ::-1]), f"{S}/rgb", "mirrored"),
    "sensors' pictures swapped": (
        swapped(f"{S}/rgb/000000.png", f"{S}/rgb/000001.png"),
        f"{S}/rgb",
        "differ",
    ),
    "normals flipped": (array("normal", np.negative), "normal", "differ"),
    "normals of another image": (
        copied(f"{S}/normal/000002.npy", f"{S}/normal/000001.npy"),
        "normal",
        "differ",
    ),
    "normals not finite": (array("normal", lambda a: a * np.nan), "normal", "differ"),
    "normals in double": (array("normal", lambda a: a.astype(float)), "normal", "float64"),
    "normals cut": (without_end(f"{S}/normal/000001.npy"), "normal", ""),
    "normals lost": (removed(f"{S}/normal/000001.npy"), "normal", "is missing"),
    "classes moved on": (image("semantic", lambda a: a + (a > 0)), "semantic", "differ"),
    "classes mirrored": (image("semantic", lambda a: a[:, ::-1]), "semantic", "differ"),
    "instances lost": (image("instance", np.zeros_like), "instance", "differ"),
    "parts shifted": (image("part", lambda a: np.roll(a, 1, 0)), "part", "differ"),
    "parts of 16 bits": (image("part", lambda a: a.astype(np.uint16)), "part", "16-bit"),
    "names of the ids": (info(lambda v: v["labels"]["part"].update({"1": "x"})), "", "labels.part"),
    "a channel not told": (info(lambda v: v["channels"].pop("normal")), "", "normal"),
    "a channel of another type": (
        info(lambda v: v["channels"]["part"].update(dtype="uint16")),
        "",
        "part",
    ),
    "a part's nodes": (
        info(lambda v: v["2"].update(nodes=["bus"]), f"{PARTS}/models_info.json"),
        f"{PARTS}/models_info.json",
        "nodes",
    ),
    "a part's object": (
        info(lambda v: v["2"].update(obj_id=2), f"{PARTS}/models_info.json"),
        f"{PARTS}/models_info.json",
        "obj_id",
    ),
    "parts swapped": (
        swapped(f"{PARTS}/obj_000001.ply", f"{PARTS}/obj_000002.ply"),
        PARTS,
        "",
    ),
    "a part lost": (removed(f"{PARTS}/obj_000002.ply"), f"{PARTS}/obj_000002", "is missing"),
    "parts lost": (removed(PARTS), "", "missing"),
    "the whole for a part": (
        copied("models/obj_000001.ply", f"{PARTS}/obj_000002.ply"),
        f"{PARTS}/obj_000002",
        "not the model",
    ),
}


def test_good_dataset_has_no_finding(good):
    report = check_bop(good, rerender=0)
    assert report.findings == []
    assert any("again" in note for note in report.notes)
    assert check_bop(good, alone=True).findings == []


@pytest.mark.parametrize("name", FAULTS)
def test_fault_is_found(good, tmp_path, name):
    mutate, file, reason = FAULTS[name]
    root = tmp_path / "kinds"
    shutil.copytree(good, root)
    mutate(root)
    findings = check_bop(root, rerender=1).findings
    assert any(file in f.file and reason in f.reason for f in findings), findings
