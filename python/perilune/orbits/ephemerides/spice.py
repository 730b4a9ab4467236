"""States from SPICE kernels (the package spiceypy): geometric, J2000 axes, which SPICE identifies
with ICRF.

SPICE has one pool of kernels per process. Ours are reloaded whenever others were used last, so that
two simulations with different kernels do not mix."""

from __future__ import annotations

import os
from pathlib import Path
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from perilune.orbits.solar_system import Date, tdb_s

F64 = NDArray[np.float64]

_J2000_DAY = 2451545.0
_POOL = RLock()
_loaded: list[tuple[Path, ...]] = []
_process = os.getpid()


def _package() -> Any:
    try:
        import spiceypy
    except ImportError:
        text = "SPICE kernels need the package spiceypy: pip install perilune[spice]"
        raise ValueError(text) from None
    return spiceypy


def _load(spice: Any, kernels: tuple[Path, ...]) -> None:
    """Loads the kernels again in a fork, because it shares the file positions of its parent's open
    files."""
    global _process
    if _loaded and _loaded[-1] == kernels and _process == os.getpid():
        return
    _process = os.getpid()
    for path in reversed(_loaded.pop() if _loaded else ()):
        spice.unload(str(path))
    for path in kernels:
        spice.furnsh(str(path))
    _loaded.append(kernels)


def objects(path: Path) -> tuple[int, ...]:
    """SPICE numbers of the objects in a kernel; ValueError that names the file."""
    spice = _package()
    try:
        return tuple(int(number) for number in spice.spkobj(str(path)))
    except spice.utils.exceptions.SpiceyError as error:
        raise ValueError(f"{path}: no SPICE kernel of places (SPK, .bsp): {error.short}") from None


class Spice:
    """Motion of an object relative to another."""

    def __init__(self, kernels: tuple[Path, ...], target: str, observer: str) -> None:
        self.kernels, self.target, self.observer = kernels, target, observer
        _package()

    def states(self, epoch: Date, t_s: F64) -> F64:
        """(n, 6) m and m/s, ICRF axes, t_s seconds after an epoch; ValueError with SPICE's
        message."""
        spice = _package()
        start = (epoch.day - _J2000_DAY) * 86400.0 + epoch.fraction * 86400.0
        with _POOL:
            try:
                _load(spice, self.kernels)
                rows = [
                    spice.spkezr(self.target, start + t, "J2000", "NONE", self.observer)[0]
                    for t in tdb_s(epoch, t_s).tolist()
                ]
            except spice.utils.exceptions.SpiceyError as error:
                _loaded.clear()
                text = f"SPICE: {error.short}: {error.long or error.explain}"
                raise ValueError(f"{text} (kernels: {', '.join(map(str, self.kernels))})") from None
        return np.array(rows) * 1e3
