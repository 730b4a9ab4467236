/* Radiance of a body's disc as seen from one point. It is evaluated once in the centre of each cell
 * of the body's table (light/body_disc.h), with the map, photometry, air, media, night side and
 * eclipses by other bodies. It serves only as a sampling density: what the sampled rays hit is
 * shaded like anything else. */
#ifndef PL_RENDER_BODY_RADIANCE_H
#define PL_RENDER_BODY_RADIANCE_H

#include "light/body_disc.h"

struct pl_render_settings;

typedef struct pl_body_radiance {
  uint32_t body;
  pl_vec3 point; /* the point it was made for */
  pl_disc_table table;
  float irradiance;      /* on a plate at the point that faces the light, W m-2 */
  float wide_sr;         /* solid angle that the same light would fill with uniform radiance */
  double most;           /* as pl_body_disc's */
  double part, turn_rad; /* centroid of the light on the disc */
} pl_body_radiance;

/* `sun`: direction from the body to the sun. Returns false if no light is found. Reads the air,
 * media and detail of the settings. */
bool pl_body_radiance_make(const pl_snapshot *shot, const struct pl_render_settings *settings,
                           uint32_t body, pl_vec3 sun, pl_vec3 point, pl_body_radiance *out);

#endif
