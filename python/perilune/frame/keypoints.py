"""The keypoints of a frame: which there are, what the core is asked, and their table."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.config.body import Body
from perilune.config.errors import ConfigError, nearest
from perilune.config.keypoints import Keypoints, Landmark
from perilune.document.document import Document
from perilune.orbits.ground import foot, spherical
from perilune.spacecraft.articulation import Rig
from perilune.world import World

F64 = NDArray[np.float64]
Array = NDArray[Any]


@lru_cache(maxsize=1)
def label_dtype() -> np.dtype[Any]:
    """dtype of the core's part of a row."""
    return np.dtype(list(_core.KEYPOINT_LABEL))


@dataclass(frozen=True)
class _Fixed:
    """A keypoint of a spacecraft."""

    name: str
    place: F64
    """At rest in the spacecraft's frame at its ideal size, m."""
    mover: int
    """1 + its moving node; 0: none."""


def _text_rows(path: Path) -> list[tuple[str, Any]]:
    if path.suffix.lower() == ".json":
        found = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(found, Mapping):
            return [(str(name), place) for name, place in found.items()]
        return [(str(k), place) for k, place in enumerate(found, start=1)]
    rows: list[tuple[str, Any]] = []
    for k, line in enumerate(path.read_text(encoding="utf-8").splitlines()):
        cells = [cell.strip() for cell in line.split(",")]
        if not line.strip() or (k == 0 and cells[-3:] == ["x", "y", "z"]):
            continue
        rows.append((cells[0] if len(cells) == 4 else str(len(rows) + 1), cells[-3:]))
    return rows


def _arrays(path: Path) -> Array:
    """(n, 3) of a NumPy or MATLAB file."""
    if path.suffix.lower() == ".npy":
        return np.asarray(np.load(path, allow_pickle=False))
    try:
        from scipy.io import loadmat  # type: ignore[import-untyped,unused-ignore]
    except ImportError as error:
        raise ValueError("MATLAB files are read with SciPy: pip install scipy") from error
    found = [value for key, value in loadmat(path).items() if not key.startswith("__")]
    if len(found) != 1 or np.ndim(found[0]) != 2 or np.shape(found[0])[0] != 3:
        raise ValueError("must hold one array of 3 rows")
    return np.asarray(found[0]).T


def read_points(path: Path) -> list[tuple[str, F64]]:
    """Names and places (3,) of a file; ValueError for one that is none."""
    if path.suffix.lower() in (".npy", ".mat"):
        rows = [(str(k), place) for k, place in enumerate(_arrays(path), start=1)]
    elif path.suffix.lower() in (".json", ".csv"):
        rows = _text_rows(path)
    else:
        raise ValueError("must end in .json, .csv, .npy or .mat")
    points = []
    for name, place in rows:
        try:
            at = np.array(place, dtype=np.float64)
        except (TypeError, ValueError):
            at = np.empty(0)
        if at.shape != (3,) or not np.isfinite(at).all():
            raise ValueError(f"point '{name}': must be three finite numbers, not {place!r:.60}")
        points.append((name, at))
    return points


def _mover(model: _core.Model, rig: Rig | None, node: int) -> int:
    """1 + the moving node that carries a node; 0: none."""
    moving = list(rig.core.nodes) if rig is not None else []
    while node >= 0:
        if node in moving:
            return 1 + moving.index(node)
        node = model.nodes[node]["parent"]
    return 0


def _node(model: _core.Model, name: str, where: str) -> int:
    names = [row["name"] for row in model.nodes]
    if names.count(name) != 1:
        told = "no node" if name not in names else "several nodes"
        raise ConfigError(f"{where}: {told} '{name}'{nearest(name, names)}")
    return names.index(name)


def _of_craft(
    spec: Keypoints, model: Any, rig: Rig | None, document: Document, where: str
) -> list[_Fixed]:
    """model: a perilune.frame.handles.ObjectModel. where: key path, for errors."""
    source, core = document.source, model.model
    found = []
    for name, point in spec.points.items():
        key = f"{source}:\n  {where}.points.{name}.node"
        mover = 0 if point.node is None else _mover(core, rig, _node(core, point.node, key))
        found.append(_Fixed(name, np.array(point.position_m), mover))
    if spec.file is not None:
        path = document.path(spec.file, f"{where}.file")
        try:
            found += [_Fixed(name, place, 0) for name, place in read_points(path)]
        except ValueError as error:
            raise ConfigError(f"{source}:\n  {where}.file: {path}: {error}") from error
    for k, pattern in enumerate(spec.nodes):
        fits = [n for n, row in enumerate(core.nodes)
                if fnmatchcase(row["name"].lower(), pattern.lower())]  # fmt: skip
        if not fits:
            near = nearest(pattern, [row["name"] for row in core.nodes])
            raise ConfigError(f"{source}:\n  {where}.nodes[{k}]: no node fits '{pattern}'{near}")
        for n in fits:
            place = (np.array(core.nodes[n]["origin"]) - model.offset) * model.metres_per_unit
            if np.isfinite(place).all():
                found.append(_Fixed(core.nodes[n]["name"], place, _mover(core, rig, n)))
    twice = [point.name for k, point in enumerate(found) if point.name in
             {other.name for other in found[:k]}]  # fmt: skip
    if twice:
        raise ConfigError(f"{source}:\n  {where}: two keypoints are called '{twice[0]}'")
    return found


def _landmark(world: World, body: str, mark: Landmark) -> F64:
    """Its place in body axes, m."""
    entry: Body = world.config.bodies[body]
    geodetic = entry.is_geodetic if mark.latitudes is None else mark.latitudes == "geodetic"
    toward = spherical(math.radians(mark.lon_deg), math.radians(mark.lat_deg))
    point, _ = foot(world.body_radii_m[body], toward, geodetic)
    up = point / np.linalg.norm(point)
    if entry.terrain is not None or entry.shape is not None:
        point = world.surface_m(body, up) * up
    return np.asarray(point + mark.height_m * up)


class KeypointSet:
    """All keypoints of a configuration: spacecraft by spacecraft, then body by body."""

    def __init__(
        self,
        document: Document,
        models: Mapping[str, Any],
        rigs: Mapping[str, Rig],
        instances: Mapping[str, int],
    ) -> None:
        """models: perilune.frame.handles.ObjectModel of each spacecraft. instances: name -> id."""
        config = document.config
        self._models = models
        self._crafts = {
            name: _of_craft(craft.keypoints, models[name], rigs.get(name), document,
                            f"spacecraft.{name}.keypoints")
            for name, craft in config.spacecraft.items()
        }  # fmt: skip
        names = [(owner, point.name) for owner, rows in self._crafts.items() for point in rows]
        names += [(owner, name) for owner, body in config.bodies.items() for name in body.landmarks]
        widths = [max((len(text) for text in texts), default=1) for texts in
                  ([name for _, name in names], [owner for owner, _ in names])]  # fmt: skip
        kind = [("name", f"U{widths[0]}"), ("object", f"U{widths[1]}"), ("instance_id", "<i4"),
                *_core.KEYPOINT_LABEL]  # fmt: skip
        self._named = np.zeros(len(names), np.dtype(kind))
        for row, (owner, name) in zip(self._named, names, strict=True):
            row["name"], row["object"], row["instance_id"] = name, owner, instances[owner]

    @property
    def names(self) -> dict[str, tuple[str, ...]]:
        """Spacecraft or body -> names of its keypoints, in the order of rows; none without any."""
        found: dict[str, list[str]] = {}
        for row in self._named:
            found.setdefault(str(row["object"]), []).append(str(row["name"]))
        return {owner: tuple(names) for owner, names in found.items()}

    def rows(self, world: World, scales: Mapping[str, float]) -> F64:
        """(n, 6): what the core is asked in a frame. scales: metres per model unit."""
        config, rows = world.config, []
        for k, (name, points) in enumerate(self._crafts.items()):
            grown = scales[name] / self._models[name].metres_per_unit
            deep_m = config.spacecraft[name].keypoints.depth_m
            rows += [[k, point.mover, *(grown * point.place), deep_m] for point in points]
        for k, (name, body) in enumerate(config.bodies.items(), start=len(self._crafts)):
            rows += [[k, 0, *_landmark(world, name, mark), 0.0] for mark in body.landmarks.values()]
        return np.array(rows, dtype=np.float64).reshape(len(rows), 6)

    def empty(self) -> Array:
        """An array for the core's labels."""
        return np.zeros(len(self._named), label_dtype())

    def table(self, found: Array) -> Array:
        """The rows of Sample.keypoints, from the core's labels."""
        out = self._named.copy()
        for name in found.dtype.names or ():
            out[name] = found[name]
        return out
