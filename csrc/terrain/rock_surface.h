/* What of a rock is over the ground, as points: those that its silhouette is the hull of. */
#ifndef PL_TERRAIN_ROCK_SURFACE_H
#define PL_TERRAIN_ROCK_SURFACE_H

#include "terrain/rock_field.h"

/* Rocks, and points of them one after the other. */
typedef struct pl_rock_surfaces {
  size_t count;
  pl_rock *rocks;  /* owned */
  size_t *first;   /* owned: count + 1 places in `points` */
  pl_vec3 *points; /* owned; body axes, m */
} pl_rock_surfaces;

/* Finds the rocks of ids, with points of their meshes as seen from `eye` (body axes, m) in pixels
 * of an angle: vertices over the ground, and where edges go through the ground. PL_E_RANGE for an
 * id of none. */
pl_status pl_rock_surfaces_find(const pl_rock_field *field, const pl_terrain *terrain,
                                const uint64_t *ids, size_t count, pl_vec3 eye, double pixel_rad,
                                pl_rock_surfaces *out);
void pl_rock_surfaces_clear(pl_rock_surfaces *surfaces);

#endif
