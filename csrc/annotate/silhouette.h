/* Full (amodal) silhouettes of objects at pixel centres, as if nothing hid them, on the image with
 * one image size of margin on each side.
 *
 * Rays are cast only where the frame's own do not answer. Inside the image a pixel that sees the
 * object is of its silhouette, and one that sees nothing, or something beyond the object's farthest
 * point, is not; left are the pixels that see another thing at or before the object, and those
 * outside the image, as far as a box of some of the object's triangles projects there. */
#ifndef PL_ANNOTATE_SILHOUETTE_H
#define PL_ANNOTATE_SILHOUETTE_H

#include "annotate/object_label.h"
#include "annotate/outline.h"
#include "base/parallel.h"
#include "trace/solo.h"

/* What a pixel's centre ray meets. */
typedef struct pl_seen {
  uint32_t thing; /* or PL_NOTHING */
  float range_m;
} pl_seen;

/* Keeps a tile's pixels; `points` has `stride` vertices a row, `seen` is the whole image. */
void pl_seen_write(const pl_vertex *points, size_t stride, const int tile[4], int image_width,
                   pl_seen *seen);

/* Mergeable in any order. */
typedef struct pl_silhouette {
  int32_t x0, y0, x1, y1; /* inclusive, image coordinates; x0 > x1 when empty */
  int64_t count;          /* pixels on the canvas */
  int64_t inside;         /* of them in the image; each sees this object or one before it */
  int64_t rays;           /* cast to find out */
} pl_silhouette;

/* Bytes of scratch for the cells of a canvas. */
size_t pl_silhouette_cells(const pl_camera *camera);

/* `seen`, `solo` and `cells` may be NULL when no outline is asked for that is not whole, and no
 * mask. */
typedef struct pl_silhouette_job {
  const pl_snapshot *shot;
  const pl_seen *seen;    /* the whole image */
  pl_solo *solo;          /* set to other objects in passing */
  uint8_t *cells;         /* scratch, of pl_silhouette_cells */
  pl_silhouette *workers; /* scratch, one per thread */
  int threads;
  pl_cancel *cancel; /* may be NULL */
} pl_silhouette_job;

/* The silhouette of object `index`. `extent`: where it is seen. `mask`: NULL, or a height x width
 * image of zeros that becomes 1 on the silhouette. Does not depend on threads. */
pl_status pl_silhouette_find(const pl_silhouette_job *job, size_t index, const pl_outline *outline,
                             const pl_extent *extent, uint8_t *mask, pl_silhouette *out);

/* bbox_obj, px_count_all, px_count_valid and visib_fract of a label whose visible part is filled.
 * Counts beyond INT32_MAX are given as that. */
void pl_silhouette_label(const pl_silhouette *silhouette, pl_object_label *label);

#endif
