#include "terrain/size_table.h"

#include <math.h>

#include "base/memory.h"

enum { KNOTS_PER_OCTAVE = 32 };

struct pl_size_table {
  size_t count;
  double min_m, max_m, step; /* knots lie at min_m exp(k step) */
  double *densities, *logs;  /* logs: of densities, -inf for none; logs is behind densities */
};

pl_status pl_size_table_create(pl_size_density_fn density, const void *law, double min_m,
                               double max_m, pl_size_table **out) {
  *out = NULL;
  if (!(min_m > 0.0 && max_m > min_m && isfinite(max_m)))
    return pl_fail(PL_E_RANGE, "sizes from %g to %g m; need 0 < least < greatest", min_m, max_m);
  const double octaves = log2(max_m / min_m);
  const size_t count = (size_t)ceil(octaves * KNOTS_PER_OCTAVE) + 1;
  pl_size_table *table = pl_alloc(1, sizeof *table);
  double *numbers = pl_alloc(2 * count, sizeof *numbers);
  if (table == NULL || numbers == NULL) {
    pl_free(table);
    pl_free(numbers);
    return pl_fail(PL_E_MEMORY, "out of memory for a table of sizes");
  }
  *table = (pl_size_table){count,   min_m,          max_m, log(max_m / min_m) / (double)(count - 1),
                           numbers, numbers + count};
  double before = INFINITY;
  for (size_t k = 0; k < count; k++) {
    const double d = k + 1 < count ? min_m * exp((double)k * table->step) : max_m;
    const double n = density(law, d);
    if (!(n >= 0.0 && isfinite(n) && n <= before * (1.0 + 1e-12))) {
      pl_size_table_destroy(table);
      return pl_fail(PL_E_RANGE,
                     "density %g per m^2 of things of %g m or more; must be finite, 0 or more, and "
                     "not grow with size",
                     n, d);
    }
    numbers[k] = before = fmin(n, before);
    numbers[count + k] = log(numbers[k]);
  }
  *out = table;
  return PL_OK;
}

void pl_size_table_destroy(pl_size_table *table) {
  if (table == NULL)
    return;
  pl_free(table->densities);
  pl_free(table);
}

double pl_size_table_density(const pl_size_table *table, double diameter_m) {
  if (!(diameter_m > table->min_m))
    return table->densities[0];
  const double at = log(diameter_m / table->min_m) / table->step;
  if (at >= (double)(table->count - 1))
    return table->densities[table->count - 1];
  const size_t k = (size_t)at;
  const double f = at - (double)k, a = table->densities[k], b = table->densities[k + 1];
  if (b <= 0.0)
    return a + f * (b - a);
  return exp(table->logs[k] + f * (table->logs[k + 1] - table->logs[k]));
}

/* The knot k with densities[k] >= n > densities[k + 1], or the nearest. */
static size_t find(const pl_size_table *table, double n) {
  size_t low = 0, high = table->count - 1;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    if (table->densities[middle] >= n)
      low = middle;
    else
      high = middle;
  }
  return low;
}

double pl_size_table_draw(const pl_size_table *table, double low_m, double high_m, double u) {
  const double most = pl_size_table_density(table, low_m);
  const double n = most - u * (most - pl_size_table_density(table, high_m));
  const size_t k = find(table, n);
  const double a = table->densities[k], b = table->densities[k + 1];
  double f = 0.0;
  if (a > b)
    f = b > 0.0 && n > 0.0 ? (table->logs[k] - log(n)) / (table->logs[k] - table->logs[k + 1])
                           : (a - n) / (a - b);
  const double d = table->min_m * exp(((double)k + fmin(fmax(f, 0.0), 1.0)) * table->step);
  return fmin(fmax(d, low_m), high_m);
}
