/* What airs can do to a frame at most: shared by the rows of this folder. */
#ifndef PL_AIR_REACH_H
#define PL_AIR_REACH_H

#include "air/air.h"
#include "plan/view.h"

/* What the integral along a ray is off by with so many steps: so many times the light, under a sun
 * of irradiance 1, to the power of PL_AIR_POWER, where displays encode it by its 2.4th root; what
 * is darker than PL_AIR_DARK counts as that. */
#define PL_AIR_POWER (1.4 / 2.4)
#define PL_AIR_DARK 1e-4
enum { PL_AIR_RULES = 13 };

/* Upper bounds over all bands, for a sun of irradiance 1. */
typedef struct pl_air_reach {
  double depth;     /* optical, of the longest way through the air, past the limb */
  double scattered; /* radiance of what is scattered once, 1/sr */
  double several;   /* and of what is scattered again */
  double sky;       /* irradiance of the ground */
  double steps_off[PL_AIR_RULES];
} pl_air_reach;
pl_air_reach pl_air_reach_of(const pl_air *air);

double pl_air_step_error(const pl_air_reach *reach, int steps);
/* What it is an upper bound of, for one ray: the largest error of a band over its light to the
 * power PL_AIR_POWER. */
double pl_air_off_by(pl_vec3f is, pl_vec3f exact);

/* How a body's air gets into a frame: it is seen itself (1), or only by the light that it sends to
 * things in the frame or keeps from them (less; 0: not at all). */
double pl_air_share(const pl_view *view, const pl_view_thing *body);

#endif
