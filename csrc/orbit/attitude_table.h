/* Attitudes interpolated between the rows of a table. */
#ifndef PL_ORBIT_ATTITUDE_TABLE_H
#define PL_ORBIT_ATTITUDE_TABLE_H

#include <stddef.h>

#include "base/status.h"
#include "math/rotation.h"

/* Rows of a table; borrowed. */
typedef struct pl_attitude_table {
  size_t count;
  const double *t_s; /* increasing */
  const pl_quat *q;  /* need not be unit; either sign */
} pl_attitude_table;

/* Fails with PL_E_RANGE and names the row if times do not increase or a quaternion is invalid; also
 * fails without rows. */
pl_status pl_attitude_table_check(const pl_attitude_table *table);

/* Interpolates by slerp along the shorter arc: the rate is constant between two rows, and the rows
 * are reproduced exactly. Fails with PL_E_RANGE outside the rows' times, with the time span in the
 * message. */
pl_status pl_attitude_table_at(const pl_attitude_table *table, double t_s, pl_quat *out);

#endif
