"""`perilune orbit`: states at each step as a CSV table or a CCSDS OEM, and sunlight."""

from __future__ import annotations

import csv
import os
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frames, open_simulation
from perilune.config import Config, ConfigError
from perilune.config.errors import nearest
from perilune.config.motion import sections
from perilune.orbits.ephemerides import oem
from perilune.orbits.sunlight import LightCurve
from perilune.simulation import Simulation

F64 = NDArray[np.float64]

COLUMNS = (
    *("frame", "time_utc", "object"),
    *("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s"),
    *("qw", "qx", "qy", "qz"),
)
SUNLIGHT_COLUMNS = (
    *("sun_fraction_r", "sun_fraction_g", "sun_fraction_b"),
    *("sun_r_w_m2", "sun_g_w_m2", "sun_b_w_m2", "sun_hidden_by"),
)
_DIGITS = 9  # of seconds: below the rounding of a low orbit's place in doubles, times ten
_CSV_SUFFIXES = (".csv",)
_OEM_SUFFIXES = (".oem",)


@dataclass(frozen=True)
class State:
    """State of one object as a frame's shutter opens; root frame (ICRF axes), metres."""

    time_utc: str
    name: str
    pose: F64
    """(7,): x, y, z, qw, qx, qy, qz."""
    velocity_m_s: F64
    """(3,)."""


def states(sim: Simulation, index: int) -> Iterator[State]:
    """States of everything but the camera in a frame's step."""
    system = sim.system(index)
    config, epoch = system.setting.config, system.setting.epoch
    t_s = config.time.step_s * config.timeline.at(index).step
    found = system.states(np.array([t_s]))
    time = epoch.after(t_s).utc(_DIGITS)
    for name, poses in found.poses.items():
        yield State(time, name, poses[0], found.velocities_m_s[name][0])


def _chosen(sim: Simulation, names: Sequence[str] | None) -> list[str]:
    known = list(sections(sim.config))
    for name in names or ():
        if name not in known:
            raise ConfigError(f"--object {name}: no such entry{nearest(name, known)}")
    return list(names or known)


def _write_csv(
    file: TextIO, sim: Simulation, frames: Sequence[int], names: list[str], sunlight: bool
) -> int:
    table = csv.writer(file, lineterminator="\n")
    table.writerow([*COLUMNS, *(SUNLIGHT_COLUMNS if sunlight else ())])
    indices = list(_one_a_step(sim, frames))
    curves = {n: sim.light_curve(n, indices, at=0.0) for n in names} if sunlight else {}
    count = 0
    for row, index in enumerate(indices):
        for state in states(sim, index):
            if state.name in names:
                pose, velocity = state.pose, state.velocity_m_s
                numbers = np.concatenate([pose[:3], velocity, pose[3:]]).tolist()
                light = _light_cells(curves[state.name], row) if sunlight else []
                table.writerow([index, state.time_utc, state.name, *map(repr, numbers), *light])
                count += 1
    return count


def _light_cells(curve: LightCurve, row: int) -> list[str]:
    """Cells of SUNLIGHT_COLUMNS."""
    numbers = np.concatenate([curve.fraction[row], curve.irradiance_w_m2[row]]).tolist()
    hidden = [b for b, hides in zip(curve.bodies, curve.hides[row], strict=True) if hides]
    return [*map(repr, numbers), " ".join(hidden)]


def _one_a_step(sim: Simulation, frames: Sequence[int]) -> Iterator[int]:
    """The first frame of each step, because all sensors of a step see the same world."""
    last = None
    for index in frames:
        step = sim.config.timeline.at(index).step
        if step != last:
            yield index
        last = step


def _runs(sim: Simulation, frames: Sequence[int]) -> Iterator[list[int]]:
    """Runs without a jump: orbits that are drawn anew begin a new segment."""
    config, last = sim.config, None
    run: list[int] = []
    for index in _one_a_step(sim, frames):
        moment = config.timeline.at(index)
        if run and _draws(sim, config) and last is not None and moment.scene != last.scene:
            yield run
            run = []
        run.append(index)
        last = moment
    if run:
        yield run


def _draws(sim: Simulation, config: Config) -> bool:
    """Whether positions may differ between a scene and the one before."""
    kinds = {entry.orbit.kind for _, entry in sections(config).values() if entry.orbit is not None}
    return bool(sim.document.drivers) or bool(kinds & {"database", "hook"}) or sim.has_orbit_hooks


def _write_oem(file: TextIO, sim: Simulation, frames: Sequence[int], names: list[str]) -> int:
    """Writes each object relative to its central body, or to the root."""
    config = sim.config
    if config.time.step_s <= 0.0 and len(list(_one_a_step(sim, frames))) > 1:
        raise ConfigError("an OEM needs increasing times: time.step_s must be positive")
    oem.write_header(file, datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S"), "PERILUNE")
    count = 0
    for run in _runs(sim, frames):
        rows = [{state.name: state for state in states(sim, index)} for index in run]
        for name in names:
            if name == config.root:
                continue
            orbit = sections(config)[name][1].orbit
            around = config.root if orbit is None else orbit.around
            centre = config.bodies[around].kind if around in config.bodies else around
            meta = {
                "OBJECT_NAME": name,
                "OBJECT_ID": name,
                "CENTER_NAME": (around if centre == "ellipsoid" else centre).upper(),
                "REF_FRAME": "ICRF",
            }
            relative = [
                np.concatenate(
                    [
                        row[name].pose[:3] - row[around].pose[:3],
                        row[name].velocity_m_s - row[around].velocity_m_s,
                    ]
                )
                for row in rows
            ]
            times = [row[name].time_utc.removesuffix("Z") for row in rows]
            oem.write_segment(file, meta, times, np.array(relative))
            count += len(rows)
    return count


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frames(parser)
    parser.add_argument(
        "--out",
        required=True,
        metavar="FILE",
        help="file to write: a CCSDS OEM if its name ends in .oem, else a CSV table",
    )
    parser.add_argument(
        "--object",
        action="append",
        metavar="NAME",
        help="body or spacecraft to write (default: all); may be repeated",
    )
    parser.add_argument(
        "--sunlight",
        action="store_true",
        help="adds columns for the sunlight at the centre: the fraction that bodies let through, "
        "the irradiance on a surface facing the Sun, by band, and the eclipsing bodies; CSV only",
    )


def _run(args: Namespace) -> int:
    sim, out = open_simulation(args), Path(args.out)
    names = _chosen(sim, args.object)
    as_oem = out.suffix.lower() in _OEM_SUFFIXES
    if not as_oem and out.suffix.lower() not in _CSV_SUFFIXES:
        allowed = ", ".join((*_CSV_SUFFIXES, *_OEM_SUFFIXES))
        raise ValueError(f"--out {out}: the name says the format; it must end in {allowed}")
    if as_oem and args.sunlight:
        raise ConfigError("--sunlight: an OEM has no place for it; write a .csv")
    temporary = out.with_name(f"{out.name}.{os.getpid()}.tmp")
    try:
        with open(temporary, "w", encoding="utf-8", newline="") as file:
            if as_oem:
                count = _write_oem(file, sim, args.frames, names)
            else:
                count = _write_csv(file, sim, args.frames, names, args.sunlight)
        os.replace(temporary, out)
    except OSError as error:
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(out)) from error
    finally:
        temporary.unlink(missing_ok=True)
    print(f"{out}: {count} states of {len(args.frames)} frames")
    return OK


ORBIT = Command(
    "orbit", "writes positions, velocities and attitudes as a CSV table or OEM", _configure, _run
)
