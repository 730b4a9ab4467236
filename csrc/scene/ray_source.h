/* Ray sources: one table of the ways in which a sensor places its rays in space and time. A camera
 * places one ray a pixel; scanners follow a pattern. Rays are in the sensor's axes: x right, y
 * down, z forward. Sources that are images also have a ray through every position of the image:
 * all pictures, their exposures, their metering and their labels are made of those (a snapshot has
 * the source of its frame; image_sample.h places the samples of pixels). */
#ifndef PL_SCENE_RAY_SOURCE_H
#define PL_SCENE_RAY_SOURCE_H

#include <stdint.h>

#include "scene/scene.h"

enum { PL_RAY_VALUES = 8, PL_SUB_RAYS_MAX = 256 };
/* Largest number of beams of a source. */
#define PL_BEAMS_MAX ((size_t)1 << 26)

/* A ray in the sensor's axes at its time. */
typedef struct pl_sensor_ray {
  pl_vec3 origin;    /* m */
  pl_vec3 direction; /* unit; zero where a lens has no ray */
  double time_s;     /* since the start of the frame's time */
  int32_t line;      /* channel of a scanner, row of an image */
} pl_sensor_ray;

/* A number that describes a source. */
typedef struct pl_ray_value {
  const char *name, *doc;
  double low, high; /* its range */
  bool whole;
} pl_ray_value;

typedef struct pl_ray_source pl_ray_source;

typedef struct pl_ray_source_kind {
  const char *name, *doc;
  const pl_ray_value *values;
  size_t value_count;
  /* Name and row length of the list of numbers that it needs; NULL: none. */
  const char *list;
  size_t list_row;
  bool camera;     /* it needs `camera` and `shutter` */
  bool fills_area; /* sub-rays fill the area of a pixel, not the disc of a beam */
  size_t (*count)(const pl_ray_source *source);
  double (*duration_s)(const pl_ray_source *source); /* time of the last beam */
  /* Sets beam `index`; `sub` of `source->sub_rays` matters with fills_area only. */
  void (*ray)(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out);
  /* Of an image: unit direction through position (u, v), with pixel centres at integers; zero where
   * there is no ray. NULL: the source is no image. */
  pl_vec3 (*at)(const pl_ray_source *source, double u, double v);
  /* A faster way to the same bits for `count` pixels of row v from u0 on, turned by `turn`; written
   * to three arrays. Returns false where there is none; NULL: there never is. */
  bool (*row)(const pl_ray_source *source, const pl_mat3 *turn, int u0, int v, size_t count,
              double *x, double *y, double *z);
  /* Of an image: pl_camera_project is the inverse of `at`. Otherwise no pixel is known to miss a
   * mesh, and all cast rays. */
  bool projects;
} pl_ray_source_kind;

struct pl_ray_source {
  const pl_ray_source_kind *kind;
  double value[PL_RAY_VALUES]; /* in the order of the kind's */
  const double *list;          /* borrowed */
  size_t list_count;           /* rows */
  pl_camera camera;            /* of pixels */
  pl_shutter shutter;
  int sub_rays;          /* rays of a beam, 1..PL_SUB_RAYS_MAX */
  double divergence_rad; /* full angle of a beam; 0: a line */
  double aperture_m;     /* diameter of a beam where it leaves the sensor */
};

/* The table. To add a source: its file, and its name here. */
#define PL_RAY_SOURCES(X)                                                                          \
  X(pixels)                                                                                        \
  X(given)                                                                                         \
  X(flash)                                                                                         \
  X(spinning)                                                                                      \
  X(raster)                                                                                        \
  X(lissajous)                                                                                     \
  X(rosette)
#define PL_DECLARE(name) extern const pl_ray_source_kind pl_ray_source_##name;
PL_RAY_SOURCES(PL_DECLARE)
#undef PL_DECLARE
extern const pl_ray_source_kind *const pl_ray_source_kinds[];
extern const size_t pl_ray_source_kind_count;

/* Returns PL_E_RANGE, naming the value, for a source that is not valid. */
pl_status pl_ray_source_check(const pl_ray_source *source);

/* Rays of a frame's camera. */
static inline pl_ray_source pl_ray_source_of_camera(const pl_camera *camera,
                                                    const pl_shutter *shutter) {
  return (pl_ray_source){
      .kind = &pl_ray_source_pixels, .camera = *camera, .shutter = *shutter, .sub_rays = 1};
}

/* Sets ray `sub` of beam `index`. The sub-rays of a beam cover its disc evenly (Vogel, "A better
 * way to construct the sunflower head", 1979), each with the same part of its power; one is the
 * beam's axis. */
void pl_ray_source_ray(const pl_ray_source *source, size_t index, int sub, pl_sensor_ray *out);

/* A cone that contains all beams, in sensor axes: its axis is the mean direction. */
void pl_ray_source_cone(const pl_ray_source *source, pl_vec3 *axis, double *half_angle_rad);

/* Unit direction at an azimuth (to the right of z) and elevation (up, against y). */
static inline pl_vec3 pl_ray_angles(double azimuth_rad, double elevation_rad) {
  const double level = cos(elevation_rad);
  return (pl_vec3){level * sin(azimuth_rad), -sin(elevation_rad), level * cos(azimuth_rad)};
}

#endif
