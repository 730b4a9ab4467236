/* Zeros of a smooth function of one variable on an interval. */
#ifndef PL_MATH_ROOTS_H
#define PL_MATH_ROOTS_H

#include <stdbool.h>
#include <stddef.h>

typedef double (*pl_function)(const void *context, double t);

#define PL_ROOTS_SAMPLES 16

/* The first `capacity` places in [from, to], ascending, where f changes its sign (0 counts as
 * positive). f is looked at in PL_ROOTS_SAMPLES steps, and between them where it comes nearest to
 * zero: pairs of zeros are found however close, as long as f has no more than one extremum in two
 * steps. `closed`: f(to) is f(from), so that the count is even. Errors are about eps of t, or what
 * the noise of f makes of it. */
size_t pl_roots_find(pl_function f, const void *context, double from, double to, bool closed,
                     double *roots, size_t capacity);

#endif
