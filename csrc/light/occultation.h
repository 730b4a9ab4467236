/* The part of the sun's light that bodies let through: eclipses of any number of bodies at once. */
#ifndef PL_LIGHT_OCCULTATION_H
#define PL_LIGHT_OCCULTATION_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "math/rotation.h"

/* Places and times are in any common axes, metres. */
typedef struct pl_occultation {
  size_t times, bodies, bands;
  double sun_radius_m;
  const pl_vec3 *points;       /* [time] */
  const pl_vec3 *sun_m;        /* [time], the sun's centre */
  const pl_pose *poses;        /* [time * bodies + body] */
  const pl_vec3 *radii_m;      /* [body], semi-axes > 0 */
  const double *wavelength_um; /* [band], for light/limb.c; 0: a disc of even brightness */
  int nodes;                   /* of the quadrature, a quarter of a body's limb or less: 1..64 */
} pl_occultation;

typedef struct pl_occultation_result {
  double *fraction; /* [time * bands + band], 0..1: of the irradiance on a surface facing the sun */
  uint8_t *hides;   /* [time * bodies + body]: whether the body hides a part of the disc */
} pl_occultation_result;

/* By the outline of the hidden part: with Green's theorem its light is an integral over the arcs of
 * the sun's limb that are hidden, in closed form, and over the arcs of the bodies' limbs that are
 * before the sun and not behind other bodies, by quadrature. Limbs of ellipsoids are exact, on the
 * sphere of directions; so is the union of bodies. The error is that of the quadrature
 * (benchmarks/eclipse.py: below 1e-12 with 16 nodes for an even disc) and of coordinates: eps times
 * their size over the distance, over the sun's angular radius.
 *
 * A body counts where its centre is nearer than the sun's surface; inside a body the fraction is 0.
 * Bodies have no atmosphere. PL_E_RANGE, with the time's index, for places that are not finite or
 * inside the sun; PL_E_RANGE for radii, wavelengths or nodes out of range; PL_E_MEMORY. */
pl_status pl_occultation_solve(const pl_occultation *request, const pl_occultation_result *out);

#endif
