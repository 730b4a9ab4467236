/* Elliptic integrals and functions in double precision. */
#ifndef PL_MATH_ELLIPTIC_H
#define PL_MATH_ELLIPTIC_H

/* The modulus is given by the parameter m = k^2 and its complement m1 = 1 - m, both in [0, 1]: near
 * m = 1 results depend on m1, for which computing 1 - m would lose precision. Relative errors are a
 * few eps. */

/* Carlson's integral of the first kind R_F; arguments >= 0, at most one of them 0. */
double pl_elliptic_rf(double x, double y, double z);

/* Carlson's integral of the third kind R_J for p >= x, y, z >= 0, at most one of x, y, z 0. */
double pl_elliptic_rj(double x, double y, double z, double p);

/* Complete integral of the first kind K; infinite for m1 = 0. */
double pl_elliptic_k(double m1);

typedef struct pl_elliptic {
  double sn, cn, dn;
} pl_elliptic;

/* Jacobi elliptic functions of u, |u| <= K (any u for m1 = 0, where they are tanh and sech). */
pl_elliptic pl_elliptic_functions(double u, double m, double m1);

#endif
