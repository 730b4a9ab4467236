"""What a study found, as text, CSV, JSON and a figure."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import yaml

NAN = math.nan


@dataclass(frozen=True)
class Point:
    """One setting of one knob, all others being exact; nan where an error has no meaning."""

    knob: str
    rung: str
    changes: dict[str, Any]
    off: list[str]
    """Effects that are left out."""
    cpu_ms: float
    wall_ms: float
    first_ms: float
    memory_mb: float
    rmse_dn: float = NAN
    p999_dn: float = NAN
    raw_dn: float = NAN
    """RMS error with the noise of so many samples as the scene has."""
    geometry_px: float = NAN
    slope_deg: float = NAN
    orbit_m: float = NAN


@dataclass(frozen=True)
class Setting:
    """A whole setting: overrides, measured errors and times."""

    changes: dict[str, Any]
    rmse_dn: float
    p999_dn: float
    cpu_ms: float
    wall_ms: float
    first_ms: float
    memory_mb: float

    @property
    def block(self) -> str:
        """The setting as YAML to paste into the configuration."""
        tree: dict[str, Any] = {}
        for path, value in self.changes.items():
            node = tree
            *sections, key = path.split(".")
            for section in sections:
                node = node.setdefault(section, {})
            node[key] = value
        return str(yaml.safe_dump(tree, sort_keys=False, default_flow_style=None, width=100))


@dataclass(frozen=True)
class Advice:
    """The recommended setting for a wanted error, and all that were tried for it."""

    target_dn: float
    setting: Setting
    met: bool
    """Whether the measured error is at most the target."""
    tried: list[Setting]


@dataclass(frozen=True)
class Report:
    """What a study of a frame found; see docs/cost.md."""

    name: str
    index: int
    size: tuple[int, int]
    samples: int
    """Of each picture of a knob, unless the knob is `samples`."""
    reference_samples: int
    reference_dn: float
    """Standard error of the reference, RMS over pixels: errors below it are noise."""
    points: list[Point]
    own: Setting
    """The configuration as it is."""
    advice: list[Advice] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    """Settings that this scene cannot have, and why."""

    @property
    def front(self) -> list[tuple[str, Setting]]:
        """The Pareto front of whole settings: none of the others is both faster and more exact."""
        named = [("own", self.own)]
        named += [(f"{a.target_dn:g} DN", s) for a in self.advice for s in a.tried]
        best, found = math.inf, []
        for name, setting in sorted(named, key=lambda n: (n[1].cpu_ms, n[1].rmse_dn)):
            if setting.rmse_dn < best:
                best = setting.rmse_dn
                found.append((name, setting))
        return found

    @property
    def text(self) -> str:
        """Tables for a terminal."""
        return "\n".join(_lines(self))

    @property
    def csv(self) -> str:
        """A row a setting of a knob, and of a whole setting."""
        out = io.StringIO()
        names = [name for name in Point.__dataclass_fields__ if name not in ("changes", "off")]
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(names)
        for point in self.points:
            writer.writerow([_cell(getattr(point, name)) for name in names])
        for name, setting in self._settings():
            row = {"knob": "setting", "rung": name, **asdict(setting)}
            writer.writerow([_cell(row.get(column, NAN)) for column in names])
        return out.getvalue()

    def _settings(self) -> Iterator[tuple[str, Setting]]:
        yield "own", self.own
        for advice in self.advice:
            yield f"{advice.target_dn:g} DN", advice.setting

    @property
    def json(self) -> str:
        """All of it as one object; null where an error has no meaning."""
        tree = asdict(self)
        for advice, row in zip(self.advice, tree["advice"], strict=True):
            row["block"] = advice.setting.block
        tree["front"] = [name for name, _ in self.front]
        return json.dumps(_plain(tree), indent=2)

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes cost.txt, cost.csv, cost.json and, with matplotlib, cost.png into a folder."""
        to = Path(folder)
        to.mkdir(parents=True, exist_ok=True)
        for name, text in (("txt", self.text + "\n"), ("csv", self.csv), ("json", self.json)):
            (to / f"cost.{name}").write_text(text, encoding="utf-8")
        try:
            figure = self.figure()
        except ImportError as error:
            warnings.warn(f"cost.png is not written: {error}", stacklevel=2)
            return
        figure.savefig(to / "cost.png", dpi=110)

    def figure(self, figure: Any = None) -> Any:
        """A matplotlib Figure: error against time of every knob and of whole settings."""
        from perilune.show.plots import plot_cost

        return plot_cost(self, figure)

    def _repr_html_(self) -> str:
        from perilune.base.html import heading, table, whole

        columns, rows = _table(self)
        return whole(heading("Cost", _head(self)), table(columns, rows, most=200))


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _cell(value: Any) -> str:
    if not isinstance(value, float):
        return str(value)
    return f"{value:.6g}" if math.isfinite(value) else ""


def _number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else ""


_COLUMNS = {
    "rmse_dn": "RMS, DN",
    "p999_dn": "99.9 %, DN",
    "geometry_px": "ground, px",
    "slope_deg": "slope, deg",
    "orbit_m": "orbit, m",
    "cpu_ms": "CPU, ms",
    "wall_ms": "wall, ms",
    "first_ms": "first, ms",
    "memory_mb": "memory, MB",
}


def _table(report: Report) -> tuple[list[str], list[list[str]]]:
    shown = [
        name for name in _COLUMNS if any(math.isfinite(getattr(p, name)) for p in report.points)
    ]
    rows, last = [], ""
    for p in report.points:
        first = "" if p.knob == last else p.knob
        rows.append([first, p.rung, *(_number(getattr(p, name)) for name in shown)])
        last = p.knob
    return ["knob", "setting", *(_COLUMNS[name] for name in shown)], rows


def _head(report: Report) -> str:
    width, height = report.size
    return (
        f"{report.name}, frame {report.index}, {width}x{height}: each knob with all others exact, "
        f"{report.samples} samples. The reference (2 x {report.reference_samples} samples) is good "
        f"to {report.reference_dn:.2g} DN."
    )


def _setting_rows(report: Report) -> list[list[str]]:
    front = {id(setting) for _, setting in report.front}
    rows = []
    for name, s in report._settings():
        numbers = [s.rmse_dn, s.p999_dn, s.cpu_ms, s.wall_ms, s.memory_mb]
        rows.append([name, *map(_number, numbers), "yes" if id(s) in front else ""])
    return rows


def _lines(report: Report) -> Iterator[str]:
    yield _head(report)
    yield ""
    columns, rows = _table(report)
    yield from _aligned(columns, rows)
    yield from report.notes
    yield ""
    heads = ["setting", "RMS, DN", "99.9 %, DN", "CPU, ms", "wall, ms", "memory, MB", "front"]
    yield from _aligned(heads, _setting_rows(report))
    for advice in report.advice:
        yield ""
        said = "measured" if advice.met else "NOT REACHED: the nearest is"
        yield (
            f"# for {advice.target_dn:g} DN: {said} {advice.setting.rmse_dn:.3g} DN, "
            f"{advice.setting.cpu_ms:.4g} ms of CPU time (own setting: "
            f"{report.own.rmse_dn:.3g} DN, {report.own.cpu_ms:.4g} ms)"
        )
        yield advice.setting.block.rstrip()


def _aligned(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    from tabulate import tabulate  # loads slowly

    sides = ["left" if k < 2 and name in ("knob", "setting") else "right"
             for k, name in enumerate(columns)]  # fmt: skip
    text: str = tabulate(
        [list(columns), *map(list, rows)], tablefmt="plain", disable_numparse=True, colalign=sides
    )
    yield from (line.rstrip() for line in text.splitlines())
