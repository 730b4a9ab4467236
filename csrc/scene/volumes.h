/* Places volumes in the snapshot and describes them in the plan's view. */
#ifndef PL_SCENE_VOLUMES_H
#define PL_SCENE_VOLUMES_H

#include "scene/snapshot.h"

/* Places a frame's volumes on entities that are already placed. The camera's frustum lies in the
 * cone of `half_angle` about `axis`. */
pl_status pl_volumes_place(const pl_placement *placement, pl_arena *arena, pl_vec3 axis,
                           double half_angle, pl_snapshot *out);
/* Adds upper bounds of their radiance and optical depth to the view. */
pl_status pl_volumes_view(const pl_snapshot *shot, pl_arena *arena, pl_view *out);

#endif
