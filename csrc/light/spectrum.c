/* Integrals over wavelength of sunlight, reflectances and band responses. */
#include "light/spectrum.h"

#include <math.h>

#include "light/reflectance_table.h"

static const double SHORTEST_UM = 0.01, LONGEST_UM = 1000.0, SHORTEST_STEP_UM = 1e-5;

/* --- curves */

/* Fails with PL_E_RANGE and names the point (from 0) that is not finite, out of order or outside
 * 0.01 to 1000 um, or if there are fewer than two points. */
static pl_status check_curve(const pl_curve *curve) {
  if (curve->count < 2)
    return pl_fail(PL_E_RANGE, "a curve needs at least two points, not %zu", curve->count);
  for (size_t i = 0; i < curve->count; i++) {
    const double um = curve->points[i][0];
    if (!(um >= SHORTEST_UM && um <= LONGEST_UM))
      return pl_fail(PL_E_RANGE, "point %zu: wavelength %g um is not in %g..%g", i, um, SHORTEST_UM,
                     LONGEST_UM);
    if (!isfinite(curve->points[i][1]))
      return pl_fail(PL_E_RANGE, "point %zu: the value is not finite", i);
    if (i > 0 && !(um > curve->points[i - 1][0]))
      return pl_fail(PL_E_RANGE, "point %zu: wavelength %g um does not rise", i, um);
  }
  return PL_OK;
}

static double first_of(const pl_curve *curve) { return curve->points[0][0]; }
static double last_of(const pl_curve *curve) { return curve->points[curve->count - 1][0]; }

/* Number of points at or below a wavelength. */
static size_t points_below(const pl_curve *curve, double um) {
  size_t low = 0, high = curve->count;
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (curve->points[middle][0] <= um)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static double value_at(const pl_curve *curve, double um) {
  const size_t next = points_below(curve, um);
  if (next == 0 || um > last_of(curve))
    return 0.0;
  if (next == curve->count)
    return curve->points[next - 1][1];
  const double *a = curve->points[next - 1], *b = curve->points[next];
  return a[1] + (b[1] - a[1]) * (um - a[0]) / (b[0] - a[0]);
}

/* --- the default sun */

static const double SUN_K = 5850.0, SUN_BLANKETED = 0.7, SUN_EDGE_UM = 0.4;
static const double C2_UM_K = 14387.768775; /* second radiation constant, CODATA 2018 */
static const double PI = 3.14159265358979323846;

/* Fraction of the irradiance per um: Planck's law over its integral pi^4 / 15. */
static double black_body(double um) {
  const double x = C2_UM_K / (um * SUN_K);
  return 15.0 / (PI * PI * PI * PI) * x * x * x * x / (um * expm1(x));
}

/* Fraction of a black body's light below SUN_EDGE_UM, by the series of the integral of x^3 / (e^x -
 * 1) from x to infinity (Abramowitz and Stegun 27.1.2), whose 12th term is 1e-32. */
static double below_edge(void) {
  const double x = C2_UM_K / (SUN_EDGE_UM * SUN_K);
  double sum = 0.0;
  for (int n = 1; n <= 12; n++) {
    const double k = 1.0 / n;
    sum += exp(-n * x) * k * (x * x * x + k * (3.0 * x * x + k * (6.0 * x + k * 6.0)));
  }
  return 15.0 / (PI * PI * PI * PI) * sum;
}

static double curve_total(const pl_curve *curve) {
  double sum = 0.0;
  for (size_t i = 1; i < curve->count; i++) {
    const double *a = curve->points[i - 1], *b = curve->points[i];
    sum += 0.5 * (a[1] + b[1]) * (b[0] - a[0]);
  }
  return sum;
}

/* --- reflectances */

void pl_reflectance_weights(double um, double weights[3]) {
  const double place = fmin(fmax((um - TABLE_FIRST_UM) / TABLE_STEP_UM, 0.0), TABLE_ROWS - 1.0);
  const int row = place < TABLE_ROWS - 2.0 ? (int)place : TABLE_ROWS - 2;
  const double t = place - row;
  for (int c = 0; c < 2; c++)
    weights[c] = reflectance_table[row][c] * (1.0 - t) + reflectance_table[row + 1][c] * t;
  weights[2] =
      fmax(0.0, 1.0 - weights[0] - weights[1]); /* may be -1e-12 by rounding of the table */
}

/* --- integrals */

typedef struct integral {
  const pl_curve *sun;
  double sun_scale;
  const pl_curve *responses;
  size_t count;
  double step_um;
} integral;

/* End of the next piece: the next node of any curve, or the longest step. */
static double piece_end(const integral *in, double um, double last) {
  double end = fmin(last, um + in->step_um);
  for (size_t i = 0; i < in->count; i++) {
    const size_t next = points_below(&in->responses[i], um);
    if (next < in->responses[i].count)
      end = fmin(end, in->responses[i].points[next][0]);
  }
  if (in->sun != NULL) {
    const size_t next = points_below(in->sun, um);
    end = next < in->sun->count ? fmin(end, in->sun->points[next][0]) : end;
  } else if (um < SUN_EDGE_UM) {
    end = fmin(end, SUN_EDGE_UM);
  }
  for (int row = 0; row < TABLE_ROWS; row++) {
    const double at = TABLE_FIRST_UM + row * TABLE_STEP_UM;
    if (at > um)
      return fmin(end, at);
  }
  return end;
}

static void add_piece(const integral *in, double from, double to, pl_band_light *out) {
  /* Abramowitz and Stegun, table 25.4, n = 4 */
  static const double nodes[2] = {0.339981043584856, 0.861136311594053};
  static const double weights[2] = {0.652145154862546, 0.347854845137454};
  const double half = 0.5 * (to - from), middle = 0.5 * (from + to);
  for (int i = 0; i < 4; i++) {
    const double um = middle + (i % 2 == 0 ? -half : half) * nodes[i / 2];
    double light = in->sun != NULL
                       ? in->sun_scale * value_at(in->sun, um)
                       : in->sun_scale * black_body(um) * (to <= SUN_EDGE_UM ? SUN_BLANKETED : 1.0);
    double basis[3];
    for (size_t k = 0; k < in->count; k++)
      light *= value_at(&in->responses[k], um);
    light *= half * weights[i / 2];
    pl_reflectance_weights(um, basis);
    for (int c = 0; c < 3; c++) {
      out->part[c] += light * basis[c];
      out->moment_um[c] += light * basis[c] * um;
    }
  }
}

static pl_status check_sun(const pl_curve *sun, const pl_curve *response) {
  PL_TRY(check_curve(sun));
  for (size_t i = 0; i < sun->count; i++)
    if (sun->points[i][1] < 0.0)
      return pl_fail(PL_E_RANGE, "point %zu of the sun's spectrum is negative", i);
  if (!(curve_total(sun) > 0.0 && isfinite(curve_total(sun))))
    return pl_fail(PL_E_RANGE, "the sun's spectrum must hold some light, and not without end");
  if (first_of(response) < first_of(sun) || last_of(response) > last_of(sun))
    return pl_fail(PL_E_RANGE, "the band, %g to %g um, reaches beyond the sun's spectrum, %g to %g",
                   first_of(response), last_of(response), first_of(sun), last_of(sun));
  return PL_OK;
}

pl_status pl_band_gather(const pl_curve *sun, const pl_curve *responses, size_t count,
                         double step_um, pl_band_light *out) {
  *out = (pl_band_light){{0.0}, 0.0, {0.0}};
  if (count == 0 || !(step_um >= SHORTEST_STEP_UM))
    return pl_fail(PL_E_ARGUMENT, "a band needs a response, and steps of %g um or more",
                   SHORTEST_STEP_UM);
  double um = SHORTEST_UM, last = LONGEST_UM;
  for (size_t i = 0; i < count; i++) {
    PL_TRY(check_curve(&responses[i]));
    um = fmax(um, first_of(&responses[i]));
    last = fmin(last, last_of(&responses[i]));
  }
  if (sun != NULL)
    PL_TRY(check_sun(sun, &responses[0]));
  const double total = sun != NULL ? curve_total(sun) : 1.0 - (1.0 - SUN_BLANKETED) * below_edge();
  const integral in = {sun, 1.0 / total, responses, count, step_um};
  while (um < last) {
    const double end = piece_end(&in, um, last);
    add_piece(&in, um, end, out);
    um = end;
  }
  const double all = out->part[0] + out->part[1] + out->part[2];
  const double moment = out->moment_um[0] + out->moment_um[1] + out->moment_um[2];
  out->mean_um = all != 0.0 ? moment / all : 0.0;
  return PL_OK;
}
