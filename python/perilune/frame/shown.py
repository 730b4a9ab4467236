"""Lists and arrays with a table as their representation in notebooks."""

from __future__ import annotations

from typing import Any

import numpy as np

from perilune import _core
from perilune.frame.html import objects_html, plan_html


class Plan(list["_core.PlanRow"]):
    """The effects of a frame, a row each: name, on, reason, bound_dn, cost_ms."""

    def _repr_html_(self) -> str:
        return plan_html(self)


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
