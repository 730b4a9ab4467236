"""The table of planted faults: (how it is planted, the file, words of the finding)."""

from __future__ import annotations

import numpy as np
from tests.python.output.faults import S0, S1, json_fault, removed
from tests.python.output.planted import (
    CAMERA,
    COCO,
    GT,
    INFO,
    blurred,
    columns,
    configured,
    copied,
    dilated,
    entry,
    eroded,
    faces_turned,
    frame_of_another,
    gamma,
    garbage,
    hidden_pose,
    inner_noise,
    instances_reordered,
    masks,
    matrix,
    models_swapped,
    more_scenes,
    moved,
    noisy,
    of_hidden,
    off_objects,
    one_pixel,
    picture,
    plus,
    ply,
    pose,
    recoded,
    scenes_swapped,
    shifted,
    swap_masks,
    swapped,
    told,
    turn,
    turned,
    with_tile,
    without_end,
    without_image,
    world,
    written,
)

RGB, DEPTH = f"{S0}/rgb/000001.png", f"{S0}/depth/000001.png"
OTHER_RGB, OTHER_DEPTH = f"{S0}/rgb/000002.png", f"{S0}/depth/000002.png"
MODEL, MODELS = "obj_000005.ply", "models_info"

CAMERAS = {
    "K 1.002": (matrix(lambda K: K * [[1.002], [1.002], [1]]), "scene_camera", "cam_K"),
    "fx 1.002": (entry(CAMERA, "cam_K", lambda K: [1.002 * K[0], *K[1:]]), "scene_camera", "cam_K"),
    "fy 1.002": (matrix(lambda K: K * [[1], [1.002], [1]]), "scene_camera", "cam_K"),
    "cx by half a pixel": (matrix(plus(0, 2, 0.5)), "scene_camera", "cam_K"),
    "cy by half a pixel": (matrix(plus(1, 2, -0.5)), "scene_camera", "cam_K"),
    "cx by 1e-6 pixels": (matrix(plus(0, 2, 1e-6)), "scene_camera", "cam_K"),
    "skew": (matrix(plus(0, 1, 0.5)), "scene_camera", "cam_K"),
    "camera turned": (entry(CAMERA, "cam_R_w2c", turned(0.1, 2)), "scene_camera", "0.1 deg"),
    "camera turned slightly": (entry(CAMERA, "cam_R_w2c", turned(1e-4, 0)), "scene_camera", "deg"),
    "camera moved": (entry(CAMERA, "cam_t_w2c", moved(1, 0, 0)), "scene_camera", "1 mm away"),
    "camera moved a metre": (entry(CAMERA, "cam_t_w2c", moved(0, 0, 1e3)), "camera", "1e+03 mm"),
    "camera to world": (world(lambda R, t: (R.T, -R.T @ t)), "scene_camera", "cam_R_w2c"),
    "camera's place for t": (world(lambda R, t: (R, -R.T @ t)), "scene_camera", "cam_t_w2c"),
    "camera of OpenGL": (
        world(lambda R, t: (np.diag([1.0, -1, -1]) @ R, np.diag([1.0, -1, -1]) @ t)),
        "scene_camera",
        "180 deg",
    ),
    "t_w2c in m": (world(lambda R, t: (R, t / 1e3)), "scene_camera", "cam_t_w2c"),
    "camera of another image": (
        json_fault(CAMERA, lambda v: v["1"].update(cam_t_w2c=v["2"]["cam_t_w2c"])),
        "scene_camera",
        "cam_t_w2c",
    ),
    "cameras swapped": (
        json_fault(CAMERA, lambda v: v.update({"1": v["2"], "2": v["1"]})),
        "scene_camera",
        "image 1",
    ),
    "a sensor": (
        json_fault(CAMERA, lambda v: v["1"].update(sensor="left")),
        "scene_camera",
        "sensor",
    ),
    "a frame": (
        json_fault(CAMERA, lambda v: v["1"].update(frame={"index": 1, "drivers": {}})),
        "scene_camera",
        "frame",
    ),
    "nominal fx": (json_fault("camera.json", lambda v: v.update(fx=v["fx"] * 1.002)), "", "fx"),
    "nominal cx": (json_fault("camera.json", lambda v: v.update(cx=v["cx"] + 0.5)), "", "cx"),
    "nominal depth scale": (json_fault("camera.json", lambda v: v.update(depth_scale=0.1)), "", ""),
}

POSES = {
    **{
        f"turned about {'xyz'[axis]}": (entry(GT, "cam_R_m2c", turned(0.1, axis)), "gt", "0.1 deg")
        for axis in range(3)
    },
    **{
        f"moved along {'xyz'[axis]}": (
            entry(GT, "cam_t_m2c", moved(*np.eye(3)[axis])),
            "scene_gt.json",
            "1 mm away",
        )
        for axis in range(3)
    },
    "moved by a micrometre": (entry(GT, "cam_t_m2c", moved(1e-3, 0, 0)), "gt.json", "0.001 mm"),
    "farther by a thousandth": (pose(lambda R, t: (R, 1.001 * t)), "scene_gt", "cam_t_m2c"),
    "camera to model": (pose(lambda R, t: (R.T, -R.T @ t)), "scene_gt", "cam_R_m2c"),
    "pose of OpenGL": (
        pose(lambda R, t: (np.diag([1.0, -1, -1]) @ R, np.diag([1.0, -1, -1]) @ t)),
        "scene_gt",
        "180 deg",
    ),
    "model's axes y up": (pose(lambda R, t: (R @ turn(90, 0), t)), "scene_gt", "90 deg"),
    "t in m": (pose(lambda R, t: (R, t / 1e3)), "scene_gt", "cam_t_m2c"),
    "pose of another instance": (
        json_fault(GT, lambda v: v["1"][0].update(cam_t_m2c=v["1"][1]["cam_t_m2c"])),
        "scene_gt",
        "cam_t_m2c",
    ),
    "poses of another image": (
        json_fault(GT, lambda v: v.update({"1": v["2"]})),
        "scene_gt.json",
        "image 1",
    ),
    "hidden instance moved": (hidden_pose("cam_t_m2c", moved(0, 5, 0)), "gt.json", "5 mm away"),
    "hidden instance turned": (hidden_pose("cam_R_m2c", turned(1, 1)), "gt.json", "1 deg"),
    "instances reordered": (instances_reordered, "scene_gt.json", "image 1"),
    "articulation of one that has none": (
        json_fault(
            GT, lambda v: v["1"][0].update(articulation={"arm": np.eye(4).ravel().tolist()})
        ),
        "scene_gt",
        "articulation",
    ),
}

INFOS = {
    "hidden px_count_all": (of_hidden("px_count_all", lambda n: n + 40), "gt_info", "px_count_all"),
    "hidden px_count_valid": (of_hidden("px_count_valid", lambda n: n + 9), "gt_info", "valid"),
    "hidden bbox_obj": (of_hidden("bbox_obj", lambda b: [1, 1, 9, 9]), "gt_info", "bbox_obj"),
    "hidden visib_fract": (of_hidden("visib_fract", lambda f: 0.25), "gt_info", "visib_fract"),
    "cut instance's box": (
        json_fault(
            INFO,
            lambda v: (
                [
                    row.update(bbox_obj=[row["bbox_obj"][0] - 1, *row["bbox_obj"][1:]])
                    for rows in v.values()
                    for row in rows
                    if row["px_count_all"] > row["px_count_valid"] > row["px_count_visib"] > 0
                ]
                and None
            ),
        ),
        "gt_info",
        "bbox_obj",
    ),
    "visib_fract of valid pixels": (
        json_fault(INFO, lambda v: v["1"][0].update(visib_fract=0.5)),
        "gt_info",
        "visib_fract",
    ),
    "entries of another image": (
        json_fault(INFO, lambda v: v.update({"1": v["2"]})),
        "gt_info",
        "image 1",
    ),
    "negative count": (
        json_fault(INFO, lambda v: v["1"][0].update(px_count_all=-1)),
        "gt_info",
        "px_count_all",
    ),
    "text for a number": (
        json_fault(INFO, lambda v: v["1"][0].update(px_count_all="12")),
        "gt_info",
        "px_count_all",
    ),
    "infinite fraction": (
        json_fault(INFO, lambda v: v["1"][0].update(visib_fract=float("inf"))),
        "gt_info",
        "visib_fract",
    ),
    "an entry of lists": (json_fault(INFO, lambda v: v.update({"1": [[]]})), "gt_info", ""),
}

COCOS = {
    "visible box": (
        json_fault(
            COCO,
            lambda c: (
                [a.update(bbox=[*a["bbox"][:3], a["bbox"][3] + 1]) for a in c["annotations"]]
                and None
            ),
        ),
        "gt_coco",
        "bbox",
    ),
    "supercategory": (
        json_fault(COCO, lambda c: c["categories"][0].update(supercategory="thing")),
        "gt_coco",
        "supercategory",
    ),
    "category name": (
        json_fault(COCO, lambda c: c["categories"][0].update(name="sat")),
        "gt_coco",
        "name",
    ),
    "categories swapped": (
        json_fault(
            COCO,
            lambda c: (
                [a.update(category_id=12 - a["category_id"]) for a in c["annotations"]] and None
            ),
        ),
        "gt_coco",
        "category_id",
    ),
    "annotations of other images": (
        json_fault(COCO, lambda c: [a.update(image_id=0) for a in c["annotations"]] and None),
        "gt_coco",
        "",
    ),
    "coco image twice": (
        json_fault(COCO, lambda c: c["images"].append(c["images"][0])),
        "gt_coco",
        "twice",
    ),
    "coco image size": (
        json_fault(COCO, lambda c: c["images"][0].update(width=64)),
        "gt_coco",
        "width",
    ),
    "coco licence": (json_fault(COCO, lambda c: c["images"][0].update(license=2)), "", "license"),
    "coco description": (
        json_fault(COCO, lambda c: c["info"].update(description="crowd_train")),
        "gt_coco",
        "description",
    ),
    "coco creation date": (
        json_fault(COCO, lambda c: c["info"].update(date_created="2026-11-22 12:00:00")),
        "gt_coco",
        "date_created",
    ),
    "coco licences": (json_fault(COCO, lambda c: c["licenses"].append({"id": 1})), "", "licenses"),
    "segmentation turned": (
        json_fault(COCO, lambda c: c["annotations"][0]["segmentation"]["counts"].reverse()),
        "gt_coco",
        "segmentation",
    ),
}

MASKS = {
    "masks shifted right": (masks(shifted(1, 1)), "mask", "differ"),
    "masks shifted up": (masks(shifted(-1, 0)), "mask", "differ"),
    "masks dilated": (masks(dilated), "mask", "differ"),
    "masks eroded": (masks(eroded), "mask", "differ"),
    "masks mirrored": (masks(lambda m: m[:, ::-1]), "mask", "differ"),
    "masks upside down": (masks(lambda m: m[::-1]), "mask", "differ"),
    "full masks dilated": (masks(dilated, ["mask"]), "mask/", "differ"),
    "visible masks eroded": (masks(eroded, ["mask_visib"]), "mask_visib", "differ"),
    "masks swapped": (swap_masks, "mask", ""),
    "masks lost": (masks(np.zeros_like), "mask", "differ"),
    "masks inverted": (masks(lambda m: 255 - m), "mask", "differ"),
    "masks turned": (masks(lambda m: np.ascontiguousarray(m.T), told=False), "mask", "64 x 80"),
    "masks of 16 bits": (masks(lambda m: m.astype(np.uint16) * 257, told=False), "mask", "16-bit"),
    "masks in colour": (masks(lambda m: np.stack([m] * 3, 2), told=False), "mask", "RGB"),
    "masks of instance ids": (masks(lambda m: m // 128, told=False), "mask", "neither 0 nor 255"),
    "a speckle in the full mask": (
        masks(
            lambda m: np.where(np.arange(m.size).reshape(m.shape) == 0, 255, m).astype(np.uint8),
            ["mask"],
        ),
        "mask/",
        "differ",
    ),
}

DEPTHS = {
    "depth scaled": (picture("depth", lambda d: (d * 1.01).astype(np.uint16)), "depth", "differ"),
    "depth offset": (picture("depth", lambda d: d + (d > 0).astype(np.uint16)), "depth", "differ"),
    "depth of another image": (copied(OTHER_DEPTH, DEPTH), "depth", "differ"),
    "depth swapped": (swapped(DEPTH, OTHER_DEPTH), "depth", "differ"),
    "garbage off the objects": (off_objects(garbage), "depth", "differ"),
    "all far off the objects": (off_objects(lambda d: np.full_like(d, 65534)), "depth", "differ"),
    "one pixel off the objects": (
        off_objects(lambda d: np.where(np.arange(d.size).reshape(d.shape) == 0, 777, d)),
        "depth",
        "1 of",
    ),
    "depth mirrored": (picture("depth", lambda d: d[:, ::-1]), "depth", "differ"),
    "depth upside down": (picture("depth", lambda d: d[::-1]), "depth", "differ"),
    "range for depth": (
        picture("depth", lambda d: (d * np.linspace(1, 1.02, d.shape[1])).astype(np.uint16)),
        "depth",
        "differ",
    ),
    "depth with noise": (
        picture(
            "depth",
            lambda d: (d + (np.arange(d.size).reshape(d.shape) % 7 == 3) * (d > 0)).astype(
                np.uint16
            ),
        ),
        "depth",
        "differ",
    ),
    "depth bytes swapped": (picture("depth", lambda d: d.byteswap()), "depth", ""),
    "depth and scale doubled": (
        lambda root: (
            picture("depth", lambda d: d // 2)(root)
            or json_fault(CAMERA, lambda v: v["1"].update(depth_scale=2 * v["1"]["depth_scale"]))(
                root
            )
        ),
        "scene_camera",
        "depth_scale",
    ),
    "depth in m": (picture("depth", lambda d: d // 1000), "depth", "differ"),
    "no depth at all": (picture("depth", np.zeros_like), "depth", "differ"),
    "depth black in colour": (
        picture("depth", lambda d: np.zeros((*d.shape, 3), np.uint8)),
        "depth",
        "RGB",
    ),
}

COLOURS = {
    "rgb of another image": (copied(OTHER_RGB, RGB), "rgb", "that of 000002.png"),
    "rgb swapped": (swapped(RGB, OTHER_RGB), "rgb/000001", "differ"),
    "rgb of another scene": (copied(f"{S1}/rgb/000000.png", RGB), "rgb", "differ"),
    "rgb black": (picture("rgb", np.zeros_like), "rgb", "black"),
    "rgb white": (picture("rgb", lambda c: np.full_like(c, 255)), "rgb", "one colour"),
    "rgb mirrored": (picture("rgb", lambda c: c[:, ::-1]), "rgb", "mirrored"),
    "rgb upside down": (picture("rgb", lambda c: c[::-1]), "rgb", "upside down"),
    "rgb turned": (picture("rgb", lambda c: c[::-1, ::-1]), "rgb", "180 degrees"),
    "rgb columns for rows": (picture("rgb", lambda c: np.swapaxes(c, 0, 1)), "rgb", "64 x 80"),
    "red and blue swapped": (picture("rgb", lambda c: c[..., ::-1]), "rgb", "red and blue"),
    "rgb grey": (
        picture("rgb", lambda c: np.repeat(c.mean(axis=2, keepdims=True), 3, 2).astype(np.uint8)),
        "rgb",
        "differ",
    ),
    "rgb of one channel": (picture("rgb", lambda c: c[..., 0]), "rgb", "grey"),
    "gamma 1.1": (picture("rgb", gamma(1.1)), "rgb", "differ"),
    "linear light": (picture("rgb", gamma(2.2)), "rgb", "differ"),
    "rgb inverted": (picture("rgb", lambda c: 255 - c), "rgb", "differ"),
    "rgb brighter": (
        picture("rgb", lambda c: np.minimum(c * 1.03, 255).astype(np.uint8)),
        "rgb",
        "",
    ),
    "rgb with noise": (picture("rgb", noisy), "rgb", "differ"),
    "rgb blurred": (picture("rgb", blurred), "rgb", "differ"),
    "rgb shifted": (picture("rgb", lambda c: np.roll(c, 1, axis=1)), "rgb", "differ"),
    "rgb tile black": (picture("rgb", with_tile), "rgb", "differ"),
    "rgb tile white": (picture("rgb", lambda c: with_tile(c, 255)), "rgb", "differ"),
    "rgb one pixel": (picture("rgb", one_pixel), "rgb", "1 of"),
    "rgb one row": (
        picture("rgb", lambda c: np.where(np.arange(len(c))[:, None, None] == 30, 0, c)),
        "rgb",
        "differ",
    ),
    "rgb as of JPEG": (picture("rgb", recoded), "rgb", "differ"),
}

SHAPES = {
    "model enlarged": (columns(lambda p: 1.01 * p), MODEL, "1.01 times"),
    "model enlarged slightly": (columns(lambda p: 1.0001 * p), MODEL, "vertices"),
    "model in m": (columns(lambda p: p / 1000), MODEL, "0.001 times"),
    "model of half the faces": (ply(lambda v, f: (v, f[::2])), MODEL, "faces"),
    "model without a face": (ply(lambda v, f: (v, f[:-1])), MODEL, "faces"),
    "model of doubled faces": (ply(lambda v, f: (v, np.concatenate([f, f]))), MODEL, "faces"),
    "model mirrored": (columns(lambda p: p * [-1, 1, 1]), MODEL, "vertices"),
    "model's axes swapped": (columns(lambda p: p[:, [0, 2, 1]]), MODEL, "vertices"),
    "model shifted": (columns(lambda p: np.add(p, [10, 0, 0])), MODEL, "vertices"),
    "model shifted slightly": (columns(lambda p: np.add(p, [1e-2, 0, 0])), MODEL, "vertices"),
    "model's vertices moved": (columns(inner_noise), MODEL, "vertices"),
    "model flattened": (columns(lambda p: p * [1, 1, 0.98]), MODEL, "vertices"),
    "normals flipped": (columns(lambda n: -n, "normals"), MODEL, "normals"),
    "normals of one axis": (columns(lambda n: n * 0 + [0, 0, 1], "normals"), MODEL, "normals"),
    "colours lost": (columns(lambda c: c * 0 + 128, "rgb"), MODEL, "colours"),
    "faces turned": (
        ply(faces_turned),
        MODEL,
        "faces",
    ),
    "models swapped": (models_swapped, "obj_00000", "not the model"),
    "diameter": (
        json_fault(
            "models/models_info.json",
            lambda v: v["5"].update(diameter=v["5"]["diameter"] * (1 + 1e-7)),
        ),
        MODELS,
        "diameter",
    ),
    "a symmetry that is none": (
        json_fault(
            "models/models_info.json",
            lambda v: v["5"].update(
                symmetries_continuous=[{"axis": [0, 0, 1], "offset": [0, 0, 0]}]
            ),
        ),
        MODELS,
        "symmetries_continuous",
    ),
    "half a turn as a symmetry": (
        json_fault(
            "models/models_info.json",
            lambda v: v["5"].update(
                symmetries_discrete=[np.diag([-1.0, -1, 1, 1]).ravel().tolist()]
            ),
        ),
        MODELS,
        "symmetries_discrete",
    ),
    "min_x": (
        json_fault("models/models_info.json", lambda v: v["5"].update(min_x=0.0)),
        MODELS,
        "min_x",
    ),
}

ROOT = {
    "seed": (told(seed=4), "dataset_info", "seed"),
    "seed of the configuration": (configured(lambda t: t.update(seed=4)), "dataset_info", "seed"),
    "name of the configuration": (told(config_name="other"), "dataset_info", "config_name"),
    "description": (told(description="other"), "dataset_info", "description"),
    "name of the dataset": (told(dataset_name="other"), "", "dataset_name"),
    "hash of the configuration": (told(config_sha256="0" * 64), "dataset_info", "config_sha256"),
    "hash of a model": (
        json_fault(
            "dataset_info.json",
            lambda v: v["files_sha256"].update(dict.fromkeys(v["files_sha256"], "0" * 64)),
        ),
        "dataset_info",
        "files_sha256",
    ),
    "hashes lost": (told(files_sha256={}), "dataset_info", "files_sha256"),
    "sensors that are none": (
        told(sensors=[{"name": "left", "trigger_interval": 1}]),
        "",
        "sensor",
    ),
    "pictures that are none": (told(pictures={"rgb": "sensor_rgb"}), "dataset_info", "pictures"),
    "chunk size": (told(chunk_size=4), "test/000001", "image 0"),
    "another split": (told(split="train"), "train", "is missing"),
    "a key too many": (told(author="me"), "dataset_info", "author"),
    "no configuration": (removed("config.json"), "config.json", "is missing"),
    "configuration cut": (without_end("config.json"), "config.json", "cannot be read"),
    "configuration changed": (
        configured(lambda t: t["camera"].update(fov_deg=28.1)),
        "dataset_info",
        "config_sha256",
    ),
    "configuration changed with its hash": (
        configured(lambda t: t["camera"].update(fov_deg=28.1), hashed=True),
        "scene_camera",
        "cam_K",
    ),
    "sun of the configuration": (
        configured(lambda t: t.update(sun={"irradiance_w_m2": 900.0}), hashed=True),
        "",
        "",
    ),
    "targets shortened": (
        json_fault("test_targets_bop19.json", lambda v: v.pop() and None),
        "bop19",
        "",
    ),
    "target of another scene": (
        json_fault("test_targets_bop24.json", lambda v: v[0].update(scene_id=9)),
        "bop24",
        "",
    ),
    "targets of BOP 2019 lost": (removed("test_targets_bop19.json"), "bop19", "not finished"),
    "card cut": (without_end("dataset_info.md"), "dataset_info.md", "does not agree"),
    "an image of another one": (frame_of_another, "scene_camera", "image 1"),
    "an image taken away": (without_image, "scene_frames.json", "has not the images"),
    "scenes swapped": (scenes_swapped, "scene_camera", "image 0"),
    "a scene too many": (more_scenes, "test/000002", ""),
    "scene_gt of another scene": (copied(f"{S1}/scene_gt.json", GT), "scene_gt.json", "image 0"),
    "scene_camera of another scene": (copied(f"{S1}/scene_camera.json", CAMERA), "camera", "image"),
    "empty labels": (written(GT, "{}"), "scene_gt", "lacks images"),
    "labels of no use": (written(GT, ""), "scene_gt.json", "cannot be read"),
    "a list of labels": (written(INFO, "[]"), "gt_info", "dictionary"),
    "a byte too many": (written(INFO, "\ufeff{}"), "gt_info", "cannot be read"),
    "depth cut": (without_end(DEPTH), "depth", ""),
    "model cut": (without_end(f"models/{MODEL}"), MODEL, "bytes of data"),
    "models_info cut": (without_end("models/models_info.json"), MODELS, "cannot be read"),
    "a model of no object": (copied(f"models/{MODEL}", "models/obj_000009.ply"), "obj_000009", ""),
    "a folder too many": (copied(RGB, f"{S0}/extra.png"), "extra.png", "not part"),
}

PLANTED = {
    **CAMERAS,
    **POSES,
    **INFOS,
    **COCOS,
    **MASKS,
    **DEPTHS,
    **COLOURS,
    **SHAPES,
    **ROOT,
}

NEED_THE_CONFIGURATION = {
    # Which frame an image is of says nothing else.
    "a frame",
    "nominal fx",
    "nominal cx",
    "nominal depth scale",
    # Less than a pixel can show, or of what no pixel shows.
    "moved by a micrometre",
    "hidden instance moved",
    "hidden instance turned",
    "instances reordered",
    "articulation of one that has none",
    # Depth of bodies, which no model holds.
    "garbage off the objects",
    "all far off the objects",
    "one pixel off the objects",
    # What rays do not ask of a model.
    "model of doubled faces",
    "model shifted slightly",
    "normals flipped",
    "normals of one axis",
    "colours lost",
    "diameter",
    "a symmetry that is none",
    "half a turn as a symmetry",
}
"""Faults that the check misses where it cannot open the configuration, or is told not to."""
