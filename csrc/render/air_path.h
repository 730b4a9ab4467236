/* Atmospheres in the frame: light that they add along rays and take from them. */
#ifndef PL_RENDER_AIR_PATH_H
#define PL_RENDER_AIR_PATH_H

#include "air/air.h"
#include "base/memory.h"
#include "render/vertex.h"

struct pl_path_context;
struct pl_tile_buffers;
struct pl_tile;
struct pl_medium_list;

/* The air of one body. */
typedef struct pl_air_item {
  const pl_air *air;
  uint32_t body;
  pl_vec3f toward_sun; /* from the body's centre, root axes */
  pl_air_sun sun;
  float irradiance;  /* of the sun there, W m-2 */
  double reach_m;    /* radius of a sphere that holds the air */
  double distance_m; /* from the camera to that sphere; 0 inside */
} pl_air_item;

/* Read-only once built; shared by all workers. */
typedef struct pl_air_view {
  pl_air_item *items;
  size_t count;
  pl_air_rule rule;
  bool multiple, skylight;
} pl_air_view;

/* Lists the airs of a snapshot's bodies in `arena`; steps: nodes of the integrals along rays. */
pl_status pl_air_view_build(const pl_snapshot *shot, int steps, pl_arena *arena, pl_air_view *out);

/* A ray in the axes of an item's body; false if it meets none of its air before `end_m`. */
bool pl_air_item_ray(const pl_air_item *item, const pl_snapshot *shot, pl_vec3 origin,
                     pl_vec3 direction, double end_m, pl_air_ray *ray);

/* What the air makes of the background of a tile's pixels: bodies, and the black behind them. */
typedef struct pl_air_pixel {
  pl_air_light light;
  pl_vec3f sunlight, skylight; /* of the ground: see pl_air_sunlight and pl_air_skylight */
} pl_air_pixel;
/* Which of these is known for all of a pixel. */
typedef enum pl_air_known { PL_AIR_UNKNOWN, PL_AIR_SPACE, PL_AIR_GROUND } pl_air_known;

enum { PL_AIR_SIDE = 33 }; /* corners of a tile's pixels along a side */
typedef struct pl_air_corner {
  pl_air_known known; /* unknown: not asked yet */
  pl_air_pixel air;
} pl_air_corner;
/* Light up to a medium and along all of the ray, of one pixel of a block; t is 0: none yet. */
enum { PL_AIR_BLOCK = 4 };
typedef struct pl_air_block {
  double t;
  pl_air_light to_medium, whole;
} pl_air_block;
typedef struct pl_air_tile {
  const pl_air_item *item; /* the only one in the tile, of which pixels are known; or NULL */
  bool any;                /* whether any air may be in the tile */
  uint8_t known[1024];     /* a pl_air_known for each pixel */
  pl_air_pixel pixels[1024];
  pl_air_corner corners[PL_AIR_SIDE * PL_AIR_SIDE];
  /* Of known pixels: the way up to the first medium that a sample met, and its light; 0: none yet.
   */
  double medium_t[1024];
  pl_air_light to_medium[1024];
  pl_air_block blocks[1024 / (PL_AIR_BLOCK * PL_AIR_BLOCK)];
} pl_air_tile;

/* Whether any air may be in a cone of rays from the camera; `view` may be NULL. */
bool pl_air_in_cone(const pl_air_view *view, const pl_snapshot *shot, pl_vec3 axis,
                    double half_angle);
/* Fills buffers->air: air that changes evenly over the image is worked out at few places and
 * interpolated, where that is off by less than a quarter of the noise that samples may leave. */
void pl_air_prepare(const struct pl_path_context *context, struct pl_tile_buffers *buffers);
/* The light of a prefiltered ground point with a footprint: `direct` is what it sends of the sun's
 * without air. Media between it and its sky dim that. */
pl_vec3f pl_air_ground_light(const struct pl_path_context *context, uint32_t pixel,
                             const pl_vertex *vertex, pl_vec3f direct, float width_m,
                             const struct pl_tile_buffers *buffers);
/* What is seen of the radiance of a prefiltered ground point, through the media before it. */
pl_vec3f pl_air_seen(const struct pl_path_context *context, uint32_t pixel, pl_vec3f radiance,
                     const struct pl_medium_list *list, struct pl_tile_buffers *buffers);
/* Radiance of a pixel that holds nothing but air, before a sky of radiance `behind`; false if that
 * is not known to be so. */
bool pl_air_alone(const struct pl_path_context *context, uint32_t pixel, pl_vec3f behind,
                  pl_vec3f *radiance, const struct pl_tile_buffers *buffers);
/* Along the rays of a wave, whose hits are known: adds to the samples and dims what follows. */
void pl_air_apply(const struct pl_path_context *context, int bounce, size_t count,
                  struct pl_tile_buffers *buffers);
/* The same along one ray, number i of the wave, with the media that it crosses: their light is
 * added and dims what is beyond. */
void pl_air_pass(const struct pl_path_context *context, int bounce, size_t i,
                 const struct pl_medium_list *list, struct pl_tile_buffers *buffers);
/* Part of the light from a unit direction (towards the sun) that reaches a point. */
pl_vec3f pl_air_toward_sun(const pl_air_view *view, const pl_snapshot *shot, pl_vec3 point,
                           pl_vec3f toward);
/* What a shaded vertex on a body with air sends on of its skylight. */
pl_vec3f pl_air_sky_reflected(const pl_air_view *view, const pl_snapshot *shot,
                              const pl_vertex *vertex, pl_vec3f wo);

#endif
