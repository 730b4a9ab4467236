"""Builds smallsat.glb: an Earth-observing small satellite with two solar wings.

Body axes: +x is where the telescope looks, +y the left wing, +z the high-gain dish; the thruster
and the launch adapter are at -z. The origin is the middle of the bus. Metres.
"""

from __future__ import annotations

import materials
import numpy as np
from glb import Document, Node
from noise import crumple, gradient_noise
from shapes import (
    F64,
    Mesh,
    bevel_box,
    cone,
    cylinder,
    dish,
    displaced,
    faceted,
    lathe,
    merge,
    nozzle,
    ring,
    rotation,
    rounded_box,
    sphere,
    tube,
    z_to,
)

BUS = np.array([1.0, 1.1, 1.5])
SEGMENT = np.array([0.024, 1.0, 1.16])  # a wing's segment: thickness, span, width
SEGMENTS = 3
HINGE_GAP = 0.05
YOKE = 0.42
CELL_M = 0.083  # so that 12 x 14 cells fill a segment

Parts = dict[str, Mesh]


def build() -> Document:
    meshes: dict[str, Parts] = {}
    root = Node("smallsat")

    def put(parent: Node, name: str, parts: Parts, **placed: object) -> Node:
        meshes[name] = parts
        return parent.add(Node(name, mesh=name, **placed))

    bus = put(root, "bus", {"mli_gold": foil()})
    put(bus, "bus_frame", {"aluminium": frame()})
    for name, side in (("radiator_right", -1), ("radiator_left", 1)):
        put(bus, name, radiator(side))
    put(bus, "telescope", telescope(), translation=(BUS[0] / 2, 0.0, 0.22))
    for name, y in (("star_tracker_1", 0.30), ("star_tracker_2", -0.30)):
        axis = z_to([-0.55, np.sign(y) * 0.45, 0.9])
        put(bus, name, star_tracker(), translation=(-0.26, y, BUS[2] / 2 + 0.09), rotation=axis)
    put(bus, "antenna_boom", boom(), translation=(-BUS[0] / 2, -0.3, 0.55))
    put(bus, "patch_antennas", patches(), translation=(BUS[0] / 2, 0.0, -0.42))
    put(bus, "high_gain_antenna", antenna(), translation=(0.20, 0.0, BUS[2] / 2))
    put(bus, "main_thruster", engine(), translation=(0.0, 0.0, -BUS[2] / 2))
    put(bus, "adapter_ring", adapter(), translation=(0.0, 0.0, -BUS[2] / 2))
    meshes["thruster"] = small_thruster()
    for i, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1)), start=1):
        place = (x * (BUS[0] / 2 - 0.09), y * (BUS[1] / 2 - 0.09), -BUS[2] / 2 - 0.01)
        bus.add(Node(f"thruster_{i}", "thruster", place, z_to([-x, -y, 3.5])))
    meshes["panel_segment"] = segment()
    meshes["panel_yoke"] = yoke()
    for name, turn in (("panel_left", None), ("panel_right", np.diag([-1.0, -1.0, 1.0]))):
        side = 1 if turn is None else -1
        wing = Node(name, None, (0.0, side * BUS[1] / 2, 0.0), wing_rotation(turn))
        root.add(wing).add(Node(f"{name}_yoke", "panel_yoke"))
        for k in range(SEGMENTS):
            span = YOKE + k * (SEGMENT[1] + HINGE_GAP) + SEGMENT[1] / 2
            wing.add(Node(f"{name}_{k + 1}", "panel_segment", (0.0, span, 0.0)))
    used = list(dict.fromkeys(m for parts in meshes.values() for m in parts))
    return Document(
        "smallsat",
        materials.pick(*used),
        meshes,
        root,
        images={materials.SOLAR_CELL_IMAGE: materials.solar_cell_png()},
        extras={"description": "A fictional small satellite made by assets/scripts/smallsat.py"},
    )


def wing_rotation(turn: F64 | None) -> F64:
    """Cells face -x, away from what the telescope sees, turned 20 degrees about the boom."""
    track = rotation([0, 1, 0], 160.0)
    if turn is None:
        return track
    # Half a turn about x takes the wing to the right, and another track makes its cells match.
    return track @ np.diag([1.0, -1.0, -1.0])


def foil() -> Mesh:
    """Crumpled blankets: a jittered grid with nearly flat facets, as creased film has."""
    box = rounded_box(BUS - 0.022, 0.03, (16, 18, 24), arc=1)
    jitter = 0.020 * np.stack([gradient_noise(box.positions / 0.031, s) for s in (3, 4, 5)], axis=1)
    jitter -= box.normals * (jitter * box.normals).sum(axis=1, keepdims=True)
    box = Mesh(box.positions + jitter, box.normals, box.uvs, box.triangles)
    return faceted(displaced(box, lambda p: blanket(p) + crumple(p, 11, 0.11, 0.045)), 0.75)


def blanket(points: F64) -> F64:
    """Quilting: the blanket bulges between tacks a quarter of a metre apart, m."""
    wave = np.abs(np.sin(np.pi * (points + BUS / 2) / (BUS / np.array([4, 4, 6]))))
    return 0.006 * np.sort(wave, axis=1)[:, 1]


def frame() -> Mesh:
    """The corner posts and edge rails that hold the blankets, a little proud of them."""
    half, width = BUS / 2, 0.028
    bars = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for su in (-1, 1):
            for sv in (-1, 1):
                size, centre = np.full(3, width), np.zeros(3)
                size[axis] = BUS[axis] + 0.024
                centre[u], centre[v] = su * (half[u] - 0.002), sv * (half[v] - 0.002)
                bars.append(bevel_box(size, 0.004).moved(centre))
    return merge(*bars)


def radiator(side: int) -> Parts:
    """Optical solar reflectors on a face that the wing's boom crosses, in four tiles."""
    y = side * (BUS[1] / 2 + 0.015)
    tiles = [
        bevel_box((0.36, 0.03, 0.50), 0.005).moved((x, y, z))
        for x in (-0.205, 0.205)
        for z in (-0.33, 0.40)
    ]
    return {"radiator": merge(*tiles)}


def telescope() -> Parts:
    """A baffle tube with a black bore and a mirror at its bottom; looks along +x."""
    outer = [(0.232, 0.36), (0.25, 0.36), (0.25, 0.10), (0.285, 0.07), (0.285, -0.06)]
    shell = lathe([*outer, (0.0, -0.06), (0.0, -0.05), (0.232, -0.05), (0.232, 0.36)], 40)
    rings = [lathe_ring(0.205, 0.233, 0.008).moved((0, 0, z)) for z in (0.08, 0.19, 0.30)]
    mirror = cylinder(0.20, 0.02, 32, 0.004).moved((0, 0, -0.03))
    secondary = cylinder(0.06, 0.05, 20, 0.005).moved((0, 0, 0.25))
    spider = [
        bevel_box((0.42, 0.006, 0.02), 0.001).moved((0, 0, 0.26), rotation([0, 0, 1], a))
        for a in (0.0, 90.0)
    ]
    turn = z_to([1, 0, 0])
    return {
        "black_paint": merge(*rings, secondary, *spider).moved(rotation=turn),
        "mli_black": shell.moved(rotation=turn),
        "glass": mirror.moved(rotation=turn),
    }


def lathe_ring(inner: float, outer: float, height: float) -> Mesh:
    return ring(inner, outer, height, 28)


def star_tracker() -> Parts:
    """A camera head with a stepped conical baffle; looks along its +z."""
    baffle = lathe(
        [
            *[(0.0, 0.03), (0.038, 0.03), (0.062, 0.20), (0.07, 0.20), (0.066, 0.12)],
            *[(0.056, 0.11), (0.046, 0.02), (0.046, 0.0), (0.0, 0.0)],
        ],
        28,
    )
    head = bevel_box((0.12, 0.12, 0.10), 0.008).moved((0, 0, -0.05))
    bracket = tube([(0, 0, -0.17), (0, 0, -0.09)], 0.03, 12)
    return {"black_paint": baffle, "grey_paint": head, "aluminium": bracket}


def boom() -> Parts:
    """A magnetometer mast with a sensor at its end and a whip antenna; runs along -x."""
    mast = tube([(0.02, 0, 0), (-1.35, 0, 0.10)], 0.014, 10)
    root = bevel_box((0.06, 0.10, 0.10), 0.006).moved((-0.02, 0, 0))
    sensor = bevel_box((0.14, 0.07, 0.07), 0.01).moved((-1.40, 0, 0.10))
    collars = [
        cylinder(0.02, 0.03, 14, 0.003).moved((-x, 0, 0.0725 * x), z_to([-1, 0, 0.0725]))
        for x in (0.45, 0.9)
    ]
    whip = tube([(-0.03, 0.04, -0.02), (-0.25, 0.10, -0.55)], 0.006, 8)
    return {
        "carbon_fibre": mast,
        "aluminium": merge(root, *collars, whip),
        "mli_silver": sensor,
    }


def patches() -> Parts:
    """Two S-band patch antennas and an X-band horn beside the telescope, facing +x."""
    plates = [bevel_box((0.03, 0.15, 0.15), 0.005).moved((0.02, y, 0)) for y in (-0.3, 0.3)]
    buttons = [cylinder(0.045, 0.01, 20).moved((0.04, y, 0), z_to([1, 0, 0])) for y in (-0.3, 0.3)]
    horn = lathe(
        [(0.0, 0.02), (0.025, 0.02), (0.07, 0.14), (0.078, 0.14), (0.034, 0.0), (0.0, 0.0)], 28
    ).moved(rotation=z_to([1, 0, 0]))
    return {"white_paint": merge(*plates), "copper": merge(*buttons, horn)}


def antenna() -> Parts:
    """A Cassegrain dish on a gimbal, leaning to +x; struts hold the subreflector."""
    radius, depth = 0.46, 0.13
    reflector = dish(radius, depth, 0.012, 44, 8)
    rim = ring(radius - 0.006, radius + 0.008, 0.02, 44).moved((0, 0, depth - 0.006))
    hub = cone(0.12, 0.16, 0.07, 28, 0.006).moved((0, 0, -0.04))
    feed = cone(0.055, 0.038, 0.16, 24, 0.004).moved((0, 0, 0.08))
    sub = lathe(
        [(0.0, 0.445), (0.05, 0.44), (0.07, 0.425), (0.05, 0.405), (0.0, 0.395)], 28, crease_deg=50
    )
    struts = []
    for angle in np.radians([90.0, 210.0, 330.0]):
        c, s = np.cos(angle), np.sin(angle)
        foot = (0.74 * radius * c, 0.74 * radius * s, depth * 0.74**2)
        struts.append(tube([foot, (0.062 * c, 0.062 * s, 0.425)], 0.008, 8))
    lean = rotation([0, 1, 0], 22.0)
    up = np.array([0.0, 0.0, 0.36])
    yoke_arms = [bevel_box((0.07, 0.02, 0.20), 0.004).moved((0, y, 0.22)) for y in (-0.10, 0.10)]
    gimbal = [cylinder(0.075, 0.14, 24, 0.006).moved((0, 0, 0.06)), *yoke_arms]
    axle = cylinder(0.03, 0.26, 18, 0.004).moved((0, 0, 0.28), z_to([0, 1, 0]))
    return {
        "white_paint": merge(reflector, rim, sub).moved(up, lean),
        "aluminium": merge(*(m.moved(up, lean) for m in (hub, *struts)), *gimbal, axle),
        "copper": feed.moved(up, lean),
    }


def engine() -> Parts:
    bell = nozzle(0.035, 0.15, 0.30, 0.006, 30).moved((0, 0, -0.10))
    collar = cone(0.055, 0.11, 0.10, 28, 0.004).moved((0, 0, -0.05))
    shield = cone(0.24, 0.21, 0.03, 36, 0.005).moved((0, 0, -0.015))
    return {"nozzle": bell, "titanium": collar, "mli_silver": shield}


def adapter() -> Parts:
    """The separation ring, of the standard 937 mm clamp-band type scaled to this bus."""
    return {
        "aluminium": lathe(
            [
                *[(0.37, 0.0), (0.43, 0.0), (0.41, -0.03), (0.395, -0.05), (0.395, -0.10)],
                *[(0.41, -0.115), (0.41, -0.13), (0.375, -0.13), (0.375, -0.03), (0.37, 0.0)],
            ],
            44,
        )
    }


def small_thruster() -> Parts:
    """A one-newton thruster; fires along its -z."""
    return {
        "nozzle": nozzle(0.008, 0.03, 0.06, 0.002, 14, rows=5).moved((0, 0, -0.05)),
        "titanium": cylinder(0.018, 0.07, 12, 0.003).moved((0, 0, -0.015)),
    }


def segment() -> Parts:
    """One segment in the y-z plane, cells towards +x, hinges at both ends."""
    board = bevel_box(SEGMENT, 0.004)
    span, width = 12 * CELL_M - 0.006, 14 * CELL_M - 0.01
    sheet = bevel_box((0.004, span, width), 0.0008).moved((SEGMENT[0] / 2, 0, 0))
    front = np.arange(len(sheet.triangles)) // 2 == 1  # the +x face, see bevel_box
    tiles = np.array([12, 14]) / materials.CELLS_A_TILE
    cells = sheet.kept(front)
    cells = Mesh(cells.positions, cells.normals, cells.uvs * tiles, cells.triangles)
    ribs = [
        bevel_box((0.012, SEGMENT[1] - 0.06, 0.02), 0.003).moved((-SEGMENT[0] / 2 - 0.004, 0, z))
        for z in (-0.4, 0.0, 0.4)
    ]
    hinges = [
        cylinder(0.016, 0.09, 8).moved((0, s * (SEGMENT[1] + HINGE_GAP) / 2 * 0.985, z))
        for s in (-1, 1)
        for z in (-0.4, 0.4)
    ]
    return {
        "solar_cell": cells,
        "carbon_fibre": merge(sheet.kept(~front), board),
        "panel_back": merge(*ribs),
        "aluminium": merge(*hinges),
    }


def yoke() -> Parts:
    """The drive at the bus and the two arms to the first segment's hinges."""
    arms = [
        tube([(0, 0.06, 0), (0, 0.16, s * 0.05), (0, YOKE, s * 0.4)], 0.016, 10) for s in (-1, 1)
    ]
    bar = tube([(0, YOKE - 0.02, -0.46), (0, YOKE - 0.02, 0.46)], 0.013, 10)
    drive = cylinder(0.07, 0.12, 28, 0.006).moved((0, 0.05, 0), z_to([0, 1, 0]))
    knob = sphere(0.03, 16, 8).moved((0, 0.125, 0))
    return {"carbon_fibre": merge(*arms, bar), "aluminium": merge(drive, knob)}
