"""The plots: that they show what the frames hold, at equal scales, cut where they should be."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

import perilune
from perilune.show.plots import ground, tracks
from perilune.show.plots.scene3d import Scene3D

EQUATOR = {"time.step_s": 300.0, "spacecraft.sat.orbit.inclination_deg": 0.0}


@pytest.fixture
def opened(repo_dir):
    """Opens the small scene with overrides."""
    return lambda **overrides: perilune.open(
        repo_dir / "tests/python/scene.yaml", overrides=overrides
    )


def test_orbits_hold_the_bodies_and_have_one_scale(opened):
    figure = opened().plot_orbits(frames=range(3))
    (axes,) = figure.axes
    spans = [high - low for low, high in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    assert np.allclose(spans, spans[0])
    assert spans[0] > 2 * 6378.137  # km, the Earth is in it
    assert axes.get_xlabel() == "x (km)"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["sat"]


def test_a_revolution_is_one_circle(opened):
    """500 km over the Earth's mean equatorial radius, 6378.1366 km; inclined by 97.4 deg."""
    world = opened().world(0)
    points = tracks.revolution_m(world, "sat", "earth")
    radii = np.linalg.norm(points, axis=1)
    assert np.allclose(radii, radii[0], rtol=1e-9)
    assert math.isclose(radii[0], 6878.1366e3, rel_tol=1e-6)
    closing = np.linalg.norm(points[-1] - points[0]) / radii[0]
    assert closing < math.radians(3.0)
    normal = np.cross(points[0], points[40])
    assert math.isclose(
        math.degrees(math.acos(normal[2] / np.linalg.norm(normal))), 97.4, abs_tol=1e-6
    )


def test_an_open_orbit_ends(opened):
    sim = opened(**{"spacecraft.sat.orbit.eccentricity": 1.5})
    points = tracks.revolution_m(sim.world(0), "sat", "earth")
    assert 10 < len(points) < 720
    assert np.linalg.norm(points[-1]) > 12 * np.linalg.norm(points[0])


def test_frames_of_one_orbit_are_drawn_once(opened):
    sim = opened()
    worlds = [sim.world(index) for index in range(3)]
    assert [len(run) for run in tracks.rows(worlds, "sat")] == [3]
    driver = {"ideal": 0.0, "jitter_variance": 100.0, "clip_min": -90.0, "clip_max": 90.0}
    sim = opened(**{"spacecraft.sat.orbit.raan_deg": driver})
    worlds = [sim.world(index) for index in range(3)]
    assert [len(run) for run in tracks.rows(worlds, "sat")] == [1, 1, 1]


def test_orbits_drawn_by_scene_are_told_apart(opened):
    orbit = {"kind": "database", "class": "LEO", "around": "earth"}
    sim = opened(**{"spacecraft.sat.orbit": orbit, "time.frames_per_scene": 2})
    worlds = [sim.world(index) for index in range(4)]
    assert [len(run) for run in tracks.rows(worlds, "sat")] == [2, 2]


def test_frusta_project_to_the_corners_of_the_image(opened):
    from perilune.show.plots.trajectory import _frustum

    request = opened().request(0)
    lines = _frustum(np.zeros(3), np.eye(3), request, 5.0)
    pixels = lines[0][:4] @ request["K"].T / lines[0][:4, 2:]
    assert np.allclose(pixels[:, :2], [[-0.5, -0.5], [47.5, -0.5], [47.5, 31.5], [-0.5, 31.5]])
    assert np.allclose(lines[0][:, 2], 5.0)


@pytest.mark.parametrize("axes", ["icrf", "target"])
def test_trajectory_holds_every_camera(opened, axes):
    figure = opened().plot_trajectory(frames=range(4), axes=axes)
    (plot,) = figure.axes
    assert plot.get_xlabel() == "x (m)"
    path = next(line for line in plot.get_lines() if line.get_label() == "camera")
    places = np.stack(path.get_data_3d(), axis=1)
    distances = np.linalg.norm(places, axis=1)
    assert len(places) == 4
    assert (distances > 12).all()
    assert (distances < 20).all()


def test_a_body_as_target(opened):
    trajectory = {"kind": "orbit_object", "target": "earth", "distance_m": 2e7}
    figure = opened(**{"camera.trajectory": trajectory}).plot_trajectory(frames=range(2))
    assert figure.axes[0].get_xlabel() == "x (km)"


def test_ground_track_drifts_with_the_earth(opened):
    """An equatorial orbit comes back to its node after T, while the Earth turns by w T."""
    sim = opened(**EQUATOR)
    period = 2 * math.pi * math.sqrt(6878.1366e3**3 / 398600.435507e9)
    world = sim.world(0)
    first = ground.sub_point_deg(world, "sat", "earth", 0.0)
    after = ground.sub_point_deg(world, "sat", "earth", period)
    assert abs(first[1]) < 0.2  # the equator of date against ICRF's: 0.15 deg in 2026
    drift = math.remainder(after[0] - first[0], 360.0)
    assert math.isclose(drift, -math.degrees(7.292115e-5) * period, abs_tol=0.01)


def test_ground_track_never_crosses_the_map(opened):
    figure = opened(**{"time.step_s": 400.0}).ground_track(frames=range(40))
    lines = [line for line in figure.axes[0].get_lines() if line.get_linestyle() == "-"]
    assert len(lines) > 2  # cut at the date line
    for line in lines:
        assert np.abs(np.diff(line.get_xdata())).max() <= 180.0
        assert np.abs(line.get_xdata()).max() <= 180.0


def test_frames_of_different_orbits_are_not_joined(opened):
    driver = {"ideal": 0.0, "jitter_variance": 100.0, "clip_min": -90.0, "clip_max": 90.0}
    figure = opened(**{"spacecraft.sat.orbit.raan_deg": driver}).ground_track(frames=range(4))
    assert all(line.get_linestyle() != "-" for line in figure.axes[0].get_lines())


def test_cuts_at_the_date_line():
    first, second = ground.wrapped(np.array([170.0, 178.0, -176.0]), np.array([0.0, 3.0, 6.0]))
    assert first.tolist() == [[170.0, 0.0], [178.0, 3.0], [180.0, 4.0]]
    assert second.tolist() == [[-180.0, 4.0], [-176.0, 6.0]]
    west, east = ground.wrapped(np.array([-178.0, 176.0]), np.array([3.0, 0.0]))
    assert west.tolist() == [[-178.0, 3.0], [-180.0, 2.0]]
    assert east.tolist() == [[180.0, 2.0], [176.0, 0.0]]
    assert len(ground.wrapped(np.array([180.0, -180.0, -179.0]), np.zeros(3))) == 2


def test_a_line_passes_behind_and_before_a_body():
    from matplotlib.figure import Figure

    scene = Scene3D(Figure(), 111, 0.0, 0.0)  # seen from +x
    scene.add_ball(np.zeros(3), np.ones(3), np.array([1.0, 0, 0, 0]))
    angle = np.linspace(0, 2 * math.pi, 101)
    scene.add_line(2 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1))
    scene.draw("")
    (body,) = scene.axes.collections
    for line in scene.axes.get_lines():
        middle = np.stack(line.get_data_3d(), axis=1)[1:].mean(axis=0)
        assert (line.get_zorder() > body.get_zorder()) == (middle[0] > 0.0)
    assert len(scene.axes.get_lines()) == 3


def test_figures_can_be_saved(opened, tmp_path):
    opened().plot_orbits().savefig(tmp_path / "a.png", dpi=40)
    assert (tmp_path / "a.png").stat().st_size > 2000


def test_light_curve_is_drawn_as_it_is(opened):
    """Its points in hours, and the frames in eclipse grey."""
    sim = opened(**EQUATOR)
    curve = sim.light_curve("sat", range(60))
    figure = sim.plot_light_curve(["sat", "camera"], range(60))
    lines = figure.axes[0].get_lines()
    assert [line.get_label() for line in lines] == ["sat", "camera"]
    x, y = lines[0].get_data()
    np.testing.assert_allclose(x, np.arange(60) / 12.0)
    np.testing.assert_array_equal(y, curve.irradiance_w_m2[:, 1])
    hidden = curve.hides.any(axis=1)
    assert 0 < hidden.sum() < 60
    (grey,) = figure.axes[0].collections
    edges = np.unique(np.concatenate([path.vertices[:, 0] for path in grey.get_paths()]))
    np.testing.assert_allclose(edges, x[hidden])
    for wrong in ({"names": []}, {"frames": []}):
        with pytest.raises(ValueError, match="at least one of each"):
            sim.plot_light_curve(**{"names": ["sat"], "frames": [0]} | wrong)


@pytest.mark.parametrize("method", ["plot_orbits", "plot_trajectory", "ground_track"])
def test_what_is_missing_is_said(opened, monkeypatch, method):
    sim = opened()
    with pytest.raises(ValueError, match="at least one frame"):
        getattr(sim, method)(frames=[])
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ImportError, match=r"pip install 'perilune\[plot\]'"):
        getattr(sim, method)(frames=[0])


def test_names_are_checked(opened):
    with pytest.raises(ValueError, match="no body or spacecraft 'mars'"):
        opened().plot_orbits(around="mars")
    with pytest.raises(ValueError, match="no body 'sat'"):
        opened().ground_track(frames=[0], body="sat")
    with pytest.raises(ValueError, match="no body or spacecraft 'x'"):
        opened().plot_trajectory(frames=[0], target="x")


def shown_by_itself(figure):
    return figure._repr_png_().startswith(b"\x89PNG")


def test_notebooks_show_figures(opened):
    """Types may be named by text, as IPython documents for `for_type`."""
    from perilune.show import notebook

    class Formatter(dict):
        for_type = dict.__setitem__

    class Shell:
        class display_formatter:  # noqa: N801
            formatters = {"image/png": Formatter()}  # noqa: RUF012

    notebook.load_ipython_extension(Shell)
    formatter = Shell.display_formatter.formatters["image/png"]
    figure = opened().plot_orbits()
    kind = type(figure).__mro__[1]
    assert shown_by_itself(figure)
    shown = formatter[f"{kind.__module__}.{kind.__qualname__}"](figure)
    assert shown.startswith(b"\x89PNG")
    notebook.unload_ipython_extension(Shell)
    assert not formatter


@pytest.mark.parametrize("frames", [range(8), [3]])
def test_light_curve_of_the_demo_is_seen(repo_dir, frames):
    """In full sunlight: a level line, well inside the axes, and points of few frames."""
    sim = perilune.open(repo_dir / "configs" / "demo.yaml")
    axes = sim.plot_light_curve(["smallsat", "camera"], frames=frames).axes[0]
    low, high = axes.get_ylim()
    for line in axes.get_lines():
        assert low < line.get_ydata().min()
        assert line.get_ydata().max() < 0.95 * high
        assert line.get_marker() == "o"
