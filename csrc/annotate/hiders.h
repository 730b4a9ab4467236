/* Search for objects and bodies that may hide an object, by trees over their outlines. */
#ifndef PL_ANNOTATE_HIDERS_H
#define PL_ANNOTATE_HIDERS_H

#include "annotate/outline.h"

typedef struct pl_hiders {
  const pl_snapshot *shot;    /* borrowed */
  const pl_outline *outlines; /* of its objects; borrowed */
  pl_sphere_tree objects;     /* circles about the rectangles of the outlines, px */
  pl_sphere_tree bodies;      /* as far as their surfaces and rocks reach, m */
  size_t steps;               /* nodes visited so far, which tests count */
} pl_hiders;

/* Allocates in `arena`. The rectangles must not change afterwards. */
pl_status pl_hiders_build(const pl_snapshot *shot, const pl_outline *outlines, pl_arena *arena,
                          pl_hiders *out);

/* Whether an object or body may hide a pixel of object `index`, see pl_outline_build. Adds to
 * `steps` alone. */
bool pl_hiders_any(pl_hiders *hiders, size_t index);

#endif
