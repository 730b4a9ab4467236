/* Embree scenes of models, kept, and the instances of a frame in a tree of spheres. */
#ifndef PL_TRACE_ACCELERATOR_H
#define PL_TRACE_ACCELERATOR_H

#include "trace/instance.h"

typedef struct pl_model_accelerator {
  const pl_model *model; /* borrowed; the key */
  RTCScene scene;        /* owned */
  uint8_t *coincident;   /* owned; see trace/coincident.h */
  bool one_way;          /* some of its backs are not there */
} pl_model_accelerator;

/* A sphere about one instance, or about all spheres up to `after`. */
typedef struct pl_sphere {
  pl_vec3 center; /* camera-relative, m */
  double radius_m;
  uint32_t after;    /* index of the first sphere that is not inside this one */
  uint32_t instance; /* PL_NOTHING: of several */
} pl_sphere;

struct pl_accelerators {
  RTCDevice device;
  pl_model_accelerator *models; /* owned */
  size_t model_count;
};

struct pl_tracer {
  pl_instance *instances; /* those of the snapshot that are present */
  size_t instance_count;
  pl_sphere *spheres; /* a tree: each is followed by all that is in it */
  size_t sphere_count;
  const pl_snapshot *snapshot; /* borrowed */
};

/* PL_E_DEVICE with Embree's error if there is one pending. */
pl_status pl_accelerator_check(const pl_accelerators *kept, const char *doing);
/* The model's own accelerator, built when first asked for and kept; valid until the next call. */
pl_status pl_accelerator_of_model(pl_accelerators *kept, const pl_model *model,
                                  const pl_model_accelerator **out);
/* Instances of an object: itself or its pieces. */
size_t pl_accelerator_count(const pl_shot_object *object);
/* Fills those that are present; *count says how many. `index`: of the object. */
pl_status pl_accelerator_place(pl_accelerators *kept, const pl_shot_object *object, uint32_t index,
                               pl_instance *out, size_t *count);

#endif
