/* Planetshine: light that bodies reflect onto other things. A path that goes on from a surface is
 * drawn by the surface's lobe, or towards the bodies in its sky, as bright as each part of them
 * looks (render/body_radiance.h), and weighted by the density of both together (Veach 1997, the
 * balance heuristic of one sample): no ray more is cast. What it meets there is shaded as anything
 * else, so that the light is that of the body's own reflectance, map, air and shadows; a bad guess
 * of it makes noise, never an error.
 */
#ifndef PL_RENDER_PLANETSHINE_H
#define PL_RENDER_PLANETSHINE_H

#include "render/body_radiance.h"
#include "render/caustics.h"
#include "render/vertex.h"

/* Bodies that paths from one thing are drawn to: the brightest, as it sees them. */
enum { PL_PLANETSHINE_LIGHTS = 4 };

/* A body as one point sees it. */
typedef struct pl_planetshine_light {
  bool seen; /* the rest is not valid without */
  pl_body_disc disc;
  const pl_disc_table *table;
  pl_vec3f middle;           /* of its light: a unit direction */
  float irradiance, wide_sr; /* as in pl_body_radiance */
} pl_planetshine_light;

/* What is known of a thing's sky beforehand. */
typedef struct pl_planetshine_sky {
  const pl_body_radiance *look[PL_PLANETSHINE_LIGHTS];
  int count;
  bool far; /* from all of the thing the sky looks as from its centre: `lights` are valid */
  pl_planetshine_light lights[PL_PLANETSHINE_LIGHTS];
  float other; /* guess of the light by way of anything else, as radiance of a white surface */
} pl_planetshine_sky;

/* Read-only once built; shared by all workers. */
typedef struct pl_planetshine {
  const pl_snapshot *shot; /* borrowed */
  float white;             /* radiance beyond which noise is not seen, W m-2 sr-1 */
  pl_vec3 *suns;           /* of each body: the direction of the sun, root axes */
  float *radiance;         /* of each body where the sun is overhead, a guess, W m-2 sr-1 */
  pl_body_radiance *looks; /* things that see a body alike share one */
  size_t radiance_count;
  pl_planetshine_sky *skies; /* of each thing */
  bool any;                  /* something is to be drawn from anywhere */
} pl_planetshine;

/* Memory comes from `arena`. Bodies whose light is far below what is white are met by chance. Reads
 * of the settings what pl_body_radiance_make does, and their white_radiance. */
pl_status pl_planetshine_build(const pl_snapshot *shot, const struct pl_render_settings *settings,
                               pl_arena *arena, pl_planetshine *out);

/* Whether what a path finds on `thing` is planetshine, from the thing that it comes from. */
bool pl_planetshine_is_light(const pl_snapshot *shot, uint32_t thing, uint32_t from);

/* The bodies in the sky of one shaded vertex, and what mirrors the sun onto it. */
typedef struct pl_planetshine_ray {
  float share;    /* of draws that go to bodies and mirrors, 0..1; the rest is not valid at 0 */
  float mirrored; /* part of those that go to mirrors, 0..1; `mirrors` is not valid at 0 */
  pl_caustic_draws mirrors;
  int count;
  pl_body_disc disc[PL_PLANETSHINE_LIGHTS];
  const pl_disc_table *table[PL_PLANETSHINE_LIGHTS];
  float chance[PL_PLANETSHINE_LIGHTS]; /* of each, together 1 */
} pl_planetshine_ray;

/* `wo` in the surface's frame. `shine` NULL: no bodies are drawn to; `caustics` NULL: no mirrors.
 */
void pl_planetshine_at(const pl_planetshine *shine, const pl_caustics *caustics,
                       const pl_vertex *vertex, pl_vec3f wo, pl_planetshine_ray *out);

/* Where a path goes on, world axes. */
typedef struct pl_planetshine_draw {
  pl_vec3f direction, wi, weight; /* weight: reflected over pdf */
  float pdf, lobe_pdf;            /* of both ways of drawing, and of the surface's alone; 1/sr */
  bool set;                       /* of one that ends: the body is below the horizon there */
} pl_planetshine_draw;

/* False if the path ends; then only `set` is valid. */
bool pl_planetshine_sample(const pl_planetshine_ray *shine, const pl_surface *surface, pl_vec3f wo,
                           const float u[2], float choice, pl_planetshine_draw *out);

/* Density of that: `direction` in world axes, `wi` the same in the surface's frame. */
float pl_planetshine_pdf(const pl_planetshine_ray *shine, const pl_surface *surface, pl_vec3f wo,
                         pl_vec3f wi, pl_vec3f direction);

#endif
