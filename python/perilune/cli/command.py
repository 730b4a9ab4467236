"""Description of a command of the command line."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from dataclasses import dataclass

OK = 0
FAILED = 1
"""The command failed; the message says why."""
INTERNAL = 70
"""A fault of the program itself (EX_SOFTWARE of sysexits.h)."""
INTERRUPTED = 130
"""Ctrl-C, as shells report it: 128 + SIGINT."""


@dataclass(frozen=True)
class Command:
    """One row of the table of commands."""

    name: str
    doc: str
    configure: Callable[[ArgumentParser], None]
    run: Callable[[Namespace], int]
