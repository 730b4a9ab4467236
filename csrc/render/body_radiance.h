/* How bright a body's disc is as one point sees it: looked at once in the middle of each cell of
 * its table (light/body_disc.h), with its map, photometry, air, media, night and eclipses by other
 * bodies. Draws go by it; what they meet is shaded as anything else. */
#ifndef PL_RENDER_BODY_RADIANCE_H
#define PL_RENDER_BODY_RADIANCE_H

#include "light/body_disc.h"

struct pl_render_settings;

typedef struct pl_body_radiance {
  uint32_t body;
  pl_vec3 point; /* that it was made for */
  pl_disc_table table;
  float irradiance;      /* of a plate there that faces the light, W m-2 */
  float wide_sr;         /* solid angle that as much light of one brightness would fill */
  double most;           /* as of the disc there */
  double part, turn_rad; /* of the disc: the middle of the light */
} pl_body_radiance;

/* `sun`: direction from the body to the sun. False if no light is found. Reads the settings' air,
 * media and detail. */
bool pl_body_radiance_make(const pl_snapshot *shot, const struct pl_render_settings *settings,
                           uint32_t body, pl_vec3 sun, pl_vec3 point, pl_body_radiance *out);

#endif
