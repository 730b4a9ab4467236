"""`perilune info`: versions, processor, ready sensors, data."""

from __future__ import annotations

import json
import os
import platform
from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np

import perilune
from perilune import _core
from perilune.cli.command import OK, Command
from perilune.config.paths import DATA_VARIABLE
from perilune.config.sensor_presets import PRESETS
from perilune.simulation import default_threads


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _data() -> str:
    folder = os.environ.get(DATA_VARIABLE)
    if not folder:
        return "not set"
    return folder if Path(folder).is_dir() else f"{folder} (no such folder)"


def _facts() -> dict[str, str]:
    return {
        "perilune": perilune.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        **_core.version(),
        "threads": str(default_threads()),
        "sensor presets": ", ".join(PRESETS),
        DATA_VARIABLE: _data(),
    }


def _run(args: Namespace) -> int:
    facts = _facts()
    if args.json:
        print(json.dumps(facts, indent=2))
        return OK
    width = max(len(name) for name in facts)
    print("\n".join(f"{name.ljust(width)}  {value}" for name, value in facts.items()))
    return OK


INFO = Command(
    "info", "prints versions, threads, ready sensors and the data folder", _configure, _run
)
