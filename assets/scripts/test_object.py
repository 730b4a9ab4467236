"""Builds test_object.glb: a ball and a panel with round edges, to look at materials on.

The ball is to the left (-x), its centre in the origin's plane; the panel stands to the right,
leaning back a little. Cameras look along +y, z is up. Metres.
"""

from __future__ import annotations

from glb import Document, Material, Node
from shapes import rotation, rounded_box, sphere

BALL_RADIUS = 0.5
PANEL = (1.0, 0.10, 1.0)
PANEL_ROUND = 0.04


def build() -> Document:
    plain = Material("plain", (0.5, 0.5, 0.5), 0.0, 0.5)
    root = Node("test_object")
    root.add(Node("ball", "ball", (-0.58, 0.0, 0.0)))
    root.add(Node("panel", "panel", (0.58, 0.12, 0.0), rotation([1, 0, 0], -12.0)))
    panel = rounded_box(PANEL, PANEL_ROUND, (1, 1, 1), arc=6)
    meshes = {
        "ball": {"plain": sphere(BALL_RADIUS, 96, 48)},
        "panel": {"plain": panel},
    }
    text = "A ball and a panel made by assets/scripts/test_object.py"
    return Document("test_object", [plain], meshes, root, extras={"description": text})
