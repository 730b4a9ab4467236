"""Topics that `perilune schema` explains besides the sections: drivers, hooks, poses, labels ...

A topic is one line of the table below; its text is mostly the docstring of the code in question.
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

Positions are in metres. The quaternion rotates the object's own axes to those of the root frame
(ICRF axes, origin at the root body) and need not be of length 1. A camera has OpenCV axes: x right,
y down, z forward. `Simulation.camera_poses(index)` returns shape (2, 7): the poses as the shutter
opens and as it closes. A camera hook may return (2, 7), or (7,): the pose as the shutter opens,
from which the camera moves with its target. perilune.look_at makes poses.

Labels have matrices instead: `objects["R_m2c"]` (3, 3) and `["t_m2c"]` (3,), m, from an object's
frame to the camera's; `camera.R_w2c` and `.t_w2c` from the root frame to the camera's.

sample.camera: {camera}"""

_HOOKS = """{about}

Driver: {{hook: "module:function", ideal, ...}}, called once per draw. Its arguments may be rng,
seed, step (the first step of the draw), ideal and strength. It returns a value like the ideal.

Orbit: {{kind: hook, hook: "module:function"}}, called once a scene. Its arguments may be
body_radius_xyz (km), world and rng. It returns a scaled circle, a state, or elements.

Camera: {{kind: hook, hook: "module:function"}} in camera.trajectory, called several times per step.
Its first argument is world; it may also have rng. It returns a pose (7,), or two, (2, 7): as the
shutter opens and as it closes.

All may also have the argument params, and the entries of `params` by their names. See `perilune
schema camera.trajectory.hook`, `spacecraft.NAME.orbit.hook` and `driver`."""


@dataclass(frozen=True)
class Topic:
    """One line of the table."""

    title: str
    text: Callable[[], str]


def _doc(item: object) -> str:
    return inspect.getdoc(item) or ""


def _signed(item: Callable[..., object], name: str) -> str:
    return f"{name}{inspect.signature(item)}\n\n{_doc(item)}"


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
    "hook": Topic("your own functions", lambda: _HOOKS.format(about=_doc(hooks))),
    "pose": Topic("numbers and axes of a pose", lambda: _POSES.format(camera=_doc(CameraLabel))),
    "sample": Topic("contents of a frame", lambda: _sample()),
    "taxonomy": Topic("names and ids of the labels", _taxonomy),
    "collate": Topic("batches of frames", lambda: _signed(perilune.collate, "perilune.collate")),
    "state_dict": Topic("stopping and resuming a stream", _state),
}


def _sample() -> str:
    return f"{_doc(perilune.Sample)}\n\n.objects: {_doc(perilune.Sample.objects)}"


def topic_text(name: str) -> str:
    """The text of a topic."""
    return TOPICS[name].text()
