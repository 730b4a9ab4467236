/* Size-frequency laws of craters, and the ages that belong to them. */
#ifndef PL_TERRAIN_CRATER_SIZES_H
#define PL_TERRAIN_CRATER_SIZES_H

#include "terrain/size_points.h"

typedef enum pl_crater_law_kind {
  PL_CRATERS_NEUKUM_1983,
  PL_CRATERS_NEUKUM_2001,
  PL_CRATERS_TRASK,
  PL_CRATERS_HARTMANN_1984,
  PL_CRATERS_VIPER,
  PL_CRATERS_NEUKUM_EQUILIBRIUM,
  PL_CRATERS_POWER,
  PL_CRATERS_TABLE,
  PL_CRATER_LAWS
} pl_crater_law_kind;

typedef struct pl_crater_law {
  pl_crater_law_kind kind;
  double surface_age_ga;        /* (0, 4.5]: no crater is older; production grows with it */
  double factor;                /* multiplies the density; 0 or more */
  double coefficient, exponent; /* power: coefficient D^exponent per m^2 with D in m */
  pl_size_points table;
} pl_crater_law;

typedef struct pl_crater_law_row {
  const char *name, *doc;
  double (*density)(const pl_crater_law *law, double diameter_m); /* without the factor */
} pl_crater_law_row;
extern const pl_crater_law_row pl_crater_laws[PL_CRATER_LAWS];

/* Returns PL_E_RANGE if the law's numbers are not valid, or do not cover the diameters. */
pl_status pl_crater_law_check(const pl_crater_law *law, double min_m, double max_m);

/* Number of craters of diameter_m or more per m^2: a pl_size_density_fn of a valid law. */
double pl_crater_density(const void *law, double diameter_m);

/* Density of craters of 1 km or more (per m^2) that a surface gathers in age_ga: the lunar
 * chronology of Neukum et al. (2001); and its inverse. */
double pl_crater_chronology(double age_ga);
double pl_crater_chronology_age_ga(double density_1km);

/* Greatest age (Ga) of craters of a size: the time that production needs to reach the law's
 * density, at most that of the surface. Where the law is in equilibrium, older craters are gone. */
double pl_crater_oldest_ga(const pl_crater_law *law, double diameter_m);

#endif
