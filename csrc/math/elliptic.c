/* Elliptic integrals by Carlson's duplication, elliptic functions by the Gauss transformation of
 * their cotangents.
 *
 * B. C. Carlson, "Numerical computation of real or complex elliptic integrals", Numer. Algorithms
 * 10, 1995 (also DLMF 19.36); R. Bulirsch, "Numerical calculation of elliptic integrals and
 * elliptic functions", Numer. Math. 7, 1965. */
#include "math/elliptic.h"

#include <float.h>
#include <math.h>

#include "math/vec.h"

/* Enough for arguments that differ by a factor of 1e300: each step reduces their differences by a
 * factor of 4. */
#define MAX_DUPLICATIONS 600
/* The arithmetic-geometric mean of 1 and 1e-160 takes 13 steps. */
#define MAX_MEANS 18
/* Tolerance of the means; the relative difference of the next means is its square. */
#define MEANS_LIMIT 1e-9
/* For smaller |u|, sn u equals u, and the square of 1/u would overflow. */
#define TINY 1e-150

static double largest(double a, double b, double c, double d) {
  return fmax(fmax(fabs(a), fabs(b)), fmax(fabs(c), fabs(d)));
}

double pl_elliptic_rf(double x, double y, double z) {
  const double a0 = (x + y + z) / 3.0, x0 = x, y0 = y;
  const double q = pow(3.0 * DBL_EPSILON, -1.0 / 6.0) * largest(a0 - x, a0 - y, a0 - z, 0.0);
  double a = a0, shrink = 1.0;
  for (int n = 0; n < MAX_DUPLICATIONS && shrink * q >= fabs(a); n++) {
    const double rx = sqrt(x), ry = sqrt(y), rz = sqrt(z);
    const double lambda = rx * ry + rx * rz + ry * rz;
    x = 0.25 * (x + lambda);
    y = 0.25 * (y + lambda);
    z = 0.25 * (z + lambda);
    a = 0.25 * (a + lambda);
    shrink *= 0.25;
  }
  const double dx = shrink * (a0 - x0) / a, dy = shrink * (a0 - y0) / a, dz = -(dx + dy);
  const double e2 = dx * dy - dz * dz, e3 = dx * dy * dz;
  return (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0) / sqrt(a);
}

/* R_C(1, 1 + e) for e >= 0: atan(sqrt e)/sqrt e. */
static double rc_one(double e) {
  if (e < 1e-8)
    return 1.0 - e / 3.0;
  const double root = sqrt(e);
  return atan(root) / root;
}

double pl_elliptic_rj(double x, double y, double z, double p) {
  const double a0 = (x + y + z + 2.0 * p) / 5.0, x0 = x, y0 = y, z0 = z;
  double delta = (p - x) * (p - y) * (p - z); /* step n uses 4^-3n times this */
  const double q = pow(0.25 * DBL_EPSILON, -1.0 / 6.0) * largest(a0 - x, a0 - y, a0 - z, a0 - p);
  double a = a0, shrink = 1.0, sum = 0.0;
  for (int n = 0; n < MAX_DUPLICATIONS && shrink * q >= fabs(a); n++) {
    const double rx = sqrt(x), ry = sqrt(y), rz = sqrt(z), rp = sqrt(p);
    const double lambda = rx * ry + rx * rz + ry * rz;
    const double d = (rp + rx) * (rp + ry) * (rp + rz);
    sum += shrink / d * rc_one(delta / d / d);
    x = 0.25 * (x + lambda);
    y = 0.25 * (y + lambda);
    z = 0.25 * (z + lambda);
    p = 0.25 * (p + lambda);
    a = 0.25 * (a + lambda);
    shrink *= 0.25;
    delta *= 1.0 / 64.0;
  }
  const double dx = shrink * (a0 - x0) / a, dy = shrink * (a0 - y0) / a;
  const double dz = shrink * (a0 - z0) / a, dp = -0.5 * (dx + dy + dz);
  const double e2 = dx * dy + dx * dz + dy * dz - 3.0 * dp * dp;
  const double e3 = dx * dy * dz + 2.0 * e2 * dp + 4.0 * dp * dp * dp;
  const double e4 = (2.0 * dx * dy * dz + e2 * dp + 3.0 * dp * dp * dp) * dp;
  const double e5 = dx * dy * dz * dp * dp;
  const double series = 1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 - 3.0 * e4 / 22.0 -
                        9.0 * e2 * e3 / 52.0 + 3.0 * e5 / 26.0;
  return shrink * series / (a * sqrt(a)) + 6.0 * sum;
}

/* Arithmetic-geometric mean of 1 and sqrt(m1): sequences a_n and b_n until they agree; returns the
 * last n. */
static int means(double m1, double a[MAX_MEANS], double b[MAX_MEANS]) {
  a[0] = 1.0;
  b[0] = sqrt(m1);
  int n = 0;
  while (n + 1 < MAX_MEANS && fabs(a[n] - b[n]) > MEANS_LIMIT * a[n]) {
    a[n + 1] = 0.5 * (a[n] + b[n]);
    b[n + 1] = sqrt(a[n] * b[n]);
    n++;
  }
  return n;
}

double pl_elliptic_k(double m1) {
  double a[MAX_MEANS], b[MAX_MEANS];
  if (!(m1 > 0.0))
    return INFINITY;
  const int n = means(m1, a, b);
  return PL_PI / (a[n] + b[n]);
}

pl_elliptic pl_elliptic_functions(double u, double m, double m1) {
  if (!(m1 > 0.0))
    return (pl_elliptic){tanh(u), 1.0 / cosh(u), 1.0 / cosh(u)};
  if (fabs(u) < TINY)
    return (pl_elliptic){u, 1.0, 1.0};
  double a[MAX_MEANS], b[MAX_MEANS];
  const int n = means(m1, a, b);
  const double mean = 0.5 * (a[n] + b[n]), angle = mean * u;
  double ratio = cos(angle) / sin(angle), c = mean * ratio, dn = 1.0;
  for (int i = n; i >= 0; i--) { /* all sums have positive terms: no cancellation */
    const double x = ratio * c;
    c *= dn;
    dn = (b[i] + x) / (a[i] + x);
    ratio = c / a[i];
  }
  pl_elliptic out;
  out.sn = copysign(1.0 / sqrt(c * c + 1.0), sin(angle));
  out.cn = c * out.sn;
  /* As precise as dn from the loop, and consistent with cn. */
  out.dn = sqrt(m1 + m * out.cn * out.cn);
  return out;
}
