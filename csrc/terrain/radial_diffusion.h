/* Diffusion of axisymmetric profiles: dz/dt = laplacian of z, in units of a radius. */
#ifndef PL_TERRAIN_RADIAL_DIFFUSION_H
#define PL_TERRAIN_RADIAL_DIFFUSION_H

#include <stddef.h>

#include "base/status.h"

/* Advances `profiles` profiles by the time tau. z[p * cells + i] is the mean of profile p over the
 * ring from i `width` to (i + 1) `width`; nothing flows through the outer end. `steps` equal
 * implicit steps: of second order (Crank-Nicolson) or, with `smooth`, of first order without
 * oscillation (backward Euler), which a profile with edges needs for its first steps. Stable for
 * any step. `scratch` has (2 + profiles) * cells elements. */
void pl_radial_diffuse(double *z, size_t profiles, size_t cells, double width, double tau,
                       int steps, int smooth, double *scratch);

#endif
