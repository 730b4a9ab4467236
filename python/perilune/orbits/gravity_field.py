"""Gravity fields from files of spherical-harmonic coefficients.

It reads two formats: ICGEM's (Barthelmes and Foerste, The ICGEM-format, GFZ 2011; static fields),
with or without its `begin_of_head`, and plain tables as published for EGM96 and EGM2008. Lines of
the latter are n, m, C, S and optionally their errors. They do not state gm and radius, so those of
the EGM models are assumed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_EGM_GM, _EGM_RADIUS = 3986004.415e8, 6378136.3
"""EGM96's and EGM2008's constants (NIMA TR8350.2, and Pavlis et al. 2012)."""
_TIMED = ("gfct", "trnd", "dot", "asin", "acos")
MAX_DEGREE = 360
"""The core's limit."""


@dataclass(frozen=True)
class GravityField:
    """Fully normalised coefficients of a static field."""

    name: str
    body: str | None
    """Name of the body in lower case, if the file states it."""
    gm_m3_s2: float
    radius_m: float
    degree: int
    order: int
    c: F64
    """Coefficient of (n, m) at index n (n + 1)/2 + m, from n = 0 to the degree."""
    s: F64


@dataclass
class _Head:
    gm: float = _EGM_GM
    radius: float = _EGM_RADIUS
    name: str = ""
    body: str | None = None


def _number(text: str, where: str) -> float:
    try:
        value = float(text.replace("D", "e").replace("d", "e"))
    except ValueError:
        raise ValueError(f"{where}: not a number: '{text}'") from None
    if not np.isfinite(value):
        raise ValueError(f"{where}: '{text}' is not finite")
    return value


def _read_head(lines: Iterator[tuple[str, str]], head: _Head) -> None:
    """Reads the header up to end_of_head."""
    found = set()
    for where, line in lines:
        words = line.split()
        if not words:
            continue
        key, value = words[0], words[1] if len(words) > 1 else ""
        if key == "end_of_head":
            break
        if key in ("gravity_constant", "earth_gravity_constant"):
            head.gm = _number(value, where)
            found.add("gravity_constant")
        elif key == "radius":
            head.radius = _number(value, where)
            found.add("radius")
        elif key == "modelname":
            head.name = value
        elif key == "body":
            head.body = value.lower()
        elif key == "norm" and value != "fully_normalized":
            raise ValueError(f"{where}: norm is {value}; only fully_normalized is read")
    missing = {"gravity_constant", "radius"} - found
    if missing:
        raise ValueError(f"the head has no {' and no '.join(sorted(missing))}")
    if not (head.gm > 0.0 and head.radius > 0.0):
        raise ValueError("gravity_constant and radius must be positive")


def _coefficients(
    lines: Iterator[tuple[str, str]], keyed: bool
) -> Iterator[tuple[str, int, int, float, float]]:
    for where, line in lines:
        words = line.split()
        if not words or (keyed and words[0] not in ("gfc", *_TIMED)):
            continue
        if keyed and words[0] in _TIMED:
            raise ValueError(f"{where}: '{words[0]}': fields that change with time are not read")
        numbers = words[1:] if keyed else words
        if len(numbers) < 4 or not (numbers[0].isdecimal() and numbers[1].isdecimal()):
            raise ValueError(f"{where}: must be n, m, C, S and maybe errors, not '{line.strip()}'")
        n, m = int(numbers[0]), int(numbers[1])
        if m > n:
            raise ValueError(f"{where}: the order {m} is above the degree {n}")
        yield where, n, m, _number(numbers[2], where), _number(numbers[3], where)


def _highest(known: set[tuple[int, int]], degree: int, order: int) -> int:
    """Largest degree, from 2 on, up to which all coefficients to the order exist."""
    n = 2
    while n <= degree and all((n, m) in known for m in range(min(n, order) + 1)):
        n += 1
    return n - 1


def read(path: Path, degree: int, order: int | None = None) -> GravityField:
    """The field of a file up to a degree (2 to 360) and an order (default: the degree).

    Degrees 0 and 1 may be missing; they are then 1, and 0 for an origin at the centre of mass.
    ValueError that names file, line and what was expected; OSError if the file cannot be read."""
    order = degree if order is None else order
    if not 2 <= degree <= MAX_DEGREE or not 0 <= order <= degree:
        raise ValueError(
            f"degree {degree}, order {order}: the degree must be from 2 to {MAX_DEGREE}, the order "
            "from 0 to the degree"
        )
    try:
        return _parse(path.read_text(encoding="utf-8", errors="replace"), path.name, degree, order)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _parse(text: str, name: str, degree: int, order: int) -> GravityField:
    head = _Head(name=name)
    content = text.splitlines()
    lines = ((f"line {k}", line) for k, line in enumerate(content, 1))
    words = [line.split(maxsplit=1)[0] if line.strip() else "" for line in content]
    keyed = "end_of_head" in words
    if keyed:
        if "begin_of_head" in words:  # the text above it is free
            for _, line in lines:
                if line.startswith("begin_of_head"):
                    break
        _read_head(lines, head)
    size = (degree + 1) * (degree + 2) // 2
    c, s = np.zeros(size), np.zeros(size)
    c[0] = 1.0
    known: set[tuple[int, int]] = set()
    for where, n, m, cosine, sine in _coefficients(lines, keyed):
        if (n, m) in known:
            raise ValueError(f"{where}: degree {n}, order {m} stands there twice")
        known.add((n, m))
        if n <= degree and m <= order:
            k = n * (n + 1) // 2 + m
            c[k], s[k] = cosine, sine
    highest = _highest(known, degree, order)
    if highest < degree:
        reached = f"to degree {highest}" if highest >= 2 else "for no degree"
        raise ValueError(f"up to order {order} the file is complete {reached}, not to {degree}")
    return GravityField(head.name, head.body, head.gm, head.radius, degree, order, c, s)
