/* Planetshine: light that bodies reflect onto other objects and bodies. The next segment of a path
 * is drawn from the surface's lobe, or towards the bodies in its sky, in proportion to the radiance
 * of each part of their discs (render/body_radiance.h), and is weighted by the combined density of
 * both (Veach 1997, the one-sample balance heuristic). No additional ray is traced. What it hits
 * there is shaded as usual, so that the light has the body's own reflectance, map, air and shadows.
 * A wrong estimate of the radiance adds noise, but no bias. */
#ifndef PL_RENDER_PLANETSHINE_H
#define PL_RENDER_PLANETSHINE_H

#include "render/body_radiance.h"
#include "render/caustics.h"
#include "render/vertex.h"

/* Maximum number of bodies that are sampled from one object or body: those it sees as brightest. */
enum { PL_PLANETSHINE_LIGHTS = 4 };

/* A body as seen from one point. */
typedef struct pl_planetshine_light {
  bool seen; /* whether it is visible; the rest is valid only if true */
  pl_body_disc disc;
  const pl_disc_table *table;
  pl_vec3f middle;           /* unit direction to the centre of its light */
  float irradiance, wide_sr; /* as in pl_body_radiance */
} pl_planetshine_light;

/* The bodies in the sky of one object or body, computed once per frame. */
typedef struct pl_planetshine_sky {
  const pl_body_radiance *estimate[PL_PLANETSHINE_LIGHTS];
  int count;
  /* the sky looks the same from all of the object as from its centre: `lights` are valid */
  bool far;
  pl_planetshine_light lights[PL_PLANETSHINE_LIGHTS];
  float other; /* estimate of the light by any other route, as radiance of a white surface */
} pl_planetshine_sky;

/* Read-only once built; shared by all workers. */
typedef struct pl_planetshine {
  const pl_snapshot *shot; /* borrowed */
  float white;             /* radiance shown as white; noise above it is not visible, W m-2 sr-1 */
  pl_vec3 *suns;           /* of each body: vector to the sun, root axes, m */
  float *radiance;         /* of each body: estimate for the sun overhead, W m-2 sr-1 */
  pl_body_radiance *estimates; /* shared by objects that see a body alike */
  size_t radiance_count;
  pl_planetshine_sky *skies; /* of each object and body */
  bool any;                  /* there is a body to sample from somewhere */
  /* To find the bodies that are bright in a sky. Of each node of the snapshot's tree of bodies: the
   * largest product of radiance and squared radius, W sr-1. */
  float *strength;
  uint32_t *found; /* body_count elements, scratch memory */
  size_t steps;    /* nodes visited so far, which tests count */
} pl_planetshine;

/* Allocates from `arena`. Bodies whose light is far below white are not sampled, but only hit by
 * chance. Reads white_radiance of the settings and what pl_body_radiance_make reads. */
pl_status pl_planetshine_build(const pl_snapshot *shot, const struct pl_render_settings *settings,
                               pl_arena *arena, pl_planetshine *out);

/* Whether light that a path from `from` finds on `id` is planetshine. */
bool pl_planetshine_is_light(pl_surface_id id, pl_surface_id from);

/* The bodies in the sky of one shaded vertex, and the mirrors that reflect the sun onto it. */
typedef struct pl_planetshine_ray {
  float fraction; /* of draws towards bodies and mirrors, 0..1; the rest is not valid at 0 */
  float mirrored; /* of these, fraction towards mirrors, 0..1; `mirrors` is not valid at 0 */
  pl_caustic_draws mirrors;
  int count;
  pl_body_disc disc[PL_PLANETSHINE_LIGHTS];
  const pl_disc_table *table[PL_PLANETSHINE_LIGHTS];
  float chance[PL_PLANETSHINE_LIGHTS]; /* probability of each; their sum is 1 */
} pl_planetshine_ray;

/* `wo`: in the surface's frame. `planetshine` NULL: no bodies are sampled; `caustics` NULL: no
 * mirrors.
 */
void pl_planetshine_at(const pl_planetshine *planetshine, const pl_caustics *caustics,
                       const pl_vertex *vertex, pl_vec3f wo, pl_planetshine_ray *out);

/* The next segment of a path, world axes. */
typedef struct pl_planetshine_draw {
  pl_vec3f direction, wi, weight; /* weight: reflectance times cosine over pdf */
  float pdf, lobe_pdf; /* of the combined density, and of the surface's lobe alone; 1/sr */
  bool set;            /* if the path ends: the target drawn is below the surface's horizon */
} pl_planetshine_draw;

/* False if the path ends; then only `set` is valid. */
bool pl_planetshine_sample(const pl_planetshine_ray *planetshine, const pl_surface *surface,
                           pl_vec3f wo, const float u[2], float choice, pl_planetshine_draw *out);

/* Density of pl_planetshine_sample; `direction`: in world axes, `wi`: the same in the surface's
 * frame. */
float pl_planetshine_pdf(const pl_planetshine_ray *planetshine, const pl_surface *surface,
                         pl_vec3f wo, pl_vec3f wi, pl_vec3f direction);

#endif
