"""Full silhouettes by other means than the core's: every object rendered alone on a wide canvas."""

from __future__ import annotations

import numpy as np

from perilune import _core


def _alone(row):
    """A renderer of one spacecraft and nothing else; its instance id is 1."""
    scene = _core.Scene(1)
    parts = len(row.model.parts)
    scene.add_object(
        name=row.name,
        model=row.model,
        offset=row.offset,
        obj_id=row.obj_id,
        instance_id=1,
        part_ids=np.ones(parts, dtype=np.int32),
        class_ids=np.ones((parts, 1), dtype=np.uint16),
    )
    return _core.Renderer(scene)


def silhouettes(sim, index):
    """(objects, 3 H, 3 W): every spacecraft as if it were alone, one image size of margin."""
    request = dict(sim.request(index))
    width, height = request["width"], request["height"]
    K = np.array(request["K"])
    K[0, 2] += width
    K[1, 2] += height
    request.update(width=3 * width, height=3 * height, K=K)
    for key in [key for key in request if key.startswith("body_")]:
        request[key] = request[key][:0]
    found = np.zeros((len(sim.models), 3 * height, 3 * width), dtype=bool)
    poses, scales = request["object_poses"], request["object_scale"]
    for k, row in enumerate(sim.models.values()):
        ids = np.empty(found.shape[1:], dtype=np.int32)
        request.update(object_poses=poses[k : k + 1], object_scale=scales[k : k + 1])
        _alone(row).render(request, {"instance": ids}, 1)
        found[k] = ids == 1
    return found
