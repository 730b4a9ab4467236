/* Labels of objects, which are spacecraft and the bodies that ask for one: pose, bounding boxes,
 * visible and amodal pixel counts. */
#ifndef PL_ANNOTATE_OBJECT_LABEL_H
#define PL_ANNOTATE_OBJECT_LABEL_H

#include <stdint.h>

#include "render/vertex.h"

/* One row of Sample.objects; has the memory layout of the NumPy dtype. Pose at mid-exposure:
 * p_camera = R p_object + t, OpenCV axes, metres. */
typedef struct pl_object_label {
  double R_m2c[9]; /* row-major */
  double t_m2c[3]; /* m */
  /* px_count_visib / px_count_all, 0 when there is no silhouette; nan when amodal labels are off */
  double visib_fract;
  int32_t instance_id;
  int32_t obj_id;
  /* Boxes are x, y, w, h in image coordinates; w = x_max - x_min as in BOP; all -1 when the object
   * is not visible. bbox_obj is the box of the full silhouette, which may lie outside the image. */
  int32_t bbox_visib[4];
  int32_t bbox_obj[4];
  int32_t px_count_visib;
  /* Pixel counts of the full silhouette: px_count_all on the canvas with a margin of one image size
   * on each side, px_count_valid of its pixels inside the image with non-zero depth. -1 when amodal
   * labels are off. */
  int32_t px_count_all;
  int32_t px_count_valid;
  int32_t in_view; /* 1 when the bounding sphere touches the frustum */
} pl_object_label;

/* Some parts of an object, which together have a label. */
typedef struct pl_part_group {
  size_t object; /* index among those that were added */
  const uint8_t
      *parts; /* one per part of the object: not 0 where it belongs to the group; borrowed */
} pl_part_group;

/* Bounding box and number of an object's visible pixels; can be merged in any order. */
typedef struct pl_extent {
  int32_t x0, y0, x1, y1; /* inclusive; x0 > x1 when not visible */
  int32_t count;
} pl_extent;
#define PL_EXTENT_NONE ((pl_extent){INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN, 0})

/* Value of `first_body` that leaves out all bodies. */
#define PL_EXTENT_NO_BODIES SIZE_MAX
/* Adds the pixels of a tile. `extents` has an element per slot (pl_shot_slot); `first_body` is the
 * slot of the first body, whose ground has that of the body. */
void pl_extent_add(pl_extent *extents, size_t first_body, const pl_point *points, size_t stride,
                   const int tile[4]);
void pl_extent_merge(pl_extent *into, const pl_extent *from);

/* `slot`: of a spacecraft, a shape (its label is that of its body), or another body. */
void pl_object_label_fill(const pl_snapshot *shot, size_t slot, const pl_extent *extent,
                          pl_object_label *out);

#endif
