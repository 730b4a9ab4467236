"""`perilune preview`: a contact sheet with every channel of a frame."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frame, add_threads, open_simulation


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frame(parser)
    parser.add_argument("--out", required=True, metavar="PNG", help="file to write")
    add_threads(parser)


def _run(args: Namespace) -> int:
    from perilune.show import preview  # loads Pillow

    sim = open_simulation(args)
    sheet = preview.render_sheet(sim, args.frame, threads=args.threads)
    preview.save(sheet, args.out)
    print(args.out)
    return OK


PREVIEW = Command("preview", "draws every channel of a frame on one sheet", _configure, _run)
