"""The parts of station.glb, each about its own origin; modules lie along z. Metres."""

from __future__ import annotations

from itertools import pairwise

import materials
import numpy as np
from noise import crumple
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
    prism,
    ring,
    rotation,
    sphere,
    torus,
    tube,
    z_to,
)

Parts = dict[str, Mesh]

BLANKET = np.array([0.03, 3.0, 3.4])  # one bay of a roll-out array
CELL_M = 0.12


def around(mesh: Mesh, count: int, radius: float, z: float = 0.0, phase_deg: float = 0.0) -> Mesh:
    """Copies about z, each moved out along its own x by `radius`."""
    copies = []
    for k in range(count):
        turn = rotation([0, 0, 1], phase_deg + 360.0 * k / count)
        copies.append(mesh.moved((radius, 0, z)).moved(rotation=turn))
    return merge(*copies)


def curved_plate(radius: float, angle_deg: float, length: float, thick: float, n: int = 3) -> Mesh:
    """A bevelled plate bent about z, centred on +x, its middle on the cylinder `radius`."""
    half = np.radians(angle_deg) / 2
    bevel = 0.012
    flat = bevel_box((thick, 2 * half * radius, length), bevel)
    # Slice the plate across y so that it can bend: intermediate columns on the front, back, rims.
    return bend(slice_y(flat, n), radius)


def slice_y(mesh: Mesh, parts: int) -> Mesh:
    """Cuts the long triangles of a bevelled box into `parts` along y."""
    lo, hi = mesh.positions[:, 1].min(), mesh.positions[:, 1].max()
    for cut in np.linspace(lo, hi, parts + 1)[1:-1]:
        mesh = split_at(mesh, cut)
    return mesh


def split_at(mesh: Mesh, y: float) -> Mesh:
    """Splits triangles that cross the plane y; new vertices are shared by edge."""
    side = np.sign(np.round(mesh.positions[:, 1] - y, 9))
    crossing = np.abs(np.diff(np.sort(side[mesh.triangles], axis=1)[:, [0, 2]], axis=1))[:, 0] > 1
    positions, normals = list(mesh.positions), list(mesh.normals)
    uvs = list(mesh.uvs)
    made: dict[tuple[int, int], int] = {}

    def between(i: int, j: int) -> int:
        key = (min(i, j), max(i, j))
        if key not in made:
            t = (y - positions[key[0]][1]) / (positions[key[1]][1] - positions[key[0]][1])
            for values in (positions, normals, uvs):
                values.append(values[key[0]] * (1 - t) + values[key[1]] * t)
            normals[-1] = normals[-1] / np.linalg.norm(normals[-1])
            made[key] = len(positions) - 1
        return made[key]

    triangles = [tuple(t) for t in mesh.triangles[~crossing]]
    for t in mesh.triangles[crossing]:
        # Start at the corner that is alone on its side.
        lone = next(
            k
            for k in range(3)
            if side[t[k]] * side[t[k - 1]] <= 0
            and side[t[k]] * side[t[k - 2]] <= 0
            and side[t[k]] != 0
        )
        a, b, c = t[lone], t[(lone + 1) % 3], t[(lone + 2) % 3]
        ab = b if side[b] == 0 else between(a, b)
        ac = c if side[c] == 0 else between(a, c)
        triangles.append((a, ab, ac))
        if ab != b:
            triangles.append((ab, b, c))
        if ac != c:
            triangles.append((ab, c, ac))
    return Mesh(np.array(positions), np.array(normals), np.array(uvs), np.array(triangles))


def bend(mesh: Mesh, radius: float) -> Mesh:
    """Wraps y around the z axis: x is added to the radius."""
    angle = mesh.positions[:, 1] / radius
    r = radius + mesh.positions[:, 0]
    c, s = np.cos(angle), np.sin(angle)
    positions = np.column_stack([r * c, r * s, mesh.positions[:, 2]])
    n = mesh.normals
    normals = np.column_stack([n[:, 0] * c - n[:, 1] * s, n[:, 0] * s + n[:, 1] * c, n[:, 2]])
    return Mesh(positions, normals, mesh.uvs, mesh.triangles)


def hull(radius: float, length: float, neck: float = 0.72, sides: int = 64) -> Mesh:
    """A pressure shell with conical ends and rounded shoulders."""
    h, end = length / 2, 0.62
    profile = [
        *[(0.0, h), (neck, h), (neck, h - 0.10), (radius - 0.20, h - end)],
        *[(radius - 0.05, h - end - 0.10), (radius, h - end - 0.24)],
    ]
    full = [*profile, *[(r, -z) for r, z in reversed(profile)]]
    return lathe(full, sides, crease_deg=32)


def plated_module(radius: float, length: float, plate_material: str) -> Parts:
    """A hull under debris-shield plates, with ribs, straps, cables and end rings."""
    shell = hull(radius - 0.05, length)
    plates = []
    rows = np.linspace(-length / 2 + 0.95, length / 2 - 0.95, 5)
    step = float(rows[1] - rows[0])
    for k, z in enumerate(rows[:-1]):
        plate = curved_plate(radius, 360 / 16 - 1.6, step - 0.05, 0.035, 2)
        plates.append(around(plate, 16, 0.0, float(z) + step / 2, 11.25 * (k % 2)))
    ends = [ring(0.60, 0.86, 0.16, 40, 0.015).moved((0, 0, s * length / 2)) for s in (-1, 1)]
    ribs = around(bevel_box((0.05, 0.05, length - 1.8), 0.008), 4, radius + 0.035, 0.0, 45.0)
    cables = around(
        tube(
            [
                (0, 0, -length / 2 + 0.8),
                (0.05, 0.05, -0.5),
                (0.02, -0.04, 0.6),
                (0, 0, length / 2 - 0.8),
            ],
            0.018,
            8,
        ),
        6,
        radius + 0.02,
        0.0,
        15.0,
    )
    return {
        "mli_silver": shell,
        plate_material: merge(*plates),
        "aluminium": merge(*ends, ribs),
        "grey_paint": cables,
    }


def quilted_module(radius: float, length: float) -> Parts:
    """The habitat: a soft quilt of beta cloth over the hull, between hard end cones."""
    h = length / 2 - 0.75
    z = np.linspace(h, -h, 41)
    quilt = lathe(
        [
            (radius - 0.08, h + 0.04),
            *[(radius, v) for v in z],
            (radius - 0.08, -h - 0.04),
            (radius - 0.3, -h - 0.04),
            (radius - 0.3, h + 0.04),
            (radius - 0.08, h + 0.04),
        ],
        96,
    )

    def puff(p: F64) -> F64:
        outside = (np.hypot(p[:, 0], p[:, 1]) > radius - 0.01) & (np.abs(p[:, 2]) < h - 0.01)
        angle = np.arctan2(p[:, 1], p[:, 0]) * 24 / (2 * np.pi)
        bulge = np.abs(np.sin(np.pi * angle)) * np.abs(np.sin(np.pi * (p[:, 2] + h) * 10 / (2 * h)))
        return outside * (0.05 * np.sqrt(bulge) + crumple(p, 21, 0.21, 0.02) - 0.01)

    shell = hull(radius - 0.12, length)
    straps = [torus(radius + 0.03, 0.025, 56, 6).moved((0, 0, s * h)) for s in (-1, 0, 1)]
    ends = [ring(0.60, 0.86, 0.16, 40, 0.015).moved((0, 0, s * length / 2)) for s in (-1, 1)]
    return {
        "beta_cloth": displaced(quilt, puff),
        "white_paint": shell,
        "aluminium": merge(*straps, *ends),
    }


def cargo_module() -> Parts:
    """A logistics module: gold-foiled cylinder with a service skirt and an engine."""
    profile = [
        *[(0.0, 2.0), (0.78, 2.0), (0.78, 1.85), (1.55, 1.45), (1.66, 1.35), (1.7, 1.2)],
        *[(1.7, -1.3), (1.62, -1.45), (1.3, -1.9), (0.0, -1.9)],
    ]
    z = np.linspace(1.1, -1.2, 18)
    blanket = lathe(
        [
            (1.66, 1.12),
            *[(1.73, v) for v in z],
            (1.66, -1.22),
            (1.60, -1.22),
            (1.60, 1.12),
            (1.66, 1.12),
        ],
        60,
    )

    def crinkles(p: F64) -> F64:
        # None at the hard edges: their vertices have two normals and would part.
        open_face = (np.hypot(p[:, 0], p[:, 1]) > 1.7) & (p[:, 2] < 1.09) & (p[:, 2] > -1.19)
        return open_face * crumple(p, 31, 0.2, 0.05)

    foil = displaced(blanket, crinkles)
    bands = [ring(1.66, 1.78, 0.06, 48).moved((0, 0, v)) for v in (-1.25, -0.05, 1.13)]
    ends = ring(0.60, 0.86, 0.16, 40, 0.015).moved((0, 0, -1.95))
    main = (
        nozzle(0.09, 0.42, 0.75, 0.015, 32, 9)
        .moved(rotation=np.diag([1.0, -1.0, -1.0]))
        .moved((0, 0, 2.1))
    )
    pods = around(nozzle(0.02, 0.08, 0.16, 0.005, 14, 5), 4, 1.45, 1.5, 45.0)
    return {
        "white_paint": lathe(profile, 64),
        "mli_gold": foil,
        "aluminium": merge(*bands, ends),
        "nozzle": merge(main, pods),
    }


def cargo_mast() -> Parts:
    boom = tube([(0, 1.6, 0), (0, 2 * (BLANKET[1] + 0.12) + 2.9, 0)], 0.06, 16)
    root = cylinder(0.16, 0.5, 28, 0.02).moved((0, 1.9, 0), z_to([0, 1, 0]))
    return {"aluminium": merge(boom, root)}


def airlock() -> Parts:
    body = lathe(
        [
            *[(0.0, 1.8), (0.72, 1.8), (0.72, 1.5), (1.2, 1.15), (1.27, 1.0), (1.27, -1.2)],
            *[(1.2, -1.45), (0.95, -1.7), (0.0, -1.7)],
        ],
        56,
    )
    plates = [
        around(curved_plate(1.29, 360 / 10 - 3.0, 0.95, 0.03, 2), 10, 0.0, z, 18.0 * k)
        for k, z in enumerate((-0.55, 0.45))
    ]
    boxes = around(bevel_box((0.22, 0.4, 0.5), 0.02), 3, 1.4, -0.1, 60.0)
    return {"mli_silver": body, "white_paint": merge(*plates), "grey_paint": boxes}


def hatch() -> Parts:
    door = lathe([(0.0, 0.12), (0.35, 0.10), (0.46, 0.06), (0.48, 0.0), (0.0, 0.0)], 48)
    frame = ring(0.46, 0.6, 0.14, 48, 0.015)
    wheel = torus(0.16, 0.015, 32, 8).moved((0, 0, 0.17))
    bars = [
        bevel_box((0.32, 0.02, 0.02), 0.004).moved((0, 0, 0.17), rotation([0, 0, 1], a))
        for a in (0, 60, 120)
    ]
    return {"white_paint": door, "aluminium": merge(frame, *bars), "handrail": wheel}


def refuelling() -> Parts:
    body = lathe(
        [
            *[(0.0, 1.7), (0.9, 1.7), (0.98, 1.6), (1.2, 0.9), (1.22, 0.8), (1.22, -1.0)],
            *[(1.15, -1.2), (0.72, -1.5), (0.72, -1.7), (0.0, -1.7)],
        ],
        56,
    )
    plates = around(curved_plate(1.24, 360 / 12 - 3.0, 0.9, 0.03, 3), 12, 0.0, -0.45)
    decks = [ring(1.2, 1.95, 0.05, 56, 0.01).moved((0, 0, z)) for z in (0.02, 0.88)]
    return {"white_paint": merge(body, plates), "aluminium": merge(*decks)}


def tank() -> Parts:
    return {"mli_gold": sphere(0.36, 28, 14), "titanium": torus(0.362, 0.018, 28, 6)}


def cupola() -> Parts:
    """Six windows around and one on top, in an octagonal pyramid."""
    n, low, high, h = 6, 0.86, 0.5, 0.5
    body = lathe([(0.0, h), (high, h), (low, 0.0), (0.0, 0.0)], n)
    slope = np.hypot(low - high, h)
    # Faces lie between the corners, at the apothem.
    mid = (low + high) / 2 * np.cos(np.pi / n)
    tilt = rotation([0, 1, 0], -np.degrees(np.arctan2((low - high) * np.cos(np.pi / n), h)))
    pane = bevel_box((0.05, 0.42, slope * 0.62), 0.012).moved(rotation=tilt)
    frame = bevel_box((0.03, 0.52, slope * 0.78), 0.008).moved(rotation=tilt)
    top = cylinder(0.33, 0.05, 40, 0.012).moved((0, 0, h))
    rim = ring(0.32, 0.42, 0.07, 40, 0.012).moved((0, 0, h))
    return {
        "white_paint": faceted(body, 1.0),
        "aluminium": merge(around(frame, n, mid, h / 2, 180 / n), rim),
        "glass": merge(around(pane, n, mid, h / 2, 180 / n), top),
    }


def docking_port() -> Parts:
    """An androgynous port at the origin that opens towards +z: tunnel, petals, latches."""
    tunnel = lathe(
        [(0.60, 0.36), (0.68, 0.36), (0.72, 0.30), (0.72, -0.15), (0.60, -0.15), (0.60, 0.36)], 48
    )
    floor = cylinder(0.61, 0.04, 48).moved((0, 0, 0.0))
    guide = ring(0.50, 0.58, 0.06, 48, 0.01).moved((0, 0, 0.40))
    petal = prism([(-0.10, -0.16), (0.02, -0.16), (0.05, 0.0), (0.02, 0.16), (-0.10, 0.16)], 0.03)
    lean = rotation([0, 1, 0], -55.0)
    petals = around(petal.moved((0.0, 0, 0), lean), 3, 0.52, 0.48)
    latches = around(bevel_box((0.06, 0.08, 0.10), 0.01), 8, 0.745, 0.26)
    legs = [
        tube(
            [
                (0.5 * np.cos(a), 0.5 * np.sin(a), 0.38),
                (0.54 * np.cos(a + s), 0.54 * np.sin(a + s), 0.03),
            ],
            0.014,
            8,
        )
        for a in np.radians([30, 150, 270])
        for s in (-0.5, 0.5)
    ]
    return {
        "white_paint": tunnel,
        "black_paint": floor,
        "titanium": merge(guide, petals, latches, *legs),
    }


def handrail() -> Parts:
    """A rail along z on two feet, standing out along +x."""
    path = [
        (0, 0, -0.45),
        (0.06, 0, -0.42),
        (0.09, 0, -0.36),
        (0.09, 0, 0.36),
        (0.06, 0, 0.42),
        (0, 0, 0.45),
    ]
    feet = [bevel_box((0.03, 0.09, 0.07), 0.006).moved((0, 0, s * 0.45)) for s in (-1, 1)]
    return {"handrail": tube(path, 0.013, 8), "aluminium": merge(*feet)}


def array_blanket() -> Parts:
    """One bay in the y-z plane, cells towards +x, a thin frame and tension lines."""
    columns, rows = 24, 26
    sheet = bevel_box((0.012, columns * CELL_M, rows * CELL_M), 0.002)
    front = np.arange(len(sheet.triangles)) // 2 == 1  # the +x face, see bevel_box
    cells = sheet.kept(front)
    tiles = np.array([columns, rows]) / materials.CELLS_A_TILE
    cells = Mesh(cells.positions, cells.normals, cells.uvs * tiles, cells.triangles)
    edges = [
        tube(
            [(0, -BLANKET[1] / 2, s * BLANKET[2] / 2), (0, BLANKET[1] / 2, s * BLANKET[2] / 2)],
            0.035,
            10,
        )
        for s in (-1, 1)
    ]
    bars = [
        bevel_box((0.05, 0.06, BLANKET[2] + 0.04), 0.01).moved((0, s * BLANKET[1] / 2, 0))
        for s in (-1, 1)
    ]
    battens = [
        bevel_box((0.014, 0.02, rows * CELL_M), 0.003).moved((-0.012, y, 0))
        for y in np.linspace(-1.2, 1.2, 7)
    ]
    return {
        "solar_cell": cells,
        "panel_back": merge(sheet.kept(~front), *battens),
        "carbon_fibre": merge(*edges),
        "aluminium": merge(*bars),
    }


def array_mast() -> Parts:
    """The boom from the bus to the blankets and the canister crossbar; runs along +y."""
    boom = tube([(0, 1.6, 0), (0, 3.5, 0)], 0.11, 20)
    gimbal = cylinder(0.24, 0.55, 36, 0.03).moved((0, 1.95, 0), z_to([0, 1, 0]))
    canister = cylinder(0.16, 7.4, 28, 0.02).moved((0, 3.5, 0))
    braces = [tube([(0, 2.3, 0), (0, 3.45, s * 2.6)], 0.05, 12) for s in (-1, 1)]
    return {"aluminium": merge(boom, gimbal, *braces), "white_paint": canister}


def radiator_panel() -> Parts:
    """A panel in the x-z plane with flow tubes; both faces radiate along y."""
    face = bevel_box((1.5, 0.03, 2.6), 0.006)
    tubes = [
        bevel_box((1.44, 0.012, 0.02), 0.003).moved((0, s * 0.018, z))
        for s in (-1, 1)
        for z in np.linspace(-1.1, 1.1, 7)
    ]
    headers = [tube([(-0.76, 0, s * 1.28), (0.86, 0, s * 1.28)], 0.03, 12) for s in (-1, 1)]
    return {"radiator": face, "white_paint": merge(*tubes), "aluminium": merge(*headers)}


def radiator_bracket() -> Parts:
    """What holds the first panel, 0.25 m off the module, along +x."""
    arms = [tube([(-0.15, 0, s * 0.4), (0.26, 0, s * 1.2)], 0.035, 12) for s in (-1, 1)]
    return {"aluminium": merge(*arms)}


def box_unit() -> Parts:
    """An orbital replacement unit: a box on feet, with a grapple fixture, facing +x."""
    box = bevel_box((0.34, 0.6, 0.7), 0.03)
    feet = [
        bevel_box((0.16, 0.07, 0.07), 0.01).moved((-0.22, y, z))
        for y in (-0.22, 0.22)
        for z in (-0.26, 0.26)
    ]
    plate = cylinder(0.14, 0.02, 32, 0.004).moved((0.18, 0, 0.1), z_to([1, 0, 0]))
    pin = cone(0.02, 0.012, 0.16, 16, 0.003).moved((0.26, 0, 0.1), z_to([1, 0, 0]))
    rails = [
        tube([(0.16, y, -0.3), (0.24, y, -0.26), (0.24, y, 0.2), (0.16, y, 0.24)], 0.012, 8)
        for y in (-0.24, 0.24)
    ]
    return {
        "mli_gold": box,
        "aluminium": merge(*feet, plate, pin),
        "handrail": merge(*rails),
    }


def octagon_bus() -> Parts:
    """The power and propulsion element along z: bus, foil bands, thruster deck at -z."""
    angle = np.radians(22.5 + 45 * np.arange(8))
    outline = 1.75 * np.column_stack([np.cos(angle), np.sin(angle)])
    body = prism(outline, 3.6, 0.03)
    apothem = 1.75 * np.cos(np.radians(22.5))
    panels = around(bevel_box((0.04, 1.1, 1.5), 0.012), 8, apothem + 0.015, 0.85)
    lower = around(bevel_box((0.05, 1.1, 1.4), 0.012), 8, apothem + 0.015, -0.95)
    deck = prism(outline * 0.92, 0.12, 0.02).moved((0, 0, -1.86))
    neck = lathe([(0.0, 2.6), (0.74, 2.6), (0.74, 2.3), (1.2, 1.8), (0.0, 1.8)], 56)
    end = ring(0.60, 0.86, 0.16, 40, 0.015).moved((0, 0, 2.6))
    return {
        "mli_black": body,
        "radiator": panels,
        "mli_gold": lower,
        "aluminium": merge(deck, end),
        "mli_silver": neck,
    }


def ion_thruster() -> Parts:
    """A Hall thruster that fires along -z, on a gimbal plate."""
    can = lathe(
        [
            (0.0, 0.18),
            (0.34, 0.18),
            (0.36, 0.14),
            (0.36, -0.16),
            (0.30, -0.18),
            (0.28, -0.02),
            (0.16, -0.02),
            (0.15, -0.16),
            (0.0, -0.16),
        ],
        48,
    )
    cathode = tube([(0.42, 0, 0.1), (0.42, 0, -0.14), (0.37, 0, -0.2)], 0.03, 12)
    return {"titanium": can, "nozzle": cathode}


def thruster_pod() -> Parts:
    """Four reaction-control thrusters on a block that stands out along +x."""
    block = bevel_box((0.22, 0.34, 0.34), 0.03)
    jets = []
    for direction in ((0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)):
        d = np.array(direction, dtype=float)
        jets.append(nozzle(0.02, 0.07, 0.14, 0.005, 14, 5).moved(0.18 * d, z_to(-d)))
    return {"white_paint": block, "nozzle": merge(*jets)}


def dish_antenna() -> Parts:
    """A high-gain dish on a mast along +z, leaning to +x."""
    lean = rotation([0, 1, 0], 35.0)
    up = np.array([0.0, 0.0, 1.5])
    bowl = dish(1.0, 0.28, 0.02, 48, 9)
    feet = [(0.75 * np.cos(a), 0.75 * np.sin(a), 0.28 * 0.75**2) for a in np.radians([0, 120, 240])]
    legs = [tube([f, (0.06 * f[0], 0.06 * f[1], 0.86)], 0.016, 8) for f in feet]
    feed = cone(0.05, 0.10, 0.16, 28, 0.01).moved((0, 0, 0.86))
    radii = np.array([0.1, 0.4, 0.7, 0.96])
    ribs = []
    for angle in np.radians(30 + 60 * np.arange(6)):
        # Along the back of the bowl, half sunk into it.
        x, y, z = radii * np.cos(angle), radii * np.sin(angle), 0.28 * radii**2 - 0.025
        ribs.append(tube(np.column_stack([x, y, z]), 0.015, 8))
    mast = tube([(0, 0, -0.5), (0, 0, 1.4)], 0.06, 16)
    joint = sphere(0.14, 20, 10).moved((0, 0, 1.4))
    return {
        "white_paint": merge(bowl, feed).moved(up, lean),
        "aluminium": merge(mast, *(m.moved(up, lean) for m in (*legs, *ribs))),
        "grey_paint": joint,
    }


def arm(joints: F64) -> Parts:
    """Booms between joints; each joint is a short drum across the arm."""
    booms, drums, bands = [], [], []
    for a, b in pairwise(joints):
        toward = (b - a) / np.linalg.norm(b - a)
        booms.append(tube([a + 0.12 * toward, b - 0.12 * toward], 0.11, 24))
        for t in (0.2, 0.8):
            middle = a + t * (b - a)
            bands.append(ring(0.105, 0.135, 0.08, 24).moved(middle, z_to(toward)))
    for point in joints:
        drums.append(cylinder(0.17, 0.42, 24, 0.03).moved(point, z_to([1, 0, 0])))
        drums.append(sphere(0.19, 20, 10).moved(point))
    base = cone(0.35, 0.25, 0.3, 36, 0.02).moved(joints[0] - [0, 0.1, 0], z_to([0, 1, 0]))
    return {
        "white_paint": merge(*booms),
        "grey_paint": merge(*drums, base),
        "handrail": merge(*bands),
    }


def arm_effector() -> Parts:
    """A latching end effector that opens towards +z."""
    can = lathe(
        [
            (0.13, 0.62),
            (0.16, 0.62),
            (0.18, 0.58),
            (0.18, 0.0),
            (0.12, -0.05),
            (0.0, -0.05),
            (0.0, 0.30),
            (0.13, 0.30),
            (0.13, 0.62),
        ],
        40,
    )
    camera = bevel_box((0.10, 0.14, 0.18), 0.015).moved((0.22, 0, 0.3))
    lens = cylinder(0.03, 0.04, 20, 0.004).moved((0.22, 0, 0.4))
    return {"white_paint": can, "grey_paint": camera, "glass": lens}


def truss(bays: int) -> Parts:
    """A square lattice along z from the origin: longerons, battens and diagonals."""
    half, bay = 0.32, 0.8
    corner = half * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    bars = [tube([(x, y, 0), (x, y, bays * bay)], 0.035, 12) for x, y in corner]
    thin, nodes = [], []
    for k in range(bays + 1):
        z = k * bay
        for i in range(4):
            a, b = corner[i], corner[(i + 1) % 4]
            thin.append(tube([(*a, z), (*b, z)], 0.02, 8))
            nodes.append(sphere(0.05, 8, 6).moved((*a, z)))
            if k < bays:
                low, high = (a, b) if (k + i) % 2 else (b, a)
                thin.append(tube([(*low, z), (*high, z + bay)], 0.016, 8))
    legs = [
        tube([(half, y, z), (half + 0.45, 1.6 * y, z)], 0.03, 10)
        for y in (-half, half)
        for z in (0.8, 0.8 * (bays - 1))
    ]
    return {"aluminium": merge(*bars, *thin, *legs), "titanium": merge(*nodes)}


def whip() -> Parts:
    mast = tube([(0, 0, 0), (0, 0, 1.6)], 0.02, 10)
    cone_top = cone(0.12, 0.03, 0.35, 24, 0.005).moved((0, 0, 1.65))
    foot = cone(0.09, 0.05, 0.14, 24, 0.01).moved((0, 0, 0.03))
    return {"aluminium": merge(mast, foot), "white_paint": cone_top}
