/* Scattering, emission and extinction in bounded volumes, along rays and towards the sun. */
#ifndef PL_RENDER_VOLUME_H
#define PL_RENDER_VOLUME_H

#include "light/sun.h"
#include "render/volume_columns.h"

typedef struct pl_volume_item {
  const pl_shot_volume *shot;
  pl_sun_view sun;                  /* as seen from the centre of its sphere, for all of it */
  pl_vec3 toward;                   /* direction to the sun, axes of the bound */
  float extinction_max;             /* maximum over bands, 1/m */
  const pl_volume_columns *columns; /* NULL if the density is uniform */
} pl_volume_item;

/* Read-only once built; shared by all workers. */
typedef struct pl_volume_view {
  pl_volume_item items[PL_VOLUMES_MAX];
  size_t count;
  int steps; /* number of steps along a ray through a volume */
} pl_volume_view;

/* Builds the volumes of a snapshot, which is borrowed, in `arena`. NULL if there are none. */
pl_status pl_volume_view_build(const pl_snapshot *shot, int steps, pl_arena *arena,
                               const pl_volume_view **out);

/* The sun's irradiance, W m-2 per band, at a camera-relative point, without extinction by volumes.
 */
typedef pl_vec3f (*pl_volume_sun_fn)(const void *context, pl_vec3 point, const pl_sun_view *sun);

/* A ray, and what is wanted along it. Camera-relative, root axes, m; unit direction. */
typedef struct pl_volume_ray {
  pl_vec3 origin, direction;
  float width_m, spread; /* as in pl_beam */
  double t_max;
  /* it starts at the camera: volumes outside the frame are left out. Other rays take a quarter of
   * the steps where graphs define the density */
  bool camera;
  bool unlit;           /* without the volumes' emission */
  pl_volume_sun_fn sun; /* NULL: only the transmittance is wanted */
  const void *context;
} pl_volume_ray;

/* A part of the ray without gaps between volumes. */
typedef struct pl_volume_stretch {
  double start, end;      /* m along the ray */
  pl_vec3f transmittance; /* for light from beyond, 0..1 */
  pl_vec3f radiance;      /* towards the ray's start, W m-2 sr-1 */
} pl_volume_stretch;

/* Single scattering, with extinction towards the sun by all volumes, and emission. Each of `steps`
 * parts of the ray has the medium of its middle, integrated in closed form over its length, so that
 * no more is scattered than extinguished. Where volumes overlap, their densities add up. The
 * stretches are in order along the ray; returns their number. */
size_t pl_volume_cross(const pl_volume_view *view, const pl_volume_ray *ray,
                       pl_volume_stretch out[PL_VOLUMES_MAX]);

/* Transmittance of the volumes for sunlight at a camera-relative point. The sun is a point there.
 */
pl_vec3f pl_volume_toward_sun(const pl_volume_view *view, pl_vec3 point);

#endif
