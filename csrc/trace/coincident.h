/* Coincident faces of a model, e.g. a decal on a hull: the later face is hit or, where materials
 * are single-sided, the face that is turned towards the ray. */
#ifndef PL_TRACE_COINCIDENT_H
#define PL_TRACE_COINCIDENT_H

#include "trace/accelerator.h"

/* Sets *out to one byte per triangle, nonzero if the triangle may be coplanar with a triangle of
 * another part and overlap it, or to NULL if there is none. Free it with pl_free. */
pl_status pl_coincident_find(const pl_model *model, uint8_t **out);

/* Hit on an instance, with its own triangle indices and units. */
typedef struct pl_mesh_hit {
  uint32_t triangle;
  float t, u, v; /* t: from the start of the approach (pl_lone_approach) */
} pl_mesh_hit;

/* Returns whether candidate `i` of a query counts for its ray; `context` holds the rays. */
typedef bool (*pl_candidate_fn)(const void *context,
                                const struct RTCFilterFunctionNArguments *arguments, unsigned i);

/* If the hit is on a marked triangle, replaces it by a coincident one: of the candidates of this
 * instance within rounding along the ray, the last that faces the ray, or the last of all if none
 * does. `at` is the ray in mesh units. Candidates for which `counts` is false, e.g. in holes cut by
 * graphs, are skipped. */
void pl_coincident_choose(const pl_instance *instance, const pl_lone_approach *at,
                          pl_candidate_fn counts, const void *context, pl_mesh_hit *hit);

#endif
