/* The law of a ground's roughness: the RMS difference of heights over a baseline (the structure
 * function) nu(L), a power L^H whose Hurst exponent H changes with scale; and the strengths of the
 * octaves of noise whose sum has it. */
#ifndef PL_TERRAIN_DETAIL_LAW_H
#define PL_TERRAIN_DETAIL_LAW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "terrain/cube.h"

#define PL_DETAIL_RANGES 8

/* H of the baselines from `from_m` up to the next range. */
typedef struct pl_detail_range {
  double from_m, hurst;
} pl_detail_range;

/* How detail is made below the posts of rasters. */
typedef enum pl_detail_method {
  PL_DETAIL_NOISE, /* terrain/fractal_detail.h; where no raster reaches, it is always this */
  PL_DETAIL_DIAMOND_SQUARE, /* terrain/diamond_square.h */
  PL_DETAIL_METHOD_COUNT
} pl_detail_method;

/* Detail is drawn with wavelengths between about longest_m and finest_m. */
typedef struct pl_terrain_detail {
  bool on;
  pl_detail_method method;
  uint64_t seed;
  double baseline_m, deviation_m; /* nu(baseline_m) = deviation_m fixes the amplitude */
  size_t range_count;             /* 1 to PL_DETAIL_RANGES; the first is from 0, then upwards */
  pl_detail_range ranges[PL_DETAIL_RANGES];
  double strength;            /* factor of all heights */
  double longest_m, finest_m; /* widest and narrowest cells of noise */
} pl_terrain_detail;

/* Returns the highlands of the Moon: nu(17 m) = 1.9 m with H = 0.95 between 0.1 m and 1 km
 * (Rosenburg et al. 2011, table 2); beyond, what leads to the nu(L) of LOLA's model LDEM_4, within
 * 10 % from 8 to 250 km; below 0.1 m 0.85, by which slopes at 1 cm stay near 10 degrees; down to 1
 * cm. */
pl_terrain_detail pl_terrain_detail_default(double radius_m);
/* PL_E_RANGE with a text that names the field. */
pl_status pl_terrain_detail_check(const pl_terrain_detail *detail);
/* Returns nu(L), without `strength`. */
double pl_terrain_detail_deviation_m(const pl_terrain_detail *detail, double baseline_m);

/* Correlation of an octave's heights at a distance in cells, its mean over directions. */
double pl_detail_correlation(double cells);
/* Writes the standard deviation of the octave of each level of the cube, 0 beyond longest_m and
 * finest_m, such that the sum of all has the law's nu(L). Solves a least-squares problem. */
void pl_detail_octaves(const pl_terrain_detail *detail, double radius_m,
                       double sigma_m[PL_CUBE_LEVELS]);

#endif
