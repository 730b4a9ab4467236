/* The law of a ground's roughness, and octaves that have it. */
#include "terrain/detail_law.h"

#include <math.h>

pl_terrain_detail pl_terrain_detail_default(double radius_m) {
  return (pl_terrain_detail){
      .on = true,
      .baseline_m = 17.0,
      .deviation_m = 1.900860716,
      .range_count = 5,
      .ranges = {{0.0, 0.85}, {0.1, 0.95}, {1e3, 0.86}, {8e3, 0.6}, {2.5e4, 0.22}},
      .strength = 1.0,
      .longest_m = pl_cube_cell_m(2, radius_m),
      .finest_m = 0.01,
  };
}

static bool positive(double value) { return isfinite(value) && value > 0.0; }

pl_status pl_terrain_detail_check(const pl_terrain_detail *detail) {
  if (!(detail->method < PL_DETAIL_METHOD_COUNT))
    return pl_fail(PL_E_ARGUMENT, "detail: method %d is none", (int)detail->method);
  if (!positive(detail->baseline_m))
    return pl_fail(PL_E_RANGE, "detail: baseline_m must be above 0, not %g", detail->baseline_m);
  if (!positive(detail->deviation_m) && detail->deviation_m != 0.0)
    return pl_fail(PL_E_RANGE, "detail: deviation_m must be at least 0, not %g",
                   detail->deviation_m);
  if (!positive(detail->strength) && detail->strength != 0.0)
    return pl_fail(PL_E_RANGE, "detail: strength must be at least 0, not %g", detail->strength);
  if (!positive(detail->finest_m) || !isfinite(detail->longest_m) ||
      detail->longest_m < detail->finest_m)
    return pl_fail(PL_E_RANGE,
                   "detail: finest_m must be above 0 and at most longest_m, not %g and %g",
                   detail->finest_m, detail->longest_m);
  if (detail->range_count < 1 || detail->range_count > PL_DETAIL_RANGES)
    return pl_fail(PL_E_RANGE, "detail: there must be 1 to %d ranges of Hurst exponents, not %zu",
                   PL_DETAIL_RANGES, detail->range_count);
  for (size_t k = 0; k < detail->range_count; k++) {
    const pl_detail_range *range = &detail->ranges[k];
    if (!(range->hurst >= 0.0 && range->hurst <= 1.0))
      return pl_fail(PL_E_RANGE, "detail: Hurst exponents must be in [0, 1], not %g", range->hurst);
    if (k == 0 ? range->from_m != 0.0
               : !isfinite(range->from_m) || !(range->from_m > detail->ranges[k - 1].from_m))
      return pl_fail(
          PL_E_RANGE,
          "detail: ranges of Hurst exponents must begin at 0 m and ascend, not %g at %zu",
          range->from_m, k);
  }
  return PL_OK;
}

/* log nu(L) up to a constant: the integral of H over log L, from 1 m. */
static double log_law(const pl_terrain_detail *detail, double baseline_m) {
  double sum = 0.0;
  const double from = fmin(baseline_m, 1.0), to = fmax(baseline_m, 1.0);
  for (size_t k = 0; k < detail->range_count; k++) {
    const double low = fmax(from, detail->ranges[k].from_m);
    const double high = k + 1 < detail->range_count ? fmin(to, detail->ranges[k + 1].from_m) : to;
    if (high > low)
      sum += detail->ranges[k].hurst * log(high / low);
  }
  return baseline_m < 1.0 ? -sum : sum;
}

double pl_terrain_detail_deviation_m(const pl_terrain_detail *detail, double baseline_m) {
  return detail->deviation_m *
         exp(log_law(detail, baseline_m) - log_law(detail, detail->baseline_m));
}

/* The B-spline of degree 7, the autocorrelation of the cubic one. */
static double spline7(double x) {
  static const double BINOMIAL[9] = {1.0, -8.0, 28.0, -56.0, 70.0, -56.0, 28.0, -8.0, 1.0};
  double sum = 0.0;
  for (int k = 0; k < 9; k++) {
    const double y = 4.0 - fabs(x) - k; /* the far side, where few terms cancel */
    if (y > 0.0)
      sum += BINOMIAL[k] * pow(y, 7.0);
  }
  return sum / 5040.0;
}

/* Lebedev's 26 directions: along axes, edges and diagonals of the lattice. */
double pl_detail_correlation(double cells) {
  const double centre = spline7(0.0);
  const double edge = spline7(cells * sqrt(0.5)) / centre;
  const double diagonal = spline7(cells * sqrt(1.0 / 3.0)) / centre;
  return 6.0 / 21.0 * spline7(cells) / centre + 48.0 / 105.0 * edge * edge +
         72.0 / 280.0 * diagonal * diagonal * diagonal;
}

/* Equations: the sum over octaves of `fraction` times the octave's variance, relative to the wanted
 * nu(L)^2, is 1 at two baselines an octave. */
typedef struct octave_fit {
  int levels, lags;
  double fraction[2 * PL_CUBE_LEVELS][PL_CUBE_LEVELS];
} octave_fit;

static void set_up(const pl_terrain_detail *detail, double radius_m, int first, octave_fit *fit) {
  fit->lags = 2 * fit->levels - 1;
  for (int m = 0; m < fit->lags; m++) {
    const double lag_m = pl_cube_cell_m(first, radius_m) * exp2(-0.5 * m);
    const double wanted = pl_terrain_detail_deviation_m(detail, lag_m);
    for (int k = 0; k < fit->levels; k++) {
      const double rest = 1.0 - pl_detail_correlation(lag_m / pl_cube_cell_m(first + k, radius_m));
      fit->fraction[m][k] = 2.0 * rest / (wanted * wanted);
    }
  }
}

enum { FIT_STEPS = 300 };
static const double SMOOTHING = 0.05; /* weight of the neighbours' mean */

/* One step of the multiplicative algorithm for least squares with variances that are not negative
 * (Daube-Witherspoon and Muehllehner 1986). */
static void improve(const octave_fit *fit, double *variance) {
  double above[PL_CUBE_LEVELS] = {0.0}, below[PL_CUBE_LEVELS] = {0.0};
  for (int m = 0; m < fit->lags; m++) {
    double sum = 0.0;
    for (int k = 0; k < fit->levels; k++)
      sum += fit->fraction[m][k] * variance[k];
    for (int k = 0; k < fit->levels; k++) {
      above[k] += fit->fraction[m][k];
      below[k] += fit->fraction[m][k] * sum;
    }
  }
  for (int k = 0; k < fit->levels; k++)
    variance[k] *= above[k] / below[k];
}

/* Evens the strengths of neighbouring octaves, relative to the law: nu(L) hardly depends on how
 * variance is divided between neighbours, and where H is near 1 or changes, the fit would else put
 * most of it into single octaves. */
static void smooth(const double *law, int levels, double *variance) {
  double logs[PL_CUBE_LEVELS];
  for (int k = 0; k < levels; k++)
    logs[k] = log(fmax(variance[k] / law[k], 1e-12)); /* H = 1 drives all but one to 0 */
  for (int k = 0; k < levels && levels > 1; k++) {
    const double before = k > 0 ? logs[k - 1] : 2.0 * logs[0] - logs[1];
    const double after = k < levels - 1 ? logs[k + 1] : 2.0 * logs[k] - logs[k - 1];
    variance[k] = law[k] * exp((1.0 - SMOOTHING) * logs[k] + SMOOTHING * 0.5 * (before + after));
  }
}

void pl_detail_octaves(const pl_terrain_detail *detail, double radius_m,
                       double sigma_m[PL_CUBE_LEVELS]) {
  for (int k = 0; k < PL_CUBE_LEVELS; k++)
    sigma_m[k] = 0.0;
  if (!detail->on || !(detail->deviation_m * detail->strength > 0.0))
    return;
  octave_fit fit;
  const int first = pl_cube_level(detail->longest_m, radius_m);
  const int last = pl_cube_level(detail->finest_m, radius_m);
  double variance[PL_CUBE_LEVELS], law[PL_CUBE_LEVELS];
  fit.levels = last - first + 1;
  set_up(detail, radius_m, first, &fit);
  for (int k = 0; k < fit.levels; k++) {
    const double cell_m = pl_cube_cell_m(first + k, radius_m);
    law[k] = pow(pl_terrain_detail_deviation_m(detail, cell_m), 2.0);
    variance[k] = 0.1 * law[k];
  }
  for (int step = 0; step < FIT_STEPS; step++) {
    improve(&fit, variance);
    smooth(law, fit.levels, variance);
  }
  for (int k = 0; k < fit.levels; k++)
    sigma_m[first + k] = detail->strength * sqrt(variance[k]);
}
