/* Rings: validation of the settings, precomputed tables and the phase function. */
#include "rings/rings.h"

#include <string.h>

#include "base/memory.h"
#include "math/quadrature.h"
#include "rings/table.h"

static const double DEPTH_MAX = 1000.0, EXPONENT_MAX = 20.0, PEAKED = 0.98;

static pl_status check_number(const char *name, double value, double low, double high) {
  if (isfinite(value) && value >= low && value <= high)
    return PL_OK;
  return pl_fail(PL_E_RANGE, "rings: %s must be in %g..%g, not %g", name, low, high, value);
}

static pl_status check(const pl_rings_settings *s) {
  if (s->count < 1 || s->count > PL_RINGS_COUNT_MAX)
    return pl_fail(PL_E_RANGE, "rings: 1..%d intervals of radius, not %zu", PL_RINGS_COUNT_MAX,
                   s->count);
  PL_TRY(check_number("the inner radius", s->edges_m[0], 1e-6, 1e15));
  for (size_t i = 0; i < s->count; i++) {
    PL_TRY(check_number("a radius", s->edges_m[i + 1], 1e-6, 1e15));
    if (!(s->edges_m[i + 1] > s->edges_m[i]))
      return pl_fail(PL_E_RANGE, "rings: radii must rise: %g m follows on %g m", s->edges_m[i + 1],
                     s->edges_m[i]);
    PL_TRY(check_number("optical depth", s->depth[i], 0.0, DEPTH_MAX));
    for (size_t k = 0; k < 3; k++)
      PL_TRY(check_number("albedo", s->albedo[3 * i + k], 0.0, 1.0));
  }
  PL_TRY(check_number("phase exponent", s->exponent, 0.0, EXPONENT_MAX));
  PL_TRY(check_number("dust share", s->dust_share, 0.0, 1.0));
  return check_number("dust g", s->dust_g, -PEAKED, PEAKED);
}

/* Normalization of the particles' phase function: 1 / (integral of turn^exponent over sphere). */
static double norm_of(double exponent) {
  const pl_gauss rule = pl_gauss_make(PL_GAUSS_MAX);
  double sum = 0.0;
  for (int i = 0; i < rule.count; i++) {
    const double turn = 0.5 * PL_PI * (1.0 + rule.node[i]);
    sum += 0.5 * PL_PI * rule.weight[i] * pow(turn, exponent) * sin(turn);
  }
  return 1.0 / (2.0 * PL_PI * sum);
}

static double dust(double cosine, double g) {
  const double base = fmax(1.0 + g * g - 2.0 * g * cosine, 1e-6);
  return (1.0 - g * g) / (4.0 * PL_PI * base * sqrt(base));
}

double pl_rings_phase(const pl_rings *rings, double cosine) {
  const double fraction = rings->dust_share, c = fmin(1.0, fmax(-1.0, cosine));
  return (1.0 - fraction) * rings->norm * pow(acos(c), rings->exponent) +
         fraction * dust(c, rings->dust_g);
}

static void set_reach(pl_rings *rings) {
  double albedo = 0.0;
  for (size_t i = 0; i < rings->count; i++) {
    if (rings->depth[i] > 0.0)
      for (size_t k = 0; k < 3; k++)
        albedo = fmax(albedo, rings->albedo[3 * i + k]);
    rings->bounds.depth = fmax(rings->bounds.depth, rings->depth[i]);
  }
  const double particles = rings->norm * pow(PL_PI, rings->exponent);
  const double peak = dust(rings->dust_g < 0.0 ? -1.0 : 1.0, rings->dust_g);
  rings->bounds.scattered =
      albedo * ((1.0 - rings->dust_share) * particles + rings->dust_share * peak);
}

/* Fills the integrals over the radius that table.h describes. */
static void fill_sums(pl_rings *rings) {
  for (size_t i = 0; i < rings->count; i++) {
    const double width = rings->edges_m[i + 1] - rings->edges_m[i];
    const double *before = rings->sums + i * PL_RINGS_NODES * PL_RINGS_VALUES;
    double *after = rings->sums + (i + 1) * PL_RINGS_NODES * PL_RINGS_VALUES;
    for (int k = 0; k < PL_RINGS_NODES; k++) {
      const double path = exp2(0.5 * (k + PL_RINGS_FIRST));
      const double held = -expm1(-rings->depth[i] * path) * width;
      const double *from = before + k * PL_RINGS_VALUES;
      double *to = after + k * PL_RINGS_VALUES;
      to[0] = from[0] + held;
      for (size_t band = 0; band < 3; band++)
        to[1 + band] = from[1 + band] + held * rings->albedo[3 * i + band];
    }
  }
}

static pl_status copy(const double *from, size_t count, double **out) {
  void *memory;
  PL_TRY(pl_alloc_or_fail(count, sizeof(double), "rings", &memory));
  memcpy(memory, from, count * sizeof(double));
  *out = memory;
  return PL_OK;
}

static pl_status fill(const pl_rings_settings *s, pl_rings *rings) {
  void *sums;
  PL_TRY(copy(s->edges_m, s->count + 1, &rings->edges_m));
  PL_TRY(copy(s->depth, s->count, &rings->depth));
  PL_TRY(copy(s->albedo, 3 * s->count, &rings->albedo));
  PL_TRY(pl_alloc_or_fail((s->count + 1) * PL_RINGS_NODES * PL_RINGS_VALUES, sizeof(double),
                          "the tables of rings", &sums));
  rings->sums = sums;
  rings->count = s->count;
  rings->exponent = s->exponent;
  rings->dust_share = s->dust_share;
  rings->dust_g = s->dust_g;
  rings->norm = norm_of(s->exponent);
  set_reach(rings);
  fill_sums(rings);
  return PL_OK;
}

pl_status pl_rings_create(const pl_rings_settings *settings, pl_rings **out) {
  void *memory;
  PL_TRY(check(settings));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_rings), "rings", &memory));
  const pl_status status = fill(settings, memory);
  if (status != PL_OK) {
    pl_rings_destroy(memory);
    return status;
  }
  *out = memory;
  return PL_OK;
}

void pl_rings_destroy(pl_rings *rings) {
  if (rings == NULL)
    return;
  pl_free(rings->edges_m);
  pl_free(rings->depth);
  pl_free(rings->albedo);
  pl_free(rings->sums);
  pl_free(rings);
}

double pl_rings_inner_m(const pl_rings *rings) { return rings->edges_m[0]; }

double pl_rings_outer_m(const pl_rings *rings) { return rings->edges_m[rings->count]; }

pl_rings_light_bounds pl_rings_light_bounds_of(const pl_rings *rings) { return rings->bounds; }
