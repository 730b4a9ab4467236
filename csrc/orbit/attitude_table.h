/* Attitudes interpolated between the rows of a table. */
#ifndef PL_ORBIT_ATTITUDE_TABLE_H
#define PL_ORBIT_ATTITUDE_TABLE_H

#include <stddef.h>

#include "base/status.h"
#include "math/rotation.h"

/* Rows; borrowed. */
typedef struct pl_attitude_table {
  size_t count;
  const double *t_s; /* each later than the one before */
  const pl_quat *q;  /* need not be unit; of either sign */
} pl_attitude_table;

/* PL_E_RANGE, naming the row, for no rows, times that do not increase, bad quaternions. */
pl_status pl_attitude_table_check(const pl_attitude_table *table);

/* By slerp along the shorter arc: a constant rate between two rows, exact at them. PL_E_RANGE
 * outside of the rows' times, with a text that names the span. */
pl_status pl_attitude_table_at(const pl_attitude_table *table, double t_s, pl_quat *out);

#endif
