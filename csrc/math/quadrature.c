/* Gauss-Legendre rule: nodes by Newton's method from Tricomi's estimate; weights 2 / ((1 - x^2)
 * P'(x)^2) (Abramowitz and Stegun 25.4.29). */
#include "math/quadrature.h"

#include <math.h>

#include "math/vec.h"

/* Legendre polynomial of degree n, and its derivative, inside (-1, 1). */
static double legendre(int n, double x, double *slope) {
  double before = 1.0, p = x;
  for (int k = 2; k <= n; k++) {
    const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k;
    before = p;
    p = next;
  }
  *slope = n * (before - x * p) / (1.0 - x * x);
  return p;
}

pl_gauss pl_gauss_make(int count) {
  enum { ITERATIONS = 8 }; /* quadratic convergence from three digits: four would be enough */
  const int n = count < 1 ? 1 : count > PL_GAUSS_MAX ? PL_GAUSS_MAX : count;
  pl_gauss rule = {.count = n};
  for (int i = 0; i < (n + 1) / 2; i++) {
    double x = cos(PL_PI * (i + 0.75) / (n + 0.5)), slope = 1.0;
    for (int k = 0; k < ITERATIONS; k++) {
      const double value = legendre(n, x, &slope);
      x -= value / slope;
    }
    if (2 * i + 1 == n)
      x = 0.0;
    legendre(n, x, &slope);
    rule.node[i] = -x;
    rule.node[n - 1 - i] = x;
    rule.weight[i] = rule.weight[n - 1 - i] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}
