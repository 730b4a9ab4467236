"""Single faults of a dataset, each with where and how the check must tell it."""

from __future__ import annotations

import json
import shutil

import numpy as np
from PIL import Image

S0, S1 = "test/000000", "test/000001"
"""The two scenes of the dataset that the faults are made for."""


def edit(path, change):
    """Applies a change to the content of a JSON file, which it may also replace."""
    value = json.loads(path.read_text())
    changed = change(value)
    path.write_text(json.dumps(value if changed is None else changed))


def read(path):
    with Image.open(path) as image:
        return np.array(image)


def write(path, array):
    Image.fromarray(array).save(path)


def seen_instance(root, scene=S0, hidden=False):
    """(image, gt id, entry) of the first instance that is seen; or that is hidden in part."""
    for key, rows in json.loads((root / scene / "scene_gt_info.json").read_text()).items():
        for k, row in enumerate(rows):
            covered = row["px_count_valid"] > row["px_count_visib"]
            if row["px_count_visib"] > 60 and (not hidden or covered):
                return int(key), k, row
    raise AssertionError("no such instance")


def info_fault(name, change):
    """A wrong value of a key of scene_gt_info."""

    def mutate(root):
        image, k, _ = seen_instance(root)

        def set_value(value):
            entry = value[str(image)][k]
            entry[name] = change(entry[name])

        edit(root / S0 / "scene_gt_info.json", set_value)

    return mutate


def pose_fault(change):
    """A wrong pose of an instance that is seen. change: (R, t) -> (R, t)."""

    def mutate(root):
        image, k, _ = seen_instance(root)

        def set_value(value):
            entry = value[str(image)][k]
            R, t = change(np.reshape(entry["cam_R_m2c"], (3, 3)), np.array(entry["cam_t_m2c"]))
            entry["cam_R_m2c"], entry["cam_t_m2c"] = R.ravel().tolist(), t.tolist()

        edit(root / S0 / "scene_gt.json", set_value)

    return mutate


def camera_fault(name, change):
    """A wrong value of a key of scene_camera."""

    def mutate(root):
        image, _, _ = seen_instance(root)

        def set_value(value):
            entry = value[str(image)]
            entry[name] = change(entry[name])

        edit(root / S0 / "scene_camera.json", set_value)

    return mutate


def coco_fault(change):
    """A change of the COCO object; change(coco, its first annotation)."""

    def mutate(root):
        edit(root / S0 / "scene_gt_coco.json", lambda value: change(value, value["annotations"][0]))

    return mutate


def json_fault(name, change):
    return lambda root: edit(root / name, change)


def removed(name):
    def mutate(root):
        path = root / name
        shutil.rmtree(path) if path.is_dir() else path.unlink()

    return mutate


def added(name):
    def mutate(root):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_bytes(b"")

    return mutate


def mask_fault(folder, change, **which):
    """A changed mask of an instance that is seen. change: (mask, the other mask, all visible)."""

    def mutate(root):
        image, k, _ = seen_instance(root, **which)
        paths = {name: root / S0 / name / f"{image:06d}_{k:06d}.png" for name in MASKS}
        others = [read(p) for p in (root / S0 / "mask_visib").glob(f"{image:06d}_*.png")]
        other = paths[next(name for name in MASKS if name != folder)]
        taken = np.maximum.reduce(others)
        write(paths[folder], change(read(paths[folder]), read(other), taken))

    return mutate


MASKS = ("mask", "mask_visib")


def one_pixel(mask, where, value=255):
    rows, columns = np.nonzero(where)
    mask[rows[0], columns[0]] = value
    return mask


def depth_fault(change):
    """A changed depth image. change: (depth, visible mask of an instance)."""

    def mutate(root):
        image, k, _ = seen_instance(root)
        visible = read(root / S0 / "mask_visib" / f"{image:06d}_{k:06d}.png") > 0
        path = root / S0 / "depth" / f"{image:06d}.png"
        write(path, change(read(path), visible))

    return mutate


def at_first(depth, visible, value):
    rows, columns = np.nonzero(visible)
    depth[rows[0], columns[0]] = value
    return depth


def cut_off(name, size):
    def mutate(root):
        (root / name).write_bytes((root / name).read_bytes()[:size])

    return mutate


def flipped_bit(root):
    path = root / S0 / "rgb" / "000000.png"
    data = bytearray(path.read_bytes())
    data[-30] ^= 1
    path.write_bytes(bytes(data))


def ply_text(old, new):
    def mutate(root):
        path = root / "models" / "obj_000005.ply"
        path.write_bytes(path.read_bytes().replace(old, new, 1))

    return mutate


def ply_vertex(root):
    """The first coordinate of the last vertex, a corner of the box."""
    path = root / "models" / "obj_000005.ply"
    data = bytearray(path.read_bytes())
    start = data.index(b"end_header\n") + len(b"end_header\n")
    data[start : start + 4] = np.array([2.5e3], "<f4").tobytes()
    path.write_bytes(bytes(data))


def swap_instances(root):
    image, _, _ = seen_instance(root)

    def swap(value):
        value[str(image)] = value[str(image)][::-1]

    edit(root / S0 / "scene_gt_info.json", swap)


def turn(R, t):
    """A quarter of a turn about the line of sight."""
    return np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]) @ R, t


def drop(mapping, key):
    mapping.pop(key)


def row_major(coco, entry):
    """Runs along the rows, a common mistake, of the same mask."""
    runs, (height, width) = entry["segmentation"]["counts"], entry["segmentation"]["size"]
    values = np.repeat(np.arange(len(runs)) % 2, runs).reshape(width, height).T.ravel()
    ends = np.flatnonzero(np.diff(values)) + 1
    bounds = [0, *ends.tolist(), values.size]
    entry["segmentation"]["counts"] = np.diff(bounds).tolist()


IMAGE = f"{S0}/rgb/000000.png"

FAULTS = {
    "no rgb": (removed(IMAGE), "000000.png", "is missing"),
    "no depth": (removed(f"{S0}/depth/000001.png"), "depth", "is missing"),
    "no mask": (removed(f"{S0}/mask/000001_000001.png"), "mask/", "is missing"),
    "no visible mask": (removed(f"{S0}/mask_visib/000001_000002.png"), "mask_visib", "is missing"),
    "no gt_info": (removed(f"{S0}/scene_gt_info.json"), "gt_info", "is missing"),
    "no coco": (removed(f"{S1}/scene_gt_coco.json"), "gt_coco", "is missing"),
    "no camera": (removed("camera.json"), "camera.json", "is missing"),
    "no source": (removed("dataset_info.json"), "dataset_info.json", "is missing"),
    "no card": (removed("dataset_info.md"), "dataset_info.md", "not finished"),
    "no targets": (removed("test_targets_bop24.json"), "bop24", "not finished"),
    "no model": (removed("models/obj_000007.ply"), "obj_000007", "is missing"),
    "no models_info": (removed("models/models_info.json"), "models_info", "is missing"),
    "no scene": (removed(S1), "", "does not agree"),
    "no split": (removed("test"), "test", "is missing"),
    "temporary file": (added(f"{S0}/rgb/000000.png.7.tmp"), "rgb", "not part"),
    "stray file": (added("notes.txt"), "notes.txt", "not part"),
    "stray folder in split": (added("test/aux/x"), "test/aux", "six digits"),
    "unfinished scene": (added(f"{S0}/.partial/000000.json"), S0, "not finished"),
    "unmerged shards": (added("shards/0-of-2.json"), "shards", "merge"),
    "mask without instance": (added(f"{S0}/mask/000000_000009.png"), "mask", "not part"),
    "cut rgb": (cut_off(IMAGE, 200), "rgb", "middle of a chunk"),
    "empty rgb": (cut_off(IMAGE, 0), "rgb", "no PNG"),
    "wrong checksum": (flipped_bit, "rgb", "checksum"),
    "rgb with alpha": (
        lambda root: write(root / IMAGE, np.full((64, 80, 4), 9, np.uint8)),
        "rgb",
        "RGB with alpha",
    ),
    "rgb of other size": (
        lambda root: write(root / IMAGE, np.full((64, 79, 3), 9, np.uint8)),
        "rgb",
        "79 x 64",
    ),
    "depth of 8 bits": (
        depth_fault(lambda depth, visible: (depth >> 8).astype(np.uint8)),
        "depth",
        "8-bit",
    ),
    "mask of ones": (mask_fault("mask", lambda m, *_: m // 255), "mask/", "neither 0 nor 255"),
    "mask of one bit": (mask_fault("mask", lambda m, *_: m > 0), "mask/", "1-bit"),
    "blurred mask": (
        mask_fault("mask_visib", lambda m, *_: one_pixel(m, m > 0, 254)),
        "mask_visib",
        "neither 0 nor 255",
    ),
    "visible outside the mask": (
        mask_fault("mask_visib", lambda m, whole, taken: one_pixel(m, whole == 0)),
        "mask_visib",
        "not in mask",
    ),
    "two at one pixel": (
        mask_fault(
            "mask_visib",
            lambda m, whole, taken: one_pixel(m, (whole > 0) & (m == 0) & (taken > 0)),
            hidden=True,
        ),
        "mask_visib",
        "another instance",
    ),
    "visible pixel lost": (
        mask_fault("mask_visib", lambda m, *_: one_pixel(m, m > 0, 0)),
        "scene_gt_info",
        "px_count_visib",
    ),
    "mask too large": (
        mask_fault("mask", lambda m, *_: np.full_like(m, 255)),
        "scene_gt",
        "projected model",
    ),
    "mask lost": (mask_fault("mask", lambda m, *_: m * 0), "mask_visib", "not in mask"),
    "px_count_visib": (info_fault("px_count_visib", lambda n: n + 1), "gt_info", "px_count_visib"),
    "px_count_valid": (info_fault("px_count_valid", lambda n: n - 1), "gt_info", "px_count_valid"),
    "px_count_all": (info_fault("px_count_all", lambda n: n // 2), "gt_info", "px_count_all"),
    "px_count_all of float": (info_fault("px_count_all", lambda n: n + 0.5), "gt_info", "integer"),
    "visib_fract": (info_fault("visib_fract", lambda n: 0.9 * n), "gt_info", "visib_fract"),
    "bbox_visib": (
        info_fault("bbox_visib", lambda b: [b[0], b[1], b[2] + 1, b[3] + 1]),
        "gt_info",
        "bbox_visib",
    ),
    "bbox_obj": (
        info_fault("bbox_obj", lambda b: [b[0] + 1, b[1], b[2] - 1, b[3]]),
        "gt_info",
        "bbox_obj",
    ),
    "bbox_obj too large": (
        info_fault("bbox_obj", lambda b: [-79, -63, 238, 190]),
        "scene_gt",
        "bbox_obj",
    ),
    "gt_info out of step": (swap_instances, "gt_info", "the masks say"),
    "stretched rotation": (pose_fault(lambda R, t: (R * (1 + 1e-7), t)), "scene_gt", "orthonormal"),
    "reflection": (pose_fault(lambda R, t: (-R, t)), "scene_gt", "determinant"),
    "transposed rotation": (pose_fault(lambda R, t: (R.T, t)), "", "instance"),
    "turned object": (pose_fault(turn), "", "instance"),
    "metres for millimetres": (pose_fault(lambda R, t: (R, t / 1e3)), "", "instance"),
    "another distance": (pose_fault(lambda R, t: (R, 1.5 * t)), "", "model's box"),
    "object behind the camera": (pose_fault(lambda R, t: (R, -t)), "scene_gt", "behind"),
    "another object": (
        json_fault(f"{S0}/scene_gt.json", lambda v: v["0"][0].update(obj_id=7)),
        "",
        "category_id",
    ),
    "unknown object": (
        json_fault(f"{S0}/scene_gt.json", lambda v: v["0"][0].update(obj_id=9)),
        "scene_gt",
        "not in models/",
    ),
    "key missing": (
        json_fault(f"{S0}/scene_gt.json", lambda v: drop(v["1"][0], "cam_t_m2c")),
        "scene_gt.json",
        "cam_t_m2c",
    ),
    "key too many": (
        json_fault(f"{S0}/scene_camera.json", lambda v: v["1"].update(extra=1)),
        "scene_camera",
        "extra",
    ),
    "not a number": (
        json_fault(f"{S0}/scene_gt.json", lambda v: v["1"][0].update(cam_t_m2c=[0, 0, np.nan])),
        "scene_gt.json",
        "finite",
    ),
    "padded ids": (
        json_fault(f"{S0}/scene_gt.json", lambda v: {f"{int(k):06d}": v[k] for k in v}),
        "scene_gt.json",
        "000000",
    ),
    "ids out of order": (
        json_fault(f"{S0}/scene_camera.json", lambda v: dict(reversed(v.items()))),
        "scene_camera",
        "order",
    ),
    "image missing": (
        json_fault(f"{S0}/scene_gt_info.json", lambda v: drop(v, "2")),
        "gt_info",
        "lacks images 2",
    ),
    "instance missing": (
        json_fault(f"{S0}/scene_gt_info.json", lambda v: v["2"].pop() and None),
        "gt_info",
        "entries",
    ),
    "key twice": (
        lambda root: (root / S0 / "scene_camera.json").write_text('{"0": {}, "0": {}}'),
        "scene_camera",
        "twice",
    ),
    "broken JSON": (cut_off(f"{S0}/scene_gt.json", 50), "scene_gt.json", "cannot be read"),
    "principal point": (
        camera_fault("cam_K", lambda K: [*K[:2], K[2] + 30, *K[3:]]),
        "",
        "instance",
    ),
    "transposed K": (
        camera_fault("cam_K", lambda K: np.reshape(K, (3, 3)).T.ravel().tolist()),
        "scene_camera",
        "cam_K",
    ),
    "camera mirrored": (
        camera_fault("cam_R_w2c", lambda R: [-R[0], -R[1], -R[2], *R[3:]]),
        "scene_camera",
        "determinant",
    ),
    "depth scale": (camera_fault("depth_scale", lambda s: 2.5 * s), "", "depth"),
    "depth halved": (depth_fault(lambda depth, visible: depth // 2), "depth", "model's box"),
    "depth missing": (
        depth_fault(lambda depth, visible: at_first(depth, visible, 0)),
        "depth",
        "no depth",
    ),
    "depth of one pixel": (
        depth_fault(lambda depth, visible: at_first(depth, visible, 65000)),
        "depth",
        "1 visible pixels",
    ),
    "saturated depth": (
        depth_fault(lambda depth, visible: at_first(depth, ~visible, 65535)),
        "depth",
        "saturation",
    ),
    "coco inverted": (
        coco_fault(lambda coco, a: a["segmentation"]["counts"].insert(0, 0)),
        "gt_coco",
        "segmentation",
    ),
    "coco by rows": (coco_fault(row_major), "gt_coco", "segmentation differs"),
    "coco cut": (
        coco_fault(lambda coco, a: a["segmentation"]["counts"].pop() and None),
        "gt_coco",
        "add up",
    ),
    "coco size": (
        coco_fault(lambda coco, a: a["segmentation"]["size"].reverse()),
        "gt_coco",
        "its size",
    ),
    "coco box": (
        coco_fault(lambda coco, a: a.update(bbox=[*a["bbox"][:2], a["bbox"][2] - 1, a["bbox"][3]])),
        "gt_coco",
        "bbox",
    ),
    "coco area": (coco_fault(lambda coco, a: a.update(area=a["area"] + 1)), "gt_coco", "area"),
    "coco ignore": (coco_fault(lambda c, a: a.update(ignore=not a["ignore"])), "gt_coco", "ignore"),
    "coco crowd": (coco_fault(lambda coco, a: a.update(iscrowd=1)), "gt_coco", "iscrowd"),
    "coco id twice": (
        coco_fault(lambda coco, a: coco["annotations"][1].update(id=1)),
        "gt_coco",
        "has id 1",
    ),
    "coco without one": (
        coco_fault(lambda coco, a: coco["annotations"].pop() and None),
        "gt_coco",
        "no annotation",
    ),
    "coco category": (
        coco_fault(lambda coco, a: coco["categories"].pop() and None),
        "gt_coco",
        "categories",
    ),
    "coco file name": (
        coco_fault(lambda coco, a: coco["images"][0].update(file_name="rgb/000000.jpg")),
        "gt_coco",
        "file_name",
    ),
    "coco time": (
        coco_fault(lambda coco, a: coco["images"][0].update(date_captured="2026-01-01")),
        "gt_coco",
        "date_captured",
    ),
    "coco image missing": (
        coco_fault(lambda coco, a: coco["images"].pop() and None),
        "gt_coco",
        "",
    ),
    "model diameter": (
        json_fault("models/models_info.json", lambda v: v["5"].update(diameter=1.0)),
        "models_info",
        "diameter",
    ),
    "model size": (
        json_fault(
            "models/models_info.json", lambda v: v["5"].update(size_x=v["5"]["size_x"] + 0.1)
        ),
        "models_info",
        "size_x",
    ),
    "model twice": (
        json_fault("models/models_info.json", lambda v: drop(v, "7")),
        "obj_000007",
        "not in models_info",
    ),
    "symmetry": (
        json_fault(
            "models/models_info.json",
            lambda v: v["5"].update(symmetries_discrete=[(2 * np.eye(4)).ravel().tolist()]),
        ),
        "models_info",
        "symmetries_discrete",
    ),
    "model moved": (ply_vertex, "models_info", "centred"),
    "model cut": (cut_off("models/obj_000005.ply", 900), "obj_000005", "bytes of data"),
    "model types": (ply_text(b"float x", b"float32 x"), "obj_000005", "float32"),
    "camera size": (json_fault("camera.json", lambda v: v.update(width=81)), "rgb", "must be 81"),
    "target count": (
        json_fault("test_targets_bop19.json", lambda v: v[0].update(inst_count=5)),
        "bop19",
        "does not agree",
    ),
    "card of another": (
        lambda root: (root / "dataset_info.md").write_text("# crowd\n"),
        "dataset_info.md",
        "does not agree",
    ),
    "camera too large": (
        json_fault("camera.json", lambda v: v.update(height=10**9)),
        "camera.json",
        "32768",
    ),
    "chunk too large": (
        json_fault("dataset_info.json", lambda v: v.update(chunk_size=2)),
        "scene_camera",
        "chunk size",
    ),
}
