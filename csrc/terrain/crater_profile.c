#include "terrain/crater_profile.h"

#include <math.h>

#include "base/memory.h"
#include "terrain/radial_diffusion.h"

/* A profile is a sum of these, so diffusion, which is linear, is computed once for all sizes. */
enum { BOWL_NARROW, BOWL_MIDDLE, BOWL_WIDE, UPLIFT, EJECTA, PEAK, PARTS };
static const double bowl_floors[3] = {0.2, 0.4, 0.8};

#define PEAK_RADIUS 0.15 /* of a central peak, over R */

/* Shapes are kept for tau = 0 and for TAU_MIN 2^(k/2). */
#define TAU_MIN 1e-4
enum { TIMES = 30, KNOTS = PL_CRATER_KNOTS - 2 };
/* Rings of the solution: two a knot, up to x = 8. */
enum { RINGS_PER_KNOT = 2, RINGS = 8 * RINGS_PER_KNOT * PL_CRATER_KNOTS_PER_RADIUS };
enum { STEPS = 8, FIRST_STEPS = 16 };

struct pl_crater_shapes {
  float parts[TIMES + 1][PARTS][KNOTS];
};

static double smooth(double t) {
  t = fmin(fmax(t, 0.0), 1.0);
  return t * t * (3.0 - 2.0 * t);
}

double pl_crater_complex(double diameter_m) { return smooth(log2(1e-3 * diameter_m / 10.0)); }

pl_crater_dimensions pl_crater_fresh(double diameter_m) {
  const double km = 1e-3 * diameter_m, d = fmin(diameter_m, 850.0);
  const double complex = pl_crater_complex(diameter_m);
  /* Fit to the depths by size of Stopar et al. (2017), D in m below 850 m. */
  const double small =
      d * (0.123447427 + d * (1.49135061e-4 + d * (-6.16681361e-8 + d * 7.08449143e-12)));
  const double pike_depth = 196.0 * pow(km, 1.010);
  const double simple_depth = diameter_m < 850.0 ? fmin(pike_depth, small) : pike_depth;
  /* The rims of shallower craters are lower, too: what was thrown out comes from inside. */
  const double simple_rim = 36.0 * pow(km, 1.014) * simple_depth / pike_depth;
  pl_crater_dimensions fresh;
  fresh.depth_m = pow(simple_depth, 1.0 - complex) * pow(1044.0 * pow(km, 0.301), complex);
  fresh.rim_m = pow(simple_rim, 1.0 - complex) * pow(236.0 * pow(km, 0.399), complex);
  fresh.ejecta_m = fmin(0.14 * pow(0.5 * diameter_m, 0.74), 0.5 * fresh.rim_m);
  fresh.peak_m = fmin(complex * 32.0 * pow(km, 0.9), 0.5 * fresh.depth_m);
  const double floor = 0.187 * pow(km, 0.249);
  fresh.floor = bowl_floors[0] +
                complex * (fmin(fmax(floor, bowl_floors[0]), bowl_floors[2]) - bowl_floors[0]);
  return fresh;
}

double pl_crater_tau(double diameter_m, double age_ga, double diffusivity_1km, double exponent) {
  const double diffusivity = diffusivity_1km * pow(1e-3 * diameter_m, exponent);
  return 1e3 * age_ga * diffusivity / (0.25 * diameter_m * diameter_m);
}

/* Fraction of the depth below the rim's height inside: 1 on the floor, 0 from the rim on. The wall
 * is the cubic of Fassett and Thomson between any floor and the rim. */
static double bowl(double x, double floor) {
  if (x >= 1.0)
    return 0.0;
  const double at = fmax(x, floor);
  const double f = floor - 1.0, f2 = floor * floor - 1.0, f3 = floor * floor * floor - 1.0;
  const double w = at - 1.0, w2 = at * at - 1.0, w3 = at * at * at - 1.0;
  return (w + 4.0 / 11.0 * w2 - 32.0 / 187.0 * w3) / (f + 4.0 / 11.0 * f2 - 32.0 / 187.0 * f3);
}

/* Falls as a power of the distance outside, flat at the crest itself; 1 inside. */
static double flank(double x, double power) {
  const double u = fmax(x - 1.0, 0.0);
  return pow(1.0 + u * u / (u + 0.05), power) * (1.0 - smooth(x - (PL_CRATER_REACH - 1.0)));
}

static double part_at(int part, double x) {
  if (part <= BOWL_WIDE)
    return bowl(x, bowl_floors[part]);
  if (part == PEAK)
    return exp(-x * x / (PEAK_RADIUS * PEAK_RADIUS));
  return flank(x, part == UPLIFT ? -4.2 : -3.0);
}

/* Ring means by Gauss's rule of two points, weighted by their radii. */
static double ring_mean(int part, double x, double width) {
  const double a = x + width * (0.5 - 0.28867513459481288), b = 2.0 * x + width - a;
  return (a * part_at(part, a) + b * part_at(part, b)) / (a + b);
}

/* Values between rings, where the knots lie; even about the centre. */
static double knot_value(const double *z, size_t knot) {
  if (knot == 0)
    return (9.0 * z[0] - z[1]) / 8.0;
  const double *at = z + knot * RINGS_PER_KNOT;
  return (9.0 * (at[-1] + at[0]) - at[-2] - at[1]) / 16.0;
}

static void store(pl_crater_shapes *shapes, int time, const double *z) {
  for (int part = 0; part < PARTS; part++)
    for (size_t k = 0; k < KNOTS; k++) {
      const double x = (double)k / PL_CRATER_KNOTS_PER_RADIUS;
      const double value = time == 0 ? part_at(part, x) : knot_value(z + part * RINGS, k);
      /* What has spread to the reach is cut, from a radius before it on. */
      const double end = 1.0 - smooth(x - (PL_CRATER_REACH - 1.0));
      shapes->parts[time][part][k] = (float)(end * value);
    }
}

pl_status pl_crater_shapes_create(pl_crater_shapes **out) {
  *out = NULL;
  pl_crater_shapes *shapes = pl_alloc(1, sizeof *shapes);
  double *z = pl_alloc((size_t)(2 * PARTS + 2) * RINGS, sizeof *z);
  if (shapes == NULL || z == NULL) {
    pl_free(shapes);
    pl_free(z);
    return pl_fail(PL_E_MEMORY, "out of memory for the shapes of craters");
  }
  const double width = 1.0 / (PL_CRATER_KNOTS_PER_RADIUS * RINGS_PER_KNOT);
  for (int part = 0; part < PARTS; part++)
    for (int i = 0; i < RINGS; i++)
      z[part * RINGS + i] = ring_mean(part, i * width, width);
  store(shapes, 0, z);
  double before = 0.0;
  for (int time = 1; time <= TIMES; time++) {
    const double tau = TAU_MIN * exp2(0.5 * (time - 1));
    pl_radial_diffuse(z, PARTS, RINGS, width, tau - before, time == 1 ? FIRST_STEPS : STEPS,
                      time == 1, z + PARTS * RINGS);
    store(shapes, time, z);
    before = tau;
  }
  pl_free(z);
  *out = shapes;
  return PL_OK;
}

void pl_crater_shapes_destroy(pl_crater_shapes *shapes) { pl_free(shapes); }

/* Position of a tau between the times that shapes are kept for. */
static int time_of(double tau, float *fraction) {
  const double last = TAU_MIN * exp2(0.5 * (TIMES - 1));
  tau = fmin(fmax(tau, 0.0), fmin(last, PL_CRATER_TAU_MAX));
  const double at = tau <= TAU_MIN ? tau / TAU_MIN : 1.0 + 2.0 * log2(tau / TAU_MIN);
  const int time = (int)fmin(at, TIMES - 1.0);
  *fraction = (float)(at - time);
  return time;
}

void pl_crater_profile(const pl_crater_shapes *shapes, const pl_crater_dimensions *fresh,
                       double tau, float profile[PL_CRATER_KNOTS]) {
  float fraction, weights[PARTS] = {0.0f};
  const int time = time_of(tau, &fraction);
  const int wide = fresh->floor > bowl_floors[1];
  const double f = (fresh->floor - bowl_floors[wide]) / (bowl_floors[wide + 1] - bowl_floors[wide]);
  weights[wide] = (float)(-fresh->depth_m * (1.0 - f));
  weights[wide + 1] = (float)(-fresh->depth_m * f);
  weights[UPLIFT] = (float)(fresh->rim_m - fresh->ejecta_m);
  weights[EJECTA] = (float)fresh->ejecta_m;
  weights[PEAK] = (float)fresh->peak_m;
  for (int k = 0; k < PL_CRATER_KNOTS; k++)
    profile[k] = 0.0f;
  for (int part = 0; part < PARTS; part++) {
    if (weights[part] == 0.0f)
      continue;
    const float *a = shapes->parts[time][part], *b = shapes->parts[time + 1][part];
    for (int k = 0; k < KNOTS; k++)
      profile[k + 1] += weights[part] * (a[k] + fraction * (b[k] - a[k]));
  }
  profile[0] = profile[2];
  profile[PL_CRATER_KNOTS - 2] = profile[PL_CRATER_KNOTS - 1] = 0.0f;
}

double pl_crater_profile_height(const float profile[PL_CRATER_KNOTS], double x) {
  if (!(x < PL_CRATER_REACH))
    return 0.0;
  const double at = x * PL_CRATER_KNOTS_PER_RADIUS;
  const int k = (int)at;
  const double t = at - k, a = (double)profile[k], b = (double)profile[k + 1],
               c = (double)profile[k + 2], d = (double)profile[k + 3];
  return b +
         0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)));
}
