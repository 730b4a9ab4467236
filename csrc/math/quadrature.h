/* Gauss-Legendre quadrature. */
#ifndef PL_MATH_QUADRATURE_H
#define PL_MATH_QUADRATURE_H

#define PL_GAUSS_MAX 64

/* The integral of f over [-1, 1] is near the sum of weight[i] f(node[i]), exactly for polynomials
 * of degree 2 count - 1. */
typedef struct pl_gauss {
  int count;
  double node[PL_GAUSS_MAX], weight[PL_GAUSS_MAX];
} pl_gauss;

/* count is cut off to 1..PL_GAUSS_MAX. Nodes ascend; errors are a few eps. */
pl_gauss pl_gauss_make(int count);

#endif
