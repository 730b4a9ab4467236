/* Full (amodal) silhouettes of objects at pixel centres, as if nothing occluded them, on the image
 * with a margin of one image size on each side.
 *
 * Rays are cast only where the rays of the frame do not decide. A pixel of the image that shows the
 * object belongs to its silhouette. A pixel that shows nothing, or a surface beyond the object's
 * farthest point, does not. A ray is needed for pixels that show another surface at or before the
 * object, and for pixels outside the image, where a box of the object's triangles projects
 * there. */
#ifndef PL_ANNOTATE_SILHOUETTE_H
#define PL_ANNOTATE_SILHOUETTE_H

#include "annotate/object_label.h"
#include "annotate/outline_cells.h"
#include "base/parallel.h"
#include "trace/solo.h"

/* What the centre ray of a pixel hits. */
typedef struct pl_seen {
  pl_surface_id surface_id; /* or PL_NO_SURFACE */
  uint32_t triangle;        /* of a mesh */
  float range_m;
} pl_seen;

/* Stores the pixels of a tile; `points` has `stride` vertices per row, `seen` is the whole
 * image. */
void pl_seen_write(const pl_point *points, size_t stride, const int tile[4], int image_width,
                   pl_seen *seen);

/* Silhouette of an object; can be merged in any order. */
typedef struct pl_silhouette {
  int32_t x0, y0, x1, y1; /* inclusive, image coordinates; x0 > x1 when empty */
  int64_t count;          /* pixels on the canvas */
  int64_t inside;         /* those inside the image: each shows this object or one in front of it */
  int64_t rays;           /* number of rays cast */
} pl_silhouette;

/* The silhouette of nothing. */
#define PL_SILHOUETTE_NOTHING ((pl_silhouette){INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN, 0, 0, 0})

/* Adds a pixel of the canvas. */
void pl_silhouette_add(pl_silhouette *into, int x, int y, bool inside);
void pl_silhouette_merge(pl_silhouette *into, const pl_silhouette *from);

/* `seen`, `solo` and `cells` may be NULL when all requested outlines are whole and no mask is
 * requested. */
typedef struct pl_silhouette_job {
  const pl_snapshot *shot;
  const pl_seen *seen;    /* the whole image */
  pl_solo *solo;          /* what it casts at is changed by the search */
  uint8_t *cells;         /* scratch memory, size from pl_outline_cells_size */
  pl_silhouette *workers; /* scratch memory, one per thread */
  int threads;
  pl_cancel *cancel; /* may be NULL */
} pl_silhouette_job;

static inline bool pl_silhouette_in_image(const pl_camera *camera, int x, int y) {
  return x >= 0 && y >= 0 && x < camera->width && y < camera->height;
}
/* What a pixel of the image shows. */
static inline const pl_seen *pl_silhouette_seen(const pl_silhouette_job *job, int x, int y) {
  return &job->seen[(size_t)y * (size_t)job->shot->rays.camera.width + (size_t)x];
}

/* Finds the silhouette of the entity in a slot (pl_shot_slot): an object, or a body without a
 * shape, with its ground. `extent` is that of its visible pixels. `mask` is NULL, or a height x
 * width image of zeros that becomes 1 on the silhouette. The result does not depend on the number
 * of threads. */
pl_status pl_silhouette_find(const pl_silhouette_job *job, size_t slot, const pl_outline *outline,
                             const pl_extent *extent, uint8_t *mask, pl_silhouette *out);

/* Sets bbox_obj, px_count_all, px_count_valid and visib_fract of a label whose visible part is
 * filled. Counts saturate at INT32_MAX. */
void pl_silhouette_label(const pl_silhouette *silhouette, pl_object_label *label);

#endif
