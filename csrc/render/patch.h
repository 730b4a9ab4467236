/* Patches: the part of one surface that a pixel sees, and the indirect light that reached it. */
#ifndef PL_RENDER_PATCH_H
#define PL_RENDER_PATCH_H

#include <stdbool.h>
#include <math.h>
#include <stdint.h>

#include "trace/tracer.h"

/* If the samples of one pixel hit more surfaces than this, those on the others have no patch. */
enum { PL_PATCHES = 4, PL_PATCH_NONE = PL_PATCHES };

/* The location of a patch. */
typedef struct pl_spot {
  pl_surface_id surface_id;
  uint32_t part;
  /* root axes; the point is relative to the centre of the object or body, m */
  pl_vec3f point, normal;
  float range_m; /* distance from the camera, m */
} pl_spot;

typedef struct pl_patch {
  pl_spot spot;                 /* location of the first hit */
  uint32_t triangle;            /* triangle of the latest hit */
  uint32_t seen;                /* number of samples that hit it */
  uint32_t wide;                /* of these, continued into a wide lobe */
  uint32_t lit;                 /* of these, followed */
  pl_vec3f own;                 /* sum over `seen` of the radiance without filtered light */
  pl_vec3f filtered;            /* sum over `lit` of the radiance of filtered light */
  pl_vec3f weight, lit_weight;  /* sums of the paths' throughput over `wide` and over `lit` */
  float own_square, lit_square; /* sums of squared luminances, of own and of filtered */
} pl_patch;

typedef struct pl_pixel_patches {
  pl_patch patch[PL_PATCHES];
  uint32_t count;
} pl_pixel_patches;

/* The index of the patch that a camera ray hits, counted in `seen`. Appends a patch if none fits;
 * PL_PATCH_NONE if there is no room. `spread`: that of the pixel's cone. */
uint32_t pl_patch_meet(pl_pixel_patches *patches, const pl_snapshot *shot, const pl_hit *hit,
                       pl_vec3 direction, float spread);

/* Maximum distance of a smooth surface from the plane of a patch, m. */
static inline float pl_spot_depth(const pl_spot *spot, float spread) {
  const float plane_widths = 1.0f; /* widths of the pixel's footprint */
  return plane_widths * spread * spot->range_m;
}

/* Whether two patches may belong to one smooth surface: their normals differ by less than 18
 * degrees. */
static inline bool pl_spot_fits(const pl_spot *a, const pl_spot *b, float depth_m) {
  const float cosine_min = 0.95f;
  return pl_surface_same(a->surface_id, b->surface_id) && a->part == b->part &&
         pl_vec3f_dot(a->normal, b->normal) > cosine_min &&
         fabsf(pl_vec3f_dot(a->normal, pl_vec3f_sub(b->point, a->point))) < depth_m;
}

#endif
