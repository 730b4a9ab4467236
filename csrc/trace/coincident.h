/* Faces of a model in one place, as of a decal on a hull: the later face is the one that is hit, or
 * where a file has them single-sided the one that looks at the ray. */
#ifndef PL_TRACE_COINCIDENT_H
#define PL_TRACE_COINCIDENT_H

#include "trace/accelerator.h"

/* A byte for each triangle that may lie in the plane of another part's and overlap it; *out is NULL
 * where none does. Free with pl_free. */
pl_status pl_coincident_find(const pl_model *model, uint8_t **out);

/* A hit on an instance, in its own triangles and units. */
typedef struct pl_mesh_hit {
  uint32_t triangle;
  float t, u, v; /* t: from where the ray came to it */
} pl_mesh_hit;

/* Whether candidate `i` of a query counts for its rays, which the context tells. */
typedef bool (*pl_candidate_fn)(const void *context,
                                const struct RTCFilterFunctionNArguments *arguments, unsigned i);

/* Replaces a hit on such a triangle by the last of those of its instance that look at the ray, or
 * if none does by the last, within rounding of it along the ray, which came to it as `at` says.
 * Only candidates that count: holes of graphs do not. */
void pl_coincident_choose(const pl_instance *instance, const pl_lone_approach *at,
                          pl_candidate_fn counts, const void *context, pl_mesh_hit *hit);

#endif
