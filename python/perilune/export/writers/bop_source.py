"""Description of a simulation in a BOP dataset: models, nominal camera, provenance."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base.version import VERSION
from perilune.camera.imaging import intrinsics
from perilune.config.camera import Camera
from perilune.config.errors import ConfigError
from perilune.config.file_names import file_names
from perilune.config.symmetries import Symmetries
from perilune.document.references import KEYPOINTS
from perilune.drivers import Found, path_text
from perilune.drivers.choice import KIND as CHOICE
from perilune.export.writers.bop_bodies import body_model, varies
from perilune.export.writers.bop_channels import channel_files, label_names, pictures, scan_files
from perilune.export.writers.bop_closed import closed
from perilune.export.writers.bop_files import RGB_FOLDER
from perilune.export.writers.bop_models import BopModel, Surfaces, bop_model
from perilune.export.writers.bop_symmetry import check_symmetries, turns
from perilune.materials import images_in
from perilune.simulation import Simulation

F64 = NDArray[np.float64]

_SIZE_KEYS = ("size_m", "metres_per_unit")
_HASH_BLOCK = 1 << 20


def _varies_size(driver: Found) -> bool:
    if len(driver.path) > 2:
        return driver.path[-1] in _SIZE_KEYS
    # One among several whole entries, or whole sections.
    entries = [driver.ideal, *driver.distribution.limits.values()]
    if len(driver.path) == 2:
        entries = [[entry.get(key) for key in _SIZE_KEYS] for entry in entries]
    return any(entry != entries[0] for entry in entries)


def driven_size(sim: Simulation, name: str) -> bool:
    """Whether the size of a spacecraft varies from frame to frame."""
    rows = (driver for driver in sim.document.drivers if driver.path[:2] == ("spacecraft", name))
    return any(map(_varies_size, rows))


def _refuse_driven_sizes(sim: Simulation) -> None:
    """Refuses sizes that vary from frame to frame, because a BOP model has one size."""
    for driver in sim.document.drivers:
        of_craft = driver.path[0] == "spacecraft" and _varies_size(driver)
        if of_craft or varies(sim, driver):
            raise ConfigError(
                f"{sim.document.source}: {driver.name}: has a driver, but models of a BOP dataset "
                "have one size; give it a number"
            )


def _refuse_several_sizes(sim: Simulation) -> None:
    sizes = {name: (camera.width, camera.height) for name, camera in sim.config.cameras.items()}
    if len(set(sizes.values())) > 1:
        told = ", ".join(f"{name} {width} x {height}" for name, (width, height) in sizes.items())
        raise ConfigError(
            f"{sim.document.source}: sensors: images of a BOP split have one size, but there are "
            f"{told}; write each size into a folder of its own, without the other sensors "
            "(--set sensors.NAME=null)"
        )


def refuse_unfit(sim: Simulation) -> None:
    """ConfigError for settings that a BOP dataset cannot represent."""
    _refuse_driven_sizes(sim)
    _refuse_several_sizes(sim)
    for name, camera in sim.config.cameras.items():
        if camera.label_lens == "distorted":
            where = "camera" if name is None else f"sensors.{name}"
            way = (
                "a panorama is none"
                if camera.is_panorama
                else "say lens.labels: undistorted for labels of that pinhole beside distorted "
                "images, or remove the lens"
            )
            raise ConfigError(
                f"{sim.document.source}: {where}.lens: a BOP camera is a pinhole, which K "
                f"describes whole; {way}"
            )
    if not sim.config.render.amodal:
        raise ConfigError(
            f"{sim.document.source}: render.amodal: false leaves out the full silhouettes, which "
            "a BOP dataset needs; remove it or say true"
        )


def _surfaces(sim: Simulation, names: Sequence[str]) -> Surfaces:
    """Surfaces of a model shared by spacecraft, each with its own materials and moving parts."""
    model = sim.models[names[0]].model
    rows = [sim.presence(name) for name in names]
    low, high = np.minimum.reduce(rows), np.maximum.reduce(rows)
    presence = np.where(low == high, low, np.uint8(1))
    double_sided = model.surfaces()["double_sided"]
    if double_sided.any():
        double_sided &= ~closed(model, presence)
    chains = sim.moving_nodes(names)
    if not any(chains):
        return Surfaces(double_sided, presence)
    nodes = sorted(set(chains), key=lambda chain: (len(chain), chain))
    of_part = np.array([nodes.index(chain) for chain in chains], dtype=np.int64)
    return Surfaces(double_sided, presence, nodes, of_part[model.mesh()["triangle_part"]])


def _symmetries(sim: Simulation, names: Sequence[str]) -> tuple[str, Symmetries]:
    """Key and value of the symmetries that one of the spacecraft with a common model states;
    ConfigError if two differ."""
    stated = {name: sim.models[name].symmetries for name in names}
    told = [name for name, value in stated.items() if value != Symmetries()] or names[:1]
    for name in told[1:]:
        if stated[name] != stated[told[0]]:
            raise ConfigError(
                f"{sim.document.source}: spacecraft.{name}.symmetries: differ from those of "
                f"{told[0]}, which has the same obj_id, {sim.models[name].obj_id}; one id stands "
                "for one model: state them the same, or of one of the two alone"
            )
    return f"spacecraft.{told[0]}.symmetries", stated[told[0]]


def bop_models(sim: Simulation) -> dict[int, BopModel]:
    """Object id -> model of spacecraft, which share one with the same id, and annotated bodies.

    ConfigError for symmetries that a model does not have."""
    crafts: dict[int, list[str]] = {}
    for name, row in sim.models.items():
        crafts.setdefault(row.obj_id, []).append(name)
    models: dict[int, BopModel] = {}
    for obj_id, names in crafts.items():
        row = sim.models[names[0]]
        key, symmetries = _symmetries(sim, names)
        models[obj_id] = bop_model(
            obj_id,
            row.model.mesh(),
            _surfaces(sim, names),
            row.offset,
            row.metres_per_unit,
            *turns(symmetries),
        )
        check_symmetries(models[obj_id], symmetries, f"{sim.document.source}: {key}")
    for name in sim.config.objects[len(sim.config.spacecraft) :]:
        models[sim.obj_ids[name]] = body_model(sim, name)
    return models


def nominal_camera(sim: Simulation) -> Camera:
    """The camera of the dataset; with several sensors, the first."""
    return next(iter(sim.config.cameras.values()))


def camera_entry(sim: Simulation) -> dict[str, Any]:
    """camera.json: the nominal camera; scene_camera.json has the true one of each image."""
    camera = nominal_camera(sim)
    K = intrinsics(camera)
    return {
        "cx": float(K[0, 2]),
        "cy": float(K[1, 2]),
        "depth_scale": 1.0,
        "fx": float(K[0, 0]),
        "fy": float(K[1, 1]),
        "height": camera.height,
        "width": camera.width,
    }


def _file_sha256(sim: Simulation, text: str, key: str) -> str:
    digest = hashlib.sha256()
    with open(sim.document.path(text, key), "rb") as file:
        while block := file.read(_HASH_BLOCK):
            digest.update(block)
    return digest.hexdigest()


def _chosen_files(sim: Simulation, driver: Found) -> Iterator[tuple[str, str]]:
    """(key, file) of all files in values that a driver may choose."""
    length = len(driver.path)
    for k, config in enumerate(sim.document.choices(lambda path: path == driver.path)):
        for path, text in file_names(config):
            if path[:length] == driver.path:
                yield path_text((*driver.path, "choice", k, *path[length:])), text


def _files(sim: Simulation) -> dict[str, str]:
    """Key of the configuration -> hash of its file."""
    named = {path_text(path): text for path, text in file_names(sim.config)}
    for driver in sim.document.drivers:
        if driver.kind is CHOICE:
            named |= dict(_chosen_files(sim, driver))
    for name, material in sim.config.materials.items():
        named |= {image.key: image.file for image in images_in(name, material)}
    return {key: _file_sha256(sim, text, key) for key, text in named.items()}


def dataset_name(sim: Simulation) -> str:
    """The configuration's name in lower-case letters and digits, as BOP requires."""
    return re.sub("[^a-z0-9]", "", sim.config.name.lower()) or "perilune"


def provenance(sim: Simulation, chunk_size: int, split: str) -> dict[str, Any]:
    """What dataset_info.json of any format says of how the dataset was made. No time stamps."""
    tree = {key: value for key, value in sim.document.tree.items() if key != "seed"}
    text = json.dumps(tree, sort_keys=True, separators=(",", ":"))
    sensors = [
        {"name": name, "trigger_interval": sensor.trigger_interval}
        for name, sensor in sim.config.sensors.items()
    ]
    return {
        **({"sensors": sensors} if sensors else {}),
        "chunk_size": chunk_size,
        "config_name": sim.config.name,
        "config_sha256": hashlib.sha256(text.encode("utf-8")).hexdigest(),
        "dataset_name": dataset_name(sim),
        "description": sim.config.description,
        "files_sha256": _files(sim),
        "seed": sim.config.seed,
        "split": split,
        "versions": {"perilune": VERSION, **_core.version()},
    }


def dataset_info(sim: Simulation, chunk_size: int, split: str) -> dict[str, Any]:
    """dataset_info.json: everything needed to make the same dataset again."""
    shown, beside = pictures(sim), {**channel_files(sim), **scan_files(sim)}
    names = label_names(sim, beside)
    named = {owner: list(rows) for owner, rows in sim.keypoint_names.items()}
    undistorted = any(camera.label_lens for camera in sim.config.cameras.values())
    rolling = any(camera.line_time_us > 0.0 for camera in sim.config.cameras.values())
    return {
        **provenance(sim, chunk_size, split),
        **({"annotations": "undistorted"} if undistorted else {}),
        **({"rolling_shutter": True} if rolling else {}),
        **({"pictures": shown} if shown != {RGB_FOLDER: "rgb"} else {}),
        **({"channels": {k: row.entry() for k, row in beside.items()}} if beside else {}),
        **({"labels": names} if names else {}),
        **({KEYPOINTS: named} if KEYPOINTS in sim.config.render.channels else {}),
    }
