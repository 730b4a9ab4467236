"""The channel that formats for training show."""

from __future__ import annotations

from perilune.simulation import Simulation


def main_picture(sim: Simulation) -> str:
    """`rgb`, or `sensor_rgb` if that alone is asked for."""
    asked = sim.config.render.channels
    return "sensor_rgb" if "sensor_rgb" in asked and "rgb" not in asked else "rgb"
