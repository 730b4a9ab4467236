/* Size-frequency laws of rocks.
 *
 * D is the diameter of a rock seen from above. Golombek and Rapp (1997, JGR 102, 4117) have the
 * fraction of the ground covered by rocks of D or more, F = k exp(-q D), and so the density
 *     N(D) = (4 k q / pi) [exp(-q D) / D - q E1(q D)]   per m^2.
 * Their q(k) = 1.79 + 0.152 / k fits sites with k above 2 %; on the Moon, where k is below 1 %, it
 * leaves no rocks at all: there q must be given. */
#ifndef PL_TERRAIN_ROCK_SIZES_H
#define PL_TERRAIN_ROCK_SIZES_H

#include "terrain/size_points.h"

/* Least k for which q(k) holds. */
#define PL_ROCKS_LEAST_FITTED 0.02

typedef enum pl_rock_law_kind {
  PL_ROCKS_GOLOMBEK,
  PL_ROCKS_CHANGE_3,
  PL_ROCKS_SURVEYOR_1,
  PL_ROCKS_VIPER,
  PL_ROCKS_INTERCRATER,
  PL_ROCKS_HAWORTH,
  PL_ROCKS_POWER,
  PL_ROCKS_TABLE,
  PL_ROCK_LAWS
} pl_rock_law_kind;

typedef struct pl_rock_law {
  pl_rock_law_kind kind;
  double factor;                /* multiplies the density; 0 or more */
  double abundance;             /* golombek: k, (0, 1] */
  double decay_per_m;           /* golombek: q; 0: q(k), for k of 0.02 or more */
  double coefficient, exponent; /* power: coefficient D^exponent per m^2 with D in m */
  /* Density times exp(-D / cutoff_m): old surfaces have few large rocks. 0: none. */
  double cutoff_m;
  pl_size_points table;
} pl_rock_law;

typedef struct pl_rock_law_row {
  const char *name, *doc;
  double (*density)(const pl_rock_law *law, double diameter_m); /* without factor and cutoff */
} pl_rock_law_row;
extern const pl_rock_law_row pl_rock_laws[PL_ROCK_LAWS];

/* Returns PL_E_RANGE if the law's numbers are not valid, or do not cover the diameters. */
pl_status pl_rock_law_check(const pl_rock_law *law, double min_m, double max_m);

/* Number of rocks of diameter_m or more per m^2: a pl_size_density_fn of a valid law. */
double pl_rock_density(const void *law, double diameter_m);

/* Fraction of the ground covered by rocks of min_m to max_m. */
double pl_rock_cover(const pl_rock_law *law, double min_m, double max_m);

/* Upper incomplete gamma function of order -1: exp(-x) / x - E1(x), for x > 0, to 1e-14. */
double pl_rock_gamma(double x);

#endif
