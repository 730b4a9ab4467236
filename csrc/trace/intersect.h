/* How rays meet the surfaces of a kind of geometry: as instances in Embree's scenes, or by a closed
 * form. A part of the table of kinds (render/geometry.h). */
#ifndef PL_TRACE_INTERSECT_H
#define PL_TRACE_INTERSECT_H

#include "trace/tracer.h"

typedef struct pl_instance pl_instance;

struct pl_intersect {
  /* Number of instances of a snapshot's surfaces of the kind, or more; NULL if the kind has none of
   * its own. */
  size_t (*count)(const pl_snapshot *shot, pl_surface_kind kind);
  /* Places the instances that are present in `out`; their number is *count. */
  pl_status (*place)(pl_accelerators *kept, const pl_snapshot *shot, pl_surface_kind kind,
                     pl_instance *out, size_t *count);
  /* Replaces the hits of rays that meet a surface of the kind before them; NULL without a closed
   * form. */
  void (*closest)(const pl_snapshot *shot, const pl_ray *rays, pl_hit *hits, size_t count);
  /* Sets occluded[i] if ray i meets a surface of the kind before t_max. */
  void (*occluded)(const pl_snapshot *shot, const pl_ray *rays, bool *occluded, size_t count);
};

/* Returns the next body, from node *k of the snapshot's tree of bodies on, that a ray may meet
 * before a limit and does not skip; PL_NO_BODY after the last. */
uint32_t pl_next_body(const pl_snapshot *shot, const pl_ray *ray, double limit_m, size_t *k);

/* Meshes and shapes of bodies. */
extern const pl_intersect pl_intersect_objects;
/* Terrain; its rocks are in the same scenes. */
extern const pl_intersect pl_intersect_height_fields;
extern const pl_intersect pl_intersect_ellipsoids;

#endif
