/* Roots of a smooth function of one variable on an interval. */
#ifndef PL_MATH_ROOTS_H
#define PL_MATH_ROOTS_H

#include <stdbool.h>
#include <stddef.h>

typedef double (*pl_function)(const void *context, double t);

#define PL_ROOTS_SAMPLES 16

/* Finds the first `capacity` points in [from, to], ascending, where f changes its sign (0 counts as
 * positive). f is sampled at PL_ROOTS_SAMPLES steps, and in between where |f| may have a minimum:
 * pairs of roots are found at any distance from each other, as long as f has at most one extremum
 * in two steps. `closed`: f(to) equals f(from), so that the number of roots is even. Errors are
 * about eps of t, or larger if f has rounding errors. */
size_t pl_roots_find(pl_function f, const void *context, double from, double to, bool closed,
                     double *roots, size_t capacity);

#endif
