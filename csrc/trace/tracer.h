/* Closest hits and occlusion in a snapshot: meshes through Embree, bodies analytically. */
#ifndef PL_TRACE_TRACER_H
#define PL_TRACE_TRACER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "scene/snapshot.h"

/* Things are numbered objects first, then bodies. */
#define PL_NOTHING UINT32_MAX
enum { PL_TRACER_PACKET = 8 };
/* For pl_ray.skip_body: no body can be hit at all. */
#define PL_EVERY_BODY (UINT32_MAX - 1)

typedef struct pl_ray {
  pl_vec3 origin;    /* camera-relative, root axes, m */
  pl_vec3 direction; /* unit */
  double t_max;      /* m */
  uint32_t
      skip_body; /* index of a body that cannot be hit (its own convex surface), or PL_NOTHING */
  /* The triangle that the ray starts on and so cannot hit: of an object, counted from 1; 0: none.
   */
  uint32_t from_thing, from_triangle;
  /* So far, m, it cannot hit triangles of `from_thing` that it comes out of: by their backs, or by
   * their corners' normals. */
  float leaves;
  bool no_meshes; /* closest hits: of bodies alone */
} pl_ray;

typedef struct pl_hit {
  uint32_t thing;    /* object index; object_count + body index; or PL_NOTHING */
  uint32_t triangle; /* of the object's model */
  float u, v;        /* barycentric weights of corners 1 and 2 */
  double t;          /* m along the unit direction */
} pl_hit;

/* The accelerators of models: each is built when first asked for, and kept. */
typedef struct pl_accelerators pl_accelerators;
/* Opens an Embree device of one build thread, so that accelerators are the same everywhere. */
pl_status pl_accelerators_create(pl_accelerators **out);
void pl_accelerators_destroy(pl_accelerators *kept); /* NULL is allowed */

/* What rays of one snapshot are cast in. Does not change any more: several may be used side by
 * side. */
typedef struct pl_tracer pl_tracer;
/* In `arena`. Borrows the snapshot and what is kept. */
pl_status pl_tracer_build(pl_accelerators *kept, const pl_snapshot *snapshot, pl_arena *arena,
                          const pl_tracer **out);

/* Thread-safe. `coherent` rays (neighbours with similar directions) go as packets of
 * PL_TRACER_PACKET in their order. The choice, and what is in a packet, are part of the result's
 * definition: rounding depends on them. They must not depend on threads. `meshes` false skips
 * meshes: the caller knows that these rays can meet none.
 *
 * The backs of single-sided materials, and of sheets that others back, are not there.
 * Where faces of two objects lie in one place, but for rounding, the later object's is hit: hulls
 * and what is stuck on them do not speckle. */
void pl_tracer_closest(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits, size_t count,
                       bool coherent, bool meshes);
/* occluded[i] is true if anything lies on ray i before t_max, where a light is: faces are there
 * that the light sees. */
void pl_tracer_occluded(const pl_tracer *tracer, const pl_ray *rays, bool *occluded, size_t count,
                        bool coherent);

/* Embree's version and instruction set, e.g. "3.13.5". */
const char *pl_tracer_version(void);

#endif
