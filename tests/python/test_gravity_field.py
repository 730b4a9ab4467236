"""Gravity fields from files: real ones, and what is told of broken ones."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from perilune.orbits import gravity_field
from perilune.orbits.gravity import ZONALS

HEAD = """prose above the head
begin_of_head
modelname tiny
body moon
gravity_constant 4.9e12
radius 1.738D6
norm fully_normalized
end_of_head
"""
ROWS = """gfc 0 0 1.0 0.0
gfc 2 0 -9.0e-5 0.0 1e-9 1e-9
gfc 2 1 1.0D-9 2.0D-9
gfc 2 2 3.4e-5 2.6e-10
"""


def test_egm96(data_dir: Path) -> None:
    path = data_dir / "orbits" / "gravity" / "EGM96-truncated-21x21"
    field = gravity_field.read(path, 21)
    assert (field.degree, field.order, field.c.size) == (21, 21, 253)
    assert field.gm_m3_s2 == 3.986004415e14
    assert field.radius_m == 6378136.3
    # Lines of the file: (2, 2) and the last, (21, 21).
    assert (field.c[5], field.s[5]) == (0.243914352398e-05, -0.140016683654e-05)
    assert (field.c[-1], field.s[-1]) == (0.830374873932e-08, -0.375546121742e-08)
    # The table's zonal harmonics are this field's.
    for n, j in enumerate(ZONALS["earth"].j, 2):
        assert -math.sqrt(2 * n + 1) * field.c[n * (n + 1) // 2] == pytest.approx(j, rel=1e-9)
    low = gravity_field.read(path, 8, 3)
    assert low.c[8 * 9 // 2 + 3] == field.c[8 * 9 // 2 + 3]
    assert not low.c[8 * 9 // 2 + 4 :].any()


def test_grazil(data_dir: Path) -> None:
    """The file's head says degree 300; its lines go to 12."""
    path = data_dir / "orbits" / "gravity" / "GrazLGM300c.truncated"
    field = gravity_field.read(path, 12)
    assert (field.name, field.body) == ("GrazLGM300c", "moon")
    assert (field.gm_m3_s2, field.radius_m) == (4.9028010560e12, 1738000.0)
    # GRAIL's J2 without the permanent tide, and C22: 2.0322e-4, 2.238e-5.
    assert -math.sqrt(5) * field.c[3] == pytest.approx(2.0322e-4, rel=1e-4)
    assert math.sqrt(5 / 12) * field.c[5] == pytest.approx(2.238e-5, rel=5e-3)
    with pytest.raises(ValueError, match="complete to degree 12, not to 13"):
        gravity_field.read(path, 13)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "field.gfc"
    path.write_text(text)
    return path


def test_icgem(tmp_path: Path) -> None:
    field = gravity_field.read(written(tmp_path, HEAD + ROWS), 2)
    assert (field.name, field.body, field.gm_m3_s2, field.radius_m) == (
        "tiny", "moon", 4.9e12, 1.738e6,
    )  # fmt: skip
    np.testing.assert_array_equal(field.c, [1.0, 0, 0, -9.0e-5, 1e-9, 3.4e-5])
    np.testing.assert_array_equal(field.s, [0.0, 0, 0, 0, 2e-9, 2.6e-10])


def test_order_zero_needs_no_tesserals(tmp_path: Path) -> None:
    path = written(tmp_path, HEAD + "gfc 2 0 -9.0e-5 0.0\n")
    assert gravity_field.read(path, 2, 0).c[3] == -9.0e-5
    with pytest.raises(ValueError, match="complete for no degree"):
        gravity_field.read(path, 2)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("radius 1.738D6\n", "", "the head has no radius"),
        ("gravity_constant 4.9e12\n", "", "the head has no gravity_constant"),
        ("radius 1.738D6", "radius -1", "must be positive"),
        ("radius 1.738D6", "radius big", "line 6: not a number: 'big'"),
        ("fully_normalized", "unnormalized", "line 7: norm is unnormalized"),
        ("gfc 2 1", "gfct 2 1", "line 11: 'gfct': fields that change with time"),
        ("gfc 2 1", "gfc 1 2", "line 11: the order 2 is above the degree 1"),
        ("gfc 2 1", "gfc 2 2", "line 12: degree 2, order 2 stands there twice"),
        ("1.0D-9", "nan", "line 11: 'nan' is not finite"),
        ("gfc 2 1 1.0D-9 2.0D-9", "gfc 2 1 1.0D-9", "line 11: must be n, m, C, S"),
        ("gfc 2 1", "gfc 2 -1", "line 11: must be n, m, C, S"),
        ("gfc 2 1 1.0D-9 2.0D-9\n", "", "complete for no degree"),
    ],
)
def test_broken_files(tmp_path: Path, old: str, new: str, what: str) -> None:
    text = HEAD + ROWS
    assert old in text
    path = written(tmp_path, text.replace(old, new, 1))
    with pytest.raises(ValueError, match=r"field\.gfc") as error:
        gravity_field.read(path, 2)
    assert what in str(error.value)


@pytest.mark.parametrize(("degree", "order"), [(1, None), (361, None), (4, 5), (4, -1)])
def test_bad_sizes(tmp_path: Path, degree: int, order: int | None) -> None:
    with pytest.raises(ValueError, match="the degree must be from 2 to 360"):
        gravity_field.read(tmp_path / "not read", degree, order)


def test_not_a_field(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="line 1"):
        gravity_field.read(written(tmp_path, "hello world\n"), 2)
    with pytest.raises(OSError, match="missing"):
        gravity_field.read(tmp_path / "missing", 2)
