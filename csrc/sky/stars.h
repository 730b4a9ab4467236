/* Stars of one frame: selection, bounds for the plan, and contribution to pixels. */
#ifndef PL_SKY_STARS_H
#define PL_SKY_STARS_H

#include "base/memory.h"
#include "plan/view.h"
#include "scene/snapshot.h"
#include "sky/catalogue.h"

/* A star in the frame. */
typedef struct pl_field_star {
  const pl_star *star; /* borrowed from the catalogue */
  pl_vec3 direction;   /* apparent direction for the moving camera, unit, root axes */
  double u, v;         /* pixel position of the image of the star */
  int level; /* tenths of a magnitude fainter than the brightest star in the frame, from 1 */
} pl_field_star;

typedef struct pl_star_field {
  pl_field_star *stars; /* sorted from bright to faint, then by order in the catalogue */
  size_t count;
  int levels; /* level of the faintest star */
} pl_star_field;

/* Contribution of a star to the four pixels about its position: radiances whose integral over the
 * solid angles of the pixels is the star's irradiance, less the part outside the image. Weights are
 * bilinear, so that the centroid of the light is the star's position. */
typedef struct pl_star_splat {
  int count;
  uint32_t pixels[4]; /* y * width + x */
  pl_vec3f light[4];  /* W m-2 sr-1 */
} pl_star_splat;

/* Apparent direction of a star for an observer with velocity `beta` (in units of the speed of
 * light): special relativity, without gravitational light deflection by the sun. `direction` and
 * the result are unit vectors. */
pl_vec3 pl_star_aberrate(pl_vec3 direction, pl_vec3 beta);

/* Lists the stars in the field of view of the camera of `shot`, including occluded ones, and fills
 * the stars' part of `view`. The faintest stars of a cell of the sky are omitted if together they
 * add at most `faint` (W m-2 sr-1) to a pixel; `view` has the bound of their contribution. Memory
 * is allocated in the arena. */
pl_status pl_star_field_gather(const pl_star_catalogue *catalogue, const pl_snapshot *shot,
                               pl_vec3 beta, double faint, pl_arena *arena, pl_star_field *out,
                               pl_view_sky *view);

/* Contribution of a star at pixel position (u, v). */
void pl_star_splat_at(const pl_camera *camera, const pl_star *star, double u, double v,
                      pl_star_splat *out);

/* Solid angle of a pixel, sr; 0 where the lens has no ray. */
double pl_pixel_solid_angle(const pl_camera *camera, int x, int y);

#endif
