"""Air of one gas around a ball, for other renderers: what they can take without a model of ours.

Rayleigh's law, one scale height, nothing that absorbs: haze's phase function and ozone are not
exported.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune.bodies import atmospheres

from .scene import Array, Gas

VOXELS = 160
"""Along each axis of the grid that Mitsuba gets."""


def unknown(atmosphere: Any) -> list[str]:
    """What of its settings is not exported."""
    given = atmospheres.settings(atmosphere)
    wrong = [key for key in ("mie_extinction", "ozone_absorption") if any(given[key])]
    return wrong + ["rayleigh_upper_m"] * (given["rayleigh_upper_m"][1] > 0.0)


def gas_of(body: Any, radii: Array, albedo: Array, centre: Array) -> Gas:
    """Of a body at a place in camera axes; ValueError names what is not exported."""
    given = atmospheres.settings(body.atmosphere)
    wrong = []
    if np.ptp(radii) > 0.0:
        wrong.append("a body that is no ball")
    if float(np.linalg.norm(centre)) <= radii[0] + given["top_m"]:
        wrong.append("a camera in it")
    if not given["multiple"] and np.any(albedo):
        wrong.append("multiple_scattering: false over ground that is not black")
    if given["multiple"] and not np.allclose(given["ground_albedo"], albedo):
        wrong.append("a ground_albedo that is not the body's")
    if wrong:
        raise ValueError(f"atmosphere: not exported: {', '.join(wrong)}")
    return Gas(
        centre=tuple(float(v) for v in centre),
        radius_m=float(radii[0]),
        top_m=float(given["top_m"]),
        height_m=float(given["rayleigh_height_m"]),
        scattering_per_m=tuple(float(v) for v in given["rayleigh_scattering"]),
        orders=None if given["multiple"] else 1,
    )


def grid(gas: Gas, voxels: int = VOXELS) -> Array:
    """(voxels, voxels, voxels, 3) scattering per metre in the middles of a box about the air's top.

    Read linearly, convex values come out too large: by the mean of that they are less."""
    half = gas.radius_m + gas.top_m
    step = 2.0 * half / voxels
    middle = (np.arange(voxels) + 0.5) * step - half
    square = (middle**2)[:, None, None] + (middle**2)[:, None] + middle**2
    # Below the ground they go on for two voxels, so that right above it none is too small.
    height = np.maximum(np.sqrt(square) - gas.radius_m, -2.0 * step)
    density = np.exp(-height / gas.height_m) / (1.0 + (step / gas.height_m) ** 2 / 12.0)
    density[height > gas.top_m] = 0.0
    return (density[..., None] * np.array(gas.scattering_per_m)).astype(np.float32)


def described(mitsuba: Any, gas: Gas, index: int) -> dict[str, Any]:
    """What of a Mitsuba scene is this air."""
    half = gas.radius_m + gas.top_m
    transform = mitsuba.ScalarTransform4f
    place = list(gas.centre)
    box = transform().translate(place).scale(2.0 * half).translate([-0.5, -0.5, -0.5])
    medium = {
        "type": "heterogeneous",
        "albedo": {"type": "constvolume", "value": {"type": "rgb", "value": [1.0, 1.0, 1.0]}},
        "sigma_t": {
            "type": "gridvolume",
            "grid": mitsuba.VolumeGrid(grid(gas)),
            "raw": True,
            "to_world": box,
        },
        "phase": {"type": "rayleigh"},
    }
    edge = {
        "type": "sphere",
        "center": place,
        "radius": half,
        "bsdf": {"type": "null"},
        "interior": medium,
    }
    return {f"air{index}": edge}


def integrator(airs: list[Gas]) -> dict[str, Any]:
    """That follows light through them: of as many orders as we count."""
    once = any(gas.orders == 1 for gas in airs)
    return {"type": "volpath", "max_depth": 2 if once else 64, "rr_depth": 16}
