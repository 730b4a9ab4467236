/* Which rays to sights may meet something before them: all others are spared, without a change of
 * any bit of what is hidden. */
#ifndef PL_ANNOTATE_CLEAR_VIEW_H
#define PL_ANNOTATE_CLEAR_VIEW_H

#include "annotate/sight.h"

/* Smooth bodies that some rays may meet. */
enum { PL_BODIES_NEAR = 8 };
typedef struct pl_bodies_near {
  bool all; /* any body, whatever the list */
  size_t count;
  uint32_t bodies[PL_BODIES_NEAR];
} pl_bodies_near;

/* Lists the bodies that rays with these queries may meet, by a cone that has all of them. */
void pl_bodies_near_find(const pl_snapshot *shot, const pl_sight_query *queries, size_t count,
                         pl_bodies_near *out);
/* Whether one of them may hide a sight. A convex body does not hide its own points. */
bool pl_bodies_near_hide(const pl_snapshot *shot, const pl_bodies_near *near, const pl_sight *sight,
                         const pl_sight_query *query);

/* Whether a ray through a point of the picture may meet a mesh or ground. */
bool pl_sight_may_meet_mesh(const pl_sight_frame *frame, const double pixel[2]);

#endif
