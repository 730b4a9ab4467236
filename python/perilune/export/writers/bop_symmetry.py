"""Tests stated symmetries on the model itself.

A symmetry of BOP is a transformation that moves the surface by less than a tenth of the diameter,
or 15 mm (Hodan et al., "BOP Challenge 2020 on 6D Object Localization", section 2.2: the Hausdorff
distance between the model and the transformed model)."""

from __future__ import annotations

import logging
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from perilune.base import rotations
from perilune.config.errors import ConfigError
from perilune.config.symmetries import Symmetries
from perilune.export.writers.bop_models import BopModel, about_origin
from perilune.export.writers.diameter import diameter

F64 = NDArray[np.float64]

_log = logging.getLogger(__name__)

_FRACTION, _LEAST_MM = 0.1, 15.0
_NOTABLE = 0.02
"""Fraction of the diameter from which an accepted symmetry is reported."""
_SAMPLES = 20_000
_POINTS = 400
_DIRECTIONS = 200
_AT_ONCE = 32
_ANGLES_DEG = (36.87, 90.0, 137.51, 180.0, 251.3)
"""Test angles of a continuous symmetry, without a short common period."""


def turns(
    symmetries: Symmetries,
) -> tuple[list[tuple[F64, F64]], list[tuple[F64, F64]]]:
    """Discrete symmetries as (rotation (3, 3), point (3,), m), continuous ones as (axis, point)."""

    def matrix(rpy_deg: tuple[float, float, float]) -> F64:
        return rotations.to_matrix(rotations.from_rpy_deg(rpy_deg))

    discrete = [(matrix(angles), np.zeros(3)) for angles in symmetries.discrete_deg]
    discrete += [(matrix(row.rotation_deg), np.array(row.offset_m)) for row in symmetries.discrete]
    return discrete, [(np.array(row.axis), np.array(row.offset_m)) for row in symmetries.continuous]


def _named(symmetries: Symmetries) -> Iterator[tuple[str, list[tuple[F64, F64]]]]:
    """Key of each symmetry, and its rotations with their points."""
    discrete, continuous = turns(symmetries)
    count = len(symmetries.discrete_deg)
    for k, turn in enumerate(discrete):
        yield f"discrete_deg[{k}]" if k < count else f"discrete[{k - count}]", [turn]
    for k, (axis, point_m) in enumerate(continuous):
        unit = axis / np.linalg.norm(axis)
        angles = np.radians(_ANGLES_DEG)
        matrices = [rotations.to_matrix(rotations.axis_angle(unit, angle)) for angle in angles]
        yield f"continuous[{k}]", [(matrix, point_m) for matrix in matrices]


def _spread(model: BopModel) -> F64:
    """About _SAMPLES points, evenly spread over the surface, mm; the same for the same model."""
    a, b, c = (model.positions_mm[model.faces[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    if not areas.sum() > 0.0:
        return a
    # Low-discrepancy points of the unit square (R2, Roberts 2018), folded into the triangles.
    k = np.arange(_SAMPLES) + 0.5
    ends = np.cumsum(areas)
    face = np.minimum(np.searchsorted(ends, k / _SAMPLES * ends[-1]), len(areas) - 1)
    u, v = (0.7548776662466927 * k) % 1.0, (0.5698402909980532 * k) % 1.0
    outside = u + v > 1.0
    u, v = np.where(outside, 1.0 - u, u)[:, None], np.where(outside, 1.0 - v, v)[:, None]
    return np.asarray(a[face] + u * (b - a)[face] + v * (c - a)[face])


def _directions() -> F64:
    """Evenly distributed unit vectors: a spiral on the sphere."""
    k = np.arange(_DIRECTIONS) + 0.5
    z, angle = 1.0 - 2.0 * k / _DIRECTIONS, np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=1)


def _farthest(points: F64, surface: F64) -> float:
    """Largest distance of one of the points from the nearest point of the surface."""
    squares = (surface**2).sum(axis=1)
    most = 0.0
    for start in range(0, len(points), _AT_ONCE):
        batch = points[start : start + _AT_ONCE]
        nearest = (squares - 2.0 * batch @ surface.T).min(axis=1) + (batch**2).sum(axis=1)
        most = max(most, float(nearest.max()))
    return float(np.sqrt(max(most, 0.0)))


class Deviation:
    """Distance of a model from itself after a rotation."""

    def __init__(self, model: BopModel) -> None:
        self._model = model
        vertices = model.positions_mm
        step = max(1, len(vertices) // _POINTS)
        spread = _spread(model)
        ends = vertices[(_directions() @ vertices.T).argmax(axis=1)]
        self._points = np.concatenate([ends, vertices[::step], spread[:: _SAMPLES // _POINTS]])
        self._surface = np.concatenate([spread, vertices[::step], ends])

    def mm(self, rotation: F64, point_m: F64) -> float:
        """Hausdorff distance in mm between the model and the model rotated about a point of the
        object's frame: for about a thousand points, including protruding ones, to the spacing of 20
        000 points on the surface."""
        matrix = about_origin(self._model, rotation, point_m)
        turned = self._points @ matrix[:3, :3].T + matrix[:3, 3]
        back = (self._points - matrix[:3, 3]) @ matrix[:3, :3]
        return max(_farthest(turned, self._surface), _farthest(back, self._surface))


def check_symmetries(model: BopModel, symmetries: Symmetries, where: str) -> None:
    """ConfigError for a stated symmetry that the model does not have; a warning for an approximate
    one. where: file and key of the symmetries."""
    named = list(_named(symmetries))
    if not named:
        return
    deviation, length = Deviation(model), diameter(model.positions_mm)
    allowed = max(_FRACTION * length, _LEAST_MM)
    for key, parts in named:
        away = max(deviation.mm(rotation, point_m) for rotation, point_m in parts)
        told = f"the model turned so is up to {away:.4g} mm, {away / length:.1%} of its diameter,"
        if away > allowed:
            raise ConfigError(
                f"{where}.{key}: {told} from itself; a symmetry may be {allowed:.4g} mm off (BOP: "
                "a tenth of the diameter, or 15 mm); correct or remove it"
            )
        if away > _NOTABLE * length:
            _log.warning("%s.%s: %s from itself, which BOP still allows", where, key, told)
