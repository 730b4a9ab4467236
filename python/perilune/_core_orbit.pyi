"""Orbits and turns of the C core: `perilune._core` has their names."""

from collections.abc import Mapping, Sequence
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

FORCES: tuple[dict[str, Any], ...]
"""Every force of the numerical propagator: {"name", "doc", "parameters": tuple of {"key", "type":
"numbers" | "body" | "motion", "count": how many numbers or 0 for any, "optional", "doc"}}."""

TURNS: tuple[dict[str, str], ...]
"""The frames that a node's rotation may follow: {"name", "doc"}."""

@final
class Propagator:
    """A path about a parent, from the epoch JD(TDB) = tdb_day + tdb_fraction on; immutable.

    spec, by its kind; metres, seconds, radians:
    {"kind": "kepler", "gm", "elements" or "state", "frame": "icrf" | "equator", "parent_body": name
     in BODIES or None}: elements at the epoch are periapsis_m, eccentricity, inclination_rad,
     raan_rad, arg_periapsis_rad, and one of since_periapsis_s, mean_anomaly_rad, true_anomaly_rad,
     for any conic; state (6,) is position and velocity, radial motion too. "equator": the body's equator of the epoch, x along its ascending node on ICRF's.
    {"kind": "circular", "radii_m": (3,), "q": (4,), "start_rev", "rate_rev_s"}:
     r = q (a cos u, b sin u, 0), u = 2 pi (start_rev + rate_rev_s t).
    {"kind": "j2", "gm", "elements" or "state", "frame", "parent_body", "j2", "radius_m",
     "osculating": bool}: the pole is that of parent_body whatever the frame, ICRF's z without one.
    {"kind": "table", "t_s": (n,), "states": (n, 6) or (n, 3), "degree": int}: Hermite's polynomials
     (degree 3, 5, ...) or Lagrange's, 25 at most; times outside are an error.
    {"kind": "numerical", "gm", "state": (6,) at the epoch, ICRF axes, "rtol": 1e-15 to 1e-3,
     default 1e-12, "surface_m": distance from the centre below which the orbit ends with an error,
     default none, "forces": [{"kind": name in FORCES, its parameters}], "motions": {name: spec}}:
     the point mass of gm always acts; a force's "motion" is the name of one of the motions, which
     are propagators about the same centre (of the Sun, say).
    Errors (ValueError) start with the kind."""
    def __new__(cls, spec: Mapping[str, Any], tdb_day: float, tdb_fraction: float) -> Self: ...
    @property
    def kind(self) -> str:
        """Name of its kind, as in PROPAGATORS."""
    def states(self, t_s: F64, /) -> F64:
        """(n, 6) position m and velocity m/s about the parent, ICRF axes, at seconds t_s (n,) after
        the epoch. Thread-safe; the same bits in whatever order times are asked for."""

@final
class Tree:
    """Bodies and objects that move about each other and turn; immutable.

    Each node: {"name": str, "parent": index or -1, "motion": M, "rotation": R}, in any order.
    M: a Propagator of the same epoch | {"kind": "fixed", "position_m": (3,)} (ICRF axes from the
       parent's centre) | {"kind": "given", "slot": k} (states come with the times).
    R: {"frame": F, "q": (4,), "axis": (3,), "rate_rad_s"}: frame(t) * q * rotation(axis, rate t),
       all but the frame optional. F is a name of TURNS; "body" needs "body": name in BODIES; "sun"
       and "target" need "towards": index of a node, or (3,) ICRF direction, and take "up": (3,)
       ICRF direction instead of the orbit normal; "tumble" needs "inertia": (3,) principal moments
       and "omega_rad_s": (3,) in the principal axes at the epoch, and takes "start": (4,), those
       axes to ICRF at the epoch; "table" needs "t_s": (n,), "quats": (n, 4); "given" needs "slot".
    Errors (ValueError) name the node; a cycle of parents is printed."""
    def __new__(
        cls, nodes: Sequence[Mapping[str, Any]], tdb_day: float, tdb_fraction: float) -> Self: ...
    def states(
        self, t_s: F64, given: F64 | None = None, given_q: F64 | None = None) -> tuple[F64, F64]:
        """Poses (n, nodes, 7) to the root frame (ICRF axes) and velocities (n, nodes, 3), m/s in
        it, at seconds t_s (n,) after the epoch. given (n, slots, 6): states about the parent of
        nodes whose motion is given; given_q (n, slots, 4): axes of those whose rotation is."""
