"""Builds tango_like.glb: a target with the shape and key points of PRISMA's Tango.

The key points are those of the SPEED+ baseline, so that pose networks trained on images of this
model predict the same eleven points. The rest of the model is our own: plausible, not a replica.
Axes and origin are SPEED+'s: metres, z through the lid, origin on the bottom face.
"""

from __future__ import annotations

import materials
import numpy as np
from glb import Document, Node
from noise import crumple, gradient_noise
from shapes import (
    Mesh,
    bevel_box,
    cylinder,
    displaced,
    faceted,
    lathe,
    merge,
    ring,
    rounded_box,
    tube,
    z_to,
)

# tangoPoints.mat of the SPEED+ baseline (Park, Martens, Lecuyer, Izzo, D'Amico: "SPEED+: Next-
# Generation Dataset for Spacecraft Pose Estimation across Domain Gap", IEEE Aerospace 2022;
# code at tpark94/speedplusbaseline, MIT), in its order, metres.
KEY_POINTS = {
    "lid_1": (-0.37, -0.385, 0.3215),
    "lid_2": (-0.37, 0.385, 0.3215),
    "lid_3": (0.37, 0.385, 0.3215),
    "lid_4": (0.37, -0.385, 0.3215),
    "bottom_1": (-0.37, -0.264, 0.0),
    "bottom_2": (-0.37, 0.304, 0.0),
    "bottom_3": (0.37, 0.304, 0.0),
    "bottom_4": (0.37, -0.264, 0.0),
    "antenna_1": (-0.5427, 0.4877, 0.2535),
    "antenna_2": (0.5427, 0.4877, 0.2591),
    "antenna_3": (0.305, -0.579, 0.2515),
}

BEVEL = 0.0005  # the corners stay within 0.8 mm of the key points
LID = 0.022  # thickness, m
TOP = 0.3215
BODY_TOP = TOP - LID
Y_LOW, Y_HIGH = -0.264, 0.304  # of the body
MIDDLE = np.array([0.0, (Y_LOW + Y_HIGH) / 2, BODY_TOP / 2])
SIZE = np.array([0.74, Y_HIGH - Y_LOW, BODY_TOP])

Parts = dict[str, Mesh]


def build() -> Document:
    meshes: dict[str, Parts] = {
        "body": body(),
        "body_foil": {"mli_silver": foil()},
        "solar_lid": lid(),
        "side_cells": side_cells(),
        "gps_antennas": gps_antennas(),
        "separation_ring": {"aluminium": separation_ring()},
        "sensors": sensors(),
        **{name: antenna(name) for name in KEY_POINTS if name.startswith("antenna")},
    }
    root = Node("tango_like", children=[Node(name, name) for name in meshes])
    used = list(dict.fromkeys(m for parts in meshes.values() for m in parts))
    return Document(
        "tango_like",
        materials.pick(*used),
        meshes,
        root,
        images={materials.SOLAR_CELL_IMAGE: materials.solar_cell_png()},
        extras={
            "description": "A Tango-like target made by assets/scripts/tango_like.py",
            "key_points": {
                "frame": "metres, z up: the file's (x, y, z) is (x, -z, y) here",
                "source": "SPEED+ baseline, tangoPoints.mat (tpark94/speedplusbaseline, MIT)",
                "names": list(KEY_POINTS),
                "points_m": [list(point) for point in KEY_POINTS.values()],
            },
        },
    )


def body() -> Parts:
    """The bottom and top plates and the corner posts; their corners are the key points."""
    plate = 0.012
    bottom = bevel_box((*SIZE[:2], plate), BEVEL).moved((0, MIDDLE[1], plate / 2))
    top = bevel_box((*SIZE[:2], plate), BEVEL).moved((0, MIDDLE[1], BODY_TOP - plate / 2))
    posts = [
        bevel_box((0.024, 0.024, BODY_TOP - 2 * plate + 0.001), 0.002).moved((x, y, MIDDLE[2]))
        for x in (-0.357, 0.357)
        for y in (Y_LOW + 0.013, Y_HIGH - 0.013)
    ]
    return {"aluminium": merge(bottom, top, *posts)}


def foil() -> Mesh:
    """Silvered blankets between the plates, a little inside the posts."""
    size = SIZE - [0.030, 0.030, 0.022]
    box = rounded_box(size, 0.012, (14, 11, 6), arc=1)
    noise = np.stack([gradient_noise(box.positions / 0.023, s) for s in (3, 4, 5)], axis=1)
    slide = 0.012 * (noise - box.normals * (noise * box.normals).sum(axis=1, keepdims=True))
    box = Mesh(box.positions + slide, box.normals, box.uvs, box.triangles)
    return faceted(displaced(box, lambda p: crumple(p, 5, 0.08, 0.013)), 0.75).moved(MIDDLE)


def cell_sheet(columns: int, rows: int, pitch: float) -> tuple[Mesh, Mesh]:
    """Cells facing +z, and the thin sheet's other faces; closed together."""
    sheet = bevel_box((columns * pitch, rows * pitch, 0.002), 0.0004)
    front = np.arange(len(sheet.triangles)) // 2 == 5  # the +z face, see bevel_box
    cells = sheet.kept(front)
    tiles = np.array([columns, rows]) / materials.CELLS_A_TILE
    return Mesh(cells.positions, cells.normals, cells.uvs * tiles, cells.triangles), sheet.kept(
        ~front
    )


def lid() -> Parts:
    """The solar panel on top: wider than the body in y, cells nearly to its edges."""
    board = bevel_box((0.74, 0.77, LID), BEVEL).moved((0, 0, TOP - LID / 2))
    # The cells lie in a shallow frame of the board, so that its corners stay the highest points.
    cells, sheet = cell_sheet(17, 18, 0.041)
    rise = (0, 0, TOP - 0.0006)
    struts = [
        tube([(x, Y_LOW + 0.03, 0.20), (x, -0.355, BODY_TOP - 0.002)], 0.006, 8)
        for x in (-0.28, 0.0, 0.28)
    ]
    return {
        "solar_cell": cells.moved(rise),
        "carbon_fibre": merge(board, sheet.moved(rise)),
        "aluminium": merge(*struts),
    }


def side_cells() -> Parts:
    """A strip of cells on the +y face, which the lid shades least."""
    cells, sheet = cell_sheet(15, 5, 0.041)
    turn = z_to([0, 1, 0])
    place = (0, Y_HIGH + 0.003, 0.145)
    backing = bevel_box((0.64, 0.012, 0.225), 0.001).moved((0, Y_HIGH - 0.004, 0.145))
    return {
        "solar_cell": cells.moved(place, turn),
        "carbon_fibre": merge(sheet.moved(place, turn), backing),
    }


def antenna(name: str) -> Parts:
    """A rod from the body to the key point, which is the centre of its end."""
    tip = np.array(KEY_POINTS[name])
    foot = np.array([np.clip(tip[0], -0.355, 0.355), np.clip(tip[1], Y_LOW, Y_HIGH), tip[2]])
    toward = (tip - foot) / np.linalg.norm(tip - foot)
    rod = tube([foot, tip], 0.005, 12)
    socket = cylinder(0.014, 0.05, 20, 0.002).moved(foot + 0.018 * toward, z_to(toward))
    return {"aluminium": rod, "white_paint": socket}


def gps_antennas() -> Parts:
    """Two patch antennas at the low sides of the body, facing -y."""
    pads = [
        bevel_box((0.07, 0.014, 0.07), 0.002).moved((x, Y_LOW - 0.004, 0.10)) for x in (-0.18, 0.1)
    ]
    domes = [
        lathe([(0, 0.014), (0.015, 0.012), (0.026, 0.0), (0, 0)], 24, crease_deg=50).moved(
            (x, Y_LOW - 0.011, 0.10), z_to([0, -1, 0])
        )
        for x in (-0.18, 0.1)
    ]
    return {"grey_paint": merge(*pads), "white_paint": merge(*domes)}


def separation_ring() -> Mesh:
    """Under the body, where the launcher held it."""
    return ring(0.14, 0.165, 0.02, 48, 0.003).moved((0, 0.02, -0.0095))


def sensors() -> Parts:
    """Sun sensors on the sides and a corner-cube reflector on +x."""
    boxes = [
        bevel_box((0.04, 0.04, 0.03), 0.003).moved((sx * 0.372, y, 0.22), z_to([sx, 0, 0]))
        for sx, y in ((1.0, -0.15), (-1.0, 0.2))
    ]
    eyes = [
        cylinder(0.008, 0.004, 16).moved((sx * 0.388, y, 0.22), z_to([sx, 0, 0]))
        for sx, y in ((1.0, -0.15), (-1.0, 0.2))
    ]
    cube = cylinder(0.028, 0.03, 24, 0.003).moved((0.37, 0.1, 0.12), z_to([1, 0, 0]))
    return {"aluminium": merge(*boxes, cube), "glass": merge(*eyes)}
