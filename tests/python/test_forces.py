"""Forces of a configuration as those of the core: what they become, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from perilune import _core
from perilune.base import rotations
from perilune.config.orbit import Forces
from perilune.orbits import forces, solar_system
from perilune.orbits.solar_system import date_from_utc
from perilune.orbits.turns import earth

EPOCH = date_from_utc((2024, 3, 20, 3, 6, 0.0))


def centre(table: str | None = "earth", turning: Any = "own") -> forces.Centre:
    name = table or "rock"
    known = _core.BODIES[table or "phobos"]
    if turning == "own":
        turning = None if table is None else forces.turning_of(table, EPOCH)
    return forces.Centre(name, table, float(known["gm_m3_s2"]), np.array(known["radii_m"]), turning)


def specification(section: dict[str, Any], around: forces.Centre, **keys: Any) -> dict[str, Any]:
    model = Forces.model_validate(section)
    return forces.specification(model, around, EPOCH, lambda text, key: Path(text), **keys)


def states(spec: dict[str, Any], around: forces.Centre, state: Any, t_s: Any) -> np.ndarray:
    full = {"kind": "numerical", "gm": around.gm_m3_s2, "state": state, **spec}
    return _core.Propagator(full, EPOCH.day, EPOCH.fraction).states(np.array(t_s))


LOW = [6778e3, 0.0, 0.0, 0.0, 4700.0, 6000.0]
EVERYTHING = {
    "harmonics": {"degree": 4},
    "third_bodies": ["sun", "moon"],
    "drag": {"area_to_mass_m2_kg": 0.01},
    "radiation_pressure": {"area_to_mass_m2_kg": 0.02, "cr": 1.2},
}


def test_everything_about_the_earth() -> None:
    spec = specification(EVERYTHING, centre())
    kinds = [row["kind"] for row in spec["forces"]]
    assert kinds == ["zonal", "third_body", "third_body", "drag", "radiation_pressure"]
    assert set(spec["motions"]) == {"sun", "moon"}
    with_all = states(spec, centre(), LOW, [86400.0, -86400.0])
    for key in EVERYTHING:  # each does something
        rest = {name: value for name, value in EVERYTHING.items() if name != key}
        without = states(specification(rest, centre()), centre(), LOW, [86400.0, -86400.0])
        assert np.linalg.norm((with_all - without)[:, :3], axis=1).min() > 1.0, key


def test_the_other_bodies_are_where_they_are() -> None:
    """Between the rows of the tables too, against the ephemerides they are made from."""
    rng = np.random.default_rng(1)
    pairs = "sun earth, moon earth, earth moon, sun mars, jupiter europa, mars phobos, phobos mars"
    for name, origin in (pair.split() for pair in pairs.split(", ")):
        spec = specification({"third_bodies": [name]}, centre(origin))["motions"][name]
        reach = float(spec["t_s"][-1]) * 0.99
        t = rng.uniform(-reach, reach, 50)
        got = _core.Propagator(spec, EPOCH.day, EPOCH.fraction).states(t)[:, :3]
        expected = np.stack([solar_system.relative_m(name, origin, EPOCH.after(x)) for x in t])
        apart = np.linalg.norm(got - expected, axis=1) / np.linalg.norm(expected, axis=1)
        assert apart.max() < 2e-7, (name, origin, apart.max())


def test_reach_does_not_matter() -> None:
    """The same bits however far the tables reach; beyond them an error that names the span."""
    spans = [specification(EVERYTHING, centre(), reach_s=days * 86400.0) for days in (3, 40)]
    both = [states(spec, centre(), LOW, [1e5, -2e5]) for spec in spans]
    np.testing.assert_array_equal(*both)
    with pytest.raises(ValueError, match=r"outside|span"):
        states(spans[0], centre(), LOW, [30 * 86400.0])


def test_the_earths_turn() -> None:
    """Uniform about the pole of the epoch: within 0.01 deg of ERFA's axes half a year later."""
    turning = forces.turning_of("earth", EPOCH)
    for t in (0.0, 86400.0, 1.6e7, -1.6e7):
        spin = rotations.axis_angle((0.0, 0.0, 1.0), turning["rate_rad_s"] * t)
        ours = rotations.multiply(turning["q"], spin)
        exact = earth(EPOCH)(np.array([t]))[0]
        off = rotations.multiply(rotations.conjugate(ours), exact)
        angle = 2.0 * np.degrees(np.arcsin(np.linalg.norm(off[1:])))
        assert angle < (1e-9 if t == 0.0 else 0.01), (t, angle)


def test_a_field_from_a_file(data_dir: Path) -> None:
    file = str(data_dir / "orbits" / "gravity" / "EGM96-truncated-21x21")
    spec = specification({"harmonics": {"file": file, "degree": 8, "order": 5}}, centre())
    (row,) = spec["forces"]
    assert (row["kind"], row["order"], len(row["c"])) == ("harmonics", 5, 45)
    zonal = specification({"harmonics": {"degree": 6}}, centre())
    order0 = specification({"harmonics": {"file": file, "degree": 6, "order": 0}}, centre())
    a, b = (states(s, centre(), LOW, [20000.0])[0] for s in (zonal, order0))
    # The same harmonics; the file's gm, 2e-8 larger than the centre's, scales them.
    assert np.linalg.norm((a - b)[:3]) < 0.1
    lunar = str(data_dir / "orbits" / "gravity" / "GrazLGM300c.truncated")
    with pytest.raises(ValueError, match="is a field of moon, not earth"):
        specification({"harmonics": {"file": lunar, "degree": 8}}, centre())
    low = [0.0, 1838e3, 0.0, 100.0, 0.0, 1630.0]
    spec = specification({"harmonics": {"file": lunar, "degree": 12}}, centre("moon"))
    assert np.isfinite(states(spec, centre("moon"), low, [86400.0])).all()


@pytest.mark.parametrize(
    ("section", "around", "what"),
    [
        ({"third_bodies": ["mooon"]}, "earth", "no ephemeris of 'mooon'; did you mean 'moon'"),
        ({"third_bodies": ["earth"]}, "earth", "earth is what is orbited"),
        ({"third_bodies": ["sun"]}, None, "rock has no ephemeris"),
        ({"radiation_pressure": {"area_to_mass_m2_kg": 0.1}}, None, "rock has no ephemeris"),
        ({"harmonics": {"degree": 2}}, None, "harmonics: how rock turns is not known"),
        ({"harmonics": {"degree": 2}}, "venus", "harmonics: none known of venus"),
        ({"harmonics": {"degree": 3}}, "europa", "harmonics.degree: 3: of europa"),
        ({"drag": {"area_to_mass_m2_kg": 0.1}}, "moon", "drag: no air is known of moon"),
    ],
)
def test_refusals(section: dict[str, Any], around: str | None, what: str) -> None:
    with pytest.raises(ValueError, match=r"harmonics|third_bodies|drag|sun") as error:
        specification(section, centre(around))
    assert what in str(error.value)


def test_the_table_of_forces() -> None:
    """Documented rows, and every force of the configuration is one."""
    names = {row["name"] for row in _core.FORCES}
    assert names == {
        "point_mass", "zonal", "harmonics", "third_body", "drag", "radiation_pressure",
    }  # fmt: skip
    for row in _core.FORCES:
        assert row["doc"]
        assert all(parameter["doc"] for parameter in row["parameters"])


def error_of(**keys: Any) -> str:
    spec = {"kind": "numerical", "gm": 4e14, "state": LOW, **keys}
    with pytest.raises((ValueError, TypeError)) as error:
        _core.Propagator(spec, EPOCH.day, EPOCH.fraction)
    return str(error.value)


def test_what_the_core_refuses() -> None:
    zonal = {"kind": "zonal", "q": (1, 0, 0, 0), "radius_m": 6e6, "j": (1e-3,)}
    wrong = error_of(forces=[{"kind": "zonl"}])
    assert "no force named 'zonl'; allowed: point_mass, zonal" in wrong
    assert "forces[1] (zonal): unknown key 'jj'" in error_of(forces=[zonal, {**zonal, "jj": 1}])
    assert "forces[0] (zonal): radius_m is missing" in error_of(
        forces=[{"kind": "zonal", "q": (1, 0, 0, 0)}]
    )
    assert "give either body or q" in error_of(forces=[{**zonal, "body": "earth"}])
    third = {"kind": "third_body", "gm": 1e13, "motion": "moon"}
    assert "motion is 'moon'; 'motions' has: ['sun']" in error_of(
        forces=[third],
        motions={"sun": {"kind": "kepler", "gm": 1e20, "state": [1e11, 0, 0, 0, 3e4, 0],
                         "frame": "icrf"}},
    )  # fmt: skip
    assert "motions: sun: kind is 'still'" in error_of(motions={"sun": {"kind": "still"}})
    assert "j[0] is not finite" in error_of(forces=[{**zonal, "j": (float("nan"),)}])
    assert "j is empty" in error_of(forces=[{**zonal, "j": ()}])
    assert "below the surface" in error_of(surface_m=7000e3)
    assert "rtol = 1e-20 must be" in error_of(rtol=1e-20)
    assert "motions must be a dict" in error_of(motions=3)
    assert "forces must be a sequence" in error_of(forces=3)
