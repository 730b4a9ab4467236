"""The craters of a terrain in a frame: where they lie in the picture, and what is seen of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.base import rotations
from perilune.camera.label import CameraLabel
from perilune.config import Config
from perilune.frame.rocks import pixels_of
from perilune.world import World

F64 = NDArray[np.float64]
Array = NDArray[np.void]

_RIM_POINTS = 24

CRATER_LABEL = np.dtype(
    [
        ("id", "i8"),
        ("instance_id", "i4"),
        ("source", "U9"),
        ("name", "U24"),
        *((name, *rest) for name, *rest in _core.CRATER if name != "id"),
        ("lon_deg", "f8"),
        ("lat_deg", "f8"),
        ("center_m", "f8", 3),
        ("center", "f8", 2),
        ("semi_axes", "f8", 2),
        ("angle_rad", "f8"),
        ("bbox", "f8", 4),
        ("facing", "f8"),
        ("inside_fract", "f8"),
        ("visib_fract", "f8"),
        ("center_visible", "?"),
        ("cut", "?"),
        ("rim_px", "f4", (_RIM_POINTS, 2)),
        ("rim_inside", "?", _RIM_POINTS),
        ("rim_visib", "?", _RIM_POINTS),
        ("bbox_visib", "i4", 4),
        ("px_count_visib", "i4"),
    ]
)
"""A row of `Simulation.craters`; docs/craters.md explains the fields."""

_KNOWN = np.dtype([("id", "i8"), *(row for row in _core.CRATER if row[0] != "id")])
_CELLS = 8.0  # of the ground on which rims are laid, along the least diameter of an octave
_NEAR_M = 1e-3
_HIDDEN = 0.05  # of a diameter: what is no farther behind the picture's surface is seen
_WIDEST = 1.6  # the largest semi-axis over half the diameter, of an ellipticity of 0.6


def bodies_with(config: Config, what: str) -> list[str]:
    """Bodies with craters or rocks (`what`)."""
    keys = ("craters", "crater_catalogue") if what == "craters" else (what,)
    return [
        name
        for name, entry in config.bodies.items()
        if entry.terrain is not None
        and any(getattr(entry.terrain, key) is not None for key in keys)
    ]


def body_of(config: Config, body: str | None, what: str) -> str:
    """The body whose craters or rocks (`what`) are asked for; None: the only one that has any."""
    having = bodies_with(config, what)
    if body is None and len(having) == 1:
        return having[0]
    if body in having:
        return str(body)
    said = f"several bodies have {what}: name one" if body is None else f"'{body}' has no {what}"
    if not having:
        raise ValueError(f"body: no body has terrain.{what}")
    raise ValueError(f"body: {said}; those with terrain.{what} are {', '.join(having)}")


def in_view(
    position_m: F64,
    ids: NDArray[np.int64],
    on_body: NDArray[np.bool_],
    camera: CameraLabel,
    world: World,
    body: str,
    terrain: _core.Terrain,
    least_px: float,
    most: int,
    catalogue: Array | None,
) -> Array:
    """Rows of CRATER_LABEL. position_m, ids: the channels `position` and `crater_id`. on_body:
    pixels that show the body. world: in the middle of the exposure. catalogue: of CATALOGUED."""
    pose = world.poses[body][0]
    range_m = np.linalg.norm(position_m - camera.position_m, axis=-1)
    ground = (position_m[on_body] - pose[:3]) @ rotations.to_matrix(pose[3:])
    eye = world.body_axes(body, camera.position_m - pose[:3])
    focal = float(max(camera.K[0, 0], camera.K[1, 1]))
    parts = [
        _projected(world, body, terrain, camera, range_m, found)
        for found in _listed(terrain, ground, eye, least_px / focal, most)
    ]
    for part in parts:
        part["source"] = "drawn"
    if catalogue is not None:
        parts += [
            _named(_projected(world, body, terrain, camera, range_m, found), catalogue)
            for found in _known(catalogue, ground, eye, least_px / focal)
        ]
    rows = np.concatenate(parts) if parts else np.zeros(0, CRATER_LABEL)
    shown = _set_pixels(rows, np.where(on_body, ids, 0))
    seen_rows = (rows["inside_fract"] > 0.0) | _around(rows, camera)
    large = ~(2.0 * rows["semi_axes"][:, 0] < least_px)  # nan: cut by the camera's plane
    faced = (rows["facing"] > 0.0) | (rows["visib_fract"] > 0.0)
    away = np.linalg.norm(rows["center_m"] - eye, axis=1)
    counted = shown & (focal * rows["diameter_m"] >= least_px * away)
    rows = rows[(seen_rows & large & faced) | counted]
    _, first = np.unique(rows["id"], return_index=True)
    rows = rows[first]
    return np.asarray(rows[np.lexsort((rows["id"], -rows["diameter_m"]))])


def _set_pixels(rows: Array, ids: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Sets what pixels of `crater_id` rows have; returns whether they have any."""
    known, pixels = pixels_of(ids)
    at = np.searchsorted(known, rows["id"])
    shown = at < len(known)
    shown[shown] = known[at[shown]] == rows["id"][shown]
    for name in ("bbox_visib", "px_count_visib"):
        rows[name][shown] = pixels[name][at[shown]]
    return np.asarray(shown)


def _around(rows: Array, camera: CameraLabel) -> NDArray[np.bool_]:
    """Whether a crater encloses the camera, or its rim all of the picture: its box does."""
    low, size = rows["bbox"][:, :2], rows["bbox"][:, 2:]
    corner = np.array([camera.width - 0.5, camera.height - 0.5])
    return np.asarray(((low <= -0.5) & (low + size >= corner)).all(axis=1))


def _listed(
    terrain: _core.Terrain, ground: F64, eye: F64, least_rad: float, most: int
) -> Iterator[Array]:
    """Craters about the ground that is seen, by octaves of its distance and of diameters; a crater
    may come more than once. ground: (n, 3), eye (3,): body axes, m. least_rad: least angle."""
    if len(ground) == 0:
        return
    away = np.linalg.norm(ground - eye, axis=1)
    octaves = np.floor(np.log2(np.maximum(away, _NEAR_M))).astype(int)
    ids: set[int] = set()
    for octave in np.unique(octaves):
        points = ground[octaves == octave]
        up = points / np.linalg.norm(points, axis=1, keepdims=True)
        middle = up.mean(axis=0)
        middle /= np.linalg.norm(middle)
        radius_m = float(np.linalg.norm(points, axis=1).max())
        chord = float(np.linalg.norm(up - middle, axis=1).max())
        cap_m = radius_m * 2.0 * np.arcsin(min(0.5 * chord, 1.0))
        least_m = least_rad * 2.0**octave / _WIDEST
        low = 2.0 ** np.floor(np.log2(least_m))  # octaves are the same in any frame
        while low < 0.4 * radius_m:
            found = terrain.craters(middle, cap_m + _WIDEST * low, max(low, least_m), 2.0 * low)
            fresh = np.array([int(row) not in ids for row in found["id"]], dtype=bool)
            ids.update(found["id"].tolist())
            if len(ids) > most:
                raise ValueError(
                    f"least_px: more than {most} craters about the ground in view; raise least_px, "
                    "or most"
                )
            if fresh.any():
                yield found[fresh]
            low *= 2.0


def _known(catalogue: Array, ground: F64, eye: F64, least_rad: float) -> Iterator[Array]:
    """Craters of a catalogue about the ground that is seen, by octaves of diameters, as records of
    _KNOWN."""
    if len(ground) == 0:
        return
    away_m = float(np.linalg.norm(ground - eye, axis=1).min())
    radius_m = float(np.linalg.norm(ground, axis=1).max())
    up = ground / np.linalg.norm(ground, axis=1, keepdims=True)
    middle = up.mean(axis=0)
    middle /= np.linalg.norm(middle)
    diameter_m = catalogue["diameter_m"]
    reach = np.linalg.norm(up - middle, axis=1).max() + diameter_m / radius_m
    near = np.linalg.norm(catalogue["direction"] - middle, axis=1) < reach
    found = catalogue[near & (diameter_m > least_rad * away_m / _WIDEST)]
    rows = np.zeros(len(found), _KNOWN)
    for name in ("age_ga", "tau", "depth_m", "rim_m", "kept"):
        rows[name] = np.nan
    rows["id"], rows["axis_ratio"] = -found["id"], 1.0
    rows["direction"], rows["diameter_m"] = found["direction"], found["diameter_m"]
    other = np.where(np.abs(found["direction"][:, 2:]) < 0.7, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    across = np.cross(other, found["direction"])
    rows["major"] = across / np.linalg.norm(across, axis=1, keepdims=True)
    octaves = np.floor(np.log2(rows["diameter_m"]))
    for octave in np.unique(octaves):
        yield rows[octaves == octave]


def _named(rows: Array, catalogue: Array) -> Array:
    """The same rows with their names in the catalogue."""
    rows["source"], rows["name"] = "catalogue", catalogue["name"][-rows["id"] - 1]
    return rows


def _cell_m(craters: Array) -> float:
    return float(2.0 ** np.floor(np.log2(craters["diameter_m"].min())) / _CELLS)


def _rims(terrain: _core.Terrain, radii_m: F64, craters: Array) -> F64:
    """(n, points, 3): points of the ground at the rims, body axes, m. craters: of an octave of
    diameters."""
    up, major = craters["direction"][:, None, :], craters["major"][:, None, :]
    turn = np.linspace(0.0, 2.0 * np.pi, _RIM_POINTS, endpoint=False)[None, :, None]
    root = np.sqrt(craters["axis_ratio"])[:, None, None]
    half = 0.5 * craters["diameter_m"][:, None, None] / np.cbrt(np.prod(radii_m))
    along, across = half / root * np.cos(turn), half * root * np.sin(turn)
    angle = np.hypot(along, across)
    minor = np.cross(up, major)
    to = np.cos(angle) * up + np.sin(angle) / angle * (along * major + across * minor)
    return _on_ground(terrain, radii_m, to, _cell_m(craters))


def _on_ground(terrain: _core.Terrain, radii_m: F64, to: F64, cell_m: float) -> F64:
    flat = np.ascontiguousarray(to.reshape(-1, 3))
    datum = 1.0 / np.linalg.norm(flat / radii_m, axis=1)
    return np.asarray((flat * (datum + terrain.heights(flat, cell_m))[:, None]).reshape(to.shape))


def _projected(
    world: World,
    body: str,
    terrain: _core.Terrain,
    camera: CameraLabel,
    range_m: F64,
    craters: Array,
) -> Array:
    pose, radii_m = world.poses[body][0], world.body_radii_m[body]
    own_to_camera = camera.R_w2c @ rotations.to_matrix(pose[3:])
    offset = camera.R_w2c @ pose[:3] + camera.t_w2c
    rows = np.zeros(len(craters), CRATER_LABEL)
    for name, *_ in _core.CRATER:
        rows[name] = craters[name]
    up = craters["direction"]
    rows["lon_deg"] = np.degrees(np.arctan2(up[:, 1], up[:, 0]))
    rows["lat_deg"] = np.degrees(np.arcsin(np.clip(up[:, 2], -1.0, 1.0)))
    cell_m = _cell_m(craters)
    rows["center_m"] = _on_ground(terrain, radii_m, up, cell_m)
    middle = rows["center_m"] @ own_to_camera.T + offset
    near = _may_be_inside(middle, rows["diameter_m"], camera)
    rows, craters, middle = rows[near], craters[near], middle[near]
    if len(rows) == 0:
        return rows
    points = _rims(terrain, radii_m, craters) @ own_to_camera.T + offset
    _set_ellipses(rows, points, camera)
    _set_visible(rows, points, middle, camera, range_m)
    return rows


def _may_be_inside(middle: F64, reach_m: F64, camera: CameraLabel) -> NDArray[np.bool_]:
    """Whether spheres about points in camera axes meet the camera's view; all of those not behind
    it if the lens bends."""
    inside = middle[:, 2] > -reach_m
    if camera.lens is not None:
        return inside
    corners = np.array([(-0.5, camera.width - 0.5), (-0.5, camera.height - 0.5)])
    u, v = np.linalg.inv(camera.K)[:2, :2] @ (corners - camera.K[:2, 2:])
    for axis, (low, high) in ((0, u), (1, v)):
        for side, edge in ((1.0, high), (-1.0, low)):
            plane = np.zeros(3)
            plane[axis], plane[2] = side, -side * edge
            inside &= middle @ plane < reach_m * np.linalg.norm(plane)
    return np.asarray(inside)


def _set_ellipses(rows: Array, points: F64, camera: CameraLabel) -> None:
    """The ellipse that fits the points of a rim best, and its image."""
    turn = np.linspace(0.0, 2.0 * np.pi, _RIM_POINTS, endpoint=False)
    waves = np.stack([np.full(_RIM_POINTS, 0.5), np.cos(turn), np.sin(turn)]) * 2.0 / _RIM_POINTS
    rims = np.ascontiguousarray(np.einsum("kp,npc->nkc", waves, points))
    K = camera.K
    pinhole = (float(K[0, 0]), float(K[1, 1]), float(K[0, 2]), float(K[1, 2]), float(K[0, 1]))
    images = _core.rim_images(rims, pinhole, _NEAR_M)
    whole = images["kind"] == 2
    for name, of in (("center", "centre"), ("semi_axes", "semi_axes"), ("angle_rad", "angle_rad")):
        rows[name] = np.nan
        rows[name][whole] = images[of][whole]
    rows["facing"] = images["facing"]
    low, high = images["box"][:, :2], images["box"][:, 2:]
    if camera.lens is not None:
        uv = camera_pixels(camera, points)
        low, high = uv.min(axis=1), uv.max(axis=1)
    rows["bbox"] = np.concatenate([low, high - low], axis=1)
    rows["bbox"][images["kind"] == 0] = np.nan


def camera_pixels(camera: CameraLabel, points: F64) -> F64:
    """(..., 2) pixels of points (..., 3) in camera axes, with the labels' distortion."""
    flat = np.ascontiguousarray(points.reshape(-1, 3))
    return _core.project(camera.K, camera.lens, flat).reshape(*points.shape[:-1], 2)


def _set_visible(rows: Array, points: F64, middle: F64, camera: CameraLabel, range_m: F64) -> None:
    inside, seen = _seen(rows, points, camera, range_m)
    rows["inside_fract"], rows["visib_fract"] = inside.mean(axis=1), seen.mean(axis=1)
    rows["cut"] = ~inside.all(axis=1)
    rows["rim_px"] = camera_pixels(camera, points)
    rows["rim_px"][points[..., 2] < _NEAR_M] = np.nan
    rows["rim_inside"], rows["rim_visib"] = inside, seen
    rows["center_visible"] = _seen(rows, middle[:, None, :], camera, range_m)[1][:, 0]


def _seen(
    rows: Array, points: F64, camera: CameraLabel, range_m: F64
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """(n, k) whether points (n, k, 3) lie in the picture, and whether nothing is before them."""
    uv = camera_pixels(camera, points)
    high = np.array([camera.width, camera.height]) - 0.5
    inside = np.asarray(((uv >= -0.5) & (uv < high)).all(axis=-1))  # nan is outside
    cell = np.where(inside[..., None], np.floor(uv + 0.5), 0.0).astype(int)
    away = np.linalg.norm(points, axis=-1)
    grazing = np.maximum(np.abs(rows["facing"]), 0.05)[:, None]
    pixel_m = away / float(min(camera.K[0, 0], camera.K[1, 1])) / grazing
    slack = np.maximum(2.0 * pixel_m, _HIDDEN * rows["diameter_m"][:, None])
    hidden = range_m[cell[..., 1], cell[..., 0]] < away - slack  # nan: the sky, which hides nothing
    return inside, inside & ~hidden
