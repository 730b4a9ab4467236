/* Traces rays against a single object or body and ignores all others. */
#ifndef PL_TRACE_SOLO_H
#define PL_TRACE_SOLO_H

#include "trace/tracer.h"

typedef struct pl_solo pl_solo;

/* Borrows the accelerators of models; destroy it before them. */
pl_status pl_solo_create(pl_accelerators *kept, pl_solo **out);
void pl_solo_destroy(pl_solo *solo); /* NULL is allowed */

/* Selects the object to test, even if culling dropped it from its snapshot. */
pl_status pl_solo_set(pl_solo *solo, const pl_shot_object *object);

/* The same for a body without a shape: its ellipsoid in closed form, or its terrain with rocks, as
 * far as the frame has any. */
pl_status pl_solo_set_body(pl_solo *solo, const pl_shot_body *body);

/* Sets hits[i] if the ray from the camera along unit direction i (root axes) meets what is
 * selected. Thread-safe. Neighbouring directions form packets, with the same transformation and
 * filters as in pl_tracer_closest, so that rounding agrees. */
void pl_solo_cast(const pl_solo *solo, const pl_vec3 *directions, bool *hits, size_t count);

/* Finds all parts (pl_object_part) of the selected object that a ray meets: bit k of sets[i *
 * words] and the words behind it is set if ray i meets part k, and cleared otherwise. As
 * pl_solo_cast. */
void pl_solo_find_parts(const pl_solo *solo, const pl_shot_object *object,
                        const pl_vec3 *directions, size_t count, uint64_t *sets, size_t words);

#endif
