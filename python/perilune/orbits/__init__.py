"""From the configuration's orbits, rotations and attitudes to states in the root frame."""

from __future__ import annotations

from perilune.orbits.motion import States
from perilune.orbits.setting import (
    Parent,
    Setting,
    ephemeris_name,
    gm_m3_s2,
    parent_of,
    radii_m,
    table_name,
)
from perilune.orbits.sun import sun_position_m
from perilune.orbits.system import System

__all__ = [
    "Parent",
    "Setting",
    "States",
    "System",
    "ephemeris_name",
    "gm_m3_s2",
    "parent_of",
    "radii_m",
    "sun_position_m",
    "table_name",
]
