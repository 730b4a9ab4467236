"""`perilune graph`: a material's graph as a picture."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, open_simulation


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    parser.add_argument("name", metavar="NAME", help="entry of `materials`")
    parser.add_argument("--on", metavar="S", help="spacecraft or body whose drivers are shown")
    parser.add_argument("--out", required=True, metavar="SVG", help="file to write")


def _run(args: Namespace) -> int:
    print(open_simulation(args).graph(args.name, args.on).save(args.out))
    return OK


GRAPH = Command("graph", "draws a material's graph with its drivers", _configure, _run)
