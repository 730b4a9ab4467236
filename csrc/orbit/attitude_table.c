/* Spherical linear interpolation (slerp) between the rows of a table. */
#include "orbit/attitude_table.h"

#include "orbit/attitude.h"

pl_status pl_attitude_table_check(const pl_attitude_table *table) {
  if (table->count == 0)
    return pl_fail(PL_E_RANGE, "the table of attitudes has no rows");
  for (size_t i = 0; i < table->count; i++) {
    const double t = table->t_s[i];
    if (!isfinite(t) || (i > 0 && !(t > table->t_s[i - 1])))
      return pl_fail(PL_E_RANGE, "row %zu: t_s is %.17g, but must be finite and increase", i, t);
    if (pl_attitude_check(table->q[i], "") != PL_OK)
      return pl_fail(PL_E_RANGE, "row %zu: the quaternion must be finite and not zero", i);
  }
  return PL_OK;
}

pl_status pl_attitude_table_at(const pl_attitude_table *table, double t_s, pl_quat *out) {
  const double first = table->t_s[0], last = table->t_s[table->count - 1];
  if (!(t_s >= first && t_s <= last))
    return pl_fail(PL_E_RANGE,
                   "%.17g s is outside the table of attitudes, which goes from %.17g to %.17g s",
                   t_s, first, last);
  size_t low = 0, high = table->count - 1;
  while (high > low + 1) {
    const size_t middle = low + (high - low) / 2;
    if (table->t_s[middle] <= t_s)
      low = middle;
    else
      high = middle;
  }
  if (t_s == table->t_s[high])
    low = high;
  const pl_quat a = pl_quat_unit(table->q[low]);
  if (t_s == table->t_s[low]) {
    *out = a;
    return PL_OK;
  }
  const double u = (t_s - table->t_s[low]) / (table->t_s[high] - table->t_s[low]);
  *out = pl_quat_slerp(a, pl_quat_unit(table->q[high]), u);
  return PL_OK;
}
