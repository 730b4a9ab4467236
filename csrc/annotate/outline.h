/* Bounds where the silhouette of an object can lie, and finds whether all of it is visible, before
 * any ray is cast. */
#ifndef PL_ANNOTATE_OUTLINE_H
#define PL_ANNOTATE_OUTLINE_H

#include <stdbool.h>

#include "annotate/clusters.h"
#include "scene/snapshot.h"

/* Pixels, inclusive; x0 > x1 when empty. */
typedef struct pl_rect {
  int x0, y0, x1, y1;
} pl_rect;

/* Outline of an object, or of a piece of an articulated object. */
typedef struct pl_outline pl_outline;
struct pl_outline {
  pl_rect rect; /* rectangle of the canvas that it may cover */
  /* borrowed: the model whose triangles lie in the clusters; NULL for a body without a shape */
  const pl_model *model;
  /* model axes in camera axes, m per model unit; not set for an articulated object */
  pl_vec3 axes[3];
  pl_vec3 origin;       /* model origin in camera axes, m */
  double z0_m, z1_m;    /* range of its depths */
  double far_m;         /* largest distance of its points from the camera */
  bool whole;           /* its visible pixels are its full silhouette */
  pl_clusters clusters; /* empty where the bounding box alone shows that it is whole */
  pl_outline *pieces;   /* of an articulated object: they have the axes, origin and clusters */
  size_t piece_count;
};

/* Returns the number of outlines that pl_outline_build writes: one per object, then one per
 * piece. */
size_t pl_outline_count(const pl_snapshot *shot);
/* Returns the outlines whose clusters together enclose an object: its pieces, or the outline
 * itself. */
static inline const pl_outline *pl_outline_pieces(const pl_outline *outline, size_t *count) {
  *count = outline->pieces != NULL ? outline->piece_count : 1;
  return outline->pieces != NULL ? outline->pieces : outline;
}

/* The canvas is the image with a margin of one image size on each side (BOP). An object is whole
 * when three conditions hold. The projected boxes of its triangles lie inside the image. No other
 * object projects on the same pixels with a box that begins nearer than the far end of this one. No
 * body intersects the cone of the object's bounding sphere with a bounding sphere that begins
 * nearer than the object's farthest corner. Then neither the border of the image nor another object
 * or body can hide a pixel of it. An object that does not project on the canvas is whole too.
 * Others are searched for by trees (hiders.h), in `arena`. */
pl_status pl_outline_build(const pl_snapshot *shot, pl_cluster_cache *cache, pl_arena *arena,
                           pl_outline *outlines);

/* Outline of a body without a shape: the rectangle of its bounding box. It has no clusters and is
 * never whole. */
pl_outline pl_outline_of_body(const pl_snapshot *shot, const pl_shot_body *body);

/* Returns the rectangle of the canvas that a box in model units may cover. Boxes that enclose the
 * camera are allowed. */
pl_rect pl_outline_project(const pl_outline *outline, const pl_camera *camera, const float *low,
                           const float *high);
/* Returns true if the whole box lies in front of the camera. */
bool pl_outline_before(const pl_outline *outline, const float *low, const float *high);

#endif
