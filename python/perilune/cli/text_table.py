"""Tables of text in a terminal, by tabulate."""

from __future__ import annotations

from collections.abc import Collection, Sequence


def text_table(
    names: Sequence[str], rows: Sequence[Sequence[str]], right: Collection[str] = ()
) -> str:
    """Columns side by side below their names. right: names of columns that stand to the right."""
    from tabulate import tabulate  # loads slowly

    return tabulate(
        [names, *rows],  # as a row: what tabulate knows to be names it sets wider
        tablefmt="plain",
        disable_numparse=True,
        colalign=["right" if name in right else "left" for name in names],
    )
