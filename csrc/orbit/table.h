/* The propagator `table`: states interpolated between rows. */
#ifndef PL_ORBIT_TABLE_H
#define PL_ORBIT_TABLE_H

#include <stdbool.h>

#include "orbit/propagator.h"

extern const pl_propagator_kind pl_table_kind;

#define PL_TABLE_MAX_DEGREE 25

/* Rows of a table; borrowed, and copied by pl_table_create. */
typedef struct pl_table_rows {
  size_t count;
  const double *t_s;    /* after the epoch; each later than the one before */
  const double *values; /* rows of 6 (place m, velocity m/s) or 3 (place), ICRF axes */
  bool has_velocities;  /* 6 */
} pl_table_rows;

/* Polynomials of `degree` through the rows about a time: Hermite's through places and velocities
 * ((degree + 1)/2 rows; the degree must be 3, 5, ...), or Lagrange's through the places of degree +
 * 1 rows. Exact at the rows; the path is continuous there. Velocities are the derivatives. Outside
 * the rows' times states are PL_E_RANGE, with a text that names the span. Here PL_E_RANGE for times
 * that do not increase, numbers that are not finite, a degree out of 1 to 25, even or 1 with
 * velocities, or for more rows than there are; PL_E_MEMORY. */
pl_status pl_table_create(const pl_table_rows *rows, int degree, pl_propagator **out);

#endif
