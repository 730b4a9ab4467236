/* Keypoints of objects and landmarks on bodies: named points whose images are labels. */
#ifndef PL_ANNOTATE_KEYPOINT_H
#define PL_ANNOTATE_KEYPOINT_H

#include "annotate/sight.h"

typedef struct pl_keypoint {
  size_t owner;  /* index of the object; from the scene's craft_count on that of a body */
  int32_t mover; /* 1 + the moving node that carries it; 0: none. 0 on bodies */
  pl_vec3 place; /* at rest in the frame of the object, or in body axes, m */
  double deep_m; /* how far the surface of its owner may lie before it without hiding it */
} pl_keypoint;

/* As COCO has them. */
typedef enum pl_keypoint_visible {
  PL_KEYPOINT_OUTSIDE, /* outside of the picture, or without an image */
  PL_KEYPOINT_HIDDEN,
  PL_KEYPOINT_SEEN
} pl_keypoint_visible;

/* One row of Sample.keypoints; has the memory layout of the NumPy dtype. */
typedef struct pl_keypoint_label {
  double xy[2];        /* pixels, with the lens; also outside of the picture; nan: no image */
  double position[3];  /* camera axes, m */
  int32_t visible;     /* a pl_keypoint_visible */
  int32_t occluded_by; /* instance id of what hides it; 0: nothing, or it is outside */
} pl_keypoint_label;

/* PL_E_ARGUMENT, naming the number, for an owner or a node that is not in the scene. */
pl_status pl_keypoints_check(const pl_scene *scene, const pl_keypoint *keypoints, size_t count);

/* `frame`: the scene as it is seen. */
void pl_keypoint_find(const pl_scene *scene, const pl_sight_frame *frame,
                      const pl_keypoint *keypoint, pl_keypoint_label *out);

#endif
