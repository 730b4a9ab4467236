"""`perilune orbit`: where everything is, frame by frame, as a table."""

from __future__ import annotations

import csv
import os
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frames, open_simulation
from perilune.simulation import Simulation

F64 = NDArray[np.float64]

COLUMNS = (
    *("frame", "time_utc", "object"),
    *("x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s"),
    *("qw", "qx", "qy", "qz"),
)


def states(sim: Simulation, index: int) -> Iterator[tuple[str, str, F64, F64, F64]]:
    """Time, name, position, velocity (root frame) and quaternion to root, of everything.

    At the opening of the shutter; the camera is not among them.
    """
    system = sim.system(index)
    config, epoch = system.setting.config, system.setting.epoch
    t_s = config.time.step_s * config.timeline.at(index).step
    found = system.states(np.array([t_s]))
    time = epoch.after(t_s).utc()
    for name, poses in found.poses.items():
        yield time, name, poses[0, :3], found.velocities_m_s[name][0], poses[0, 3:]


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frames(parser)
    parser.add_argument("--out", required=True, metavar="CSV", help="file to write")


def _run(args: Namespace) -> int:
    sim, out = open_simulation(args), Path(args.out)
    temporary = out.with_name(f"{out.name}.{os.getpid()}.tmp")
    count = 0
    try:
        with open(temporary, "w", encoding="utf-8", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(COLUMNS)
            for index in args.frames:
                for time, name, position, velocity, quaternion in states(sim, index):
                    numbers = np.concatenate([position, velocity, quaternion]).tolist()
                    table.writerow([index, time, name, *map(repr, numbers)])
                    count += 1
        os.replace(temporary, out)
    except OSError as error:
        raise OSError(error.errno, f"cannot be written: {error.strerror}", str(out)) from error
    finally:
        temporary.unlink(missing_ok=True)
    print(f"{out}: {count} states of {len(args.frames)} frames")
    return OK


ORBIT = Command(
    "orbit", "writes positions, velocities and attitudes as a CSV table", _configure, _run
)
