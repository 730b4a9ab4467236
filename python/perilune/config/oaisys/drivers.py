"""`material_drivers`: checked, and told of, as materials are not graphs here yet."""

from __future__ import annotations

from perilune.config.oaisys.node import Node

_NUMBERS = ("clip_min", "clip_max", "ideal", "jitter_variance")
_WHY = "not applied: materials have no driven values yet"


def read(owner: Node) -> None:
    """The section below a mesh or a material, if there is one."""
    if not owner.has("material_drivers"):
        return
    section = owner.child("material_drivers")
    section.number("jitter_strength", 1.0)
    section.whole("step_interval", 1, smallest=1)
    named = section.child("drivers")
    for name in named.raw:
        driver = named.child(name)
        low, high, ideal, variance = (driver.number(key) for key in _NUMBERS)
        if not low <= ideal <= high:
            driver.fail("ideal", f"{ideal:g} is outside [clip_min, clip_max] = [{low:g}, {high:g}]")
        if variance < 0.0:
            driver.fail("jitter_variance", f"must not be negative: {variance:g}")
        owner.notes.warn(driver.path, _WHY)
