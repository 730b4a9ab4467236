/* The sun as a light: a uniform disc of true angular size. */
#ifndef PL_LIGHT_SUN_H
#define PL_LIGHT_SUN_H

#include "math/vec.h"
#include "scene/snapshot.h"

/* The sun's disc as seen from one point of the scene. */
typedef struct pl_sun_view {
  pl_vec3f direction;  /* unit, to the centre of the disc */
  float sin_radius;    /* sine of the angular radius */
  float one_minus_cos; /* of the angular radius */
  float irradiance;    /* on a surface facing it, W m-2 per band */
  float radiance;      /* of the disc, W m-2 sr-1 per band */
  float distance_m;
} pl_sun_view;

/* `point` is camera-relative, root axes. A point inside the sun sees a full hemisphere. */
pl_sun_view pl_sun_view_at(const pl_shot_sun *sun, pl_vec3 point);
/* Samples a direction on the disc, uniform in solid angle; its density is pl_sun_pdf. */
pl_vec3f pl_sun_sample(const pl_sun_view *view, const float u[2]);
float pl_sun_pdf(const pl_sun_view *view);
/* True if a unit direction points at the disc. */
bool pl_sun_covers(const pl_sun_view *view, pl_vec3f direction);

/* True if a sphere covers a part of the disc as seen from a point, or contains the point. */
bool pl_sun_behind_sphere(const pl_sun_view *view, pl_vec3 point, pl_vec3 center, double radius_m);
/* Returns the next item of a tree, from node *k on, whose sphere does so if `margin_m` is added to
 * its radius; PL_NO_ITEM after the last. */
uint32_t pl_sun_next_sphere(const pl_sun_view *view, const pl_sphere_tree *tree, pl_vec3 point,
                            double margin_m, size_t *k);

#endif
