"""`perilune schema`: the JSON Schema of a configuration, for editors and other programs."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace

from perilune.cli.command import OK, Command
from perilune.cli.json_schema import config_schema


def _configure(parser: ArgumentParser) -> None:
    """No options."""


def _run(args: Namespace) -> int:
    print(json.dumps(config_schema(), indent=2))
    return OK


SCHEMA = Command(
    "schema", "prints the JSON Schema of a configuration, for editors", _configure, _run
)
