/* A user's table of a cumulative size-frequency law, with power laws between its entries. */
#ifndef PL_TERRAIN_SIZE_POINTS_H
#define PL_TERRAIN_SIZE_POINTS_H

#include <stddef.h>

#include "base/status.h"

/* Densities (per m^2) of items of these diameters (m) or more: diameters rise, densities do not;
 * the last density may be 0. */
typedef struct pl_size_points {
  const double *diameters_m, *densities; /* borrowed */
  size_t count;
} pl_size_points;

/* PL_E_RANGE if the table is not valid or does not cover the diameters; `noun` names them. */
pl_status pl_size_points_check(const pl_size_points *points, const char *noun, double min_m,
                               double max_m);

/* PL_E_RANGE unless coefficient D^exponent per m^2 is a cumulative law. */
pl_status pl_size_power_check(const char *noun, double coefficient, double exponent);

/* Density of items of diameter_m or more (per m^2), of a valid table. */
double pl_size_points_density(const pl_size_points *points, double diameter_m);

/* Makes the table's arrays copies of themselves, in one block that is freed with pl_free. */
pl_status pl_size_points_copy(pl_size_points *points, double **block);

#endif
