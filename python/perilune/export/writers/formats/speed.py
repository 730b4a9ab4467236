"""SPEED and SPEED+: the pose of one object a picture, as the challenges' JSON has it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from perilune.base import rotations
from perilune.config.errors import ConfigError
from perilune.export.writers.formats.base import (
    Array,
    Encoded,
    Files,
    Format,
    Frame,
    Info,
    Record,
)
from perilune.export.writers.formats.channels import COLOR, Channel
from perilune.export.writers.formats.pixels import from_png, png
from perilune.simulation import Simulation

TARGET = "target"


def _pose(info: Info, record: Record) -> dict[str, Any]:
    """An entry of the list of poses."""
    (row,) = [row for row in record["objects"] if row["name"] == info[TARGET]]
    q = rotations.from_matrix(np.array(row["R_m2c"], dtype=np.float64).reshape(3, 3))
    return {
        "filename": f"{record['index']:06d}.png",
        "q_vbs2tango_true": q.tolist(),
        "r_Vo2To_vbs_true": row["t_m2c"],
    }


class Speed(Format):
    """Poses for the tools of the Satellite Pose Estimation Challenges."""

    name = "speed"
    doc = "SPEED+: the pose of one spacecraft as quaternion and position"
    layout = (
        "`images/NNNNNN.png`, `SPLIT.json` (`filename`, `q_vbs2tango_true`: scalar first, p_camera "
        "= R(q) p_spacecraft + r; `r_Vo2To_vbs_true`: metres, of the spacecraft's origin in camera "
        "axes), `camera.json`"
    )
    reader = "the tools of SPEED+ (speedplusbaseline and others)"
    needs = ("picture", "objects")

    def holds(self, channel: Channel) -> bool:
        """Pictures."""
        return channel.name in COLOR

    def describe(self, sim: Simulation) -> dict[str, Any]:
        """The object: the target of the camera's trajectory, or the only one."""
        names = list(sim.config.objects)
        target = getattr(sim.config.camera.trajectory, TARGET, None)
        if target not in names:
            if len(names) != 1:
                raise ConfigError(
                    f"{sim.document.source}: spacecraft: SPEED has the pose of one object, here "
                    f"are {len(names)}; camera.trajectory.target must name which"
                )
            target = names[0]
        for name, camera in sim.config.cameras.items():
            if camera.label_lens == "distorted":
                where = "camera" if name is None else f"sensors.{name}"
                way = (
                    "remove it"
                    if camera.is_panorama
                    else "say lens.labels: undistorted, or remove it"
                )
                raise ConfigError(
                    f"{sim.document.source}: {where}.lens: camera.json has OpenCV's distortion of "
                    f"radial and tangential terms alone; {way}"
                )
        return {TARGET: target}

    def begin(self, sim: Simulation, info: Info) -> Files:
        """camera.json, with the keys of SPEED+, of the first camera."""
        from perilune.export.writers.bop_source import camera_entry

        camera = camera_entry(sim)
        f, c = (camera["fx"], camera["fy"]), (camera["cx"], camera["cy"])
        told = {
            "Nu": camera["width"],
            "Nv": camera["height"],
            "ppx": None,
            "ppy": None,
            "fx": None,
            "fy": None,
            "ccx": c[0],
            "ccy": c[1],
            "cameraMatrix": [[f[0], 0.0, c[0]], [0.0, f[1], c[1]], [0.0, 0.0, 1.0]],
            "distCoeffs": [0.0] * 5,
        }
        return {"camera.json": (json.dumps(told) + "\n").encode("utf-8")}

    def encode(self, info: Info, frame: Frame) -> Encoded:
        """The picture, and the pose for `finish`."""
        picture = png(frame.arrays[info["picture"]])
        return Encoded({f"images/{frame.key}.png": picture}, _pose(info, frame.record))

    def finish(
        self, info: Info, records: Callable[[], Iterator[Record]]
    ) -> Iterator[tuple[str, Iterable[bytes]]]:
        """The list of poses."""

        def text() -> Iterator[bytes]:
            comma = "[\n"
            for record in records():
                yield f"{comma}{json.dumps(record['labels'])}".encode()
                comma = ",\n"
            yield b"\n]\n"

        yield f"{info['split']}.json", text()

    def decode(self, info: Info, record: Record, read: Callable[[str], bytes]) -> dict[str, Array]:
        """The picture."""
        return {info["picture"]: from_png(read(f"images/{record['index']:06d}.png"))}

    def faults(
        self, info: Info, record: Record, arrays: Mapping[str, Array], read: Callable[[str], bytes]
    ) -> Iterator[str]:
        """A pose that is not that of the object."""
        if record["labels"] != _pose(info, record):
            yield f"object '{info[TARGET]}': its pose is not that of its record"
