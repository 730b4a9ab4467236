/* A gravity field in spherical harmonics, regular at the poles.
 *
 * S. Pines, "Uniform representation of the gravitational potential and its derivatives", AIAA
 * Journal 11 (1973), with fully normalised coefficients. With u the sine of the latitude, the
 * normalised derived Legendre functions A_nm = d^m P_n/du^m follow by columns (fixed m) from
 *   A_mm = sqrt((2m+1)/(2m)) A_{m-1,m-1},  A_nm = g_nm u A_{n-1,m} - h_nm A_{n-2,m},
 * a recursion that is stable for increasing n (Lundberg and Schutz 1988). The direction (s, t, u)
 * enters through the powers of s + i t, so there is no division by the cosine of the latitude. */
#include "base/memory.h"
#include "orbit/force.h"
#include "orbit/turning.h"

#include <string.h>

#define MAX_DEGREE 360

/* Coefficients of one term, stored together. */
typedef struct term {
  double c, s;  /* normalised coefficients */
  double g, h;  /* recursion coefficients of A_nm */
  double shift; /* normalisation of A_nm relative to A_{n,m+1} */
} term;

typedef struct harmonics {
  pl_force base;
  pl_turning turning;
  double gm_m3_s2, radius_m;
  size_t degree, order;
  term terms[]; /* columns m = 0..min(order + 1, degree), each n = m..degree; the last only for A */
} harmonics;

enum { GM = PL_TURNING_COUNT, RADIUS, C, S, ORDER, PARAMETER_COUNT };
_Static_assert(PARAMETER_COUNT <= PL_FORCE_PARAMETERS, "raise PL_FORCE_PARAMETERS");
static const pl_force_parameter parameters[] = {
    PL_TURNING_PARAMETERS,
    {"gm", PL_FORCE_NUMBERS, 1, true, "m^3/s^2 that goes with them; default: the centre's"},
    {"radius_m", PL_FORCE_NUMBERS, 1, false, "reference radius of the harmonics, m"},
    {"c", PL_FORCE_NUMBERS, 0, false,
     "fully normalised cosine coefficients: (0,0), (1,0), (1,1), (2,0), ...; (0,0) is not used, "
     "the "
     "point mass stands for it"},
    {"s", PL_FORCE_NUMBERS, 0, false, "fully normalised sine coefficients, in the same order"},
    {"order", PL_FORCE_NUMBERS, 1, true, "highest order m used; default: the degree"},
};

static size_t column_start(size_t degree, size_t m) { return m * (degree + 1) - m * (m - 1) / 2; }

/* Degree and order, from the number of coefficients. */
static pl_status sizes(const pl_force_value *values, size_t *degree, size_t *order) {
  const size_t count = values[C].count;
  size_t n = 0;
  while ((n + 1) * (n + 2) / 2 < count)
    n++;
  if ((n + 1) * (n + 2) / 2 != count || values[S].count != count)
    return pl_fail(PL_E_ARGUMENT,
                   "c and s must have (n+1)(n+2)/2 numbers for a degree n; they have %zu and %zu",
                   count, values[S].count);
  if (n > MAX_DEGREE)
    return pl_fail(PL_E_RANGE, "degree %zu of the harmonics is above the limit of %d", n,
                   MAX_DEGREE);
  *degree = *order = n;
  if (!values[ORDER].count)
    return PL_OK;
  const double asked = values[ORDER].numbers[0];
  if (!(asked >= 0.0 && asked <= (double)n && asked == floor(asked)))
    return pl_fail(PL_E_RANGE, "order %g must be a whole number from 0 to the degree, %zu", asked,
                   n);
  *order = (size_t)asked;
  return PL_OK;
}

static term make_term(size_t degree_n, size_t order_m) {
  const double n = (double)degree_n, m = (double)order_m;
  term out = {.shift = order_m == 0 ? sqrt(0.5 * n * (n + 1.0)) : sqrt((n - m) * (n + m + 1.0))};
  if (degree_n > order_m) {
    const double below = (n - m) * (n + m);
    out.g = sqrt((2.0 * n + 1.0) * (2.0 * n - 1.0) / below);
    if (degree_n > order_m + 1)
      out.h = sqrt((2.0 * n + 1.0) * (n - m - 1.0) * (n + m - 1.0) / ((2.0 * n - 3.0) * below));
  }
  return out;
}

static void fill_terms(harmonics *self, size_t columns, const double *c, const double *s) {
  for (size_t m = 0; m < columns; m++)
    for (size_t n = m; n <= self->degree; n++) {
      term *t = &self->terms[column_start(self->degree, m) + n - m];
      *t = make_term(n, m);
      t->c = c[n * (n + 1) / 2 + m];
      t->s = m > 0 ? s[n * (n + 1) / 2 + m] : 0.0;
    }
}

static pl_status create(const pl_force_setting *setting, const pl_force_value *values,
                        pl_force **out) {
  size_t degree = 0, order = 0;
  PL_TRY(sizes(values, &degree, &order));
  if (!(values[RADIUS].numbers[0] > 0.0))
    return pl_fail(PL_E_RANGE, "radius_m must be positive");
  pl_turning turning;
  PL_TRY(pl_turning_init(setting, values, &turning));
  const size_t columns = (order < degree ? order + 1 : degree) + 1;
  harmonics *self = NULL;
  const size_t terms = column_start(degree, columns);
  PL_TRY(pl_alloc_or_fail(1, sizeof *self + terms * sizeof *self->terms, "gravity field",
                          (void **)&self));
  self->base.kind = &pl_force_harmonics;
  self->turning = turning;
  self->gm_m3_s2 = values[GM].count ? values[GM].numbers[0] : setting->gm_m3_s2;
  self->radius_m = values[RADIUS].numbers[0];
  self->degree = degree;
  self->order = order;
  fill_terms(self, columns, values[C].numbers, values[S].numbers);
  *out = &self->base;
  return PL_OK;
}

/* Writes A_nm for n = m..degree to a[n]; `diagonal` is A_mm. */
static void fill_column(const harmonics *self, size_t m, double diagonal, double u, double *a) {
  if (m > self->degree)
    return;
  const term *t = self->terms + column_start(self->degree, m);
  double below = 0.0, at = diagonal;
  a[m] = at;
  for (size_t n = m + 1; n <= self->degree; n++) {
    t++;
    const double next = t->g * u * at - t->h * below;
    below = at;
    at = next;
    a[n] = at;
  }
}

/* Direction at which the sums of a column are evaluated. */
typedef struct direction {
  double u;              /* sine of the latitude */
  double re, im;         /* (s + i t)^m */
  double re_low, im_low; /* (s + i t)^(m-1); 0 at m = 0 */
} direction;

/* Adds a column's contribution to the four sums of Pines: three along the axes, one along the
 * radius. */
static void add_column(const harmonics *self, size_t m, const direction *d, const double *scale,
                       const double *a, const double *a_next, double sums[4]) {
  const term *t = self->terms + column_start(self->degree, m);
  for (size_t n = m; n <= self->degree; n++, t++) {
    if (n == 0)
      continue;
    const double turned = t->c * d->re + t->s * d->im;
    const double up = n > m ? t->shift * a_next[n] : 0.0;
    const double weight = scale[n] * (double)m * a[n];
    sums[0] += weight * (t->c * d->re_low + t->s * d->im_low);
    sums[1] += weight * (t->s * d->re_low - t->c * d->im_low);
    sums[2] += scale[n] * up * turned;
    sums[3] -= scale[n] * ((double)(n + m + 1) * a[n] + d->u * up) * turned;
  }
}

static pl_vec3 body_fixed(const harmonics *self, pl_vec3 p) {
  double scale[MAX_DEGREE + 1], columns[2][MAX_DEGREE + 2];
  const double r = pl_vec3_norm(p);
  const pl_vec3 e = pl_vec3_scale(p, 1.0 / r);
  scale[0] = self->gm_m3_s2 / (r * r);
  for (size_t n = 1; n <= self->degree; n++)
    scale[n] = scale[n - 1] * (self->radius_m / r);
  double sums[4] = {0.0, 0.0, 0.0, 0.0}, diagonal = 1.0;
  direction d = {.u = e.z, .re = 1.0};
  fill_column(self, 0, diagonal, e.z, columns[0]);
  for (size_t m = 0; m <= self->order; m++) {
    const double k = (double)(m + 1);
    diagonal *= m == 0 ? sqrt(3.0) : sqrt((2.0 * k + 1.0) / (2.0 * k));
    fill_column(self, m + 1, diagonal, e.z, columns[(m + 1) % 2]);
    add_column(self, m, &d, scale, columns[m % 2], columns[(m + 1) % 2], sums);
    d.re_low = d.re;
    d.im_low = d.im;
    d.re = e.x * d.re_low - e.y * d.im_low;
    d.im = e.x * d.im_low + e.y * d.re_low;
  }
  return pl_vec3_madd(pl_vec3_make(sums[0], sums[1], sums[2]), sums[3], e);
}

static pl_status acceleration(const pl_force *force, const pl_force_point *at, pl_vec3 *out) {
  const harmonics *self = (const harmonics *)force;
  const pl_mat3 to_icrf = pl_turning_matrix(&self->turning, at->t_s);
  *out = pl_mat3_mul_vec(to_icrf, body_fixed(self, pl_mat3_mul_vec_t(to_icrf, at->r_m)));
  return PL_OK;
}

const pl_force_kind pl_force_harmonics = {
    .name = "harmonics",
    .doc =
        "A gravity field of spherical harmonics that turns with the centre; static, without tides",
    .parameter_count = PARAMETER_COUNT,
    .parameters = parameters,
    .create = create,
    .acceleration = acceleration,
};
