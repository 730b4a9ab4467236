/* Volumes in the snapshot and in the plan's view. */
#ifndef PL_SCENE_VOLUMES_H
#define PL_SCENE_VOLUMES_H

#include "scene/snapshot.h"

/* Places a frame's volumes on things that are placed already; the camera sees a cone about `axis`.
 */
pl_status pl_volumes_place(const pl_placement *placement, pl_arena *arena, pl_vec3 axis,
                           double half_angle, pl_snapshot *out);
/* Upper bounds of what they send and take. */
pl_status pl_volumes_view(const pl_snapshot *shot, pl_arena *arena, pl_view *out);

#endif
