/* Surfaces that emit light, as lights: triangles of emissive materials or graphs, and bodies with
 * emission, those with a shape by its triangles. Radiance is in W m-2 sr-1 per band, the same on
 * both sides of double-sided materials.
 */
#ifndef PL_LIGHT_EMITTERS_H
#define PL_LIGHT_EMITTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "scene/snapshot.h"

/* All that emits on one object, or one body. */
typedef struct pl_emitter {
  uint32_t thing; /* objects first, then bodies */
  pl_vec3 center; /* camera-relative, m */
  double radius_m;
  double power;        /* luminance times projected area, W sr-1 */
  double weight;       /* of a mesh: sum over its emissive triangles of luminance times area */
  size_t first, count; /* of its triangles */
} pl_emitter;

/* Read-only once built; shared by all workers. */
typedef struct pl_emitters {
  const pl_snapshot *shot; /* borrowed */
  pl_detail detail;        /* of emission maps */
  pl_emitter *items;
  size_t count;
  uint32_t *triangles; /* of all meshes, of each in rising order */
  float *luminances;   /* mean, of each of those */
  float *sums;         /* running share of the emitter's weight, up to 1 with its last triangle */
} pl_emitters;

/* A way from a point to a lit-up one. */
typedef struct pl_emitter_sample {
  uint32_t thing;     /* whose light it is */
  pl_vec3f direction; /* unit */
  double distance_m;  /* to stay below: short of the surface by more than rounding */
  float pdf;          /* per solid angle */
  pl_vec3f radiance;  /* arriving, if nothing is between */
} pl_emitter_sample;

/* Lists what emits among the things that the snapshot keeps; memory comes from `arena`. */
pl_status pl_emitters_build(const pl_snapshot *shot, pl_detail detail, pl_arena *arena,
                            pl_emitters *out);

/* Draws a point of an emitter as seen from `point` (camera-relative): u in
 * [0, 1)^2. False if what was drawn sends no light here. */
bool pl_emitters_sample(const pl_emitters *emitters, pl_vec3 point, const float u[2],
                        pl_emitter_sample *out);

/* Density with which pl_emitters_sample draws the direction of a ray from `point` that meets an
 * emitter, per solid angle. */
typedef struct pl_emitter_hit {
  uint32_t thing, triangle;
  double t;     /* along the ray, m */
  float cosine; /* between ray and geometric normal, absolute */
} pl_emitter_hit;
float pl_emitters_pdf(const pl_emitters *emitters, pl_vec3 point, const pl_emitter_hit *hit);

#endif
