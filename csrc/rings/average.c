/* Means of opacity and of opacity times albedo over a range of radii. */
#include <string.h>

#include "rings/table.h"

/* Ranges that span fewer intervals than this are summed interval by interval. */
enum { DIRECT = 6 };

/* Index of the interval that contains a radius within the rings. The outer edge belongs to the last
 * interval. */
static size_t find(const pl_rings *rings, double radius_m) {
  size_t low = 0, high = rings->count;
  while (high - low > 1) {
    const size_t middle = (low + high) / 2;
    if (radius_m < rings->edges_m[middle])
      high = middle;
    else
      low = middle;
  }
  return low;
}

static void add(const pl_rings *rings, size_t i, double width, double c, double sum[]) {
  const double held = -expm1(-rings->depth[i] * c) * width;
  sum[0] += held;
  for (size_t k = 0; k < 3; k++)
    sum[1 + k] += held * rings->albedo[3 * i + k];
}

/* Adds whole intervals first..last - 1, interpolated by a cubic through the four nodes around c. */
static void add_table(const pl_rings *rings, size_t first, size_t last, double c, double sum[]) {
  const double u = 2.0 * log2(c);
  const double below = fmin(fmax(floor(u), 0.0), PL_RINGS_NODES + PL_RINGS_FIRST - 3.0);
  const double f = u - below;
  const double weight[4] = {-f * (f - 1.0) * (f - 2.0) / 6.0,
                            (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0,
                            -(f + 1.0) * f * (f - 2.0) / 2.0, (f + 1.0) * f * (f - 1.0) / 6.0};
  const size_t node = (size_t)((int)below - 1 - PL_RINGS_FIRST) * PL_RINGS_VALUES;
  const size_t edge = PL_RINGS_NODES * (size_t)PL_RINGS_VALUES;
  const double *from = rings->sums + first * edge + node, *to = rings->sums + last * edge + node;
  for (size_t k = 0; k < 4; k++)
    for (size_t value = 0; value < PL_RINGS_VALUES; value++)
      sum[value] += weight[k] * (to[4 * k + value] - from[4 * k + value]);
}

pl_rings_mean pl_rings_average(const pl_rings *rings, double low_m, double high_m, double path) {
  const double *edges = rings->edges_m;
  const double low = fmax(low_m, edges[0]), high = fmin(high_m, edges[rings->count]);
  const double c = fmin(path, PL_RINGS_PATH_MAX);
  double sum[PL_RINGS_VALUES] = {0.0}, width = high_m - low_m;
  if (!(low <= high))
    return (pl_rings_mean){0};
  const size_t first = find(rings, low), last = find(rings, high);
  if (!(width > 1e-12 * high_m)) {
    add(rings, first, 1.0, c, sum);
    width = 1.0;
  } else if (last - first < DIRECT) {
    for (size_t i = first; i <= last; i++)
      add(rings, i, fmin(high, edges[i + 1]) - fmax(low, edges[i]), c, sum);
  } else {
    add(rings, first, edges[first + 1] - low, c, sum);
    add_table(rings, first + 1, last, c, sum);
    add(rings, last, high - edges[last], c, sum);
  }
  pl_rings_mean out = {.opacity = fmin(1.0, fmax(0.0, sum[0] / width))};
  for (size_t k = 0; k < 3; k++)
    out.lit[k] = fmin(out.opacity, fmax(0.0, sum[1 + k] / width));
  return out;
}
