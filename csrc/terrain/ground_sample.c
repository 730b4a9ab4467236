#include "terrain/ground_sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "math/noise.h"
#include "math/philox.h"
#include "math/vec.h"

/* Points along a pixel at which heights are taken. */
enum { POINTS = 2 };
/* Density counts clods of this diameter or more. */
#define COUNTED_M 0.01

static pl_status check_pixels(int pixels) {
  if (pixels >= PL_GROUND_SAMPLE_LEAST && pixels <= PL_GROUND_SAMPLE_MOST)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "pixels: %d; must be %d to %d", pixels, (int)PL_GROUND_SAMPLE_LEAST,
                 (int)PL_GROUND_SAMPLE_MOST);
}

/* --- clods ------------------------------------------------------------------------------------ */

enum { SIDES = 6 };

/* A clod: a pyramid of planes with its top cut off, more or less of a dome, stretched and turned.
 */
typedef struct clod {
  double x, y, radius; /* m */
  double cosine, sine, narrow;
  double along[SIDES][2], steep[SIDES]; /* planes that fall to 0 at a distance of 1 */
  double top, tilt, round;
} clod;

static double between(pl_philox_stream *s, double low, double high) {
  return low + (high - low) * pl_philox_next(s);
}

static double law(const pl_clods *of, double diameter_m) {
  return of->density * pow(diameter_m / COUNTED_M, -of->exponent);
}

double pl_clods_cover(const pl_clods *of) {
  const double b = of->exponent, a = b * law(of, 1.0) * 0.25 * PL_PI;
  if (fabs(b - 2.0) < 1e-9)
    return a * log(of->max_m / of->min_m);
  return a * (pow(of->max_m, 2.0 - b) - pow(of->min_m, 2.0 - b)) / (2.0 - b);
}

/* Draws clod n: its diameter by the law, cut off at both ends. Ratios of height to width scatter
 * for Apollo's small fragments as for rocks; parts below the soil leave 0.15 to 0.4. */
static clod draw(const pl_clods *of, uint64_t n) {
  pl_philox_stream s = {.key = {of->seed ^ UINT64_C(0x636c6f6473), n}};
  const double least = law(of, of->max_m), all = law(of, of->min_m);
  const double fraction = (least + (all - least) * (1.0 - pl_philox_next(&s))) / of->density;
  clod out = {.radius = 0.5 * COUNTED_M * pow(fraction, -1.0 / of->exponent)};
  out.x = of->size_m * pl_philox_next(&s); /* initialisers have no order */
  out.y = of->size_m * pl_philox_next(&s);
  const double turn = 2.0 * PL_PI * pl_philox_next(&s);
  out.cosine = cos(turn);
  out.sine = sin(turn);
  out.narrow = between(&s, 0.6, 1.0);
  for (int k = 0; k < SIDES; k++) {
    const double a = 2.0 * PL_PI / SIDES * (k + between(&s, -0.35, 0.35));
    out.along[k][0] = cos(a);
    out.along[k][1] = sin(a);
    out.steep[k] = between(&s, 0.8, 2.5);
  }
  out.top = between(&s, 0.3, 0.8);
  out.tilt = between(&s, -0.3, 0.3);
  out.round = pl_philox_next(&s);
  return out;
}

/* Height of a clod over the soil at a point; 0 beside it. */
static double height_at(const clod *c, double x, double y) {
  const double dx = (x - c->x) / c->radius, dy = (y - c->y) / c->radius;
  const double u = dx * c->cosine + dy * c->sine, v = (dy * c->cosine - dx * c->sine) / c->narrow;
  double flat = c->top + c->tilt * u;
  for (int k = 0; k < SIDES; k++)
    flat = fmin(flat, c->steep[k] * (1.0 - u * c->along[k][0] - v * c->along[k][1]));
  const double dome = c->top * (1.0 - u * u - v * v);
  return c->radius * fmax((1.0 - c->round) * flat + c->round * fmin(dome, 2.0 * flat), 0.0);
}

/* Puts a clod on the points around it: where clods overlap, the higher one is seen. */
static void put(const pl_clods *of, const clod *c, float *points) {
  const int side = POINTS * of->pixels;
  const double step = of->size_m / side, reach = 1.3 * c->radius;
  const int x0 = (int)fmax(floor((c->x - reach) / step), 0.0);
  const int y0 = (int)fmax(floor((c->y - reach) / step), 0.0);
  const int x1 = (int)fmin(ceil((c->x + reach) / step), side - 1.0);
  const int y1 = (int)fmin(ceil((c->y + reach) / step), side - 1.0);
  for (int j = y0; j <= y1; j++)
    for (int i = x0; i <= x1; i++) {
      float *at = &points[(size_t)j * (size_t)side + (size_t)i];
      *at = fmaxf(*at, (float)height_at(c, (i + 0.5) * step, (j + 0.5) * step));
    }
}

static void gather(int pixels, const float *points, float *out) {
  const size_t side = (size_t)(POINTS * pixels);
  for (size_t j = 0; j < (size_t)pixels; j++)
    for (size_t i = 0; i < (size_t)pixels; i++) {
      float sum = 0.0f;
      for (size_t k = 0; k < POINTS * POINTS; k++)
        sum += points[(j * POINTS + k / POINTS) * side + i * POINTS + k % POINTS];
      out[j * (size_t)pixels + i] = sum / (POINTS * POINTS);
    }
}

static pl_status check_clods(const pl_clods *of) {
  PL_TRY(check_pixels(of->pixels));
  if (!(of->size_m > 0.0 && of->min_m > 0.0 && of->max_m > of->min_m && of->exponent > 0.0 &&
        of->density >= 0.0 && isfinite(of->density)))
    return pl_fail(PL_E_RANGE, "clods: needs 0 < min_diameter_m < max_diameter_m, and a law of "
                               "numbers above 0");
  if (of->max_m > 0.125 * of->size_m)
    return pl_fail(PL_E_RANGE,
                   "max_diameter_m: %g; must be at most an eighth of size_m: patches of a quarter "
                   "of the sample are laid on the ground",
                   of->max_m);
  if (of->density > 0.0 && pl_clods_cover(of) > PL_CLODS_COVER_MOST)
    return pl_fail(PL_E_RANGE, "density_per_m2: clods would cover %.2g of the ground; at most %g",
                   pl_clods_cover(of), PL_CLODS_COVER_MOST);
  const double count = law(of, of->min_m) * of->size_m * of->size_m;
  return count <= PL_CLODS_MOST
             ? PL_OK
             : pl_fail(PL_E_RANGE, "min_diameter_m: %.2g clods in the sample; at most %g", count,
                       PL_CLODS_MOST);
}

pl_status pl_clods_make(const pl_clods *given, float *heights_m) {
  void *points;
  PL_TRY(check_clods(given));
  const size_t side = (size_t)(POINTS * given->pixels);
  PL_TRY(pl_alloc_or_fail(side * side, sizeof(float), "a sample of ground", &points));
  const double each = law(given, given->min_m) - law(given, given->max_m);
  const uint64_t count = (uint64_t)(each * given->size_m * given->size_m + 0.5);
  for (uint64_t n = 0; n < count; n++) {
    const clod c = draw(given, n);
    put(given, &c, points);
  }
  gather(given->pixels, points, heights_m);
  pl_free(points);
  return PL_OK;
}

/* --- mottling --------------------------------------------------------------------------------- */

/* The widest waves are a sixth of the sample: patches of a quarter of it are laid on the ground. */
#define WIDEST 6.0

/* A sum of octaves down to two pixels. */
static float fractal(const pl_mottling *of, double x, double y) {
  const uint32_t seed = (uint32_t)(of->seed ^ of->seed >> 32);
  const double turn = exp2(-of->hurst);
  double sum = 0.0, amplitude = 1.0, frequency = WIDEST;
  for (uint32_t k = 0; frequency <= 0.5 * of->pixels; k++) {
    const pl_vec3 at = {frequency * x + 17.3 * k, frequency * y - 5.1 * k, 0.37 + 0.71 * k};
    sum += amplitude * (double)pl_noise(at, seed + k);
    amplitude *= turn;
    frequency *= 2.0;
  }
  return (float)sum;
}

static int ascending(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return x < y ? -1 : x > y;
}

/* The value that a fraction of the numbers is above; `sorted` is overwritten. */
static double quantile(const float *values, size_t count, double above, float *sorted) {
  memcpy(sorted, values, count * sizeof *sorted);
  qsort(sorted, count, sizeof *sorted, ascending);
  return (double)sorted[(size_t)((1.0 - above) * (double)(count - 1) + 0.5)];
}

static void take_kinds(size_t count, double middle, double width, float *values) {
  double sum = 0.0;
  for (size_t k = 0; k < count; k++) {
    const double t = fmin(fmax(0.5 + ((double)values[k] - middle) / width, 0.0), 1.0);
    values[k] = (float)(t * t * (3.0 - 2.0 * t));
    sum += (double)values[k];
  }
  for (size_t k = 0; k < count; k++)
    values[k] -= (float)(sum / (double)count);
}

pl_status pl_mottling_make(const pl_mottling *given, float *out) {
  PL_TRY(check_pixels(given->pixels));
  if (!(given->cover > 0.0 && given->cover < 1.0 && given->border > 0.0 &&
        isfinite(given->border) && given->hurst >= 0.0 && given->hurst <= 1.0))
    return pl_fail(PL_E_RANGE, "mottling: needs 0 < cover < 1, border > 0 and hurst in 0..1");
  const size_t side = (size_t)given->pixels, count = side * side;
  void *sorted;
  double square = 0.0;
  PL_TRY(pl_alloc_or_fail(count, sizeof(float), "a sample of ground", &sorted));
  for (size_t k = 0; k < count; k++) {
    out[k] = fractal(given, ((double)(k % side) + 0.5) / (double)side,
                     ((double)(k / side) + 0.5) / (double)side);
    square += (double)out[k] * (double)out[k];
  }
  const double middle = quantile(out, count, given->cover, sorted);
  pl_free(sorted);
  take_kinds(count, middle, given->border * sqrt(square / (double)count), out);
  return PL_OK;
}
