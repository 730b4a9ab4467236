"""A frame of a simulation as plain data (`scene.Scene`), for other renderers.

Models come as Perilune places and articulates them, bodies as ellipsoids or shapes whose maps are
turned and stretched as their latitudes say; gas about a ball and a sea that covers it are exported,
too. What is not described there (haze, clouds, coasts, rings, volumes, material graphs, laws but
Lambert's, lenses, skies) is an error that names it.
"""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image as Picture

import perilune

from . import gas, ground, sheets
from .gltf import File
from .palette import split
from .scene import Array, Image, Input, Material, Mesh, Scene

AU = 149597870700.0
ROWS = 512
"""Of quads from pole to pole, of ellipsoids."""


def matrix(pose: Array) -> Array:
    """(4, 4) of a pose x y z qw qx qy qz."""
    w, x, y, z = pose[3:]
    out = np.eye(4)
    out[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    out[:3, 3] = pose[:3]
    return out


def middle(poses: Array) -> Array:
    """(4, 4): of the two poses of an exposure that has no length."""
    if not np.array_equal(poses[0], poses[1]):
        raise ValueError("frames with an exposure time are not exported")
    return matrix(poses[0])


def moved(points: Array, to: Array) -> Array:
    return np.asarray(points @ to[:3, :3].T + to[:3, 3])


def _check(sim: perilune.Simulation, config: Any) -> None:
    wrong = []
    for name, body in config.bodies.items():
        extras = ("clouds", "rings", "relief", "night_lights", "material")
        wrong += [f"bodies.{name}.{key}" for key in extras if getattr(body, key, None) is not None]
        if body.atmosphere is not None and (names := gas.unknown(body.atmosphere)):
            wrong.append(f"bodies.{name}.atmosphere ({', '.join(names)})")
        wrong += ground.check(name, body.terrain)
        if body.terrain is not None and body.color_map is not None:
            wrong.append(f"bodies.{name}.color_map (with terrain)")
        if body.reflectance != "lambert":
            wrong.append(f"bodies.{name}.reflectance: {body.reflectance}")
    wrong += [f"spacecraft.{n}.materials" for n, c in config.spacecraft.items() if c.materials]
    wrong += [
        f"spacecraft.{n}.faces" for n, c in config.spacecraft.items() if c.faces != "double_sided"
    ]
    wrong += [key for key in ("volumes", "sky") if getattr(config, key, None)]
    if config.camera.lens is not None:
        wrong.append("camera.lens")
    if wrong:
        raise ValueError(f"{sim.document.source}: not exported: {', '.join(wrong)}")


def export(sim: perilune.Simulation, frame: int, rows: int = ROWS) -> Scene:
    """The frame; ValueError for what the description has no place for."""
    config = sim.world(frame).config
    _check(sim, config)
    request = sim.request(frame)
    camera = np.linalg.inv(middle(request["camera_pose"]))
    sun = moved(request["sun_position"][np.newaxis], camera)[0]
    away = float(np.linalg.norm(sun))
    K = request["K"]
    scene = Scene(
        camera={
            "width": request["width"],
            "height": request["height"],
            "focal_px": (float(K[0, 0]), float(K[1, 1])),
            "centre_px": (float(K[0, 2]), float(K[1, 2])),
        },
        sun={
            "direction": tuple(sun / away),
            "distance_m": away,
            "irradiance": request["sun_irradiance"] * (AU / away) ** 2,
            "radius_rad": math.asin(request["sun_radius"] / away),
        },
        max_bounces=config.render.max_bounces,
        white_radiance=float(sim.frame(frame, channels=["rgb"]).meta["white_radiance"]),
    )
    mover = 0
    for index, (name, model) in enumerate(sim.models.items()):
        nodes = sim._mine().rigs[name].core.nodes if name in sim._mine().rigs else ()
        motions = request["object_movers"][mover : mover + len(nodes)]
        mover += len(nodes)
        place = camera @ middle(request["object_poses"][index])
        scale = float(request["object_scale"][index])
        _add_model(scene, name, model, dict(zip(nodes, motions, strict=True)), place, scale)
    shapes = sim._mine().shapes_of(config)
    for index, (name, body) in enumerate(config.bodies.items()):
        place = camera @ middle(request["body_poses"][index])
        albedo = tuple(float(v) for v in request["body_albedo"][index])
        path = body.color_map and sim.document.path(body.color_map, f"bodies.{name}.color_map")
        soil = Material(name, _map(path, albedo), lambert=True)
        scene.materials.append(soil if body.ocean is None else _sea(sim, name, body))
        geodetic = body.is_geodetic
        radii = request["body_radii"][index]
        if body.atmosphere is not None:
            below = np.array(albedo) if path is None else np.full(3, np.nan)  # a map has no one
            if body.ocean is not None:
                below = np.zeros(3)
            scene.air.append(gas.gas_of(body, radii, below, place[:3, 3]))
        center = math.radians(body.map_center_lon_deg)
        if body.terrain is not None:
            mesh = ground.square(sim, frame, name, place)
        elif name in shapes:
            mesh = _shape(shapes[name].model.mesh(), geodetic and radii, center)
        else:
            mesh = ellipsoid(radii, geodetic, center, rows)
        points, normals, uv, indices = mesh
        scene.meshes.append(
            Mesh(
                name,
                len(scene.materials) - 1,
                moved(points, place),
                normals @ place[:3, :3].T,
                indices,
                uv,
            )
        )
    return scene


def _map(path: Path | None, albedo: tuple[float, ...]) -> Input:
    if path is None:
        return albedo
    return Image(np.asarray(Picture.open(path).convert("RGB")), True, albedo)


def _sea(sim: perilune.Simulation, name: str, body: Any) -> Material:
    """Water everywhere, black below: what others know as a rough boundary."""
    ocean = body.ocean
    path = sim.document.path(ocean.map, f"bodies.{name}.ocean.map") if ocean.map else None
    if path is None or np.asarray(Picture.open(path).convert("L")).min() < 255:
        raise ValueError(f"bodies.{name}.ocean.map: not exported: a sea with coasts")
    if ocean.albedo is None or any(ocean.albedo):
        raise ValueError(f"bodies.{name}.ocean.albedo: not exported: light from below the water")
    alpha = math.sqrt(0.003 + 0.00512 * ocean.wind_m_s)  # Cox and Munk 1954
    return Material(name, (0.0, 0.0, 0.0), waves=alpha)


def _add_model(
    scene: Scene,
    name: str,
    model: Any,
    motions: dict[int, Array],
    place: Array,
    scale: float,
) -> None:
    """A mesh for each material of the model and thing that moves."""
    core = model.model
    mesh = sheets.apart(core.mesh(), ~core.surfaces()["double_sided"])
    file = File(Path(core.path))
    materials = file.parts()
    seen: Counter[int] = Counter()
    groups: dict[tuple[int, int], list[int]] = {}
    for index, part in enumerate(core.parts):
        material = materials[part["node"]][seen[part["node"]]]
        seen[part["node"]] += 1
        groups.setdefault((material, _mover(core, part["node"], motions)), []).append(index)
    uv = mesh["uv"] * [1.0, -1.0] + [0.0, 1.0] if "uv" in mesh else None
    known: dict[int, Material] = {}
    for (material, node), parts in groups.items():
        if material not in known:
            known[material] = file.material(material)
        faces = mesh["indices"][np.isin(mesh["triangle_part"], parts)]
        corners = None if uv is None else uv[faces]
        for skin, chosen in split(known[material], corners, len(faces)):
            used, indices = np.unique(faces[chosen], return_inverse=True)
            points, normals, indices = _posed(
                mesh["positions"][used],
                mesh["normals"][used].astype(float),
                indices.reshape(-1, 3).astype(np.uint32),
                motions.get(node),
            )
            scene.materials.append(skin)
            scene.meshes.append(
                Mesh(
                    f"{name}.{skin.name}",
                    len(scene.materials) - 1,
                    moved(scale * (points - model.offset), place),
                    normals @ place[:3, :3].T,
                    indices,
                    None if uv is None else uv[used],
                )
            )


def _posed(
    points: Array, normals: Array, triangles: Array, motion: Array | None
) -> tuple[Array, Array, Array]:
    """Where a motion (3, 4) takes them; mirrored triangles turn their corners round."""
    if motion is None:
        return points, normals, triangles
    turn = motion[:, :3]
    normals = normals @ np.linalg.inv(turn)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    around = triangles[:, ::-1] if np.linalg.det(turn) < 0.0 else triangles
    return points @ turn.T + motion[:, 3], normals, around


def _mover(core: Any, node: int, motions: dict[int, Array]) -> int:
    """The moving node that a node hangs on; -1: none."""
    while node >= 0 and node not in motions:
        node = core.nodes[node]["parent"]
    return node


def ellipsoid(
    radii: Array, geodetic: bool, center_lon_rad: float, rows: int
) -> tuple[Array, Array, Array, Array]:
    """Points, normals, uv by the latitudes of the map, and triangles, in body axes."""
    columns = 2 * rows
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    lon, lat = (2 * u - 1) * math.pi + center_lon_rad, (v - 0.5) * math.pi
    unit = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
    unit = unit.reshape(-1, 3)
    if geodetic:  # the equator counts as a circle
        across = math.sqrt(radii[0] * radii[1])
        unit = unit * [across**2, across**2, radii[2] ** 2]
        unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    points = unit / np.linalg.norm(unit / radii, axis=1, keepdims=True)
    normals = points / np.square(radii)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).reshape(-1)
    lower = np.stack([corner, corner + 1, corner + columns + 2], axis=-1)
    upper = np.stack([corner, corner + columns + 2, corner + columns + 1], axis=-1)
    triangles = np.concatenate([lower[columns:], upper[:-columns]])  # no slivers at the poles
    return points, normals, np.stack([u, v], -1).reshape(-1, 2), triangles.astype(np.uint32)


def _shape(
    mesh: dict[str, Array], radii: Array | bool, center_lon_rad: float
) -> tuple[Array, Array, Array, Array]:
    """Corners apart, so that a triangle over the map's edge has both sides of it."""
    corners = mesh["indices"].reshape(-1)
    points, normals = mesh["positions"][corners], mesh["normals"][corners].astype(float)
    up = points[:, 2]
    if not isinstance(radii, bool):
        up = up * (radii[0] * radii[1]) / radii[2] ** 2
    lat = np.arctan2(up, np.hypot(points[:, 0], points[:, 1]))
    u = 0.5 + (np.arctan2(points[:, 1], points[:, 0]) - center_lon_rad) / (2.0 * math.pi)
    u = u.reshape(-1, 3)
    u -= np.round(u - u[:, :1])
    uv = np.stack([u.reshape(-1), 0.5 + lat / math.pi], -1)
    return points, normals, uv, np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
