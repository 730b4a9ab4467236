"""ASSET_SETUP.MESHES: each mesh becomes a body or a spacecraft (a model).

A mesh with a glTF file is a spacecraft, whatever it shows, except for a planet with axis-wise
scaling: that is a body with this shape, and so is every .obj. Other meshes are bodies: the body of
the table that the file, instance or entry is named after; or, if something orbits it, an ellipsoid
with the Earth's gravity. An ellipsoid has the radii `scale` in scene units. A body uses the picture
next to its file as its map, and may have an atmosphere, clouds and so on by Perilune's keys."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from perilune.document.oaisys import drivers, files, labels, orbits, planets
from perilune.document.oaisys.node import Node
from perilune.document.oaisys.scene import ORIGIN, Entity, Scene, clean_name
from perilune.document.oaisys.units import known_body, metres_per_unit

_ORIGIN_KM = 1e-12
"""Radius, a nanometre, of the placeholder at the origin of a scene without a body there."""
_STANDS = "the mesh stands still at its position, as its file has it"
_ASTEROID = {
    "location": _STANDS,
    "trajectorySimulation": _STANDS,
    "trajectoryParams": _STANDS,
    "random_rotation": _STANDS,
    "assetDistanceScale": "sensorDistanceScale says how far the camera is",
    "assetDisplacementParams": "meshes keep the shape of their files",
    "assetMaterial": "meshes keep the materials of their files",
    "activationProbability": "every mesh is in every scene",
    "randomSwitchOnOff": "every mesh is in every scene",
    "numSamples": "numSamplesPerBatch says how many steps a scene has",
}
"""Keys of MeshAsteroid that are not applied -> the reason."""


class Mesh:
    """An entry while it is read: its nodes and its files."""

    def __init__(self, entry: Node, scene: Scene, taken: list[str]) -> None:
        self.entry = entry
        self.kind = entry.text("type")
        self.params = entry.child("meshParams")
        self.alias = entry.text("name")
        self.instance = self.params.text("meshInstanceName", self.alias)
        self.name = clean_name(self.alias, taken)
        self.scale = self.params.numbers("scale", 3, [1.0, 1.0, 1.0])
        if not min(self.scale) > 0.0:
            self.params.fail("scale", f"must be positive, not {self.scale}")
        self.position = self.params.numbers("position", 3, [0.0, 0.0, 0.0])
        self.file = files.model(self.params, "meshFilePath", scene.base)
        self.table = known_body(self.file.stem, self.instance, self.alias)
        self.orbit = self._orbit()
        self.is_parent = False

    def _orbit(self) -> Node | None:
        """`orbit_params`, which stands inside or beside `meshParams`."""
        for owner in (self.params, self.entry):
            if owner.has("orbit_params"):
                if self.kind != "MeshSatelliteObject":
                    text = f"orbits belong to MeshSatelliteObject; {self.kind} stands still"
                    owner.ignore("orbit_params", text)
                    continue
                return owner.child("orbit_params")
        if self.kind == "MeshSatelliteObject":
            self.params.fail("orbit_params", "required, but missing")
        return None

    @property
    def is_shape(self) -> bool:
        """Whether it is a body with the shape of its file."""
        if self.file.found is None:
            return self.file.shape is not None
        return self.is_planet and len(set(self.scale)) > 1

    @property
    def is_planet(self) -> bool:
        """Whether it is a body of the table, or something orbits it."""
        return self.table is not None or self.is_parent

    @property
    def is_body(self) -> bool:
        """Whether it becomes a body of ours: an ellipsoid or a shape."""
        return self.is_shape or (self.file.found is None and self.is_planet)


def _pose(mesh: Mesh, ours: str) -> dict[str, Any]:
    """rotation_deg and spin, which have the same keys as ours."""
    params = mesh.params
    turn: dict[str, Any] = {"rotation_deg": params.numbers("rotation_deg", 3, [0.0, 0.0, 0.0])}
    if params.has("rotation_deg_step_v"):
        raw = params.get("rotation_deg_step_v")
        if isinstance(raw, list) and len(raw) == 3:
            turn["rotation_deg_step_v"] = params.numbers("rotation_deg_step_v", 3)
        else:
            turn["rotation_deg_step_v"] = params.number("rotation_deg_step_v")
    if params.has("rotation_mode"):
        mode = params.choice("rotation_mode", ("local", "global"))
        if "rotation_deg_step_v" in turn:
            turn["rotation_mode"] = mode
        else:
            params.ignore("rotation_mode", "it does not turn: there is no rotation_deg_step_v")
    for key in turn:
        params.comes(f"{ours}.{key}", key)
    return turn


def _place(mesh: Mesh, scene: Scene, root: str, ours: str) -> dict[str, Any]:
    """A fixed position in scene units from the scene's origin."""
    place = scene.lengths_m(mesh.position)
    mesh.params.comes(f"{ours}.orbit", "position")
    if root == ORIGIN and not any(place):
        place = [2e3 * _ORIGIN_KM, 0.0, 0.0]  # out of the speck, which nothing may be in
    return {"around": root, "position_km": [value / 1e3 for value in place]}


def _body(mesh: Mesh, scene: Scene) -> dict[str, Any]:
    entry = planets.read(mesh, scene)
    entry["rotation"] = _pose(mesh, f"bodies.{mesh.name}.rotation")
    return entry


def _metres_per_unit(mesh: Mesh, scene: Scene) -> float | list[float]:
    """Scale of the model along Blender's axes, which are ours: z is up."""
    by_axis = scene.lengths_m(mesh.scale)
    return by_axis if len(set(by_axis)) > 1 else by_axis[0]


def _spacecraft(mesh: Mesh, scene: Scene) -> dict[str, Any]:
    params, ours = mesh.params, f"spacecraft.{mesh.name}"
    if mesh.file.found is None:
        params.fail("meshFilePath", mesh.file.missing())
    if mesh.file.swapped:
        text = f"read from {mesh.file.found}, as .blend files cannot be"
        params.notes.warn(params.where("meshFilePath"), text)
    for owner in (params, mesh.entry):
        for key in planets.OURS:
            owner.ignore(key, "not applied: only a body has it, and this is a model in glTF")
    params.comes(ours, "meshFilePath")
    params.comes(f"{ours}.metres_per_unit", "scale")
    return {
        "model": mesh.file.found,
        "metres_per_unit": _metres_per_unit(mesh, scene),
        "centre": "origin",
        "class": mesh.instance,
        "attitude": _pose(mesh, f"{ours}.attitude"),
    }


def _radii_m(mesh: Mesh, entry: dict[str, Any]) -> tuple[float, float, float]:
    if mesh.is_body:
        first, second, third = (value * 1e3 for value in entry["radii_km"])
        return first, second, third
    # To its farthest vertex, as our orbits count it; read when an orbit or a camera needs it.
    reach = files.reach(mesh.file, mesh.params, entry["metres_per_unit"])
    return reach, reach, reach


def _unsupported(entry: Node) -> None:
    kind = entry.text("type")
    drivers.read(entry, "scattered meshes are not there yet")
    entry.leave(f"{kind}: scattered meshes are not there yet; it is left out")


_KINDS: dict[str, Callable[[Node], None] | None] = {
    "MeshSingle": None,
    "MeshSatelliteObject": None,
    "MeshAsteroid": None,
    "MeshMultipleRandom": _unsupported,
}
"""type -> function that skips it; None: it is read."""


def _read_all(section: Node, scene: Scene) -> list[Mesh]:
    meshes: list[Mesh] = []
    for entry in section.children("MESHES"):
        leave = _KINDS[entry.choice("type", _KINDS)]
        if leave is not None:
            leave(entry)
            continue
        meshes.append(Mesh(entry, scene, [mesh.name for mesh in meshes] + [ORIGIN]))
    if not meshes:
        section.fail("MESHES", "holds no mesh that can be shown")
    parents = {mesh.orbit.text("parent") for mesh in meshes if mesh.orbit is not None}
    for mesh in meshes:
        mesh.is_parent = mesh.alias in parents or mesh.instance in parents
    return meshes


def _unit_m(root: Node, meshes: list[Mesh]) -> float:
    """Scene unit. Planets come before their moons, which are central bodies too, and before other
    bodies."""
    bodies = sorted(
        (mesh for mesh in meshes if mesh.is_body or mesh.is_parent),
        key=lambda mesh: (not mesh.is_parent, mesh.orbit is not None),
    )
    moving = any(mesh.orbit is not None for mesh in meshes)
    return metres_per_unit(root, [mesh.table for mesh in bodies], moving)


def _entry(mesh: Mesh, scene: Scene) -> dict[str, Any]:
    """Our entry of a mesh without its orbit; adds the object to the scene."""
    if mesh.kind == "MeshAsteroid":
        for key, why in _ASTEROID.items():
            mesh.params.ignore(key, f"not applied: {why}")
    entry = _body(mesh, scene) if mesh.is_body else _spacecraft(mesh, scene)
    section = "bodies" if mesh.is_body else "spacecraft"
    ours = f"{section}.{mesh.name}"
    drivers.read_mesh((mesh.params, mesh.entry), entry, ours, mesh.file, mesh.is_body)
    scene.entities[mesh.name] = Entity(
        name=mesh.name,
        aliases=(mesh.alias, mesh.instance),
        node=mesh.entry,
        section=section,
        table=mesh.table if mesh.is_body or mesh.is_parent else None,
        rotation_deg=entry["rotation" if mesh.is_body else "attitude"]["rotation_deg"],
        radii_m=partial(_radii_m, mesh, entry),
    )
    return entry


def read(root: Node, section: Node, scene: Scene) -> None:
    """Fills `bodies`, `spacecraft`, `labels` and `root` of our tree, and the scene's objects."""
    section.child("GENERAL")
    meshes = _read_all(section, scene)
    scene.metres_per_unit = _unit_m(root, meshes)
    sections: dict[str, dict[str, Any]] = {"bodies": {}, "spacecraft": {}}
    center = next((mesh.name for mesh in meshes if _rests_at_origin(mesh)), None)
    if center is None:
        sections["bodies"][ORIGIN] = _origin()
    for mesh in meshes:
        entry = _entry(mesh, scene)
        sections[scene.entities[mesh.name].section][mesh.name] = entry
    for mesh in meshes:  # all of them are known by now
        where = scene.entities[mesh.name].section
        entry, ours = sections[where][mesh.name], f"{where}.{mesh.name}"
        if mesh.orbit is not None:
            entry["orbit"] = orbits.read(mesh.orbit, scene, f"{ours}.orbit")
            if any(mesh.position):
                mesh.params.ignore("position", "not applied: the orbit says where it is")
        elif mesh.name != center:
            entry["orbit"] = _place(mesh, scene, center or ORIGIN, ours)
    scene.tree |= {"root": center or ORIGIN, **sections}
    scene.tree["labels"] = labels.read([(mesh.name, mesh.params) for mesh in meshes], scene)


def _rests_at_origin(mesh: Mesh) -> bool:
    return mesh.is_body and mesh.orbit is None and not any(mesh.position)


def _origin() -> dict[str, Any]:
    """A placeholder at the scene's origin, if there is no body."""
    radii = [_ORIGIN_KM] * 3
    return {"kind": "ellipsoid", "radii_km": radii, "gm_km3_s2": 1e-20, "albedo": 0.0}
