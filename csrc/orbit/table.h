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
  const double *t_s;    /* after the epoch; increasing */
  const double *values; /* rows of 6 (position m, velocity m/s) or 3 (position), ICRF axes */
  bool has_velocities;  /* true for rows of 6 */
} pl_table_rows;

/* Creates a propagator that interpolates with polynomials of `degree` through the rows around a
 * time: Hermite polynomials through positions and velocities ((degree + 1)/2 rows; the degree must
 * be 3, 5, ...), or Lagrange polynomials through the positions of degree + 1 rows. The rows are
 * reproduced exactly and the path is continuous there. Velocities are the derivatives. States
 * outside the rows' times fail with PL_E_RANGE, with the time span in the message. Creation fails
 * with PL_E_RANGE for times that do not increase, numbers that are not finite, a degree outside 1
 * to 25, an even degree or 1 with velocities, or a degree that needs more rows than there are; with
 * PL_E_MEMORY. */
pl_status pl_table_create(const pl_table_rows *rows, int degree, pl_propagator **out);

#endif
