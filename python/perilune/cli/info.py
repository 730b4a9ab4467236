"""`perilune info`: versions, processor, ready sensors, data; for a configuration its models."""

from __future__ import annotations

import json
import os
import platform
import warnings
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

import numpy as np

import perilune
from perilune import _core
from perilune.base.processors import default_threads
from perilune.cli.command import OK, Command
from perilune.cli.options import add_overrides, open_simulation
from perilune.config.errors import ModelWarning
from perilune.config.sensor_presets import PRESETS
from perilune.document.paths import DATA_VARIABLE
from perilune.orbits.almanac import sources
from perilune.simulation import Simulation


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument(
        "config",
        metavar="CONFIG",
        nargs="?",
        help="a configuration: also lists its models, and what their files contain that is ignored",
    )
    add_overrides(parser)
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


def _models(sim: Simulation) -> list[dict[str, Any]]:
    """Models of spacecraft, and shapes of bodies."""
    config, path = sim.config, sim.document.path
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelWarning)  # they are listed
        found = [
            _model(key, path(config.spacecraft[name].model, key), row.model, row.radius_m)
            for name, row in sim.models.items()
            if (key := f"spacecraft.{name}.model")
        ]
        for name, row in sim.shapes.items():
            shape, key = config.bodies[name].shape, f"bodies.{name}.shape.file"
            if shape is not None:
                entry = _model(key, path(shape.file, key), row.model, row.radius_m)
                found.append({**entry, "warnings": list(row.warnings)})
    return found


def _model(key: str, file: Path, model: _core.Model, radius_m: float) -> dict[str, Any]:
    return {
        "key": key,
        "file": str(file),
        "triangles": model.triangle_count,
        "radius_m": radius_m,
        "warnings": list(model.warnings),
    }


def _lines(models: list[dict[str, Any]]) -> list[str]:
    lines = []
    for row in models:
        size = f"{row['triangles']} triangles, radius {row['radius_m']:.6g} m"
        lines.append(f"{row['key']}: {row['file']}: {size}")
        lines += [f"  warning: {text}" for text in row["warnings"]]
    return lines


def _run(args: Namespace) -> int:
    if args.config is None and (args.overrides or args.seed is not None):
        raise ValueError("--set and --seed go with a CONFIG")
    facts: dict[str, Any] = _facts()
    found: dict[str, Any] = {}
    if args.config is not None:
        sim = open_simulation(args)
        found = {"models": _models(sim), "places": sources(sim.config)}
    if args.json:
        print(json.dumps({**facts, **found}, indent=2))
        return OK
    width = max(len(name) for name in facts)
    lines = [f"{name.ljust(width)}  {value}" for name, value in facts.items()]
    if args.config is not None:
        lines += _lines(found["models"])
        lines += [f"{key}: its place is from {text}" for key, text in found["places"].items()]
    print("\n".join(lines))
    return OK


INFO = Command(
    "info", "prints versions, threads, ready sensors and the data folder", _configure, _run
)
