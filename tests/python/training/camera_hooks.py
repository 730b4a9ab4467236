"""Hooks that tests name as module:function."""

from __future__ import annotations

import perilune

CALLS: list[int] = []


def still(world):
    """One pose, twelve metres beside the satellite."""
    return perilune.look_at(world, "sat", [12.0, 0.0, 3.0])[0]


def riding(world, rng, distance_m=12.0):
    """On the satellite's own axes."""
    return perilune.look_at(world, "sat", [distance_m, 0.0, 0.0], frame="target", up=[0, 0, 1])


def counted(step, ideal):
    """What a driver asks for."""
    CALLS.append(step)
    return ideal + step


def grey(rng):
    """A material of another structure and colour each time."""
    level = float(rng.uniform(0.1, 0.9))
    skin = {"type": "principled", "base_color": [level] * 3}
    if level > 0.5:
        nodes = {"at": {"type": "coordinates"}, "noise": {"type": "noise", "vector": "at"}}
        return {"nodes": {**nodes, "skin": {**skin, "roughness": "noise.value"}}}
    return {"nodes": {"skin": skin}}


def broken(rng):
    """A key that nodes do not have."""
    return {"nodes": {"skin": {"type": "principled", "base_colour": 0.5}}}
