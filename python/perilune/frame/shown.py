"""Lists and arrays that show themselves as tables in a notebook, and are lists and arrays else."""

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
    """A structured array of object labels; a field of it is an array like any other."""

    def _repr_html_(self) -> str | None:
        """None, of a single row or a field, leaves its text."""
        if self.dtype.names is None or self.ndim != 1 or "t_m2c" not in self.dtype.names:
            return None
        return objects_html(self)


def object_rows(rows: np.ndarray[Any, Any]) -> ObjectRows:
    """The same memory; what has the type already is given back."""
    return rows if isinstance(rows, ObjectRows) else rows.view(ObjectRows)
