"""The command line. A new command is its own file and one line of the table below."""

from __future__ import annotations

import os
import sys
import traceback
import warnings
from argparse import ArgumentParser, Namespace
from collections.abc import Sequence
from typing import Any

import perilune
from perilune.cli.calibrate import CALIBRATE
from perilune.cli.check import CHECK
from perilune.cli.command import FAILED, INTERNAL, INTERRUPTED, Command
from perilune.cli.cost import COST
from perilune.cli.graph import GRAPH
from perilune.cli.info import INFO
from perilune.cli.merge import MERGE
from perilune.cli.orbit import ORBIT
from perilune.cli.parser import Parser
from perilune.cli.parts import PARTS
from perilune.cli.plan import PLAN
from perilune.cli.preview import PREVIEW
from perilune.cli.render import RENDER
from perilune.cli.schema import SCHEMA
from perilune.cli.stats import STATS

COMMANDS: tuple[Command, ...] = (
    RENDER,
    MERGE,
    CHECK,
    STATS,
    PREVIEW,
    PLAN,
    COST,
    CALIBRATE,
    PARTS,
    GRAPH,
    ORBIT,
    SCHEMA,
    INFO,
)

_EXPECTED = (ValueError, OSError, MemoryError, RuntimeError)
"""Errors that tell users what to do; any other is a fault of the program."""


def _parser() -> ArgumentParser:
    parser = Parser(prog="perilune", description="Annotated synthetic images of space.")
    parser.add_argument("--version", action="version", version=f"perilune {perilune.__version__}")
    common = Parser(add_help=False)
    common.add_argument("--debug", action="store_true", help="show the traceback of an error")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for command in COMMANDS:
        sub = commands.add_parser(
            command.name, help=command.doc, description=f"{command.doc}.", parents=[common]
        )
        command.configure(sub)
        sub.set_defaults(run=command.run)
    return parser


def describe(error: BaseException) -> str:
    """Message of an error, with the file first, as in errors of the core."""
    if isinstance(error, OSError) and error.strerror and error.filename:
        return f"{error.filename}: {error.strerror}"
    if isinstance(error, MemoryError) and not str(error):
        return "out of memory"
    return str(error) or type(error).__name__


def _fail(args: Namespace, code: int, message: str) -> int:
    if args.debug:
        traceback.print_exc()
    print(f"perilune {args.command}: {message}", file=sys.stderr)
    return code


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    """Prints a warning on its own line, without its place in the code."""
    print(f"perilune: warning: {message}", file=sys.stderr)


def main(argv: Sequence[str] | None = None) -> int:
    """Runs one command; returns its exit code (2: wrong usage, by argparse)."""
    args = _parser().parse_args(argv)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = _warn
            code: int = args.run(args)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return _fail(args, INTERRUPTED, "interrupted")
    except BrokenPipeError:
        # The reader of our output has closed it (`| head`).
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except _EXPECTED as error:
        return _fail(args, FAILED, describe(error))
    except Exception as error:
        text = f"internal error, {type(error).__name__}: {error}"
        return _fail(args, INTERNAL, f"{text} (--debug shows where)")
    return code
