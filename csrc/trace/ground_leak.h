/* Mends rays that slip through the ground.
 *
 * At the very posts of a grid, Embree misses one ray in ten thousand: rounding makes each of the
 * triangles around a vertex leave the ray to the next one. The ground is closed, and rays start
 * above it: a ray that has slipped through meets it next from below. It is traced again, a hair
 * aside. Shadow rays need no mending, since any hit counts. */
#ifndef PL_TRACE_GROUND_LEAK_H
#define PL_TRACE_GROUND_LEAK_H

#include "trace/embree.h"

/* Replaces a hit on the ground from below by one from above that is nearer, or
 * as near, if there is one. `ray`
 * is a result of pl_embree_intersect1 on the scene of a height field with this query. */
void pl_ground_mend(RTCScene scene, pl_embree_query *query, struct RTCRayHit *ray);
/* The same for result `lane` of pl_embree_intersect8. */
void pl_ground_mend_lane(RTCScene scene, pl_embree_query *query, struct RTCRayHit8 *rays,
                         unsigned lane);

#endif
