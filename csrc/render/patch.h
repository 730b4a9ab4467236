/* Patches: what a pixel sees of one surface, and the light that reached it there by way of others.
 */
#ifndef PL_RENDER_PATCH_H
#define PL_RENDER_PATCH_H

#include <stdbool.h>
#include <math.h>
#include <stdint.h>

#include "trace/tracer.h"

/* Samples that meet more surfaces than these, in one pixel, are on no patch. */
enum { PL_PATCHES = 4, PL_PATCH_NONE = PL_PATCHES };

/* Where a patch is. */
typedef struct pl_spot {
  uint32_t thing, part;
  pl_vec3f point, normal; /* root axes; the point from the middle of the thing, m */
  float range_m;          /* from the camera */
} pl_spot;

typedef struct pl_patch {
  pl_spot spot;                 /* of the first hit */
  uint32_t triangle;            /* that was hit last */
  uint32_t seen;                /* samples that hit it */
  uint32_t wide;                /* of these: went on into a wide lobe */
  uint32_t lit;                 /* of these: were followed */
  pl_vec3f own;                 /* sum over seen of the radiance, but for what is shared */
  pl_vec3f shared;              /* sum over lit of the radiance by light that is shared */
  pl_vec3f weight, lit_weight;  /* sums over wide and over lit of what paths carry on */
  float own_square, lit_square; /* sums of squared luminances, of own and of shared */
} pl_patch;

typedef struct pl_pixel_patches {
  pl_patch patch[PL_PATCHES];
  uint32_t count;
} pl_pixel_patches;

/* Which patch the camera's ray meets: one is added where none fits, and counted as seen.
 * PL_PATCH_NONE if there is no room. `spread` of the pixel's cone. */
uint32_t pl_patch_meet(pl_pixel_patches *patches, const pl_snapshot *shot, const pl_hit *hit,
                       pl_vec3 direction, float spread);

/* How far a smooth surface may leave the plane of a patch, m. */
static inline float pl_spot_depth(const pl_spot *spot, float spread) {
  const float plane_widths = 1.0f; /* of the pixel */
  return plane_widths * spread * spot->range_m;
}

/* Whether two patches may be of one smooth surface: their normals differ by less than 18 degrees.
 */
static inline bool pl_spot_fits(const pl_spot *a, const pl_spot *b, float depth_m) {
  const float cosine_min = 0.95f;
  return a->thing == b->thing && a->part == b->part &&
         pl_vec3f_dot(a->normal, b->normal) > cosine_min &&
         fabsf(pl_vec3f_dot(a->normal, pl_vec3f_sub(b->point, a->point))) < depth_m;
}

#endif
