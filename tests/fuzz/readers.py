"""Fuzzes every reader of files that Python has: mutated files are an error of a stated kind or a
sound result, never another exception, a crash or a hang.

    python tests/fuzz/readers.py [--inputs N] [--seed S] [READER...]

Pictures go to the core's decoders. A finding prints the reader, its seed and the exception, and
leaves the input in build/fuzz/crashes. The same seed makes the same inputs.
"""

from __future__ import annotations

import argparse
import faulthandler
import io
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from perilune.bodies import craters, elevation_files, maps, shape_files
from perilune.document import load
from perilune.document.loader import read_tree
from perilune.orbits import gravity_field, solar_system
from perilune.orbits.ephemerides import csv_table, oem, tle
from perilune.sky import star_files

ROOT = Path(__file__).resolve().parents[2]
ALLOWED = (ValueError, OSError)
"""Kinds of error that readers may raise; they name the file."""
LONGEST_S = 30
EPOCH = solar_system.date_from_utc((2026, 3, 20, 12, 0, 0.0))
WORDS = (b"nan", b"inf", b"-1", b"0", b"1e999", b"1e-320", b"99999999999999999999", b"\x00",
         b"\xff\xfe", b"\n", b",", b"[", b"{", b"'", b"*a", b"&a ", b"<<: ", b"---\n")  # fmt: skip


@dataclass(frozen=True)
class Reader:
    """One reader: seeds that it takes, and what it is called with."""

    suffix: str
    seeds: Callable[[], list[bytes]]
    read: Callable[[Path], Any]


def _sound(values: Any) -> None:
    """A result holds numbers: readers say of those that are not finite that they are wrong."""
    if not np.isfinite(np.asarray(values, dtype=np.float64)).all():
        raise AssertionError("a result that is not finite")


def _tle(path: Path) -> None:
    found = tle.read(path, None, None)
    try:
        tle.Sgp4(found)
    except ModuleNotFoundError:
        return


def _oem(path: Path) -> None:
    for segment in oem.parse(path):
        _sound(oem.states(segment, EPOCH, path)[1])


def _csv(path: Path) -> None:
    _sound(csv_table.states(path, EPOCH)[1])


def _shape(path: Path) -> None:
    vertices, _ = shape_files.read(path)
    _sound(vertices)


def _configuration(path: Path) -> None:
    load(path, {}, None, None)


def _picture(path: Path) -> None:
    maps.picture(path)


def _graph(path: Path) -> None:
    tree = read_tree(ROOT / "tests" / "python" / "scene.yaml")
    load(
        {**tree, "materials": {"fuzzed": {"file": str(path)}}}, {}, ROOT / "tests" / "python", None
    )


def _picture_seeds(kind: str, *modes: str) -> Callable[[], list[bytes]]:
    def seeds() -> list[bytes]:
        draw, made = np.random.default_rng(1), []
        for mode in modes or ("RGB", "L"):
            noise = draw.integers(0, 255, (9, 14, len(mode)), np.uint8).squeeze()
            file = io.BytesIO()
            Image.fromarray(noise).save(file, kind)
            made.append(file.getvalue())
        return made

    return seeds


def _npy() -> list[bytes]:
    file = io.BytesIO()
    np.save(file, np.arange(60, dtype=np.float32).reshape(6, 10))
    return [file.getvalue()]


def _text(*texts: str) -> Callable[[], list[bytes]]:
    return lambda: [text.encode() for text in texts]


def _file(*names: str) -> Callable[[], list[bytes]]:
    return lambda: [(ROOT / name).read_bytes() for name in names]


_ISS = (
    "ISS\n1 25544U 98067A   20045.18587073  .00000950  00000-0  25302-4 0  9990\n"
    "2 25544  51.6443 242.0161 0004885 264.6060 207.3845 15.49165514212791\n"
)
_OEM = (
    "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\nMETA_START\n"
    "OBJECT_NAME = SAT\nOBJECT_ID = 2026-001A\nCENTER_NAME = EARTH\nREF_FRAME = ICRF\n"
    "TIME_SYSTEM = UTC\nSTART_TIME = 2026-03-20T12:00:00\nSTOP_TIME = 2026-03-20T12:02:00\n"
    "META_STOP\n2026-03-20T12:00:00 7000 0 0 0 7.5 0\n2026-03-20T12:01:00 6990 449 0 -.5 7.4 0\n"
    "2026-03-20T12:02:00 6970 890 0 -1 7.3 0\n"
)
_STATES = (
    "t_s,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s\n0,7000,0,0,0,7.5,0\n60,6990,449,0,-.5,7.4,0\n"
)
_TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
_GRAVITY = (
    "product_type gravity_field\nmodelname X\nearth_gravity_constant 3.986004415E+14\n"
    "radius 6378136.3\nmax_degree 2\nerrors no\nnorm fully_normalized\nend_of_head\n"
    "gfc 0 0 1.0 0.0\ngfc 2 0 -4.84E-04 0.0\ngfc 2 1 -2E-10 1E-09\ngfc 2 2 2.4E-06 -1.4E-06\n"
)
_CRATERS = "CRATER_ID,LAT_CIRC_IMG,LON_CIRC_IMG,DIAM_CIRC_IMG\na,10.5,20.25,3.5\nb,-80,359,12\n"
_STARS = "ra_deg,dec_deg,vmag,bv\n10.5,20.25,3.5,0.6\n350,-80,1.2,\n"

READERS: dict[str, Reader] = {
    "tle": Reader(".tle", _text(_ISS), _tle),
    "oem": Reader(".oem", _text(_OEM), _oem),
    "states": Reader(".csv", _text(_STATES), _csv),
    "gravity": Reader(".gfc", _text(_GRAVITY), lambda path: gravity_field.read(path, 2)),
    "craters": Reader(".csv", _text(_CRATERS), craters.read_catalogue),
    "stars": Reader(".csv", _text(_STARS), star_files.read_stars),
    "shape": Reader(".obj", _text(_TETRAHEDRON), _shape),
    "elevation": Reader(".npy", _npy, lambda path: elevation_files.read(path, None)),
    "elevation_tiff": Reader(
        ".tif", _picture_seeds("TIFF", "L"), lambda path: elevation_files.read(path, None)
    ),
    "elevation_png": Reader(
        ".png", _picture_seeds("PNG", "L"), lambda path: elevation_files.read(path, None)
    ),
    "png": Reader(".png", _picture_seeds("PNG"), _picture),
    "jpeg": Reader(".jpg", _picture_seeds("JPEG"), _picture),
    "webp": Reader(".webp", _picture_seeds("WEBP"), _picture),
    "graph": Reader(
        ".yaml",
        _file("assets/materials/gold_mli.yaml", "assets/materials/solar_cells.yaml"),
        _graph,
    ),
    "configuration": Reader(".yaml", _file("tests/python/scene.yaml"), _configuration),
}
"""The table: a new reader is one line."""


def mutated(seed: bytes, draw: np.random.Generator) -> bytes:
    """A seed with one to five changes: bits, bytes, words, cuts, repeats."""
    data = bytearray(seed)
    for _ in range(int(draw.integers(1, 6))):
        at = int(draw.integers(0, len(data) + 1))
        end = min(len(data), at + int(draw.integers(1, 24)))
        match int(draw.integers(0, 7)):
            case 0 if at < len(data):
                data[at] ^= 1 << int(draw.integers(0, 8))
            case 1 if at < len(data):
                data[at] = int(draw.integers(0, 256))
            case 2:
                data[at:at] = WORDS[int(draw.integers(0, len(WORDS)))]
            case 3:
                data[at:end] = WORDS[int(draw.integers(0, len(WORDS)))]
            case 4:
                del data[at:end]
            case 5:
                data[at:at] = data[at:end]
            case 6 if draw.integers(0, 8) == 0:
                del data[at:]
    return bytes(data)


def trial(reader: Reader, data: bytes, path: Path) -> str | None:
    """What is wrong with how an input was taken; None if nothing is."""
    path.write_bytes(data)
    try:
        reader.read(path)
    except ALLOWED as error:
        return None if str(error) else f"{type(error).__name__} without a message"
    except Exception:
        return traceback.format_exc()
    return None


def fuzz(name: str, inputs: int, seed: int, folder: Path, crashes: Path | None = None) -> list[str]:
    """Findings among so many inputs, no two of the same place."""
    reader = READERS[name]
    seeds, found = reader.seeds(), dict[str, str]()
    path = folder / f"input{reader.suffix}"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for number in range(inputs):
            draw = np.random.default_rng((seed, number))
            data = mutated(seeds[number % len(seeds)], draw)
            faulthandler.dump_traceback_later(LONGEST_S, exit=True)  # a hang names its place
            fault = trial(reader, data, path)
            faulthandler.cancel_dump_traceback_later()
            if fault is None:
                continue
            place = "\n".join(fault.splitlines()[-4:])
            if place not in found:
                found[place] = f"{name}, input {number} of seed {seed}:\n{fault}"
                if crashes is not None:
                    crashes.mkdir(parents=True, exist_ok=True)
                    (crashes / f"{name}-{seed}-{number}{reader.suffix}").write_bytes(data)
    return list(found.values())


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("readers", nargs="*", metavar="READER", help=", ".join(READERS))
    parser.add_argument("--inputs", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    unknown = set(asked.readers) - set(READERS)
    if unknown:
        parser.error(f"no reader {', '.join(sorted(unknown))}; there are {', '.join(READERS)}")
    findings = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in asked.readers or READERS:
            crashes = ROOT / "build" / "fuzz" / "crashes"
            found = fuzz(name, asked.inputs, asked.seed, Path(folder), crashes)
            print(f"{name}: {asked.inputs} inputs, {len(found)} findings", flush=True)
            print("\n".join(found))
            findings += len(found)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
