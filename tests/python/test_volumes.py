"""Volumes of configurations: against SciPy's integrals, by graphs and drivers, and their errors."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad
from tests.python.volume_worlds import AWAY_M, config, mist, rays

import perilune
from perilune import _core
from perilune.config import ConfigError

SUN = np.array([1.0, 0.0, 0.0])


def picture(tree: dict[str, Any], **options: Any) -> Any:
    return perilune.open(tree).frame(0, **options)["radiance"].astype(np.float64)


def phase(g: float, cosine: float) -> float:
    """Henyey and Greenstein, 1/sr."""
    return float((1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * cosine) ** 1.5))


def ball_light(
    origin: Any, direction: Any, density: Any, extinction: float, albedo: float, g: float
) -> float:
    """Radiance of a unit ball at the origin whose density is a function of the point, by QUADPACK:
    the integral along the ray, in which there is one towards the sun."""

    def out(p: Any, d: Any) -> float:
        return float(-p @ d + np.sqrt(max(0.0, (p @ d) ** 2 - p @ p + 1.0)))

    def depth(p: Any, d: Any, length: float) -> float:
        value = quad(lambda s: density(p + s * d), 0.0, length, epsrel=1e-7, epsabs=1e-9)[0]
        return extinction * float(value)

    middle = float(-origin @ direction)
    nearest = origin + middle * direction
    half2 = 1.0 - float(nearest @ nearest)
    if half2 <= 0.0:
        return 0.0
    start = origin + (middle - np.sqrt(half2)) * direction

    def source(s: float) -> float:
        p = start + s * direction
        dimmed = np.exp(-depth(start, direction, s) - depth(p, SUN, out(p, SUN)))
        return float(density(p) * dimmed)

    total = quad(source, 0.0, 2.0 * np.sqrt(half2), epsrel=1e-6)[0]
    turned = phase(g, float(direction @ SUN))
    return 1000.0 * extinction * albedo * turned * float(total)


@pytest.mark.parametrize(("steps", "within"), [(32, 8e-3), (64, 2.5e-3)])
def test_ball_is_scipys(steps: int, within: float) -> None:
    """Even mist in three colours, at some pixels."""
    given_ = mist()
    tree = config({"mist": given_})
    tree["render"]["volume_steps"] = steps
    sim = perilune.open(tree)
    found = sim.frame(0)["radiance"]
    origin, directions = rays(sim)
    for row, column in ((8, 12), (5, 9), (12, 15), (9, 6), (3, 11)):
        for band in range(3):
            exact = ball_light(
                origin, directions[row, column], lambda p: 1.0,
                given_["extinction_per_m"][band], given_["albedo"][band], 0.5,
            )  # fmt: skip
            assert found[row, column, band] == pytest.approx(exact, rel=within)
    assert found.max() > 5.0
    assert not found[0, 0].any()


LAYERED = {
    "nodes": {
        "place": {"type": "coordinates"},
        "up": {"type": "vector_math", "function": "dot", "a": "place", "b": [0.3, 0.1, 0.4]},
        "half": {"type": "math", "function": "add", "a": "up.value", "b": 0.5},
        "medium": {"type": "lambert", "base_color": [1.0, 0.5, 0.25], "alpha": "half"},
    }
}


def test_graph_is_scipys() -> None:
    """A density that rises along a line, which shades itself: within 1 %."""
    ball = mist(material="layers", extinction_per_m=2.0, albedo=1.0)
    tree = config({"mist": ball}, materials={"layers": LAYERED})
    tree["render"]["volume_steps"] = 64
    sim = perilune.open(tree)
    found = sim.frame(0)["radiance"]
    origin, directions = rays(sim)

    def density(p: Any) -> float:
        return float(np.clip(0.5 + p @ [0.3, 0.1, 0.4], 0.0, 1.0))

    for row, column in ((8, 12), (5, 9), (12, 15), (9, 6)):
        exact = ball_light(origin, directions[row, column], density, 2.0, 1.0, 0.5)
        assert found[row, column, 0] == pytest.approx(exact, rel=1e-2)
        assert found[row, column, 1] == pytest.approx(0.5 * found[row, column, 0], rel=1e-5)


@given(st.floats(1e-3, 1e3), st.floats(-0.95, 0.95), st.sampled_from(["box", "ellipsoid", "cone"]))
@settings(max_examples=12, deadline=None)
def test_energy(extinction: float, g: float, shape: str) -> None:
    """No more is scattered than is met, whatever the mist."""
    keys = {
        "box": {"size_m": [1.0, 2.0, 1.5]},
        "ellipsoid": {"radii_m": [1.0, 0.5, 0.7]},
        "cone": {"end_radius_m": 1.0, "length_m": 1.5},
    }
    ball = mist(shape=shape, extinction_per_m=extinction, albedo=1.0, g=g)
    del ball["radii_m"]
    found = picture(config({"mist": ball | keys[shape]}))
    assert np.all(found >= 0.0)
    assert np.all(found <= 1000.0 * phase(abs(g), 1.0) * (1.0 + 1e-5))


def test_off_and_absent() -> None:
    """Without its row a frame is as without volumes; without volumes the row says so."""
    tree = config({"mist": mist()})
    off = config({"mist": mist()})
    off["render"]["force_off"] = ["volumes"]
    none = config({})
    assert not np.array_equal(picture(tree), picture(none))
    assert np.array_equal(picture(off), picture(none))
    row = next(r for r in perilune.open(none).plan(0) if r["name"] == "volumes")
    assert not row["on"]
    assert row["reason"] == "there are no volumes"
    dim = config({"mist": mist(extinction_per_m=1e-9)})
    row = next(r for r in perilune.open(dim).plan(0) if r["name"] == "volumes")
    assert not row["on"]
    assert 0.0 < row["bound_dn"] < 0.01


def test_drivers() -> None:
    """Numbers of a volume, and of its graph by name, vary from scene to scene; a replay is the same
    to the bit."""
    graph = {
        "nodes": {
            "driver:thick": {"type": "value", "value": 0.5},
            "medium": {"type": "lambert", "base_color": 1.0, "alpha": "driver:thick"},
        },
        "drivers": {"drivers": {"thick": {"uniform": [0.1, 1.0]}}},
    }
    ball = mist(material="fog", radii_m={"uniform": [0.5, 1.0]})
    sim = perilune.open(config({"mist": ball}, materials={"fog": graph}))
    first, second = sim[0], sim[1]
    names = {"volumes.mist.radii_m", "materials.fog.drivers.drivers.thick"}
    assert set(first.meta["drivers"]) == names
    assert not np.array_equal(first["radiance"], second["radiance"])
    again = pickle.loads(pickle.dumps(sim))[1]
    assert np.array_equal(again["radiance"], second["radiance"])
    replayed = perilune.open(config({"mist": ball}, materials={"fog": graph}), replay=second.meta)[
        1
    ]
    assert np.array_equal(replayed["radiance"], second["radiance"])
    thick = first.meta["drivers"]["materials.fog.drivers.drivers.thick"]
    fixed = mist(
        radii_m=first.meta["drivers"]["volumes.mist.radii_m"],
        extinction_per_m=[thick * x for x in (0.3, 1.0, 4.0)],
    )
    assert np.allclose(picture(config({"mist": fixed})), first["radiance"], rtol=0.02, atol=0.03)


def test_own_values_in_each_volume() -> None:
    """`material_drivers` of a volume are its own."""
    graph = {
        "nodes": {
            "driver:thick": {"type": "value", "value": 0.5},
            "medium": {"type": "lambert", "alpha": "driver:thick"},
        }
    }
    left = mist(material="fog", material_drivers={"drivers": {"thick": 0.0}})
    left["position_m"] = [-1.1, 0.0, AWAY_M]
    right = mist(material="fog", position_m=[1.1, 0.0, AWAY_M])
    found = picture(config({"left": left, "right": right}, materials={"fog": graph}))
    halves = np.split(found, 2, axis=1)
    assert sorted(bool(half.any()) for half in halves) == [False, True]


def test_a_draw_for_each_volume() -> None:
    graph = {
        "nodes": {
            "driver:thick": {"type": "value", "value": 0.5},
            "medium": {"type": "lambert", "alpha": "driver:thick"},
        },
        "drivers": {"per": "instance", "drivers": {"thick": {"uniform": [0.1, 1.0]}}},
    }
    balls = {"left": mist(material="fog"), "right": mist(material="fog")}
    drawn = perilune.open(config(balls, materials={"fog": graph}))[0].meta["drivers"]
    assert len(drawn) == 2
    assert len(set(drawn.values())) == 2


def test_same_bits_for_any_threads() -> None:
    balls = {"mist": mist(material="layers"), "more": mist(radii_m=[2.0, 0.3, 0.3])}
    tree = config(balls, materials={"layers": LAYERED})
    sim = perilune.open(tree)
    one = sim.frame(0, threads=1)["radiance"]
    assert np.array_equal(one, sim.frame(0, threads=3)["radiance"])


@pytest.mark.parametrize(
    ("volume", "text"),
    [
        ({"parent": "rok"}, "volumes.mist.parent: no entry named 'rok'; did you mean 'rock'?"),
        ({"shape": "ball"}, "volumes.mist"),
        ({"shape": None}, "volumes.mist: needs the key 'shape'"),
        ({"radii_m": 0.0}, "volumes.mist.radii_m"),
        ({"size_m": 1.0}, "volumes.mist.size_m: unknown key"),
        ({"g": 1.0}, "volumes.mist.g"),
        ({"albedo": 1.2}, "volumes.mist.albedo"),
        ({"core_m": 1.0}, "volumes.mist.core_m: does nothing without a material"),
        ({"material": "foog"}, "volumes.mist.material: no entry named 'foog'; did you mean 'fog'?"),
        ({"material": "own"}, "volumes.mist.material: 'own' asks for a model's own material"),
    ],
)
def test_errors_name_the_key(volume: dict[str, Any], text: str) -> None:
    graphs = {
        "fog": {"nodes": {"medium": {"type": "lambert", "alpha": 0.5}}},
        "own": {
            "nodes": {
                "old": {"type": "model_material"},
                "medium": {"type": "lambert", "base_color": "old.base_color"},
            }
        },
    }
    with pytest.raises(ConfigError) as error:
        perilune.open(config({"mist": mist(**volume)}, materials=graphs))
    assert text in str(error.value)


def test_names_are_of_one_thing() -> None:
    with pytest.raises(ConfigError, match=r"volumes\.rock: a body or spacecraft has the same name"):
        perilune.open(config({"rock": mist()}))


def test_core_refuses_bad_requests() -> None:
    """What the schema would not let through."""
    sim = perilune.open(config({"mist": mist()}))
    renderer = sim._mine().renderer
    size = (18, 24, 3)
    for key, value, text in (
        ("parent", 9, "volume 'mist'"),
        ("size_m", (1.0, float("nan"), 1.0), "volume 'mist'"),
        ("shape", "ball", "allowed: box, ellipsoid, cone"),
        ("graph", 3, "Graph"),
    ):
        request = sim.request(0)
        request["volumes"] = [{**request["volumes"][0], key: value}]
        with pytest.raises((ValueError, TypeError), match=text):
            renderer.render(request, {"radiance": np.empty(size, np.float32)})
    request = sim.request(0)
    request["volumes"] = list(request["volumes"]) * 17
    with pytest.raises(ValueError, match="there may be 16"):
        renderer.render(request, {"radiance": np.empty(size, np.float32)})
    request = sim.request(0)
    request["quality"]["volume_steps"] = 0
    with pytest.raises(ValueError, match="volume_steps"):
        renderer.render(request, {"radiance": np.empty(size, np.float32)})
    assert any(row["name"] == "volumes" for row in _core.EFFECTS)
