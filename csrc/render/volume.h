/* Light in bounded volumes, along rays and towards the sun. */
#ifndef PL_RENDER_VOLUME_H
#define PL_RENDER_VOLUME_H

#include "light/sun.h"
#include "render/volume_columns.h"

typedef struct pl_volume_item {
  const pl_shot_volume *shot;
  pl_sun_view sun;                  /* at the centre of its sphere, for all of it */
  pl_vec3 toward;                   /* to the sun, axes of the bound */
  float extinction_max;             /* of the bands, 1/m */
  const pl_volume_columns *columns; /* NULL where it is as dense everywhere */
} pl_volume_item;

/* Read-only once built; shared by all workers. */
typedef struct pl_volume_view {
  pl_volume_item items[PL_VOLUMES_MAX];
  size_t count;
  int steps; /* along a ray through one */
} pl_volume_view;

/* In `arena`; the volumes of a snapshot, which is borrowed. NULL without any. */
pl_status pl_volume_view_build(const pl_snapshot *shot, int steps, pl_arena *arena,
                               const pl_volume_view **out);

/* The sun's irradiance, W m-2 per band, at a camera-relative point but for what the volumes take of
 * it. */
typedef pl_vec3f (*pl_volume_sun_fn)(const void *context, pl_vec3 point, const pl_sun_view *sun);

/* What is asked of a ray. Camera-relative, root axes, m; unit direction. */
typedef struct pl_volume_ray {
  pl_vec3 origin, direction;
  float width_m, spread; /* as of a pl_beam */
  double t_max;
  bool camera; /* from the camera: volumes that are not in the frame are left out. Other rays
                * take a quarter of the steps where densities are graphs' */
  bool unlit;  /* what the volumes emit is left out */
  pl_volume_sun_fn sun; /* NULL: only what passes is wanted */
  const void *context;
} pl_volume_ray;

/* A part of the ray without gaps between volumes. */
typedef struct pl_volume_stretch {
  double start, end; /* m along the ray */
  pl_vec3f passed;   /* part of what comes from beyond, 0..1 */
  pl_vec3f radiance; /* towards the ray's start, W m-2 sr-1 */
} pl_volume_stretch;

/* Single scattering with the sun's way through all volumes, and emission: each of `steps` parts of
 * the ray sends on what its medium does at its middle, in closed form over its length, so that no
 * more is scattered than taken away. Where volumes overlap, densities add up. In order; returns how
 * many. */
size_t pl_volume_cross(const pl_volume_view *view, const pl_volume_ray *ray,
                       pl_volume_stretch out[PL_VOLUMES_MAX]);

/* Part of the sun's light that volumes leave at a camera-relative point. The sun counts as a point
 * there. */
pl_vec3f pl_volume_toward_sun(const pl_volume_view *view, pl_vec3 point);

#endif
