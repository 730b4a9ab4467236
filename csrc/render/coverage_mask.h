/* Coverage mask: the pixels in which a mesh may be visible, from projections of its bounding boxes
 * and, where that pays, of its triangles. */
#ifndef PL_RENDER_COVERAGE_MASK_H
#define PL_RENDER_COVERAGE_MASK_H

#include <stdatomic.h>
#include <stdbool.h>

#include "scene/snapshot.h"

/* What a ray through a pixel may meet. Ground is continuous, of meshes there may be slivers. */
typedef enum pl_coverage_mark {
  PL_COVERED_BY_NONE,
  PL_COVERED_BY_MESH,
  PL_COVERED_BY_GROUND /* and by no other mesh */
} pl_coverage_mark;

typedef struct pl_coverage {
  int width, height;
  atomic_uchar *pixels; /* pl_coverage_mark; owned */
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
/* Marks the blocks of pixels in which a sphere of ground may be visible. */
void pl_coverage_sphere(const pl_coverage_job *job, pl_vec3 center, double radius_m);

static inline pl_coverage_mark pl_coverage_of(const pl_coverage *coverage, int x, int y) {
  return (pl_coverage_mark)atomic_load_explicit(
      &coverage->pixels[(size_t)y * (size_t)coverage->width + (size_t)x], memory_order_relaxed);
}

/* Whether a ray through the pixel may meet any mesh. */
static inline bool pl_coverage_pixel(const pl_coverage *coverage, int x, int y) {
  return pl_coverage_of(coverage, x, y) != PL_COVERED_BY_NONE;
}

#endif
