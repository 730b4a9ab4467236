"""Options that several commands share, and how their values are read."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from typing import Any

import perilune
from perilune.config import parse_override
from perilune.simulation import Simulation, default_threads


def whole_number(smallest: int) -> Any:
    """A reader of integers not below `smallest`."""

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise ArgumentTypeError(f"{text!r} is not a whole number") from None
        if value < smallest:
            raise ArgumentTypeError(f"{value} is too small; at least {smallest}")
        return value

    return read


def frame_range(text: str) -> range:
    """`12`, `0:20` (20 is left out) or `0:100:10`."""
    fields = text.split(":")
    try:
        numbers = [int(field) if field else 0 for field in fields]
    except ValueError:
        numbers = []
    if not numbers or len(fields) > 3 or not fields[-1]:
        raise ArgumentTypeError(f"{text!r} is none of N, FIRST:END, FIRST:END:STEP")
    if len(numbers) == 1:
        numbers.append(numbers[0] + 1)
    step = numbers[2] if len(numbers) == 3 else 1
    if numbers[0] < 0 or step < 1:
        raise ArgumentTypeError(f"{text!r}: frames start at 0 and the step at 1")
    frames = range(numbers[0], numbers[1], step)
    if not frames:
        raise ArgumentTypeError(f"{text!r} holds no frame (END is left out)")
    return frames


def add_config(parser: ArgumentParser) -> None:
    """CONFIG, --seed and --set."""
    parser.add_argument("config", metavar="CONFIG", help="configuration file, YAML or JSON")
    parser.add_argument(
        "--seed", type=whole_number(0), help="seed of all randomness (default: the file's)"
    )
    parser.add_argument(
        "--set",
        dest="overrides",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="replaces a key of the configuration, e.g. camera.width=320; may be repeated",
    )


def add_threads(parser: ArgumentParser) -> None:
    """--threads."""
    parser.add_argument(
        "--threads",
        type=whole_number(1),
        default=default_threads(),
        help="threads a frame (default: all available, %(default)s)",
    )


def open_simulation(args: Namespace) -> Simulation:
    """The simulation that CONFIG, --seed and --set describe."""
    overrides = dict(parse_override(text) for text in args.overrides)
    return perilune.open(args.config, seed=args.seed, overrides=overrides)
