/* Faces in one place, as of a decal on a hull: the later one is hit, of one model or of two
 * objects. */
#ifndef PL_TRACE_COINCIDENT_H
#define PL_TRACE_COINCIDENT_H

#include "trace/accelerator.h"

/* A byte for each triangle that may lie in the plane of another part's and overlap it; *out is NULL
 * where none does. Free with pl_free. */
pl_status pl_coincident_find(const pl_model *model, uint8_t **out);

/* Whether candidate `i` of a query counts for its rays, which the context tells. */
typedef bool (*pl_candidate_fn)(const void *context,
                                const struct RTCFilterFunctionNArguments *arguments, unsigned i);

/* Replaces a hit by one within rounding of it along the ray: on a later object, or on the last such
 * triangle of its instance. Only candidates that count, holes of graphs do not. `hit` names the
 * instance, as Embree does. */
void pl_coincident_settle(const pl_tracer *tracer, const pl_ray *ray, pl_candidate_fn counts,
                          const void *context, pl_hit *hit);

#endif
