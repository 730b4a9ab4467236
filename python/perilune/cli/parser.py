"""An argument parser whose errors name what is allowed and what is nearest."""

from __future__ import annotations

import re
import sys
from argparse import Action, ArgumentError, ArgumentParser, Namespace
from collections.abc import Sequence
from itertools import takewhile
from typing import Any, NoReturn

from perilune.config.errors import nearest

_NEGATIVE = re.compile(r"-[\d.:]")
_KEY_VALUE = re.compile(r"[A-Za-z_][\w.\[\]-]*=")


class Parser(ArgumentParser):
    """The standard library's parser with other messages; errors keep its exit code 2."""

    def __init__(self, **options: Any) -> None:
        # An option cut short would come to mean another one when there is one more.
        super().__init__(allow_abbrev=False, **options)

    def _check_value(self, action: Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            what = "command" if action.dest == "command" else "choice"
            raise ArgumentError(action, f"no {what} '{value}'{nearest(value, action.choices)}")

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Namespace | None = None
    ) -> tuple[Namespace, list[str]]:
        given = list(sys.argv[1:] if args is None else args)
        own = given if self._subparsers is None else takewhile(lambda a: a.startswith("-"), given)
        for argument in own:  # before missing arguments are reported
            self._check_option(argument)
        found, rest = super().parse_known_args(joined(given), namespace)
        if rest:
            self._refuse(rest[0], found)
        return found, rest

    def _refuse(self, argument: str, found: Namespace) -> NoReturn:
        self._check_option(argument)
        if _KEY_VALUE.match(argument) and hasattr(found, "overrides"):
            self.error(f"'{argument}': each key has a --set of its own: --set {argument}")
        self.error(f"'{argument}': there is no such argument; see --help")

    def _check_option(self, argument: str) -> None:
        name = argument.partition("=")[0]
        options = [name for name in self._option_string_actions if name.startswith("--")]
        if len(name) > 2 and name.startswith("--") and name not in options:
            self.error(f"no option '{name}'{nearest(name, options)}")


def joined(args: Sequence[str]) -> list[str]:
    """Joins `--frames -3:5` to `--frames=-3:5`, because a negative value is no option."""
    result: list[str] = []
    for argument in args:
        after_option = bool(result) and result[-1].startswith("--") and "=" not in result[-1]
        if after_option and len(result[-1]) > 2 and _NEGATIVE.match(argument):
            result[-1] += f"={argument}"
        else:
            result.append(argument)
    return result
