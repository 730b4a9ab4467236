"""Options that several commands share, and how their values are read."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Callable

import perilune
from perilune.base.processors import default_threads
from perilune.document import parse_override
from perilune.simulation import Simulation

LAST_FRAME = 2**31 - 1


def whole_number(smallest: int, largest: int | None = None) -> Callable[[str], int]:
    """A reader of integers not below `smallest` and not above `largest`."""

    def read(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            raise ArgumentTypeError(f"{text!r} is not a whole number") from None
        if value < smallest:
            raise ArgumentTypeError(f"{value} is too small; at least {smallest}")
        if largest is not None and value > largest:
            raise ArgumentTypeError(f"{value} is too large; at most {largest}")
        return value

    return read


def shard(text: str) -> tuple[int, int]:
    """(k, n) of a shard, from `0/4` to `3/4`."""
    part, slash, count = text.partition("/")
    try:
        numbers = int(part), int(count)
    except ValueError:
        numbers = (-1, 0)
    if not slash or not 0 <= numbers[0] < numbers[1]:
        raise ArgumentTypeError(f"{text!r} is no K/N with 0 <= K < N, such as 0/4 to 3/4")
    return numbers


def frame_range(text: str) -> range:
    """A range of frames from `12`, `0:20` (20 is excluded) or `0:100:10`."""
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
    if frames[-1] > LAST_FRAME:
        raise ArgumentTypeError(f"{text!r}: the last frame there is has index {LAST_FRAME}")
    return frames


def add_config(parser: ArgumentParser) -> None:
    """CONFIG, --seed and --set."""
    parser.add_argument("config", metavar="CONFIG", help="configuration file, YAML or JSON")
    add_overrides(parser)


def add_overrides(parser: ArgumentParser) -> None:
    """--seed and --set."""
    parser.add_argument(
        "--seed", type=whole_number(0), help="seed of all random numbers (default: the file's)"
    )
    parser.add_argument(
        "--set",
        dest="overrides",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="replaces a value of the configuration, such as camera.width=320; may be repeated",
    )


def add_frames(parser: ArgumentParser) -> None:
    """--frames."""
    parser.add_argument(
        "--frames",
        type=frame_range,
        required=True,
        metavar="FIRST:END",
        help="frames to write: N, FIRST:END or FIRST:END:STEP; END is exclusive",
    )


def add_frame(parser: ArgumentParser) -> None:
    """--frame."""
    parser.add_argument(
        "--frame",
        type=whole_number(0, LAST_FRAME),
        default=0,
        metavar="N",
        help="index of the frame (default: 0)",
    )


def add_threads(parser: ArgumentParser) -> None:
    """--threads."""
    parser.add_argument(
        "--threads",
        type=whole_number(1),
        default=default_threads(),
        help="threads per frame (default: all available, %(default)s)",
    )


def open_simulation(args: Namespace) -> Simulation:
    """The simulation that CONFIG, --seed and --set describe."""
    overrides = dict(parse_override(text) for text in args.overrides)
    return perilune.open(args.config, seed=args.seed, overrides=overrides)
