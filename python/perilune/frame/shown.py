"""Lists and arrays with a table as their representation in notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from perilune import _core
from perilune.frame.html import objects_html, plan_html
from perilune.frame.plan_rows import totals

if TYPE_CHECKING:
    from perilune.cost.model import Expected


class Plan(list["_core.PlanRow"]):
    """The effects of a frame, a row each: name, on, value, ceiling, reason, bound_dn, residual_dn,
    spent_dn, cost_ms, and measured_ms, measured_dn, measured_p999_dn if they were measured."""

    spread_ms: float | None = None
    """How far two measurements of the frame's time differ; None if nothing was measured."""

    expected: Expected | None = None
    """What the frame is expected to take, if that was asked for."""
    tolerance_dn: float | None = None
    """The tolerance that a budget asked for; None without one."""

    @property
    def expected_ms(self) -> float | None:
        """CPU time that the frame is expected to take, ms; None if that was not asked for."""
        return None if self.expected is None else self.expected.ms

    @property
    def text(self) -> str:
        """Counts and sums of all rows, in a sentence or two."""
        told = totals(self).text
        if self.tolerance_dn is not None:
            told = f"at a tolerance of {self.tolerance_dn:g} DN: {told}"
        if self.expected is not None:
            told = f"{told}; {self.expected.text}"
        if self.spread_ms is None:
            return told
        return f"{told}; the frame itself, measured twice, differs by {self.spread_ms:.3g} ms"

    def _repr_html_(self) -> str:
        return plan_html(self, self.text)


class ObjectRows(np.ndarray[Any, np.dtype[Any]]):
    """A structured array of object labels; its fields are plain arrays."""

    def _repr_html_(self) -> str | None:
        """None, which shows the plain text, for a single row or a field."""
        if self.dtype.names is None or self.ndim != 1 or "t_m2c" not in self.dtype.names:
            return None
        return objects_html(self)


def object_rows(rows: np.ndarray[Any, Any]) -> ObjectRows:
    """A view as ObjectRows; the array itself if it is one already."""
    return rows if isinstance(rows, ObjectRows) else rows.view(ObjectRows)
