/* Where the silhouette of an object can lie, and whether what is seen of it is all of it: known
 * before any ray is cast. */
#ifndef PL_ANNOTATE_OUTLINE_H
#define PL_ANNOTATE_OUTLINE_H

#include <stdbool.h>

#include "annotate/clusters.h"
#include "scene/snapshot.h"

/* Pixels, inclusive; x0 > x1 when empty. */
typedef struct pl_rect {
  int x0, y0, x1, y1;
} pl_rect;

/* Of an object, or of a piece of an articulated one. */
typedef struct pl_outline pl_outline;
struct pl_outline {
  pl_rect rect;          /* of the canvas, that it may cover */
  const pl_model *model; /* borrowed: whose triangles lie in the clusters */
  pl_vec3 axes[3]; /* of the model in camera axes, m per model unit; not of an articulated object */
  pl_vec3 origin;  /* of the model in camera axes, m */
  double z0_m, z1_m;    /* its depths lie between these */
  double far_m;         /* no point of it is farther from the camera */
  bool whole;           /* its seen pixels are its silhouette */
  pl_clusters clusters; /* none where the bounding box alone shows that it is whole */
  pl_outline *pieces;   /* of an articulated object: axes, origin and clusters are theirs */
  size_t piece_count;
};

/* Outlines that pl_outline_build writes: one an object, then one a piece. */
size_t pl_outline_count(const pl_snapshot *shot);
/* The outlines whose clusters together hold an object: its pieces, or itself. */
static inline const pl_outline *pl_outline_pieces(const pl_outline *outline, size_t *count) {
  *count = outline->pieces != NULL ? outline->piece_count : 1;
  return outline->pieces != NULL ? outline->pieces : outline;
}

/* The canvas is the image with one image size of margin on each side (BOP). An object is whole when
 * the projected boxes of its triangles lie inside the image, and no other object whose box begins
 * nearer than this one's ends projects on the same pixels, and no body whose bounding sphere begins
 * nearer than this one's farthest corner stands in the cone of its own: then neither the image's
 * border nor another thing can take a pixel. One that projects nowhere on the canvas is whole too.
 */
pl_status pl_outline_build(const pl_snapshot *shot, pl_cluster_cache *cache, pl_outline *outlines);

/* The pixels that a box in model units may cover on the canvas. Holds around the camera. */
pl_rect pl_outline_project(const pl_outline *outline, const pl_camera *camera, const float *low,
                           const float *high);
/* Whether all of the box lies before the camera. */
bool pl_outline_before(const pl_outline *outline, const float *low, const float *high);

#endif
