/* Faces of a model in one place, as of a decal on a hull: the later face is the one that is hit. */
#ifndef PL_TRACE_COINCIDENT_H
#define PL_TRACE_COINCIDENT_H

#include "trace/accelerator.h"

/* A byte for each triangle that may lie in the plane of another part's and overlap it; *out is NULL
 * where none does. Free with pl_free. */
pl_status pl_coincident_find(const pl_model *model, uint8_t **out);

/* Replaces a hit on such a triangle by the last of its instance's within rounding of it along the
 * ray. `hit` names the instance, as Embree does. */
void pl_coincident_settle(const pl_tracer *tracer, const pl_ray *ray, pl_hit *hit);

#endif
