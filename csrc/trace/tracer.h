/* Closest hits and occlusion in a snapshot: meshes and terrain with Embree, ellipsoids in closed
 * form. */
#ifndef PL_TRACE_TRACER_H
#define PL_TRACE_TRACER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "scene/snapshot.h"

enum { PL_TRACER_PACKET = 8 };
/* Value of pl_ray.skip_body: the ray ignores all ellipsoids, which the caller has met itself. Rays
 * still meet every other kind of surface, with a closed form or without. */
#define PL_EVERY_ELLIPSOID (UINT32_MAX - 1)

typedef struct pl_ray {
  pl_vec3 origin;    /* camera-relative, root axes, m */
  pl_vec3 direction; /* unit */
  double t_max;      /* m */
  /* Index of a body that cannot be hit, since the ray starts on its convex surface; or PL_NO_BODY,
   * or PL_EVERY_ELLIPSOID. */
  uint32_t skip_body;
  /* Triangle that the ray starts on and therefore cannot hit: surface, and triangle index + 1; 0
   * for none. */
  pl_surface_id from_surface;
  uint32_t from_triangle;
  /* Up to this distance, m, hits on `from_surface` are ignored where the ray meets a triangle from
   * behind, or leaves the surface by its interpolated normal. */
  float leaves;
  bool no_meshes; /* closest hits: test bodies only */
} pl_ray;

typedef struct pl_hit {
  pl_surface_id surface_id; /* or PL_NO_SURFACE */
  uint32_t triangle;        /* of the object's model; of a height field the tile; of rocks
                             * among those of all tiles */
  /* barycentric weights of corners 1 and 2; on a tile of a height field coordinates of its grid */
  float u, v;
  double t; /* m along the unit direction */
} pl_hit;

/* Accelerators of models: each is built on first use and cached. */
typedef struct pl_accelerators pl_accelerators;
/* Opens an Embree device with one build thread, so that accelerators are the same on every machine.
 */
pl_status pl_accelerators_create(pl_accelerators **out);
void pl_accelerators_destroy(pl_accelerators *kept); /* NULL is allowed */

/* Scene in which the rays of one snapshot are cast. Immutable: several may be used side by side. */
typedef struct pl_tracer pl_tracer;
/* How rays meet each kind of geometry, by pl_surface_kind (trace/intersect.h). */
typedef struct pl_intersect pl_intersect;
typedef struct pl_intersects {
  const pl_intersect *of[PL_SURFACE_KINDS]; /* NULL: as part of another kind */
} pl_intersects;
/* Allocated in `arena`. Borrows the snapshot and the cached accelerators. `pl_geometry_tracer` of
 * render/geometry.h does it for all kinds. */
pl_status pl_tracer_build(pl_accelerators *kept, const pl_snapshot *snapshot,
                          const pl_intersects *kinds, pl_arena *arena, const pl_tracer **out);

/* Finds the closest hit of each ray. Thread-safe. `coherent` rays (neighbours with similar
 * directions) are traced in packets of PL_TRACER_PACKET, in their order. This choice and the
 * content of packets are part of the definition of the result, since rounding depends on them; they
 * must not depend on threads. `meshes` false skips meshes, if the caller knows that these rays
 * cannot hit any.
 *
 * The backs of single-sided materials and of back-to-back sheets do not exist for rays. Where faces
 * of two objects coincide within rounding, the later object is hit, so that a hull and the parts
 * attached to it show no speckles. */
void pl_tracer_closest(const pl_tracer *tracer, const pl_ray *rays, pl_hit *hits, size_t count,
                       bool coherent, bool meshes);
/* Sets occluded[i] if anything lies on ray i before t_max, where the light is. A face exists if it
 * exists as seen from the light. */
void pl_tracer_occluded(const pl_tracer *tracer, const pl_ray *rays, bool *occluded, size_t count,
                        bool coherent);

/* Embree's version and instruction set, e.g. "3.13.5". */
const char *pl_tracer_version(void);

#endif
