"""`perilune preview`: a contact sheet with every channel of a frame, or labels over its picture."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from perilune.cli.command import OK, Command
from perilune.cli.options import add_config, add_frame, add_threads, open_simulation


def _configure(parser: ArgumentParser) -> None:
    add_config(parser)
    add_frame(parser)
    parser.add_argument(
        "--overlay",
        metavar="LABELS",
        help="instead of the sheet draw the picture with labels over it: axes, boxes, masks, "
        "craters, keypoints, flow, with commas between",
    )
    parser.add_argument("--out", required=True, metavar="PNG", help="file to write")
    add_threads(parser)


def _run(args: Namespace) -> int:
    from perilune.show import preview  # loads Pillow

    sim = open_simulation(args)
    if args.overlay is None:
        picture = preview.render_sheet(sim, args.frame, threads=args.threads)
    else:
        names = [name.strip() for name in args.overlay.split(",")]
        picture = preview.render_overlay(sim, args.frame, names, threads=args.threads)
    preview.save(picture, args.out)
    print(args.out)
    return OK


PREVIEW = Command("preview", "draws every channel of a frame on one sheet", _configure, _run)
