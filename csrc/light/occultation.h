/* The fraction of sunlight that remains during eclipses by any number of bodies at once. */
#ifndef PL_LIGHT_OCCULTATION_H
#define PL_LIGHT_OCCULTATION_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/rotation.h"

/* Positions are in any common axes, metres. */
typedef struct pl_occultation {
  size_t times, bodies, bands;
  double sun_radius_m;
  const pl_vec3 *points;       /* [time] */
  const pl_vec3 *sun_m;        /* [time], the sun's centre */
  const pl_pose *poses;        /* [time * bodies + body] */
  const pl_vec3 *radii_m;      /* [body], semi-axes > 0 */
  const double *wavelength_um; /* [band], for light/limb.c; 0: a uniform disc */
  int nodes;                   /* quadrature nodes per quarter of a body's limb or less: 1..64 */
} pl_occultation;

typedef struct pl_occultation_result {
  double *fraction; /* [time * bands + band], 0..1, of the irradiance on a surface facing the sun */
  uint8_t *hides;   /* [time * bodies + body]: 1 if the body occults a part of the disc, else 0 */
} pl_occultation_result;

/* Integrates along the outline of the occulted part. By Green's theorem its light is a sum of line
 * integrals: in closed form over the occulted arcs of the sun's limb, and by quadrature over the
 * arcs of the bodies' limbs that lie in front of the sun and not behind other bodies. The limbs of
 * ellipsoids are exact on the sphere of directions, and so is the union of bodies. The error is
 * that of the quadrature (benchmarks/eclipse.py: below 1e-12 with 16 nodes for a uniform disc) and
 * that of rounding in the coordinates: eps times their size over the distance, relative to the
 * sun's angular radius.
 *
 * A body counts if its centre is closer than the sun's surface. Inside a body the fraction is 0.
 * Atmospheres are ignored. Fails with PL_E_RANGE and the index of the time for positions that are
 * not finite or are inside the sun; with PL_E_RANGE for radii, wavelengths or nodes out of range;
 * with PL_E_MEMORY. */
pl_status pl_occultation_solve(const pl_occultation *request, const pl_occultation_result *out);

#endif
