/* Cached Embree scenes of models, and the instances of a frame in a tree of bounding spheres. */
#ifndef PL_TRACE_ACCELERATOR_H
#define PL_TRACE_ACCELERATOR_H

#include "geom/sphere_tree.h"
#include "trace/instance.h"
#include "trace/intersect.h"
#include "trace/ray_log.h"

typedef struct pl_model_accelerator {
  const pl_model *model; /* borrowed; the key */
  RTCScene scene;        /* owned */
  uint8_t *coincident;   /* owned; see trace/coincident.h */
  bool one_way;          /* some of its back faces do not exist for rays */
} pl_model_accelerator;

typedef struct pl_ground_tiles pl_ground_tiles;

struct pl_accelerators {
  RTCDevice device;
  pl_model_accelerator *models; /* owned */
  size_t model_count;
  pl_ground_tiles *ground; /* owned; NULL before the first use */
  pl_ray_log *log;         /* borrowed; NULL: none */
};

struct pl_tracer {
  pl_instance *instances; /* the instances of the snapshot that are present */
  size_t instance_count;
  pl_sphere_tree tree;                          /* of their bounding spheres */
  const pl_intersect *closed[PL_SURFACE_KINDS]; /* kinds with a closed form */
  size_t closed_count;
  const pl_snapshot *snapshot; /* borrowed */
  pl_ray_log *log;             /* borrowed; NULL: none */
};

/* Frees the tiles of all grounds (trace/height_field.c). */
void pl_ground_tiles_destroy(pl_accelerators *kept);

/* Returns PL_E_DEVICE (or PL_E_MEMORY) with Embree's error if one is pending; `doing` completes the
 * error text. */
pl_status pl_accelerator_check(const pl_accelerators *kept, const char *doing);
/* Returns the number of instances of an object: 1, or the number of its pieces. */
size_t pl_accelerator_count(const pl_shot_object *object);
/* Places the instances that are present in `out` and their number in *count. */
pl_status pl_accelerator_place(pl_accelerators *kept, const pl_shot_object *object,
                               pl_instance *out, size_t *count);
/* Places the terrain of body `index`, which has a field. */
void pl_accelerator_place_field(const pl_shot_body *body, size_t index, pl_instance *out);

#endif
