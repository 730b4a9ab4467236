/* Large planar areas of a mesh: groups of facets with similar normals, each approximated by a
 * rectangle. Caustics use them to find where a mesh may mirror light; a curved area is a group
 * whose normals are spread.
 *
 * Directions that much of the area faces form a group each. Then the group that fits its rectangle
 * worst is split repeatedly: by its normals, or by position where it fills its rectangle badly.
 * Each group has one material. */
#ifndef PL_GEOM_FACETS_H
#define PL_GEOM_FACETS_H

#include <stddef.h>

#include "base/status.h"
#include "geom/model.h"

/* Largest number of groups of a mesh. */
enum { PL_FACET_GROUPS = 96 };

typedef struct pl_facet_group {
  pl_vec3f center;   /* centre of the rectangle, mesh units */
  pl_vec3f half[2];  /* half axes of the rectangle, mesh units, orthogonal */
  pl_vec3f normal;   /* mean of the facets' normals, outward unit vector */
  float area;        /* total area of the facets, square mesh units */
  float spread;      /* mean squared sine of the angle between their normals and the mean normal */
  uint32_t triangle; /* index of its largest facet */
} pl_facet_group;

typedef struct pl_facets {
  pl_facet_group *groups; /* owned; largest first */
  size_t count;           /* 0 for an empty mesh */
} pl_facets;

pl_status pl_facets_init(const pl_model *model, pl_facets *out);
void pl_facets_clear(pl_facets *facets);

#endif
