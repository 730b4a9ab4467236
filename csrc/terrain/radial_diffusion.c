#include "terrain/radial_diffusion.h"

/* Conductances between ring i and its neighbours over the ring's area, times width^2. */
static double inner(size_t i) { return (double)i / ((double)i + 0.5); }
static double outer(size_t i, size_t cells) {
  return i + 1 < cells ? (double)(i + 1) / ((double)i + 0.5) : 0.0;
}

/* Thomas's algorithm for (1 - implicit L) z = right, with the factors shared by all profiles. */
static void solve(double *z, size_t profiles, size_t cells, double implicit, const double *right,
                  double *upper, double *pivot) {
  for (size_t i = 0; i < cells; i++) {
    const double a = implicit * inner(i), c = implicit * outer(i, cells);
    pivot[i] = 1.0 / (1.0 + a + c - (i > 0 ? a * upper[i - 1] : 0.0));
    upper[i] = c * pivot[i];
  }
  for (size_t p = 0; p < profiles; p++) {
    double *to = z + p * cells;
    const double *from = right + p * cells;
    to[0] = from[0] * pivot[0];
    for (size_t i = 1; i < cells; i++)
      to[i] = (from[i] + implicit * inner(i) * to[i - 1]) * pivot[i];
    for (size_t i = cells - 1; i-- > 0;)
      to[i] += upper[i] * to[i + 1];
  }
}

void pl_radial_diffuse(double *z, size_t profiles, size_t cells, double width, double tau,
                       int steps, int smooth, double *scratch) {
  double *upper = scratch, *pivot = scratch + cells, *right = scratch + 2 * cells;
  const double by = tau / steps / (width * width);
  const double implicit = smooth ? by : 0.5 * by, explicit = by - implicit;
  for (int step = 0; step < steps; step++) {
    for (size_t p = 0; p < profiles; p++)
      for (size_t i = 0; i < cells; i++) {
        const double *at = z + p * cells + i;
        const double in = i > 0 ? inner(i) * (at[-1] - at[0]) : 0.0;
        const double out = i + 1 < cells ? outer(i, cells) * (at[1] - at[0]) : 0.0;
        right[p * cells + i] = at[0] + explicit * (in + out);
      }
    solve(z, profiles, cells, implicit, right, upper, pivot);
  }
}
