/* The stars of one frame: which are in it, what they may change, and what they add to pixels. */
#ifndef PL_SKY_STARS_H
#define PL_SKY_STARS_H

#include "base/memory.h"
#include "plan/view.h"
#include "scene/snapshot.h"
#include "sky/catalogue.h"

/* A star in the frame. */
typedef struct pl_field_star {
  const pl_star *star; /* borrowed from the catalogue */
  pl_vec3 direction;   /* unit, root axes, as the moving camera sees it */
  double u, v;         /* pixel position of its centre */
  int level;           /* tenths of a magnitude fainter than the brightest of the field, from 1 */
} pl_field_star;

typedef struct pl_star_field {
  pl_field_star *stars; /* the brightest first; of equally bright ones in catalogue order */
  size_t count;
  int levels; /* of the faintest */
} pl_star_field;

/* What a star adds to the four pixels about its centre: radiances whose integral over the pixels'
 * solid angles is its irradiance, less the part that lies beyond the image. Weights are bilinear,
 * so the centre of the light is the star's place. */
typedef struct pl_star_splat {
  int count;
  uint32_t pixels[4]; /* y * width + x */
  pl_vec3f light[4];  /* W m-2 sr-1 */
} pl_star_splat;

/* Where a star at rest in the sky is seen by an observer of velocity `beta` (of light's): special
 * relativity, without the bending of light by the sun. Unit in, unit out. */
pl_vec3 pl_star_aberrate(pl_vec3 direction, pl_vec3 beta);

/* Lists the stars that the camera of `shot` sees, hidden ones too, and fills the view's part. Stars
 * of a cell of the sky are left out where all of them together cannot add more than `faint` (W m-2
 * sr-1) to a pixel; the view says how much they may. Memory is the arena's. */
pl_status pl_star_field_gather(const pl_star_catalogue *catalogue, const pl_snapshot *shot,
                               pl_vec3 beta, double faint, pl_arena *arena, pl_star_field *out,
                               pl_view_sky *view);

/* What a star at pixel position (u, v) adds. */
void pl_star_splat_at(const pl_camera *camera, const pl_star *star, double u, double v,
                      pl_star_splat *out);

/* Solid angle of a pixel, sr; 0 where the lens has no ray. */
double pl_pixel_solid_angle(const pl_camera *camera, int x, int y);

#endif
