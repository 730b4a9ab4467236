"""Code that runs while the core reads its arguments: nothing is freed, overrun or mixed up.

`script/test hostile` runs this file with the extension built for the address sanitizer.
"""

from __future__ import annotations

import contextlib
import gc
import random
import signal
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import perilune
from perilune import _core

sys.path.insert(0, str(Path(__file__).resolve().parent))
import hostile_objects as hostile

# Memory that is freed or overrun shows in the extension with sanitizers; here, what is answered.
SEEDS = range(40 if "asan" in Path(_core.__file__).parts else 10)


@pytest.fixture(scope="module")
def world():
    return hostile.World()


def rendered(world, request=None, out=None):
    out = world.outputs() if out is None else out
    world.renderer.render(world.request() if request is None else request, out, 1)
    return {name: array.copy() for name, array in out.items()}


@pytest.fixture(scope="module")
def reference(world):
    return rendered(world)


def assert_same(got, reference):
    for name, array in reference.items():
        np.testing.assert_array_equal(dict.__getitem__(got, name), array, err_msg=name)


def other_frame(world, seen):
    """Asks for another frame of the same renderer, and notes the answer."""

    def action():
        try:
            world.renderer.render(world.request(z_m=25.0), world.outputs(), 1)
            seen.append("rendered")
        except ValueError as error:
            seen.append(str(error))

    return action


def test_outputs_that_render_another_frame(world, reference):
    """A mapping of outputs whose items() asks for another frame."""
    seen: list[str] = []
    out = hostile.Mapping(world.outputs())
    out.action = other_frame(world, seen)
    world.renderer.render(world.request(), out, 1)
    assert_same(out, reference)
    assert seen
    assert all("already rendering" in text for text in seen), seen


@pytest.mark.parametrize(
    "key", ["K", "object_poses", "graph_parameters", "body_emission", "sun_position"]
)
@pytest.mark.parametrize("kind", [hostile.Array, hostile.Buffer])
def test_arrays_that_render_another_frame(world, reference, key, kind):
    """The places of the first frame are not overwritten by those of the second."""
    seen: list[str] = []
    request = world.request()
    request[key] = kind(request[key], other_frame(world, seen))
    assert_same(rendered(world, request), reference)
    assert seen
    assert all("already rendering" in text for text in seen), seen


@pytest.mark.parametrize("call", ["plan", "measure_rays", "measure_frame"])
def test_plans_and_measurements_hold_the_renderer_too(world, call):
    seen: list[str] = []
    request = world.request()
    request["K"] = hostile.Array(request["K"], other_frame(world, seen))
    if call == "plan":
        world.renderer.plan(request)
    elif call == "measure_rays":
        world.renderer.measure_rays(request, 1)
    else:
        world.renderer.measure_frame(request, world.outputs(), 1)
    assert seen
    assert all("already rendering" in text for text in seen), seen


def test_a_failed_request_lets_go_of_the_renderer(world, reference):
    for key in world.request():
        if key not in _OPTIONAL:
            request = world.request()
            del request[key]
            with pytest.raises((KeyError, ValueError)):
                world.renderer.render(request, world.outputs(), 1)
    for out in [{"no such": np.zeros(1)}, {"rgb": np.zeros(1)}, {1: np.zeros(1)}]:
        with pytest.raises((TypeError, ValueError)):
            world.renderer.render(world.request(), out, 1)
    assert_same(rendered(world), reference)


_OPTIONAL = {"lens", "focus", "motion", "body_clouds", "body_contrast", "body_ground", "sky",
             "volumes", "sensor", "sun_wavelengths", "amodal"}  # fmt: skip


def test_values_that_leave_their_dictionary(world, reference):
    """A number's own code removes it, and all else, from the request that it stands in."""
    for section, key in [(None, "sun_radius"), (None, "width"), ("quality", "samples"),
                         ("quality", "tolerance_dn"), ("exposure", "white_radiance")]:  # fmt: skip
        request = world.request()
        tree = request if section is None else request[section]
        tree[key] = hostile.Number(tree[key], tree.clear)
        with pytest.raises((KeyError, ValueError)):
            world.renderer.render(request, world.outputs(), 1)
    for key in ["K", "camera_pose", "object_poses", "body_poses", "body_albedo", "sun_position"]:
        request = world.request()
        request[key] = hostile.Array(request[key], request.clear)
        with pytest.raises((KeyError, ValueError)):
            world.renderer.render(request, world.outputs(), 1)
    assert_same(rendered(world), reference)


def test_things_that_exist_only_while_they_are_asked_for(world, reference):
    """Mappings that make their stars, pictures and graphs anew each time, and keep none."""

    class Fresh(hostile.Mapping):
        def __getitem__(self, key):
            made = {"stars": hostile.stars, "graph": hostile.graph}
            value = super().__getitem__(key)
            return made[key]() if key in made else np.array(value) if key == "kernel" else value

    request = world.request()
    request["sky"] = Fresh(request["sky"])
    request["sensor"] = Fresh(request["sensor"])
    request["volumes"] = [Fresh(row) for row in request["volumes"]]
    assert_same(rendered(world, request), reference)


def test_a_mapping_that_is_no_dict_is_read_in_full(world):
    """Keys of a sensor that were only looked up in dictionaries."""

    class Plain:
        def __init__(self, tree: dict[str, Any]) -> None:
            self.tree = tree

        def __getitem__(self, key: str) -> Any:
            return self.tree[key]

    request = world.request()
    request["sensor"] |= {"mix": np.eye(3)[::-1], "mosaic": "rggb"}
    as_dict = rendered(world, request)
    request["sensor"] = Plain(request["sensor"])
    assert_same(rendered(world, request), as_dict)


def test_scenes_that_are_changed_while_they_are_changed(world):
    """A renderer made, or an object added, by the arrays of an object that is being added."""
    parts = len(world.model.parts)
    for action_of in [
        lambda scene: lambda: _core.Renderer(scene),
        lambda scene: lambda: hostile.add_satellite(scene, world.model),
        lambda scene: lambda: scene.set_materials(0, (hostile.graph(),), world.graphed),
    ]:
        scene = _core.Scene(1)
        hostile.add_satellite(scene, world.model)
        for change in [
            lambda array, scene=scene: hostile.add_satellite(scene, world.model, class_ids=array),
            lambda array, scene=scene: hostile.add_moon(scene, class_ids=array),
        ]:
            array = hostile.Array(np.ones((parts, 1), np.uint16), action_of(scene))
            with pytest.raises(ValueError, match="is being changed"):
                change(array)
        nodes = hostile.Array(np.array([1], np.intc), action_of(scene))
        with pytest.raises(ValueError, match="is being changed"):
            scene.articulate(0, nodes)
        assert hostile.add_satellite(scene, world.model) == 1


def test_materials_that_render_while_they_are_set(world, reference):
    seen: list[str] = []

    def render():
        try:
            world.renderer.render(world.request(), world.outputs(), 1)
            seen.append("rendered")
        except ValueError as error:
            seen.append(str(error))

    world.scene.set_materials(0, (hostile.graph(),), hostile.Array(world.graphed, render))
    assert seen
    assert all("is being changed" in text for text in seen), seen
    assert_same(rendered(world), reference)


def test_arrays_that_shrink_after_they_were_checked(world):
    """Another argument's own code makes an array smaller that was read and checked before."""
    offset = np.zeros(3)
    parts = len(world.model.parts)
    scene = _core.Scene(1)

    def shrink():
        offset.resize(0, refcheck=False)

    ids = hostile.Array(np.ones(parts, np.int32), shrink)
    assert hostile.add_satellite(scene, world.model, offset=offset, part_ids=ids) == 0

    times = np.arange(100_000.0)
    quats = np.tile([1.0, 0.0, 0.0, 0.0], (len(times), 1))
    still = {"kind": "fixed", "position_m": (0.0, 0.0, 0.0)}
    node = {"name": "a", "parent": -1, "motion": still}
    turn = {"frame": "table", "t_s": times,
            "quats": hostile.Array(quats, lambda: times.resize(0, refcheck=False))}  # fmt: skip
    tree = _core.Tree([node | {"rotation": turn}], 2451545.0, 0.0)
    assert tree.states(np.array([0.5]))[0].shape == (1, 1, 7)


@pytest.mark.parametrize("name", ["flat_field", "kernel"])
def test_images_that_shrink_after_they_were_checked(world, reference, name):
    """Those of a sensor are not copied: NumPy refuses to resize what is lent out."""
    request = world.request()
    image = np.array(request["sensor"][name])
    request["sensor"][name] = image[:] if name == "kernel" else image
    refused: list[str] = []

    def shrink():
        try:
            image.resize(0, refcheck=False)
        except ValueError as error:
            refused.append(str(error))

    request["exposure"]["key"] = hostile.Number(0.8, shrink)
    assert_same(rendered(world, request), reference)
    assert refused


def test_a_handler_of_signals_runs_in_the_middle_of_a_frame(world, reference):
    """It may neither render with the renderer, nor change the scene, nor resize the outputs."""
    seen: list[str] = []
    out, request = world.outputs(), world.request()
    request["quality"]["samples"] = 4096
    out["radiance"] = np.zeros((hostile.SIZE, hostile.SIZE, 3), np.float32)
    attempts = [
        lambda: world.renderer.render(world.request(), world.outputs(), 1),
        lambda: world.scene.set_materials(0, (hostile.graph(),), world.graphed),
        lambda: world.scene.set_body_graph(0, None),
        lambda: [array.resize(0, refcheck=False) for array in out.values()],
        lambda: (request["sensor"].clear(), request["sky"].clear(), request.clear()),
        gc.collect,
    ]

    class EnoughError(Exception):
        """Ends the frame, once everything was tried."""

    def handler(number, frame):
        for attempt in attempts:
            try:
                attempt()
                seen.append("done")
            except ValueError as error:
                seen.append(str(error))
        raise EnoughError

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(EnoughError):
            world.renderer.render(request, out, 1)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert "already rendering" in seen[0]
    assert "being rendered" in seen[1]
    assert "being rendered" in seen[2]
    assert "cannot resize" in seen[3]
    assert seen[4:] == ["done", "done"]
    assert_same(rendered(world), reference)


def test_a_handler_that_asks_the_simulation_for_a_frame(repo_dir):
    """It is refused; it used to wait for ever for the frame that waited for it."""
    sim = perilune.open(repo_dir / "tests/python/scene.yaml", overrides={"render.samples": 4096})
    seen: list[str] = []

    def handler(number, frame):
        try:
            sim.frame(1)
        except RuntimeError as error:
            seen.append(str(error))
        raise KeyboardInterrupt

    sim.plan(0)
    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            sim.frame(0)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert seen == ["a frame of this simulation is being rendered around this call"]
    assert sim.plan(0)


def test_other_threads(world, reference):
    """Frames asked for side by side of one renderer: one is right, the others are refused."""
    frames: list[dict[str, np.ndarray]] = []
    refused: list[str] = []

    def work():
        for _ in range(4):
            try:
                frames.append(rendered(world))
                world.scene.set_materials(0, (hostile.graph(),), world.graphed)
            except ValueError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert frames
    assert len(frames) + len(refused) >= 12
    for frame in frames:
        assert_same(frame, reference)


def test_a_description_that_holds_itself():
    """A propagator among whose motions is the propagator: an error, no crash."""
    spec: dict[str, Any] = {"kind": "numerical", "gm": 4e14, "state": [7e6, 0, 0, 0, 7.5e3, 0]}
    spec["motions"] = {"again": spec}
    with pytest.raises(RecursionError):
        _core.Propagator(spec, 2451545.0, 0.0)


def test_outputs_must_be_what_they_seem(world):
    """Labels of objects in a type that holds Python's own objects; items that are no pairs."""
    size = np.dtype(list(_core.OBJECT_LABEL)).itemsize
    holes = np.zeros(1, np.dtype([("x", object, (size // 8,))]))
    with pytest.raises(ValueError, match="OBJECT_LABEL"):
        world.renderer.render(world.request(), {"objects": holes}, 1)
    assert holes["x"][0][0] == 0

    class Odd(dict):
        rows: Any = ()

        def items(self):
            return self.rows

    for rows in [[("rgb",)], [["rgb", np.zeros(1)]], [()], [1], [(1, np.zeros(1))], 7, None]:
        out = Odd()
        out.rows = rows
        with pytest.raises((TypeError, ValueError)):
            world.renderer.render(world.request(), out, 1)


def _poisoned(tree: Any, action: Any, rng: random.Random) -> Any:
    """The tree with hostile values wherever the core would take them."""
    if isinstance(tree, dict):
        made = hostile.Mapping({k: _poisoned(v, action, rng) for k, v in tree.items()})
        made.action = action
        return made
    if isinstance(tree, list):
        return [_poisoned(v, action, rng) for v in tree]
    if isinstance(tree, np.ndarray):
        return rng.choice([hostile.Array, hostile.Buffer])(tree, action)
    if isinstance(tree, (int, float)) and not isinstance(tree, bool):
        return hostile.Number(tree, action)
    return tree


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # of finalizers
@pytest.mark.parametrize("seed", SEEDS)
def test_any_code_at_any_moment(world, reference, seed):
    """Every value of a request is hostile, and does something else each time it is read. What comes
    is the frame that was asked for, or an error; and the next frame is right."""
    rng = random.Random(seed)
    request = world.request()
    plain = [value for value in request.values() if isinstance(value, np.ndarray)]
    out = world.outputs()

    def touch(tree):
        if tree:
            tree.pop(rng.choice(list(dict.keys(tree))), None)

    def stop():
        raise ZeroDivisionError("hostile")

    calm = [
        lambda: world.renderer.render(world.request(25.0), world.outputs(), 1),
        lambda: world.renderer.plan(world.request(25.0)),
        lambda: world.scene.set_materials(0, (hostile.graph(),), world.graphed),
        lambda: world.scene.set_body_graph(0, None),
        gc.collect,
    ]
    wild = [
        lambda: touch(poisoned),
        lambda: touch(rng.choice([v for v in poisoned.values() if isinstance(v, dict)])),
        lambda: rng.choice(plain).resize(rng.randrange(4), refcheck=False),
        lambda: rng.choice(list(out.values())).resize(rng.randrange(4), refcheck=False),
        stop,
    ]  # fmt: skip
    is_wild = seed % 2 == 1

    def action():
        if rng.random() < 0.1:
            with contextlib.suppress(ValueError, KeyError, AttributeError):
                rng.choice(calm + wild if is_wild else calm)()

    poisoned = _poisoned(request, action, rng)
    hostile_out = hostile.Mapping(out)
    hostile_out.action = action
    try:
        world.renderer.render(poisoned, hostile_out, 1)
    except (KeyError, ValueError, TypeError, ZeroDivisionError, RuntimeError):
        assert is_wild
    else:
        if not is_wild:
            assert_same(out, reference)
    assert_same(rendered(world), reference)
