"""Rebuilds the files of assets/ from their scripts: python assets/scripts/build.py [NAME ...].

Needs NumPy; the maps of the Earth-like body need Pillow as well.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import earth_like
import smallsat
import station
import tango_like
import test_object

ASSETS = Path(__file__).resolve().parent.parent
BUILDERS: dict[str, Callable[[Path], None]] = {
    "models/smallsat.glb": lambda path: smallsat.build().save(path),
    "models/tango_like.glb": lambda path: tango_like.build().save(path),
    "models/station.glb": lambda path: station.build().save(path),
    "models/test_object.glb": lambda path: test_object.build().save(path),
    "maps/earth_like.jpg": earth_like.save,
    "maps/earth_like_clouds.jpg": earth_like.save_clouds,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BUILDERS)}")
    parser.add_argument("--out", type=Path, default=ASSETS, help="folder to write to")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.names) - set(BUILDERS))
    if unknown:
        parser.error(f"unknown {', '.join(unknown)}; there are {', '.join(BUILDERS)}")
    for name in arguments.names or BUILDERS:
        path = arguments.out / name
        path.parent.mkdir(parents=True, exist_ok=True)
        BUILDERS[name](path)
        print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
