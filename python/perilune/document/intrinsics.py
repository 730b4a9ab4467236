"""Warns about a matrix K, or a focal length in pixels, that fits another image size."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

_SIZE = ("width", "height")
_PIXELS = ("K", "focal_px")
"""Intrinsics in pixels; fov_deg holds for any size."""


@dataclass(frozen=True)
class _Optics:
    """Intrinsics and size of a camera in the tree."""

    where: str
    """Key path of the section with the intrinsics."""
    size: tuple[Any, Any]
    key: str | None
    """Key of the intrinsics; None if they do not depend on the size."""
    value: Any
    inherited: bool
    """Whether a sensor combines its own size with the intrinsics of the platform."""
    platform: tuple[Any, Any]


def _section(tree: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    value = tree.get(key)
    return value if isinstance(value, Mapping) else {}


def _optics(tree: Mapping[str, Any]) -> dict[str, _Optics]:
    """Section of a camera that takes frames -> its intrinsics and size."""
    base = _section(tree, "camera")
    sensors = _section(tree, "sensors")
    rows: dict[str, Mapping[str, Any]] = {
        f"sensors.{name}": row for name, row in sensors.items() if isinstance(row, Mapping)
    } or {"camera": {}}
    found = {}
    for name, own in rows.items():
        alone = any(own.get(key) is not None for key in (*_PIXELS, "fov_deg"))
        owner, where = (own, name) if alone else (base, "camera")
        key = next((key for key in _PIXELS if owner.get(key) is not None), None)
        size = tuple(own.get(key) or base.get(key) for key in _SIZE)
        platform = tuple(base.get(key) for key in _SIZE)
        value = None if key is None else owner[key]
        found[name] = _Optics(
            where, (size[0], size[1]), key, value, not alone and name != "camera",
            (platform[0], platform[1]),
        )  # fmt: skip
    return found


def _text(size: tuple[Any, Any]) -> str:
    return f"{size[0]}x{size[1]}"


def _outside(row: _Optics) -> tuple[float, float] | None:
    """The principal point of K, if it is outside the image."""
    if row.key != "K" or not isinstance(row.value, (list, tuple)) or len(row.value) != 9:
        return None
    point = row.value[2], row.value[5]
    plain = all(type(number) in (int, float) for number in (*point, *row.size))
    if not plain or all(-0.5 <= x < n - 0.5 for x, n in zip(point, row.size, strict=True)):
        return None
    return point


def _complaint(row: _Optics, before: _Optics | None) -> str | None:
    if row.key is None:
        return None
    if before is not None and before.size != row.size and before.value == row.value:
        return f"is that of {_text(before.size)}, and the image now {_text(row.size)}"
    if row.key == "K" and row.inherited and row.size != row.platform:
        return f"is that of {_text(row.platform)}, and the image of this sensor {_text(row.size)}"
    point = _outside(row)
    if point is not None:
        place = f"({point[0]:g}, {point[1]:g})"
        return f"has its principal point at {place}, outside an image of {_text(row.size)}"
    return None


def doubts(tree: Mapping[str, Any], before: Mapping[str, Any], source: str) -> Iterator[str]:
    """A line for each camera whose intrinsics fit another image size.

    before: the tree without overrides."""
    earlier = _optics(before)
    for name, row in _optics(tree).items():
        complaint = _complaint(row, earlier.get(name))
        if complaint is None:
            continue
        place = f"{row.where}.{row.key}" + ("" if name == row.where else f" of {name}")
        hint = f"change {row.key} too, or give fov_deg, which holds for any size"
        yield f"{source}: {place} {complaint}; {hint}"
