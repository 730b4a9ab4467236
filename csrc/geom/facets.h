/* The large flat places of a mesh: groups of facets that look the same way, as few rectangles. Who
 * wants to know where a mesh may mirror light reads them; a curved place is a group whose normals
 * are spread.
 *
 * Directions that much of the area looks in make a group each; then the mesh is halved again and
 * again where a group is least like its rectangle: by its normals, or by place where it fills its
 * rectangle badly. Groups are of one material each. */
#ifndef PL_GEOM_FACETS_H
#define PL_GEOM_FACETS_H

#include <stddef.h>

#include "base/status.h"
#include "geom/model.h"

/* Groups of a mesh, at most. */
enum { PL_FACET_GROUPS = 96 };

typedef struct pl_facet_group {
  pl_vec3f center;   /* of the rectangle, mesh units */
  pl_vec3f half[2];  /* its half axes, mesh units, at right angles */
  pl_vec3f normal;   /* mean of the facets' normals, outwards, unit */
  float area;        /* of the facets, square mesh units */
  float spread;      /* mean of the squared sine between their normals and the mean */
  uint32_t triangle; /* its largest facet */
} pl_facet_group;

typedef struct pl_facets {
  pl_facet_group *groups; /* owned; largest first */
  size_t count;           /* 0 for an empty mesh */
} pl_facets;

pl_status pl_facets_init(const pl_model *model, pl_facets *out);
void pl_facets_clear(pl_facets *facets);

#endif
