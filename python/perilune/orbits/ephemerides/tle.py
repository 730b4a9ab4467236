"""Two-line element sets: strict reading, and SGP4 (the package sgp4) in ICRF axes.

Sources: Hoots and Roehrich, Spacetrack report #3 (1980); Vallado, Crawford, Hujsak and Kelso,
Revisiting Spacetrack Report #3 (2006). SGP4 is good to about 1 km at the sets' epoch, and loses 1
to 3 km a day.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.config.errors import nearest
from perilune.orbits.dates import tt_of, tt_of_utc
from perilune.orbits.ephemerides.frames import teme_to_icrf
from perilune.orbits.solar_system import Date

F64 = NDArray[np.float64]

_LENGTH = 69
_REAL = r"[ +-]?\s*\d*\.\d+"
_EXPONENT = r"[ +-][ \d]{5}[+-]\d"  # decimal point assumed before the digits
_NUMBER = r"[ \dA-HJ-NP-Z][ \d]{4}"  # Alpha-5: a letter for 10 ... 33 ten thousands
# Columns from 1 as in the format's description; blanks stand for leading zeros.
_COLUMNS: tuple[dict[str, tuple[int, int, str]], dict[str, tuple[int, int, str]]] = (
    {
        "line number": (1, 1, "1"),
        "catalogue number": (3, 7, _NUMBER),
        "classification": (8, 8, "[UCST ]"),
        "international designator": (10, 17, ".{8}"),
        "epoch": (19, 32, r"\d\d[ \d]{3}\.\d{8}"),
        "first derivative of the mean motion": (34, 43, _REAL + r"\s*"),
        "second derivative of the mean motion": (45, 52, _EXPONENT),
        "drag term": (54, 61, _EXPONENT),
        "ephemeris type": (63, 63, r"[ \d]"),
        "set number": (65, 68, r"[ \d]{4}"),
    },
    {
        "line number": (1, 1, "2"),
        "catalogue number": (3, 7, _NUMBER),
        "inclination": (9, 16, r"[ \d]{3}\.\d{4}"),
        "right ascension of the node": (18, 25, r"[ \d]{3}\.\d{4}"),
        "eccentricity": (27, 33, r"[ \d]{7}"),
        "argument of perigee": (35, 42, r"[ \d]{3}\.\d{4}"),
        "mean anomaly": (44, 51, r"[ \d]{3}\.\d{4}"),
        "mean motion": (53, 63, r"[ \d]{2}\.\d{8}"),
        "revolution number": (64, 68, r"[ \d]{5}"),
    },
)
_BLANKS = ((2, 9, 18, 33, 44, 53, 62, 64), (2, 8, 17, 26, 34, 43, 52))
_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"  # Alpha-5 leaves out I and O

_ERRORS = {
    1: "its mean eccentricity left the range from -0.001 to 1",
    2: "its mean motion fell to zero or below",
    3: "its perturbed eccentricity left the range from 0 to 1",
    4: "its semi-latus rectum became negative",
    5: "the elements of its epoch lie below the surface",
    6: "it has decayed (its radius fell below that of the Earth)",
}


@dataclass(frozen=True)
class ElementSet:
    """A set: its lines without trailing blanks, and the name line before them."""

    name: str
    number: int
    lines: tuple[str, str]


def checksum(line: str) -> int:
    """Sum of the digits of the first 68 columns, where a minus counts 1, modulo 10."""
    digits = (int(c) if c.isdigit() else c == "-" for c in line[: _LENGTH - 1])
    return sum(digits) % 10


def catalogue_number(text: str) -> int:
    """Number in five columns, including Alpha-5: E8493 is 148493."""
    first = text[0]
    if first in _LETTERS:
        return (10 + _LETTERS.index(first)) * 10000 + int(text[1:].replace(" ", "0"))
    return int(text.strip() or 0)


def _check(line: str, which: int, where: str) -> None:
    if len(line) != _LENGTH:
        raise ValueError(f"{where}: has {len(line)} columns; a line of a set has {_LENGTH}")
    if not line.isascii():
        raise ValueError(f"{where}: has characters that are not ASCII")
    for name, (first, last, pattern) in _COLUMNS[which].items():
        text = line[first - 1 : last]
        if not re.fullmatch(pattern, text):
            columns = f"column {first}" if first == last else f"columns {first} to {last}"
            raise ValueError(f"{where}, {columns}: '{text}' is no {name}")
    for column in _BLANKS[which]:
        if line[column - 1] != " ":
            raise ValueError(f"{where}, column {column}: must be blank, not '{line[column - 1]}'")
    if line[-1] != str(checksum(line)):
        raise ValueError(f"{where}, column 69: checksum '{line[-1]}' should be {checksum(line)}")


def parse(first: str, second: str, where: str, name: str = "") -> ElementSet:
    """Checks two lines: columns, numbers, checksums. `where` names them in errors."""
    lines = (first.rstrip(), second.rstrip())
    for which, line in enumerate(lines):
        _check(line, which, f"{where}, line {which + 1} of the set")
    numbers = [catalogue_number(line[2:7]) for line in lines]
    if numbers[0] != numbers[1]:
        raise ValueError(f"{where}: lines of two satellites, {numbers[0]} and {numbers[1]}")
    return ElementSet(name, numbers[0], lines)


def sets(path: Path) -> Iterator[tuple[int, str, str, str]]:
    """Line number (from 1), name, and the two lines of each set of a file."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    name, k = "", 0
    while k < len(lines):
        line = lines[k].rstrip()
        if re.match(r"1 [ \w]{5}", line):
            if k + 1 >= len(lines) or not lines[k + 1].startswith("2 "):
                raise ValueError(f"{path}, line {k + 2}: must be line 2 of the set before")
            yield k + 1, name, line, lines[k + 1]
            name, k = "", k + 2
        else:
            if line and not line.startswith("#"):
                name = line.removeprefix("0 ").strip()
            k += 1


def read(path: Path, name: str | None, number: int | None) -> ElementSet:
    """The set of a file, by its name line or catalogue number, or its only one."""
    names, found = [], None
    for at, title, first, second in sets(path):
        wanted = name is None or title.casefold() == name.casefold()
        if number is not None:
            digits = first[2:7].replace(" ", "0")
            wanted = digits.isalnum() and catalogue_number(digits) == number
        if wanted and found is None:
            found = parse(first, second, f"{path}, line {at}", title)
        names.append(title)
    if found is None:
        if number is not None:
            text = f"no set of catalogue number {number} among {len(names)}"
        else:
            text = f"no set named '{name}'{nearest(name, names)}" if names else "no set in it"
        raise ValueError(f"{path}: {text}")
    if name is None and number is None and len(names) > 1:
        raise ValueError(f"{path}: has {len(names)} sets: say which by name or number")
    return found


class Sgp4:
    """States of a set; a path in Python, because SGP4 is not in the core."""

    def __init__(self, elements: ElementSet) -> None:
        try:
            from sgp4.api import WGS72, Satrec  # constants that sets are fitted with
        except ImportError:
            raise ValueError("kind tle needs the package sgp4: pip install perilune[tle]") from None
        self.elements = elements
        self._record: Any = Satrec.twoline2rv(*elements.lines, WGS72)

    def teme(self, minutes: float) -> F64:
        """(6,) m and m/s in TEME, minutes after the epoch of the set; ValueError that names the
        set."""
        code, r, v = self._record.sgp4_tsince(minutes)
        if code:
            raise ValueError(
                f"satellite {self.elements.number}: SGP4 error {code}, {_ERRORS.get(code, '')}, "
                f"{minutes:.6g} minutes after the epoch of its elements"
            )
        return np.array([*r, *v]) * 1e3

    def minutes(self, epoch: Date, t_s: F64) -> F64:
        """Minutes after the epoch of the set, which counts days of UTC; leap seconds are
        included."""
        at = tt_of_utc(self._record.jdsatepoch, self._record.jdsatepochF)
        tt = tt_of(epoch, t_s)
        return np.asarray(((tt[0] - at[0]) + (tt[1] - at[1])) * 1440.0)

    def states(self, epoch: Date, t_s: F64) -> F64:
        """(n, 6) m and m/s from the Earth's centre, ICRF axes, t_s seconds after an epoch."""
        teme = np.stack([self.teme(minutes) for minutes in self.minutes(epoch, t_s).tolist()])
        turn = teme_to_icrf(epoch, t_s)
        # The frame turns by 50 arcsec a year: a velocity of 1e-4 m/s that is left out, as usual.
        places = np.einsum("nij,nj->ni", turn, teme[:, :3])
        return np.concatenate([places, np.einsum("nij,nj->ni", turn, teme[:, 3:])], axis=1)
