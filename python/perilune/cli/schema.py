"""`perilune schema`: the keys of a configuration, section by section, and its JSON Schema."""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace

from perilune.cli.command import OK, Command
from perilune.cli.json_schema import config_schema
from perilune.cli.schema_table import Tables
from perilune.cli.schema_walk import Schema
from perilune.cli.topics import TOPICS, topic_text
from perilune.config.errors import ConfigError, nearest

_MORE = """
perilune schema camera.trajectory.relative    one section: its keys, units, limits, defaults
perilune schema --json                        the whole JSON Schema, for editors
perilune schema TOPIC                         one of:"""


def _configure(parser: ArgumentParser) -> None:
    parser.add_argument(
        "path",
        nargs="?",
        metavar="PATH",
        help="a section or key, such as camera.trajectory.relative or bodies.NAME.clouds, or a "
        f"topic: {', '.join(TOPICS)} (default: an overview)",
    )
    parser.add_argument(
        "--json", action="store_true", help="print the JSON Schema, or that of the section PATH"
    )


def _overview(schema: Schema) -> str:
    longest = max(map(len, TOPICS))
    topics = [f"  {name.ljust(longest)}  {topic.title}" for name, topic in TOPICS.items()]
    found = Tables(schema).overview()
    return "\n".join([found, _MORE, *topics])


def _section(schema: Schema, path: str, as_json: bool) -> str:
    try:
        found = schema.find(path)
    except ConfigError as error:
        if "." in path:
            raise
        names = [*schema.root["properties"], *TOPICS]
        raise ConfigError(f"no section or topic '{path}'{nearest(path, names)}") from error
    if as_json:
        parts = [section for _, section in found.sections] or [found.node]
        return json.dumps(parts[0] if len(parts) == 1 else {"anyOf": parts}, indent=2)
    return Tables(schema).describe(found)


def _run(args: Namespace) -> int:
    raw = config_schema()
    if args.path is None:
        print(json.dumps(raw, indent=2) if args.json else _overview(Schema(raw)))
    elif args.path in TOPICS and not args.json:
        print(topic_text(args.path))
    else:
        print(_section(Schema(raw), args.path, args.json))
    return OK


SCHEMA = Command(
    "schema", "explains the keys of a configuration; --json: its JSON Schema", _configure, _run
)
