/* Rays against one object alone, as if nothing else were there. */
#ifndef PL_TRACE_SOLO_H
#define PL_TRACE_SOLO_H

#include "trace/tracer.h"

typedef struct pl_solo pl_solo;

/* Borrows the accelerators of models; to be destroyed before them. */
pl_status pl_solo_create(pl_accelerators *kept, pl_solo **out);
void pl_solo_destroy(pl_solo *solo); /* NULL is allowed */

/* Makes `object` the one that is tested; whether it is kept in its snapshot does not matter. */
pl_status pl_solo_set(pl_solo *solo, const pl_shot_object *object);

/* hits[i] is whether the ray from the camera along the unit direction i (root axes) meets the
 * object. Thread-safe. Directions go as packets of neighbours, by the same ways to the object and
 * with the same filters as in pl_tracer_closest. */
void pl_solo_cast(const pl_solo *solo, const pl_vec3 *directions, bool *hits, size_t count);

#endif
