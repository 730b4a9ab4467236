/* Fraction of a disc that another disc occults. */
#ifndef PL_ORBIT_ECLIPSE_H
#define PL_ORBIT_ECLIPSE_H

#include "math/vec.h"

/* Visible fraction of a disc of radius a > 0 behind a disc of radius b >= 0, with their centres c
 * >= 0 apart, in the same unit. Exact to rounding for discs in a plane, for b/a up to 1e6 and
 * above. If a, b and c are angles (rad), the error is a (1/b - 1/tan b) / (3 pi) at most, 3e-4 for
 * the Sun and b near a right angle, because the limb of a great circle is straight.
 * light/occultation.h is exact in this case. */
double pl_eclipse_fraction(double a, double b, double c);

/* Visible fraction of the Sun's (uniform) disc from r_m, behind a sphere of radius_m about the
 * origin. `sun_m` is the Sun's centre. 0 inside the sphere. */
double pl_eclipse_sunlight(pl_vec3 r_m, pl_vec3 sun_m, double radius_m);

/* Type of eclipse: none (0), partial (1), total (2) or annular (3). */
int pl_eclipse_regime(pl_vec3 r_m, pl_vec3 sun_m, double radius_m);

#endif
