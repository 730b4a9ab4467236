/* Coverage mask: the pixels in which a mesh may be visible, from projections of its bounding boxes
 * and, where that pays, of its triangles. */
#ifndef PL_RENDER_COVERAGE_MASK_H
#define PL_RENDER_COVERAGE_MASK_H

#include <stdatomic.h>
#include <stdbool.h>

#include "scene/snapshot.h"

typedef struct pl_coverage {
  int width, height;
  atomic_uchar *pixels; /* owned; 1 where a ray through the pixel may meet a mesh */
  size_t room;          /* bytes allocated */
} pl_coverage;

/* Fills the mask of rows row0 to row1 - 1 for a snapshot; other rows are not valid. Memory is kept
 * and grows as needed. `rays`: approximate number of rays per pixel, at least 1, which decides how
 * much work a tighter mask is worth. The result is the same for any number of threads. */
pl_status pl_coverage_update(pl_coverage *coverage, const pl_snapshot *shot, int row0, int row1,
                             int rays, int threads);
void pl_coverage_clear(pl_coverage *coverage);

/* An update, as the rows of kinds of geometry see it. */
typedef struct pl_coverage_job {
  const pl_coverage *coverage;
  const pl_snapshot *shot;
  int rays;
  size_t slices;  /* of each surface */
  int row0, row1; /* first and last row of the image to fill */
} pl_coverage_job;

/* Marks the pixels of one slice of the boxes of an object, and of its pieces. */
void pl_coverage_object(const pl_coverage_job *job, pl_surface_id id, size_t slice);
/* Marks the blocks of pixels in which a sphere may be visible. */
void pl_coverage_sphere(const pl_coverage_job *job, pl_vec3 center, double radius_m);

static inline bool pl_coverage_pixel(const pl_coverage *coverage, int x, int y) {
  return atomic_load_explicit(&coverage->pixels[(size_t)y * (size_t)coverage->width + (size_t)x],
                              memory_order_relaxed) != 0;
}

#endif
