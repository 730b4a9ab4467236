"""What every benchmark shares: the table it prints and the JSON object of `--json`."""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import statistics
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from perilune import _core

ROOT = Path(__file__).resolve().parent.parent

LABELS = [channel["name"] for channel in _core.CHANNELS if not channel["colour"]]
"""Every pixel channel that is no light."""


def arguments(doc: str) -> argparse.ArgumentParser:
    """A parser with the options that all benchmarks have."""
    parser = argparse.ArgumentParser(
        description=doc, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--threads", type=int, default=min(2, os.cpu_count() or 1))
    return parser


def seconds(work: Callable[[], Any], repeats: int) -> list[float]:
    """Wall times of `repeats` calls."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return times


def processor_s(work: Callable[[], Any], least_s: float = 0.2) -> float:
    """Shortest of at least three runs."""
    best, spent = math.inf, 0.0
    runs = 0
    while runs < 3 or spent < least_s:
        begin = time.process_time()
        work()
        took = time.process_time() - begin
        best, spent, runs = min(best, took), spent + took, runs + 1
    return best


def median(values: Sequence[float]) -> float:
    return statistics.median(values)


def peak_memory_mb() -> float:
    """Largest resident size of this process so far, in 10^6 bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6


def text(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Columns aligned, first column to the left."""
    cells = [list(head), *[[text(value) for value in row] for row in rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = []
    for row in cells:
        first = row[0].ljust(widths[0])
        rest = [cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
        lines.append("  ".join([first, *rest]))
    lines.insert(1, "  ".join("-" * width for width in widths))
    return "\n".join(lines)


def publish(as_json: bool, result: dict[str, Any], tables: Sequence[str]) -> None:
    """Prints either the JSON object or the tables."""
    print(json.dumps(result, sort_keys=True) if as_json else "\n\n".join(tables))
