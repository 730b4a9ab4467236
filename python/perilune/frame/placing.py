"""The part of the core's input that says where everything is, at all times of a frame."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from perilune import _core
from perilune.camera.imaging import intrinsics
from perilune.frame import shutter
from perilune.frame.handles import Handles
from perilune.frame.request import request_of
from perilune.spacecraft import articulation
from perilune.world import World

F64 = NDArray[np.float64]


def placed(
    scene: World,
    handles: Handles,
    camera: Callable[[World], F64],
    hooked: bool,
    posed: Mapping[str, articulation.Posed] | None = None,
    focal_px: float | None = None,
) -> _core.FrameRequest:
    """The core's input without sky and volumes.

    camera: poses (2, 7) at opening and closing. hooked: they come from a user's function. posed:
    poses of the moving parts in the middle of the exposure, if already known. focal_px: poses
    within the exposure are right to a tenth of a pixel of this focal length; default: the
    camera's."""
    posed = posed or handles.posed(shutter.middle(scene))
    keys = None
    if scene.window_s > 0.0:
        exposure = shutter.Exposure(
            scene,
            camera,
            lambda world: articulation.stacked(handles.posed(world)),
            hooked=hooked or scene.camera.trajectory.kind == "hook",
        )
        keys = shutter.keys(scene, focal_px or float(intrinsics(scene.camera)[0, 0]), exposure)
    request = request_of(
        scene,
        camera(scene),
        handles.scales(scene.config),
        articulation.stacked(posed),
        keys,
        handles.document.path,
    )
    request["graph_parameters"] = handles.assignments.parameters(scene.config)
    return request
