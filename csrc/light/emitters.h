/* Light-emitting surfaces as light sources: triangles with emissive materials or graphs, and bodies
 * with emission (those with a shape model by its triangles). Radiance is in W m-2 sr-1 per band,
 * and is the same on both sides of double-sided materials. */
#ifndef PL_LIGHT_EMITTERS_H
#define PL_LIGHT_EMITTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/snapshot.h"

/* One emitter: all emissive triangles of one object, or one body. */
typedef struct pl_emitter {
  pl_surface_id surface_id;
  pl_vec3 center; /* camera-relative, m */
  double radius_m;
  double power;        /* luminance times projected area, W sr-1 */
  double weight;       /* of a mesh: sum of luminance times area over its emissive triangles */
  size_t first, count; /* range of its triangles in pl_emitters */
} pl_emitter;

/* Read-only after construction; shared by all workers. */
typedef struct pl_emitters {
  const pl_snapshot *shot; /* borrowed */
  pl_detail detail;        /* level of detail of emission maps */
  pl_emitter *items;
  size_t count;
  uint32_t *triangles; /* emissive triangles of all meshes, increasing within each mesh */
  float *luminances;   /* mean luminance of each of these triangles */
  float *sums;         /* cumulative fraction of the emitter's weight, 1 at its last triangle */
} pl_emitters;

/* A sampled connection from a point to a point on an emitter. */
typedef struct pl_emitter_sample {
  pl_surface_id surface_id; /* the emitter */
  pl_vec3f direction;       /* unit */
  double distance_m; /* length of the shadow ray, short of the surface by more than rounding */
  float pdf;         /* per solid angle */
  pl_vec3f radiance; /* incident radiance, if unoccluded */
} pl_emitter_sample;

/* Lists the emitters among the objects and bodies that the snapshot keeps. Memory comes from
 * `arena`. */
pl_status pl_emitters_build(const pl_snapshot *shot, pl_detail detail, pl_arena *arena,
                            pl_emitters *out);

/* Samples a point of an emitter as seen from `point` (camera-relative), with u in [0, 1)^2. Returns
 * false if the sampled point sends no light to `point`. */
bool pl_emitters_sample(const pl_emitters *emitters, pl_vec3 point, const float u[2],
                        pl_emitter_sample *out);

/* Density per solid angle with which pl_emitters_sample draws the direction of a ray from `point`
 * that hits an emitter. */
typedef struct pl_emitter_hit {
  pl_surface_id surface_id;
  uint32_t triangle;
  double t;     /* distance along the ray, m */
  float cosine; /* absolute cosine between the ray and the geometric normal */
} pl_emitter_hit;
float pl_emitters_pdf(const pl_emitters *emitters, pl_vec3 point, const pl_emitter_hit *hit);

#endif
