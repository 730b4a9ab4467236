"""Builds station.glb: a modular station around the Moon, in the manner of the Gateway.

The stack runs along x: the power and propulsion element (ppe) at -x, then halo, the habitat
(ihab) and the logistics module; the airlock hangs at -z and the refuelling module stands at +z of
the habitat. +y and -y carry the big arrays. Metres; origin at the middle of the stack.
"""

from __future__ import annotations

import materials
import numpy as np
import station_parts as parts
from glb import Document, Node
from shapes import F64, Mesh, rotation, z_to

Parts = dict[str, Mesh]
Place = tuple[float, float, float]

X_AXIS = z_to([1, 0, 0])  # module meshes lie along their own z


class Builder:
    """Meshes by name and the tree of nodes; a mesh is stored once however often it is placed."""

    def __init__(self) -> None:
        self.meshes: dict[str, Parts] = {}
        self.root = Node("station")

    def mesh(self, name: str, content: Parts) -> str:
        self.meshes.setdefault(name, content)
        return name

    def put(
        self, parent: Node, name: str, mesh: str | None, at: Place, turn: F64 | None = None
    ) -> Node:
        return parent.add(Node(name, mesh, tuple(float(v) for v in at), turn))


def build() -> Document:
    b = Builder()
    b.mesh("dock", parts.docking_port())
    b.mesh("handrail", parts.handrail())
    b.mesh("array_blanket", parts.array_blanket())
    b.mesh("array_mast", parts.array_mast())
    b.mesh("radiator_panel", parts.radiator_panel())
    b.mesh("box_unit", parts.box_unit())
    b.mesh("thruster_pod", parts.thruster_pod())
    ppe(b)
    halo(b)
    ihab(b)
    logistics(b)
    airlock(b)
    refuelling(b)
    truss(b)
    used = list(dict.fromkeys(m for content in b.meshes.values() for m in content))
    return Document(
        "station",
        materials.pick(*used),
        b.meshes,
        b.root,
        images={materials.SOLAR_CELL_IMAGE: materials.solar_cell_png()},
        extras={"description": "A fictional modular station made by assets/scripts/station.py"},
    )


def ring_of_handrails(
    b: Builder, parent: Node, radius: float, zs: list[float], count: int, phase_deg: float = 0.0
) -> None:
    """Handrails along a module's axis, `count` around it at each station in `zs`."""
    for i, z in enumerate(zs):
        for k in range(count):
            angle = phase_deg + 360.0 * k / count
            c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
            turn = rotation([0, 0, 1], angle)
            name = f"{parent.name}_handrail_{i * count + k + 1}"
            b.put(parent, name, "handrail", (radius * c, radius * s, z), turn)


def ppe(b: Builder) -> None:
    """Power and propulsion: an octagonal bus, ion thrusters, the two main array wings."""
    node = b.put(b.root, "ppe", b.mesh("ppe", parts.octagon_bus()), (-9.4, 0, 0), X_AXIS)
    for k in range(4):
        a = np.radians(45 + 90 * k)
        place = (1.05 * np.cos(a), 1.05 * np.sin(a), -2.05)
        b.put(node, f"ppe_thruster_{k + 1}", b.mesh("ion_thruster", parts.ion_thruster()), place)
    for k in range(4):
        turn = rotation([0, 0, 1], 45.0 + 90 * k)
        place = turn @ np.array([1.85, 0, 1.3])
        b.put(node, f"ppe_rcs_{k + 1}", "thruster_pod", tuple(place), turn)
    for name, side in (("array_left", 1), ("array_right", -1)):
        wing(b, name, side, (-9.6, 0, 0), segments=5)
    for k, side in enumerate((1, -1)):
        turn = np.eye(3) if side > 0 else np.diag([1.0, -1.0, -1.0])
        place = (-8.2, 0.6 * side, side * 2.05)
        b.put(b.root, f"dish_{k + 1}", b.mesh("dish", parts.dish_antenna()), place, turn)


def wing(b: Builder, name: str, side: int, at: Place, segments: int) -> None:
    """Two roll-out blankets on one boom, tilted as when tracking the Sun."""
    base = np.diag([1.0, 1.0, 1.0]) if side > 0 else np.diag([1.0, -1.0, -1.0])
    node = b.put(b.root, name, None, at, rotation([0, 1, 0], 28.0) @ base)
    b.put(node, f"{name}_mast", "array_mast", (0, 0, 0))
    for row, z in enumerate((1, -1)):
        for k in range(segments):
            y = 3.6 + k * (parts.BLANKET[1] + 0.12)
            label = f"{name}_panel_{row * segments + k + 1}"
            b.put(node, label, "array_blanket", (0, y + parts.BLANKET[1] / 2, z * 1.95))


def halo(b: Builder) -> None:
    node = b.put(
        b.root,
        "halo",
        b.mesh("halo", parts.plated_module(1.6, 5.6, "white_paint")),
        (-4.2, 0, 0),
        X_AXIS,
    )
    ring_of_handrails(b, node, 1.66, [-1.5, 0.0, 1.5], 8, 22.5)
    for k, angle in enumerate((0.0, 180.0)):
        turn = rotation([0, 0, 1], angle)
        place = turn @ np.array([1.6, 0, -0.6])
        b.put(node, f"halo_dock_{k + 1}", "dock", tuple(place), turn @ X_AXIS)
    radiators(b, node, "halo", 1.7, 0.8)
    for k, angle in enumerate((60.0, 120.0, 240.0, 300.0)):
        turn = rotation([0, 0, 1], angle)
        b.put(node, f"halo_unit_{k + 1}", "box_unit", tuple(turn @ np.array([1.72, 0, -2.0])), turn)


def radiators(b: Builder, node: Node, name: str, radius: float, z: float) -> None:
    """Two deployed radiator wings along the module's sides."""
    for k, angle in enumerate((90.0, 270.0)):
        turn = rotation([0, 0, 1], angle)
        bracket = b.mesh("radiator_bracket", parts.radiator_bracket())
        at = turn @ np.array([radius, 0, z])
        b.put(node, f"{name}_radiator_bracket_{k + 1}", bracket, tuple(at), turn)
        for j in range(3):
            place = turn @ np.array([radius + 1.0 + 1.62 * j, 0, z])
            b.put(node, f"{name}_radiator_{3 * k + j + 1}", "radiator_panel", tuple(place), turn)


def ihab(b: Builder) -> None:
    node = b.put(
        b.root, "ihab", b.mesh("ihab", parts.quilted_module(2.0, 6.4)), (2.4, 0, 0), X_AXIS
    )
    ring_of_handrails(b, node, 2.08, [-2.0, 0.0, 2.0], 6, 30.0)
    for k, angle in enumerate((0.0, 180.0)):
        turn = rotation([0, 0, 1], angle)
        b.put(
            node, f"ihab_dock_{k + 1}", "dock", tuple(turn @ np.array([1.95, 0, 0])), turn @ X_AXIS
        )
    b.put(node, "ihab_dock_3", "dock", (0, 0, 3.2))
    b.put(node, "ihab_dock_4", "dock", (0, 0, -3.2), np.diag([1.0, -1.0, -1.0]))
    arm(b, node)


def arm(b: Builder, parent: Node) -> None:
    """A seven-jointed robotic arm, bent over the habitat."""
    joints = np.array(
        [(0, 2.1, -2.4), (0, 2.7, -2.4), (0.3, 4.9, -0.6), (0.5, 5.6, 1.6), (0.3, 4.9, 3.6)]
    )
    node = b.put(parent, "robotic_arm", b.mesh("arm", parts.arm(joints)), (0, 0, 0))
    toward = z_to(joints[-1] - joints[-2] + np.array([0, -0.6, 0.4]))
    effector = b.mesh("arm_effector", parts.arm_effector())
    b.put(node, "robotic_arm_effector", effector, tuple(joints[-1]), toward)


def logistics(b: Builder) -> None:
    node = b.put(
        b.root, "logistics", b.mesh("logistics", parts.cargo_module()), (8.6, 0, 0), X_AXIS
    )
    ring_of_handrails(b, node, 1.76, [-0.9, 0.9], 6)
    for name, side in (("logistics_array_left", 1), ("logistics_array_right", -1)):
        base = np.eye(3) if side > 0 else np.diag([1.0, -1.0, -1.0])
        wing_node = b.put(b.root, name, b.mesh("cargo_mast", parts.cargo_mast()), (9.6, 0, 0), base)
        for k in range(2):
            y = 2.9 + k * (parts.BLANKET[1] + 0.12) + parts.BLANKET[1] / 2
            b.put(wing_node, f"{name}_panel_{k + 1}", "array_blanket", (0, y, 0))


def airlock(b: Builder) -> None:
    """Hangs under the habitat; its axis is the station's z."""
    node = b.put(b.root, "airlock", b.mesh("airlock", parts.airlock()), (2.4, 0, -4.2))
    ring_of_handrails(b, node, 1.32, [-0.6, 0.7], 8)
    hatch = (0, 0, -1.75)
    b.put(node, "airlock_hatch", b.mesh("hatch", parts.hatch()), hatch, np.diag([1.0, -1.0, -1.0]))


def refuelling(b: Builder) -> None:
    """Stands on the habitat: tanks outside, and a room with windows on top."""
    node = b.put(b.root, "refuelling", b.mesh("refuelling", parts.refuelling()), (2.4, 0, 4.1))
    ring_of_handrails(b, node, 1.27, [-0.4], 6, 30.0)
    b.put(node, "cupola", b.mesh("cupola", parts.cupola()), (0, 0, 1.7))
    for k in range(6):
        a = np.radians(60.0 * k)
        place = (1.62 * np.cos(a), 1.62 * np.sin(a), 0.45)
        b.put(node, f"tank_{k + 1}", b.mesh("tank", parts.tank()), place)


def truss(b: Builder) -> None:
    """An external truss along the stack with stowage and antennas."""
    node = b.put(b.root, "truss", b.mesh("truss", parts.truss(9)), (-6.4, 0, 2.35), X_AXIS)
    for k in range(4):
        b.put(
            node,
            f"truss_unit_{k + 1}",
            "box_unit",
            (-0.55, 0, 1.0 + 1.2 * k),
            rotation([0, 0, 1], 180.0),
        )
    boom = b.mesh("whip", parts.whip())
    for k, (x, y) in enumerate(((-1.2, 0.9), (-5.6, -0.8), (4.6, 1.2))):
        b.put(b.root, f"antenna_{k + 1}", boom, (x, y, 1.35 if k < 2 else 1.62))
