/* Embree scenes: one per model, kept, and one of instances, moved every frame. */
#ifndef PL_TRACE_ACCELERATOR_H
#define PL_TRACE_ACCELERATOR_H

#include "trace/embree.h"
#include "trace/tracer.h"

typedef struct pl_model_accelerator {
  const pl_model *model; /* borrowed; the key */
  RTCScene scene;        /* owned */
  uint8_t *coincident;   /* owned; see trace/coincident.h */
} pl_model_accelerator;

typedef struct pl_instance {
  const pl_model *model;     /* what `geometry` instances now; NULL when absent */
  RTCGeometry geometry;      /* owned; attached under its own index while present */
  const uint8_t *coincident; /* of the model; NULL for none */
  double radius_m;           /* of the object */
  bool overlapped;           /* the sphere of a later object reaches into the object's */
} pl_instance;

/* Whose triangles an instance beyond those of the objects holds. */
typedef struct pl_piece_owner {
  uint32_t object, first; /* first: triangle of the object's model */
} pl_piece_owner;

struct pl_tracer {
  RTCDevice device;
  RTCScene top;                 /* instances: of objects by index, then of their moving pieces */
  pl_model_accelerator *models; /* owned */
  size_t model_count;
  pl_instance *instances; /* owned, one per object, then one per moving piece */
  size_t instance_count;
  pl_piece_owner *owners;      /* owned, `instance_count`: of instances from object_count on */
  size_t object_count;         /* of the snapshot */
  bool has_pieces;             /* there are instances of moving pieces */
  const pl_snapshot *snapshot; /* borrowed */
  bool has_meshes;             /* the top scene holds an instance */
  bool has_coincident;         /* faces of models, or of two objects, may lie in one place */
  bool has_cuts;               /* graphs may cut holes into some of them */
};

/* Hits of moving pieces, named as Embree does, become those of their objects. */
static inline void pl_tracer_name_owner(const pl_tracer *tracer, uint32_t *thing,
                                        uint32_t *triangle) {
  if (*thing < tracer->object_count)
    return;
  const pl_piece_owner owner = tracer->owners[*thing];
  *thing = owner.object;
  *triangle += owner.first;
}

/* PL_E_DEVICE with Embree's error if there is one pending. */
pl_status pl_accelerator_check(const pl_tracer *tracer, const char *doing);
/* The model's own accelerator, built when first asked for and kept; valid until the next call. */
pl_status pl_accelerator_of_model(pl_tracer *tracer, const pl_model *model,
                                  const pl_model_accelerator **out);
pl_status pl_accelerator_update(pl_tracer *tracer, const pl_snapshot *snapshot);

#endif
