/* Upper bounds of the effect of atmospheres on a frame, shared by the effect rows of this folder.
 */
#ifndef PL_AIR_LIGHT_BOUNDS_H
#define PL_AIR_LIGHT_BOUNDS_H

#include "air/air.h"
#include "plan/view.h"

/* Error of the integral along a ray with a given number of steps, for a solar irradiance of 1. It
 * is a factor on the light to the power of PL_AIR_POWER, since displays encode light by its 2.4th
 * root. Light below PL_AIR_DARK counts as PL_AIR_DARK. */
#define PL_AIR_POWER (1.4 / 2.4)
#define PL_AIR_DARK 1e-4
enum { PL_AIR_RULES = 13 };

/* Upper bounds over all bands, for a solar irradiance of 1. */
typedef struct pl_air_light_bounds {
  double depth;     /* optical depth of the longest path through the air, past the limb */
  double scattered; /* radiance of single scattering, 1/sr */
  double several;   /* radiance of higher orders, 1/sr */
  double again;     /* by how much these are off, as they are isotropic: at most, 1/sr */
  double sky;       /* irradiance of the sky on the ground */
  double steps_off[PL_AIR_RULES];
} pl_air_light_bounds;
pl_air_light_bounds pl_air_light_bounds_of(const pl_air *air);

double pl_air_step_error(const pl_air_light_bounds *bounds, int steps);
/* The error of one ray that pl_air_step_error bounds: the largest over the bands of the error
 * divided by the light to the power of PL_AIR_POWER. */
double pl_air_off_by(pl_vec3f is, pl_vec3f exact);

/* Weight of a body's air in a frame: 1 if the air itself is in view; less if it only adds light to
 * entities in the frame or attenuates their light; 0 if it has no effect. */
double pl_air_fraction(const pl_view *view, const pl_view_entity *body);

#endif
