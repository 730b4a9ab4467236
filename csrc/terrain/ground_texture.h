/* Textures of the ground: images of a small sample of it, of heights, roughness and albedo, laid
 * all over a body without seams, and without a visible repeat.
 *
 * Ground is covered by overlapping patches, one about each node of triangular lattices on the faces
 * of the cube: a part of the image about a random point of it, turned at random. Where patches
 * overlap, deviations from the mean are summed with weights whose squares sum to 1, so that
 * mean and variance stay (Heitz and Neyret 2018, without their transform of histograms). Patches
 * lie within the image, which so needs no edges that fit. */
#ifndef PL_TERRAIN_GROUND_TEXTURE_H
#define PL_TERRAIN_GROUND_TEXTURE_H

#include <stdint.h>

#include "terrain/raster.h"

enum { PL_GROUND_TEXTURES = 4, PL_GROUND_TEXTURE_LEVELS = 32 };

typedef struct pl_ground_texture {
  /* Borrowed; NULL: none. Their places on a body do not count. Heights in m, of which deviations
   * from the mean are laid; factors on Hapke's roughness and on the albedo. */
  const pl_raster *heights, *roughness, *albedo;
  double size_m; /* width of the images on the ground */
  uint64_t seed;
  /* By pl_ground_texture_init: variance of slopes of laid heights along any one axis, filtered to
   * cells of 2^level texels. */
  double slopes[PL_GROUND_TEXTURE_LEVELS];
  double means[3]; /* of images, as patches have them: the middle counts more than edges */
} pl_ground_texture;

/* Checks and completes a texture for a body; PL_E_RANGE with a text that names what is wrong. */
pl_status pl_ground_texture_init(pl_ground_texture *texture, double radius_m);

typedef enum pl_ground_texture_kind {
  PL_GROUND_HEIGHTS,
  PL_GROUND_ROUGHNESS,
  PL_GROUND_ALBEDO
} pl_ground_texture_kind;

/* Returns the value in a unit direction, as a mean over a footprint (m): of heights the deviation
 * from their mean, of others at least 0; 0 and 1 without such an image. */
double pl_ground_texture_at(const pl_ground_texture *texture, pl_ground_texture_kind kind,
                            double radius_m, pl_vec3 direction, double footprint_m);
/* Adds the heights in directions, each as pl_ground_texture_at: cheaper where they are neighbours.
 */
void pl_ground_texture_add_heights(const pl_ground_texture *texture, double radius_m,
                                   const pl_vec3 *directions, size_t count, double footprint_m,
                                   double *heights_m);
/* Returns the slope of the heights over a footprint, less that over a wider one (INFINITY: less
 * nothing): a vector along the ground in body axes. */
pl_vec3 pl_ground_texture_slope(const pl_ground_texture *texture, double radius_m,
                                pl_vec3 direction, double footprint_m, double without_m);
/* Whether slopes of heights over a footprint are not 0. */
bool pl_ground_texture_shows(const pl_ground_texture *texture, double footprint_m);
/* Returns the variance of slopes along any one axis of heights over a footprint. */
double pl_ground_texture_variance(const pl_ground_texture *texture, double footprint_m);
/* Writes a bound of the deviations of heights from 0. */
double pl_ground_texture_bound_m(const pl_ground_texture *texture);
/* Returns a bound of the factor on the albedo, at least 1. */
double pl_ground_texture_brightest(const pl_ground_texture *texture);
/* Returns the width of a texel of the heights, m; INFINITY without. */
double pl_ground_texture_texel_m(const pl_ground_texture *texture);

#endif
