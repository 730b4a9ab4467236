"""Faults that leave a dataset consistent with itself, or nearly so: only what it was made of tells.

Each is (dataset, how it is planted, the file that a finding must name, words of the finding).
"""

from __future__ import annotations

import hashlib
import io
import json
import shutil

import numpy as np
from PIL import Image
from tests.python.output.faults import S0, S1, edit, json_fault, read, write

from perilune.export.writers.bop_labels import NO_BOX, annotation, extent

CAMERA, GT, INFO, COCO = (
    f"{S0}/scene_{name}.json" for name in ("camera", "gt", "gt_info", "gt_coco")
)
AT = 1
"""The image that most faults are of."""


def load(root, name):
    return json.loads((root / name).read_text())


def seen(root, image=AT):
    """The instance of an image that shows most."""
    rows = load(root, INFO)[str(image)]
    return max(range(len(rows)), key=lambda k: rows[k]["px_count_visib"])


def hidden(root):
    """(image, instance) that nothing is seen of."""
    for key, rows in load(root, INFO).items():
        for k, row in enumerate(rows):
            if row["px_count_visib"] == 0:
                return key, k
    raise AssertionError("nothing is hidden")


# Pictures and what is told of them.


def picture(folder, change, image=AT, scene=S0):
    """change: array -> array, or with the dataset's folder."""

    def mutate(root):
        path = root / scene / folder / f"{image:06d}.png"
        write(path, np.ascontiguousarray(change(read(path))))

    return mutate


def copied(source, target):
    return lambda root: shutil.copyfile(root / source, root / target)


def swapped(first, second):
    def mutate(root):
        a, b = root / first, root / second
        text = a.read_bytes()
        a.write_bytes(b.read_bytes())
        b.write_bytes(text)

    return mutate


def box(mask):
    found = extent(mask)
    return NO_BOX if found is None else [*found[:2], found[2] - found[0], found[3] - found[1]]


def restate(root, image=AT):
    """Makes counts, boxes and annotations those of the masks and depth that are there now."""
    infos, gts, coco = load(root, INFO), load(root, GT), load(root, COCO)
    depth = read(root / S0 / "depth" / f"{image:06d}.png")
    entries = []
    for k, row in enumerate(infos[str(image)]):
        name = f"{image:06d}_{k:06d}.png"
        whole, visible = (read(root / S0 / folder / name) > 0 for folder in ("mask", "mask_visib"))
        cut = row["px_count_all"] - row["px_count_valid"]
        row["px_count_visib"] = int(visible.sum())
        row["px_count_valid"] = int((whole & (depth > 0)).sum())
        row["px_count_all"] = row["px_count_valid"] + max(cut, 0)
        row["visib_fract"] = row["px_count_visib"] / max(row["px_count_all"], 1)
        row["bbox_visib"] = box(visible)
        if cut == 0 or not visible.any():
            row["bbox_obj"] = box(whole) if visible.any() else NO_BOX
        if visible.any():
            obj_id = gts[str(image)][k]["obj_id"]
            entries.append(annotation(image, obj_id, whole, visible, row["visib_fract"]))
    others = [row for row in coco["annotations"] if row["image_id"] != image]
    rows = sorted(others + entries, key=lambda row: row["image_id"])
    coco["annotations"] = [{**row, "id": k} for k, row in enumerate(rows, start=1)]
    (root / INFO).write_text(json.dumps(infos))
    (root / COCO).write_text(json.dumps(coco))


def masks(change, folders=("mask", "mask_visib"), told=True):
    """Changed masks of the instance that shows most. told: counts and boxes agree with them."""

    def mutate(root):
        for folder in folders:
            path = root / S0 / folder / f"{AT:06d}_{seen(root):06d}.png"
            write(path, np.ascontiguousarray(change(read(path))))
        if told:
            restate(root)

    return mutate


def shifted(step, axis):
    return lambda mask: np.roll(mask, step, axis=axis)


def dilated(mask):
    return np.maximum.reduce([mask, *(np.roll(mask, s, axis=a) for s in (-1, 1) for a in (0, 1))])


def eroded(mask):
    return np.minimum.reduce([mask, *(np.roll(mask, s, axis=a) for s in (-1, 1) for a in (0, 1))])


def swap_masks(root):
    one, two = 0, 1
    for folder in ("mask", "mask_visib"):
        names = [f"{S0}/{folder}/{AT:06d}_{k:06d}.png" for k in (one, two)]
        swapped(*names)(root)
    restate(root)


def off_objects(change):
    """Depth changed where no object is seen."""

    def mutate(root):
        taken = [read(p) for p in (root / S0 / "mask_visib").glob(f"{AT:06d}_*.png")]
        free = np.maximum.reduce(taken) == 0
        path = root / S0 / "depth" / f"{AT:06d}.png"
        depth = read(path)
        write(path, np.where(free, change(depth), depth).astype(np.uint16))
        restate(root)

    return mutate


def garbage(array):
    rng = np.random.default_rng(5)
    return rng.integers(1, 60000, array.shape).astype(np.uint16)


def noisy(image, sigma=6.0):
    rng = np.random.default_rng(5)
    return np.clip(image + rng.normal(0, sigma, image.shape), 0, 255).astype(np.uint8)


def blurred(image):
    wide = image.astype(float)
    for axis in (0, 1):
        wide = (np.roll(wide, 1, axis) + wide + np.roll(wide, -1, axis)) / 3
    return wide.astype(np.uint8)


def with_tile(image, value=0):
    """A tile replaced, where the picture is bright."""
    bright = image.sum(axis=2).astype(float)
    row, column = np.unravel_index(bright.argmax(), bright.shape)
    changed = image.copy()
    changed[max(row - 6, 0) : row + 6, max(column - 6, 0) : column + 6] = value
    return changed


def one_pixel(image):
    changed = image.copy()
    row, column = np.unravel_index(image.sum(axis=2).argmax(), image.shape[:2])
    changed[row, column] = 255 - changed[row, column]
    return changed


def gamma(power):
    return lambda image: np.rint(255 * (image / 255) ** power).astype(np.uint8)


def recoded(image):
    """As JPEG would leave it."""
    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=60)
    return np.array(Image.open(file))


# Poses and cameras.


def entry(name, key, change, image=AT, instance=None):
    """A changed value of an entry of an image; of an instance if the file has some."""

    def mutate(root):
        def set_value(value):
            row = value[str(image)]
            if isinstance(row, list):
                row = row[seen(root) if instance is None else instance]
            row[key] = change(row[key])

        edit(root / name, set_value)

    return mutate


def turn(degrees, axis):
    angle = np.deg2rad(degrees)
    R = np.eye(3)
    a, b = (k for k in range(3) if k != axis)
    R[[a, a, b, b], [a, b, a, b]] = np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)
    return R


def turned(degrees, axis):
    return lambda R: (turn(degrees, axis) @ np.reshape(R, (3, 3))).ravel().tolist()


def moved(*step):
    return lambda t: np.add(t, step).tolist()


def pose(change, name=GT, rotation="cam_R_m2c", place="cam_t_m2c"):
    """change: (R, t) -> (R, t)."""

    def mutate(root):
        def set_value(value):
            row = value[str(AT)]
            row = row[seen(root)] if isinstance(row, list) else row
            R, t = change(np.reshape(row[rotation], (3, 3)), np.array(row[place]))
            row[rotation], row[place] = np.ravel(R).tolist(), np.ravel(t).tolist()

        edit(root / name, set_value)

    return mutate


def world(change):
    return pose(change, CAMERA, "cam_R_w2c", "cam_t_w2c")


def matrix(change):
    return entry(CAMERA, "cam_K", lambda K: np.ravel(change(np.reshape(K, (3, 3)))).tolist())


def plus(row, column, step):
    def change(K):
        K = K.copy()
        K[row, column] += step
        return K

    return change


def of_hidden(key, change):
    def mutate(root):
        image, k = hidden(root)

        def set_value(value):
            value[image][k][key] = change(value[image][k][key])

        edit(root / INFO, set_value)

    return mutate


def hidden_pose(key, change):
    def mutate(root):
        image, k = hidden(root)

        def set_value(value):
            value[image][k][key] = change(value[image][k][key])

        edit(root / GT, set_value)

    return mutate


def instances_reordered(root):
    """All that is told of two instances swapped: as good a dataset, but for its order."""
    for name in (GT, INFO):
        edit(root / name, lambda v: v.update({str(AT): [v[str(AT)][k] for k in (1, 0, 2)]}))
    for folder in ("mask", "mask_visib"):
        swapped(*(f"{S0}/{folder}/{AT:06d}_{k:06d}.png" for k in (0, 1)))(root)
    restate(root)


def frame_of_another(root):
    """Everything of image 2 also as image 1."""
    for name in (CAMERA, GT, INFO):
        edit(root / name, lambda v: v.update({"1": v["2"]}))
    for path in (root / S0).glob("*/000002*"):
        shutil.copyfile(path, path.with_name(path.name.replace("000002", "000001")))
    restate(root)


def without_image(root):
    """An image taken away from all files of its scene, the card aside."""
    for name in (CAMERA, GT, INFO):
        edit(root / name, lambda v: v.pop("2") and None)

    def shorter(coco):
        coco["images"] = [row for row in coco["images"] if row["id"] != 2]
        rows = [row for row in coco["annotations"] if row["image_id"] != 2]
        coco["annotations"] = [{**row, "id": k} for k, row in enumerate(rows, start=1)]

    edit(root / COCO, shorter)
    for path in (root / S0).glob("*/000002*"):
        path.unlink()


def more_scenes(root):
    shutil.copytree(root / S1, root / "test/000002")


def scenes_swapped(root):
    (root / S0).rename(root / "x")
    (root / S1).rename(root / S0)
    (root / "x").rename(root / S1)


# Models.

VERTEX = np.dtype(
    [(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")]
    + [(name, "u1") for name in ("red", "green", "blue")]
)
FACE = np.dtype([("count", "u1"), ("corners", "<i4", (3,))])


def ply(change, informed=True, name="obj_000005.ply"):
    """A changed model. change: (vertices, faces) -> (vertices, faces). informed: models_info.json
    agrees with it."""

    def mutate(root):
        path = root / "models" / name
        head, mark, body = path.read_bytes().partition(b"end_header\n")
        words = head.decode().split()
        count = int(words[words.index("vertex") + 1])
        vertices = np.frombuffer(body, VERTEX, count).copy()
        faces = np.frombuffer(body, FACE, offset=count * VERTEX.itemsize).copy()
        known = len(faces)
        vertices, faces = change(vertices, faces)
        head = head.replace(b"face %d" % known, b"face %d" % len(faces))
        path.write_bytes(head + mark + vertices.tobytes() + faces.tobytes())
        if informed:
            restate_models(root, vertices, str(int(name[4:10])))

    return mutate


def restate_models(root, vertices, key):
    points = np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(float)
    low, high = points.min(axis=0), points.max(axis=0)
    longest = np.linalg.norm(points[:, None] - points[None], axis=2).max()

    def set_value(value):
        value[key].update(diameter=float(longest))
        for k, axis in enumerate("xyz"):
            value[key][f"min_{axis}"] = float(low[k])
            value[key][f"size_{axis}"] = float(high[k] - low[k])

    edit(root / "models/models_info.json", set_value)


def columns(change, names="xyz"):
    """change: (n, 3) -> (n, 3) of some properties of all vertices."""
    keys = {"xyz": ["x", "y", "z"], "normals": ["nx", "ny", "nz"], "rgb": ["red", "green", "blue"]}

    def apply(vertices, faces):
        rows = np.stack([vertices[key] for key in keys[names]], axis=1)
        rows = change(rows)
        for k, key in enumerate(keys[names]):
            vertices[key] = rows[:, k]
        return vertices, faces

    return ply(apply)


def inner_noise(points):
    """Vertices moved, but not those on the box."""
    rng = np.random.default_rng(2)
    inside = (np.abs(points) < 0.99 * np.abs(points).max(axis=0)).all(axis=1)
    return points + inside[:, None] * rng.normal(0, 5.0, points.shape)


def faces_turned(vertices, faces):
    faces["corners"] = faces["corners"][:, ::-1].copy()
    return vertices, faces


def models_swapped(root):
    swapped("models/obj_000005.ply", "models/obj_000007.ply")(root)
    edit(root / "models/models_info.json", lambda v: v.update({"5": v["7"], "7": v["5"]}))


# What describes the dataset.


def configured(change, hashed=False):
    """A changed configuration. hashed: dataset_info.json agrees with it."""

    def mutate(root):
        edit(root / "config.json", lambda value: change(value["tree"]) and None)
        if hashed:
            tree = {k: v for k, v in load(root, "config.json")["tree"].items() if k != "seed"}
            text = json.dumps(tree, sort_keys=True, separators=(",", ":"))
            digest = hashlib.sha256(text.encode()).hexdigest()
            edit(root / "dataset_info.json", lambda v: v.update(config_sha256=digest))

    return mutate


def told(**changes):
    return json_fault("dataset_info.json", lambda value: value.update(changes))


def written(name, text):
    return lambda root: (root / name).write_text(text)


def without_end(name, part=0.5):
    def mutate(root):
        data = (root / name).read_bytes()
        (root / name).write_bytes(data[: int(len(data) * part)])

    return mutate
