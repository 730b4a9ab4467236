/* How much of one disc another hides. */
#ifndef PL_ORBIT_ECLIPSE_H
#define PL_ORBIT_ECLIPSE_H

#include "math/vec.h"

/* Visible fraction of a disc of angular radius a > 0 behind a disc of radius b >= 0, their centres
 * c >= 0 apart, in the same unit. Exact in the plane, to rounding for b/a up to 1e6 and beyond. Of
 * angles (rad) wrong by a (1/b - 1/tan b) / (3 pi) at most, 3e-4 for the Sun and b near a right
 * angle, because the limb of a great circle is straight; light/occultation.h is exact there. */
double pl_eclipse_fraction(double a, double b, double c);

/* Visible fraction of the Sun's disc (uniform) from r_m, with a sphere of radius_m about the origin
 * in the way. `sun_m` is the Sun's centre. 0 inside the sphere. */
double pl_eclipse_sunlight(pl_vec3 r_m, pl_vec3 sun_m, double radius_m);

/* Whether that is all of it (0), none (2), a ring around the sphere (3) or a part (1). */
int pl_eclipse_regime(pl_vec3 r_m, pl_vec3 sun_m, double radius_m);

#endif
