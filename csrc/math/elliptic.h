/* Elliptic integrals and functions, double. */
#ifndef PL_MATH_ELLIPTIC_H
#define PL_MATH_ELLIPTIC_H

/* Moduli are given as the parameter m = k^2 and its complement m1 = 1 - m, both in [0, 1]: near
 * m = 1 everything depends on m1, which 1 - m does not hold. Relative errors are a few eps. */

/* Carlson's integral of the first kind; arguments >= 0, at most one of them 0. */
double pl_elliptic_rf(double x, double y, double z);

/* Carlson's integral of the third kind for p >= x, y, z >= 0, at most one of x, y, z 0. */
double pl_elliptic_rj(double x, double y, double z, double p);

/* Complete integral of the first kind K; infinite for m1 = 0. */
double pl_elliptic_k(double m1);

typedef struct pl_elliptic {
  double sn, cn, dn;
} pl_elliptic;

/* Jacobi's functions of u, |u| <= K (any u for m1 = 0, where they are tanh and sech). */
pl_elliptic pl_elliptic_functions(double u, double m, double m1);

#endif
