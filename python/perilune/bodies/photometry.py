"""Photometric models of bodies: from the configuration and published maps to the core's arrays."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.bodies import geotiff
from perilune.config.body import Body
from perilune.config.photometry import Photometry
from perilune.config.schema import Config

F64 = NDArray[np.float64]

_KEYS = ("b", "c", "b_c0", "h_c", "b_s0", "h_s", "roughness_deg", "filling")
"""Parameters in the core's order, which is that of the published maps after w."""
_ROUGH = "roughness_deg"
_ROUGHNESS = _KEYS.index(_ROUGH)
_LOW = (0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
_HIGH = (1.0, 0.95, 2.0, 10.0, 10.0, 10.0, 10.0, 60.0, 0.75)
"""Upper limits of a map's bands: the ranges of the configuration."""


def reads(reflectance: str) -> dict[str, tuple[float, float, float]]:
    """Parameters that a model uses, with the Moon's values; empty if it is not photometric."""
    sockets = {socket["name"]: socket["default"] for socket in _core.NODES[reflectance]["inputs"]}
    return {key: sockets[key] for key in (*_KEYS, "k") if "b_s0" in sockets and key in sockets}


def _unread(given: Photometry, known: Collection[str], law: str) -> Iterator[tuple[str, str]]:
    """(parameter, message) of each parameter that a model does not use."""
    stated = [key for key in Photometry.model_fields if key in given.model_fields_set]
    forms = ("h_function", "coherent_surge")  # of Hapke's laws, as the coherent surge is
    for key in stated:
        if key != "maps" and ("h_c" if key in forms else key) not in known:
            yield key, f"not read by reflectance {law}"
        elif key in ("h_c", "coherent_surge") and given.b_c0 is None and not given.maps:
            yield key, "does nothing without b_c0, whose default is 0"


def _roughness_of_ground(where: str, body: Body) -> Iterator[tuple[str, str]]:
    ground = body.terrain
    laws = [row["name"] for row in _core.REFLECTANCES if _ROUGH in reads(row["name"])]
    if ground is None or body.reflectance in laws:
        return
    text = f"only for reflectance {', '.join(laws)}, not {body.reflectance}"
    if ground.roughness:
        yield f"{where}.roughness", text
    if "roughness_baseline_m" in ground.model_fields_set:
        yield f"{where}.roughness_baseline_m", text


def check(config: Config) -> Iterator[tuple[str, str]]:
    """Key and message for each parameter that a body's model does not use."""
    for name, body in config.bodies.items():
        given = body.photometry
        yield from _roughness_of_ground(f"bodies.{name}.terrain", body)
        if given is None or body.reflectance not in _core.NODES:
            continue
        known = reads(body.reflectance)
        key = f"bodies.{name}.photometry"
        if not known:
            laws = [row["name"] for row in _core.REFLECTANCES if reads(row["name"])]
            yield key, f"only for reflectance {', '.join(laws)}"
            continue
        for parameter, complaint in _unread(given, known, body.reflectance):
            yield f"{key}.{parameter}", complaint
        if len(given.maps) not in (0, 1, 3):
            yield f"{key}.maps", "give one file, or those of red, green and blue"


def _rows(body: Body) -> list[float]:
    known = reads(body.reflectance)
    given = body.photometry or Photometry()
    table = np.full((3, len(_KEYS)), np.nan)
    for column, key in enumerate(_KEYS):
        value = getattr(given, key)
        if value is None and not given.maps:
            value = known.get(key)
        if value is not None:
            table[:, column] = value
    table[:, _ROUGHNESS] = np.radians(table[:, _ROUGHNESS])
    k = given.k if given.k is not None else known.get("k", (1.0,))[0]
    forms = float(given.h_function == "simple"), float(given.coherent_surge == "2012")
    return [*table.ravel().tolist(), k, *forms]


def regolith(config: Config) -> F64:
    """(bodies, 27): `body_regolith` of the core's request."""
    rows = [_rows(body) for body in config.bodies.values()]
    return np.array(rows, dtype=np.float64).reshape(-1, 3 * len(_KEYS) + 3)


def load_map(paths: Sequence[Path]) -> _core.Grid:
    """Parameter maps of the three bands, from one file or three on the same grid."""
    rasters = [geotiff.read(path) for path in paths]
    for path, raster in zip(paths, rasters, strict=True):
        _check_raster(path, raster)
        if raster.values.shape != rasters[0].values.shape or not np.allclose(
            _frame(raster), _frame(rasters[0])
        ):
            raise ValueError(f"{path}: not on the grid of {paths[0]}")
    bands = [raster.values.astype(np.float32) for raster in rasters]
    values = np.concatenate(bands if len(bands) == 3 else bands * 3, axis=2)
    values[:, :, 1 + _ROUGHNESS :: len(_LOW)] *= np.float32(math.pi / 180.0)
    first = rasters[0]
    return _core.Grid(
        np.ascontiguousarray(values),
        math.radians(first.west_deg),
        math.radians(first.north_deg),
        math.radians(first.south_deg),
    )


def _frame(raster: geotiff.Raster) -> tuple[float, float, float]:
    return raster.west_deg, raster.north_deg, raster.south_deg


def _check_raster(path: Path, raster: geotiff.Raster) -> None:
    bands = raster.values.shape[2]
    if bands != len(_LOW):
        raise ValueError(f"{path}: {bands} bands; a map of parameters has {len(_LOW)}")
    if not raster.goes_round:
        raise ValueError(f"{path}: does not cover all longitudes")
    inside = (raster.values >= np.array(_LOW)) & (raster.values <= np.array(_HIGH))
    for band, name in enumerate(("w", *_KEYS)):
        if not inside[:, :, band].all():
            low, high = _LOW[band], _HIGH[band]
            raise ValueError(f"{path}: band {band + 1} ({name}) leaves {low:g}..{high:g}")
