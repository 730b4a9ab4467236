/* Where on bodies the light of others may matter. */
#ifndef PL_RENDER_BODY_LIGHT_H
#define PL_RENDER_BODY_LIGHT_H

#include "render/vertex.h"

/* Returns whether what a shaded vertex on an ellipsoid reflects of others' light into the direction
 * opposite to `toward` (unit, root axes) may matter. */
bool pl_body_lit_by_others(const pl_snapshot *shot, const pl_vertex *vertex, pl_vec3f toward);

#endif
