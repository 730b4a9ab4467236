"""The ladder of propagators: how far each is from the finest after a revolution, a day and a month,
and what a state costs against the sgp4 package's array propagation in the same run.

The orbit is a low one (500 km, 51.6 deg). The finest is `numerical` at rtol 1e-14 with everything:
gravity, Sun and Moon, drag, sunlight with its shadow. All start from its state at the epoch;
sgp4's seven mean elements are fitted to its first three days, as the catalogue's are to tracking;
its cost here is with the way from TEME to ICRF. The error is the largest over the last revolution
before the time. The cost is processor time over a day of states every 10 s: `first` integrates
them, `again` reads what is kept.

Gravity is EGM96 to degree and order 21 with PERILUNE_DATA, the zonal harmonics to J6 without.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import report
from numpy.typing import NDArray
from scipy.optimize import least_squares
from sgp4.api import WGS72, Satrec

from perilune import _core
from perilune.base import rotations
from perilune.config.orbit import Forces
from perilune.orbits import forces
from perilune.orbits.dates import utc_of
from perilune.orbits.ephemerides.frames import teme_to_icrf
from perilune.orbits.gravity import ZONALS
from perilune.orbits.solar_system import date_from_utc

F64 = NDArray[np.float64]
Track = Callable[[F64], F64]

EPOCH = date_from_utc((2026, 3, 1, 0, 0, 0.0))
EARTH = _core.BODIES["earth"]
GM = float(EARTH["gm_m3_s2"])
RADIUS = float(EARTH["radii_m"][0])
DAY_S = 86400.0
FIELD = "orbits/gravity/EGM96-truncated-21x21"
TOLERANCES = (1e-6, 1e-8, 1e-10, 1e-12)
FINEST = 1e-14
LABEL_AT = {"j2": (6, -3), "numerical, J2 alone": (-50, -14), "numerical, J2 to J6": (-50, 7)}
"""Offsets in points of labels that would cover each other."""


def start_state() -> F64:
    """500 km, e = 0.001, 51.6 deg; ICRF."""
    axis = RADIUS + 500e3
    elements = {
        "periapsis_m": axis * 0.999, "eccentricity": 0.001, "inclination_rad": math.radians(51.6),
        "raan_rad": 1.0, "arg_periapsis_rad": 0.5, "since_periapsis_s": 600.0,
    }  # fmt: skip
    spec = {"kind": "kepler", "gm": GM, "elements": elements, "frame": "icrf", "parent_body": None}
    return propagate(spec)(np.zeros(1))[0]


def propagate(spec: dict[str, Any]) -> Track:
    """A propagator of its own: nothing is kept from another."""
    return _core.Propagator(spec, EPOCH.day, EPOCH.fraction).states


def all_forces() -> dict[str, Any]:
    """Of the finest, and which gravity it has."""
    data = Path(os.environ.get("PERILUNE_DATA", ""))
    file = data / FIELD if data.parts and (data / FIELD).is_file() else None
    harmonics = {"degree": 6} if file is None else {"degree": 21, "file": str(file)}
    section = Forces.model_validate(
        {
            "harmonics": harmonics,
            "third_bodies": ["sun", "moon"],
            "drag": {"area_to_mass_m2_kg": 0.01},
            "radiation_pressure": {"area_to_mass_m2_kg": 0.01},
        }
    )
    radii = np.array(EARTH["radii_m"])
    centre = forces.Centre("earth", "earth", GM, radii, forces.turning_of("earth", EPOCH))
    return forces.specification(section, centre, EPOCH, lambda text, key: Path(text))


def numerical(state: F64, rtol: float, **acting: Any) -> Track:
    return propagate({"kind": "numerical", "gm": GM, "state": state, "rtol": rtol, **acting})


def zonal(count: int) -> dict[str, Any]:
    """J2 alone, or more."""
    known = ZONALS["earth"]
    turning = forces.turning_of("earth", EPOCH)
    row = {"kind": "zonal", **turning, "radius_m": known.radius_m, "j": known.j[:count]}
    return {"forces": [row]}


def circular(state: F64) -> Track:
    """A circle through the start in the orbit's plane, at its mean motion."""
    r, v = state[:3], state[3:]
    radius = float(np.linalg.norm(r))
    axis = 1.0 / (2.0 / radius - v @ v / GM)
    x, z = r / radius, np.cross(r, v) / np.linalg.norm(np.cross(r, v))
    matrix = np.column_stack([x, np.cross(z, x), z])
    rate = math.sqrt(GM / axis**3) / (2.0 * math.pi)
    spec = {
        "kind": "circular", "radii_m": [radius] * 3, "q": rotations.from_matrix(matrix),
        "start_rev": 0.0, "rate_rev_s": rate,
    }  # fmt: skip
    return propagate(spec)


def days_of(t_s: F64) -> tuple[F64, F64]:
    """JD(UTC) in two parts."""
    day, fraction = utc_of(EPOCH, t_s)
    return np.asarray(day), np.asarray(fraction)


def satellite(x: F64, epoch_days: float) -> Satrec:
    """Of mean motion (rad/min), e cos w, e sin w, i, node, w + M, and B*."""
    sat = Satrec()
    ecc, perigee = math.hypot(x[1], x[2]), math.atan2(x[2], x[1])
    sat.sgp4init(
        WGS72, "i", 1, epoch_days, x[6], 0.0, 0.0, ecc, perigee % (2 * math.pi), x[3],
        (x[5] - perigee) % (2 * math.pi), x[0], x[4] % (2 * math.pi),
    )  # fmt: skip
    return sat


def teme_states(sat: Satrec, jd: tuple[F64, F64], turn: F64) -> F64:
    """(n, 6), m and m/s, ICRF axes."""
    errors, r, v = sat.sgp4_array(*jd)
    if errors.any():
        raise RuntimeError(f"sgp4: error {errors.max()}")
    return np.hstack([np.einsum("nij,nj->ni", turn, part) for part in (r, v)]) * 1e3


def fitted_sgp4(truth: F64, t_s: F64) -> Satrec:
    """Mean elements whose orbit is nearest to the truth at the times."""
    jd, turn = days_of(t_s), teme_to_icrf(EPOCH, t_s)
    first = days_of(np.zeros(1))
    epoch_days = float(first[0][0] - 2433281.5 + first[1][0])
    r, v = (np.linalg.solve(turn[0], part) for part in (truth[0, :3], truth[0, 3:]))
    h = np.cross(r, v)
    axis = 1.0 / (2.0 / np.linalg.norm(r) - v @ v / GM)
    node = math.atan2(h[0], -h[1])
    latitude = math.atan2(r @ np.cross(h / np.linalg.norm(h), _node(node)), r @ _node(node))
    guess = np.array(
        [math.sqrt(GM / axis**3) * 60.0, 0.0, 0.0, math.acos(h[2] / np.linalg.norm(h)), node,
         latitude, 1e-5]
    )  # fmt: skip
    scale = np.array([1e-5, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-4])

    def off(u: F64) -> F64:
        states = teme_states(satellite(guess + u * scale, epoch_days), jd, turn)
        return (states - truth)[:, :3].ravel() / 1e3

    found = least_squares(off, np.zeros(7), diff_step=1e-5, x_scale=1.0, max_nfev=200)
    return satellite(guess + found.x * scale, epoch_days)


def _node(angle: float) -> F64:
    return np.array([math.cos(angle), math.sin(angle), 0.0])


@dataclass
class Rung:
    """One propagator of the ladder."""

    name: str
    make: Callable[[], Track]
    keeps: bool = False
    """Whether it integrates first and then reads."""


def ladder(state: F64, acting: dict[str, Any], sat: Satrec) -> list[Rung]:
    """From the coarsest to the finest."""

    def by_sgp4() -> Track:
        return lambda t_s: teme_states(sat, days_of(t_s), teme_to_icrf(EPOCH, t_s))

    common = {"gm": GM, "state": state, "frame": "icrf"}
    mean = {"j2": ZONALS["earth"].j[0], "radius_m": ZONALS["earth"].radius_m, "osculating": True}
    rungs = [
        Rung("circular", lambda: circular(state)),
        Rung("kepler", lambda: propagate({"kind": "kepler", "parent_body": None, **common})),
        Rung("j2", lambda: propagate({"kind": "j2", "parent_body": "earth", **mean, **common})),
        Rung("sgp4, fitted to 3 days", by_sgp4),
        Rung("numerical, J2 alone", lambda: numerical(state, 1e-10, **zonal(1)), True),
        Rung("numerical, J2 to J6", lambda: numerical(state, 1e-10, **zonal(5)), True),
    ]
    for rtol in TOLERANCES:
        rungs.append(
            Rung(f"numerical {rtol:.0e}", lambda rtol=rtol: numerical(state, rtol, **acting), True)
        )
    return rungs


def afresh(rung: Rung, t_s: F64) -> F64:
    """With nothing kept."""
    return rung.make()(t_s)


def plot(path: Path, curves: dict[str, tuple[F64, F64]], rows: list[dict[str, Any]]) -> None:
    """Errors against time, and error after a day against cost."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.0, 4.6), layout="constrained")
    colors = pyplot.get_cmap("tab10")(np.arange(len(curves)))
    for color, (name, (days, error)) in zip(colors, curves.items(), strict=True):
        style = "-" if name.startswith("numerical 1e") else "--"
        left.loglog(days, np.maximum(error, 1e-6), style, label=name, color=color)
    left.set_xlabel("time since the epoch, days")
    left.set_ylabel("position error, m")
    left.set_title("Error of a low orbit against the finest")
    left.grid(alpha=0.3)
    left.legend(fontsize=7.5, loc="upper left", ncols=2)
    left.set_ylim(top=1e12)
    for color, row in zip(colors, rows, strict=True):
        right.loglog(row["first_ratio"], row["error_day_m"], "o", color=color)
        right.annotate(
            row["name"], (row["first_ratio"], row["error_day_m"]), fontsize=7.5,
            xytext=LABEL_AT.get(row["name"], (5, 4)), textcoords="offset points",
        )  # fmt: skip
    right.set_xlabel("processor time of a state, sgp4's array propagation = 1")
    right.set_ylabel("position error after a day, m")
    right.set_title("What accuracy costs")
    right.set_xlim(right=right.get_xlim()[1] * 30.0)
    right.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def errors_over(path: Track, truth: Track, ends: F64, period: float) -> F64:
    """Largest distance over the revolution before each of `ends`."""
    t = (ends[:, None] - np.linspace(0.0, period, 61)[None, :]).ravel()
    apart = np.linalg.norm((path(t) - truth(t))[:, :3], axis=1)
    return np.asarray(apart.reshape(len(ends), -1).max(axis=1))


def main() -> None:
    parser = report.arguments(__doc__)
    parser.add_argument("--plot", type=Path, help="draws the ladder there (PNG)")
    options = parser.parse_args()
    state, acting = start_state(), all_forces()
    truth = numerical(state, FINEST, **acting)
    tracked = np.arange(0.0, 3.0 * DAY_S, 900.0)
    sat = fitted_sgp4(truth(tracked), tracked)
    period = 2.0 * math.pi * math.sqrt((RADIUS + 500e3) ** 3 / GM)
    marks = {"orbit": period, "day": DAY_S, "month": 30.0 * DAY_S}
    t_s = np.arange(0.0, DAY_S, 10.0)
    jd = days_of(t_s)
    unit_s = report.processor_s(lambda: sat.sgp4_array(*jd)) / len(t_s)
    track = np.geomspace(period, 30.0 * DAY_S, 40)
    rows: list[dict[str, Any]] = []
    curves: dict[str, tuple[F64, F64]] = {}
    for rung in ladder(state, acting, sat):
        path = rung.make()
        row: dict[str, Any] = {"name": rung.name}
        for mark, end in marks.items():
            row[f"error_{mark}_m"] = float(errors_over(path, truth, np.array([end]), period)[0])
        path(t_s)
        row["again_ratio"] = report.processor_s(partial(path, t_s)) / len(t_s) / unit_s
        first = partial(afresh, rung, t_s) if rung.keeps else partial(path, t_s)
        row["first_ratio"] = report.processor_s(first) / len(t_s) / unit_s
        rows.append(row)
        curves[rung.name] = (track / DAY_S, errors_over(path, truth, track, period))
    if options.plot is not None:
        plot(options.plot, curves, rows)
    kind = acting["forces"][0]["kind"]
    gravity = "EGM96 21x21" if kind == "harmonics" else "J2-J6"
    keys = ["name", "error_orbit_m", "error_day_m", "error_month_m", "first_ratio", "again_ratio"]
    head = ["propagator", "m, 1 rev", "m, 1 day", "m, 30 days", "first/sgp4", "again/sgp4"]
    report.publish(
        options.json,
        {"gravity": gravity, "sgp4_state_s": unit_s, "rows": rows},
        [
            f"gravity of the finest: {gravity}; sgp4: {unit_s * 1e6:.3f} us a state",
            report.table(head, [[row[key] for key in keys] for row in rows]),
        ],
    )


if __name__ == "__main__":
    main()
