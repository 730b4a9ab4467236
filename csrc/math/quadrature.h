/* Gauss-Legendre quadrature. */
#ifndef PL_MATH_QUADRATURE_H
#define PL_MATH_QUADRATURE_H

#define PL_GAUSS_MAX 64

/* Approximates the integral of f over [-1, 1] by the sum of weight[i] f(node[i]), exact for
 * polynomials of degree up to 2 count - 1. */
typedef struct pl_gauss {
  int count;
  double node[PL_GAUSS_MAX], weight[PL_GAUSS_MAX];
} pl_gauss;

/* count is clamped to 1..PL_GAUSS_MAX. Nodes are in ascending order; errors are a few eps. */
pl_gauss pl_gauss_make(int count);

#endif
