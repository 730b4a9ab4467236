/* Atmospheres in the frame: light scattered along rays, and attenuation. */
#ifndef PL_RENDER_AIR_PATH_H
#define PL_RENDER_AIR_PATH_H

#include "air/air.h"
#include "base/memory.h"
#include "render/vertex.h"

struct pl_path_context;
struct pl_tile_buffers;
struct pl_tile;
struct pl_medium_list;

/* The atmosphere of one body. */
typedef struct pl_air_item {
  const pl_air *air;
  uint32_t body;
  pl_vec3f toward_sun; /* unit, from the body's centre, root axes */
  pl_air_sun sun;
  float irradiance;  /* of the sun at the body, W m-2 */
  double reach_m;    /* radius of a sphere that encloses the air */
  double distance_m; /* from the camera to that sphere; 0 inside */
} pl_air_item;

/* Read-only once built; shared by all workers. */
typedef struct pl_air_view {
  pl_air_item *items;
  size_t count;
  pl_air_rule rule;
  bool multiple, skylight;
} pl_air_view;

/* Lists the atmospheres of a snapshot's bodies in `arena`. steps: nodes of the integrals along
 * rays. */
pl_status pl_air_view_build(const pl_snapshot *shot, int steps, pl_arena *arena, pl_air_view *out);

/* Sets a ray in the scaled axes of an item's body; false if it meets none of its air before
 * `end_m`. */
bool pl_air_item_ray(const pl_air_item *item, const pl_snapshot *shot, pl_vec3 origin,
                     pl_vec3 direction, double end_m, pl_air_ray *ray);

/* Air in front of one background pixel, which shows the ground of a body or black space. */
typedef struct pl_air_pixel {
  pl_air_light light;
  pl_vec3f sunlight, skylight; /* at the ground: see pl_air_sunlight and pl_air_skylight */
} pl_air_pixel;
/* What the whole pixel is known to show behind the air. */
typedef enum pl_air_known { PL_AIR_UNKNOWN, PL_AIR_SPACE, PL_AIR_GROUND } pl_air_known;

enum { PL_AIR_SIDE = 33 }; /* pixel corners along a side of a tile */
typedef struct pl_air_corner {
  pl_air_known known; /* PL_AIR_UNKNOWN: not evaluated yet */
  pl_air_pixel air;
} pl_air_corner;
/* Light up to a medium and along the whole ray, for one pixel of a block. t is 0 if nothing is
 * stored yet. */
enum { PL_AIR_BLOCK = 4 };
typedef struct pl_air_block {
  double t;
  pl_air_light to_medium, whole;
} pl_air_block;
typedef struct pl_air_tile {
  /* the only atmosphere in the tile, for which pixels are stored; or NULL */
  const pl_air_item *item;
  bool any;            /* true if any air may be in the tile */
  uint8_t known[1024]; /* a pl_air_known for each pixel */
  pl_air_pixel pixels[1024];
  pl_air_corner corners[PL_AIR_SIDE * PL_AIR_SIDE];
  /* For pixels with stored air: distance to the first medium that a sample met, and the light up to
   * it; 0: none yet. */
  double medium_t[1024];
  pl_air_light to_medium[1024];
  pl_air_block blocks[1024 / (PL_AIR_BLOCK * PL_AIR_BLOCK)];
} pl_air_tile;

/* True if any air may be in a cone of rays from the camera; `view` may be NULL. */
bool pl_air_in_cone(const pl_air_view *view, const pl_snapshot *shot, pl_vec3 axis,
                    double half_angle);
/* Fills buffers->air. Air that varies smoothly over the image is evaluated at few points and
 * interpolated where the interpolation error is less than half of the noise that samples may leave.
 */
void pl_air_prepare(const struct pl_path_context *context, struct pl_tile_buffers *buffers);
/* Light reflected by a prefiltered ground point with a footprint, towards the camera. `direct` is
 * the sunlight it would reflect without air. Media between the point and the sky attenuate the
 * skylight. */
pl_vec3f pl_air_ground_light(const struct pl_path_context *context, uint32_t pixel,
                             const pl_vertex *vertex, pl_vec3f direct, float width_m,
                             const struct pl_tile_buffers *buffers);
/* Radiance of a prefiltered ground point as it reaches the camera, through the air and media before
 * it. */
pl_vec3f pl_air_seen(const struct pl_path_context *context, uint32_t pixel, pl_vec3f radiance,
                     const struct pl_medium_list *list, struct pl_tile_buffers *buffers);
/* Radiance of a pixel that shows only air in front of a sky of radiance `behind`; false if it may
 * show anything else. */
bool pl_air_alone(const struct pl_path_context *context, uint32_t pixel, pl_vec3f behind,
                  pl_vec3f *radiance, const struct pl_tile_buffers *buffers);
/* Applies the air along the rays of a wave with known hits: adds scattered light to the samples and
 * attenuates the path throughputs. */
void pl_air_apply(const struct pl_path_context *context, int bounce, size_t count,
                  struct pl_tile_buffers *buffers);
/* The same along ray i of the wave, with the media that it crosses: their light is added, and they
 * attenuate the light from beyond. */
void pl_air_pass(const struct pl_path_context *context, int bounce, size_t i,
                 const struct pl_medium_list *list, struct pl_tile_buffers *buffers);
/* Transmittance of the air from a point in a unit direction (towards the sun), 0..1. */
pl_vec3f pl_air_toward_sun(const pl_air_view *view, const pl_snapshot *shot, pl_vec3 point,
                           pl_vec3f toward);
/* Skylight that a shaded vertex on a body with an atmosphere reflects towards `wo`. `traced`: paths
 * go on from the vertex. From terrain, they then find the light of the sky by themselves, as far as
 * hills do not hide it; where they end, that of a whole sky is taken. */
pl_vec3f pl_air_sky_reflected(const pl_air_view *view, const pl_snapshot *shot,
                              const pl_vertex *vertex, pl_vec3f wo, bool traced);

#endif
