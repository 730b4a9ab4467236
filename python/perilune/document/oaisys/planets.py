"""Meshes that become bodies: ellipsoids with a picture as map, and shapes from .obj files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from perilune.document.oaisys import files
from perilune.document.oaisys.scene import Scene

if TYPE_CHECKING:
    from perilune.document.oaisys.meshes import Mesh

OURS = ("atmosphere", "clouds", "rings", "relief", "ocean", "night_lights")
"""Keys of Perilune's bodies that a mesh of the file may have unchanged."""
_SURFACE_GRAVITY = 9.8e-3  # km/s2, of bodies that nobody knows


def _shape(mesh: Mesh, scene: Scene, entry: dict[str, Any], ours: str) -> str:
    """A closed mesh as the surface, with its warnings."""
    text = mesh.file.shape or mesh.file.found
    assert text is not None  # else it is an ellipsoid
    units_m = [scene.metres_per_unit * scale for scale in mesh.scale]
    reach = files.semi_axes(text, mesh.file, mesh.params)
    entry["radii_km"] = [m * units / 1e3 for m, units in zip(units_m, reach, strict=True)]
    entry["shape"] = {"file": text, "metres_per_unit": units_m}
    mesh.params.comes(f"{ours}.shape", "meshFilePath")
    mesh.params.comes(f"{ours}.shape.metres_per_unit", "scale")
    return f"a body of the shape {text}, z up; its materials are not read"


def _ellipsoid(mesh: Mesh, scene: Scene, entry: dict[str, Any]) -> str:
    radii_km = [value / 1e3 for value in scene.lengths_m(mesh.scale)]
    entry["radii_km"] = radii_km
    told = f"an ellipsoid of radii {radii_km[0]:g}, {radii_km[1]:g}, {radii_km[2]:g} km"
    return f"no {mesh.file.text} in glTF; {mesh.alias} is {told}"


def _extras(mesh: Mesh, entry: dict[str, Any], ours: str) -> None:
    """Atmosphere, clouds, rings and ground by Perilune's keys."""
    for owner in (mesh.params, mesh.entry):
        for key in OURS:
            if owner.has(key):
                entry[key] = owner.get(key)
                owner.comes(f"{ours}.{key}", key)


def read(mesh: Mesh, scene: Scene) -> dict[str, Any]:
    """Our entry of a body without its orbit and rotation."""
    ours = f"bodies.{mesh.name}"
    entry: dict[str, Any] = {"kind": mesh.table or "ellipsoid", "class": mesh.instance}
    mesh.params.comes(ours, "meshFilePath")
    mesh.params.comes(f"{ours}.radii_km", "scale")
    if mesh.is_shape:
        told = f"{mesh.alias} is {_shape(mesh, scene, entry, ours)}"
    else:
        told = _ellipsoid(mesh, scene, entry)
    if mesh.table is None:
        entry["gm_km3_s2"] = _SURFACE_GRAVITY * entry["radii_km"][0] ** 2
        entry["albedo"] = 0.3
    else:
        told += f" with the constants of {mesh.table}"
    if mesh.file.map is not None:
        entry["color_map"], entry["albedo"] = mesh.file.map, 1.0
        told += f" and the map {mesh.file.map}"
    mesh.params.notes.warn(mesh.params.where("meshFilePath"), told)
    _extras(mesh, entry, ours)
    return entry
