"""What `perilune schema` explains beside the sections: drivers, hooks, poses, labels, batches.

A topic is one line of the table below; its text is the documentation of what does the work.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass

import perilune
from perilune import drivers
from perilune.base import hooks
from perilune.frame import labels
from perilune.sample import CameraLabel

_POSES = """A pose is seven numbers, x, y, z, qw, qx, qy, qz: p_root = R(q) p_own + (x, y, z).

Metres; the quaternion turns the axes of the thing itself into those of the root frame (ICRF axes,
the root body at the origin), and need not be of length 1. A camera's own axes are OpenCV's: x
right, y down, z forward. `Simulation.camera_poses(index)` gives (2, 7): as the shutter opens, and
closes. A hook of the camera may return (7,), the pose as the shutter opens, from which it moves
with its target, or (2, 7). perilune.look_at makes poses.

Labels have matrices instead: `objects["R_m2c"]` (3, 3) and `["t_m2c"]` (3,), m, from an object's
frame to the camera's; `camera.R_w2c` and `.t_w2c` from the root frame to the camera's.

sample.camera: {camera}"""

_HOOKS = """{about}

The value of a driver, {{hook: "module:function", ideal, ...}}, is drawn once a draw. It may ask for
rng, seed, step (the first that the draw is for), ideal and strength, and returns a value like the
ideal.

An orbit, {{kind: hook, hook: "module:function"}}, is drawn once a scene. It may ask for
body_radius_xyz (km), world and rng, and returns a scaled circle, a state, or elements.

A camera, {{kind: hook, hook: "module:function"}} in camera.trajectory, may be asked several
times a step. It may ask for world, which also is its first argument, and for rng, and returns a
pose (7,) or two, (2, 7): as the shutter opens, and closes.

All may also ask for params, and for the entries of `params` by their names. `perilune schema
camera.trajectory.hook`, `spacecraft.NAME.orbit.hook` and `driver` say more."""


@dataclass(frozen=True)
class Topic:
    """One line of the table."""

    title: str
    text: Callable[[], str]


def _doc(thing: object) -> str:
    return inspect.getdoc(thing) or ""


def _signed(thing: Callable[..., object], name: str) -> str:
    return f"{name}{inspect.signature(thing)}\n\n{_doc(thing)}"


def _taxonomy() -> str:
    texts = [f"sim.taxonomy: {_doc(labels.Taxonomy)}"]
    for name, value in vars(labels.Taxonomy).items():
        if not name.startswith("_") and (callable(value) or isinstance(value, property)):
            texts.append(f".{name}: {_doc(value)}")
    return "\n\n".join(texts)


def _state() -> str:
    stream = perilune.Stream
    texts = [_signed(stream.state_dict, "Stream.state_dict")]
    return "\n\n".join([*texts, _signed(stream.load_state_dict, "Stream.load_state_dict")])


TOPICS: dict[str, Topic] = {
    "driver": Topic("values that vary from frame to frame", lambda: _doc(drivers)),
    "hook": Topic("functions of your own", lambda: _HOOKS.format(about=_doc(hooks))),
    "pose": Topic("what its numbers are", lambda: _POSES.format(camera=_doc(CameraLabel))),
    "sample": Topic("what a frame holds", lambda: _sample()),
    "taxonomy": Topic("names and ids of the labels", _taxonomy),
    "collate": Topic("batches", lambda: _signed(perilune.collate, "perilune.collate")),
    "state_dict": Topic("stopping a stream, and going on", _state),
}


def _sample() -> str:
    return f"{_doc(perilune.Sample)}\n\n.objects: {_doc(perilune.Sample.objects)}"


def topic_text(name: str) -> str:
    """The text of a topic."""
    return TOPICS[name].text()
