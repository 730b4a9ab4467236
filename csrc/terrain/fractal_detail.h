/* Fractal detail of a ground: octaves of noise, interpolated by cubic B-splines, which have
 * continuous curvature and so leave no creases.
 *
 * An octave is a cubic lattice of numbers in space, cut by the sphere of directions: it has no
 * poles, faces or seams. Octaves are turned by random rotations, so that no lattice is aligned with
 * another, or with the surface at some special place, and their sum is the same in all directions.
 * Its numbers are uniform, a hash of (seed, level, cell); heights, weighted sums of 64 of them, are
 * nearly normal. The cells of level k are as wide as those of level k of the cube
 * (`terrain/cube.h`). A value depends on the direction and the levels alone: the same bits alone or
 * in any block. */
#ifndef PL_TERRAIN_FRACTAL_DETAIL_H
#define PL_TERRAIN_FRACTAL_DETAIL_H

#include "terrain/detail_law.h"

/* No sum of octaves is beyond this many of its standard deviations: it is cut off there. Sums of
 * uniform numbers exceed it less often than normal ones do, twice in 1e9 independent places. */
#define PL_DETAIL_BOUND 6.0
/* Octaves at least this many levels coarser than the nodes are summed in double. */
#define PL_DETAIL_NEAR 4

typedef struct pl_fractal_detail {
  int first, last; /* levels with an octave; last < first if there is none */
  double sigma_m[PL_CUBE_LEVELS];
  uint32_t key[PL_CUBE_LEVELS];
  pl_vec3 axes[PL_CUBE_LEVELS][3]; /* of the lattice, of the length of a radius in cells */
} pl_fractal_detail;

/* `detail` must pass pl_terrain_detail_check. */
void pl_fractal_detail_init(const pl_terrain_detail *detail, double radius_m,
                            pl_fractal_detail *out);

/* Unit directions; pl_detail_strip_close must have been called. */
enum { PL_DETAIL_STRIP = 64, PL_DETAIL_LANES = 8 };
typedef struct pl_detail_strip {
  size_t count; /* at most PL_DETAIL_STRIP */
  double x[PL_DETAIL_STRIP], y[PL_DETAIL_STRIP], z[PL_DETAIL_STRIP];
} pl_detail_strip;

/* Returns the count rounded up to whole vectors. */
static inline size_t pl_detail_strip_lanes(const pl_detail_strip *strip) {
  return (strip->count + PL_DETAIL_LANES - 1) / PL_DETAIL_LANES * PL_DETAIL_LANES;
}
/* Fills the last vector with copies of the last direction. */
static inline void pl_detail_strip_close(pl_detail_strip *strip) {
  for (size_t k = strip->count; k > 0 && k < pl_detail_strip_lanes(strip); k++) {
    strip->x[k] = strip->x[k - 1];
    strip->y[k] = strip->y[k - 1];
    strip->z[k] = strip->z[k - 1];
  }
}

/* Numbers of cells that were asked before: nodes of a block share them. */
enum { PL_DETAIL_CELLS = 128 };
typedef struct pl_detail_cell {
  int32_t octave; /* -1 for none */
  uint32_t x, y, z;
} pl_detail_cell;
typedef struct pl_detail_cache {
  pl_detail_cell cells[PL_DETAIL_CELLS];
  double numbers[PL_DETAIL_CELLS][64];
} pl_detail_cache;
void pl_detail_cache_init(pl_detail_cache *cache);

/* Adds one octave, as seen by nodes of `level`. */
void pl_fractal_detail_add(const pl_fractal_detail *detail, const pl_detail_strip *strip,
                           int octave, int level, pl_detail_cache *cache, double *sums_m);
/* Returns the standard deviation of the sum of the octaves from `coarsest` to `level`. */
double pl_fractal_detail_deviation_m(const pl_fractal_detail *detail, int coarsest, int level);
/* Cuts off a sum at a bound: PL_DETAIL_BOUND of these. */
static inline double pl_fractal_detail_cut(double sum_m, double bound_m) {
  return sum_m > bound_m ? bound_m : sum_m < -bound_m ? -bound_m : sum_m;
}
/* Returns the gradient of one octave, rise in m by distance in units of the radius; it is not along
 * the ground, but has a part along `direction`. */
pl_vec3 pl_fractal_detail_octave_gradient(const pl_fractal_detail *detail, pl_vec3 direction,
                                          int octave);
/* Returns the variance of an octave's slopes along any one axis, rise over distance, on a body of
 * the radius; its mean over places. */
double pl_fractal_detail_slope_variance(const pl_fractal_detail *detail, int octave,
                                        double radius_m);

#endif
