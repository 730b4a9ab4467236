/* Caustics: sunlight by way of surfaces that mirror it, onto others. A diffuse surface finds such a
 * mirror by chance, and in it the sun, so seldom that what it finds are fireflies. But of a flat
 * mirror it is known where the sun is to be seen in it: about the sun's mirror image, as wide as
 * the mirror's lobe. Each frame has a table of flat, sunlit mirrors. Paths that go on from a
 * surface are drawn by its lobe, to bodies (planetshine.h), or to the table: to the lobe about a
 * mirror's image of the sun, or to the mirror's rectangle where that is the smaller of the two. The
 * density of all of these together weighs them (Veach 1997, the balance heuristic of one sample):
 * what a path meets is shaded as ever, so that a mirror that is bent, hidden or not in the table
 * makes noise, never an error. */
#ifndef PL_RENDER_CAUSTICS_H
#define PL_RENDER_CAUSTICS_H

#include "math/sampling.h"
#include "render/vertex.h"

/* Mirrors of a frame, and those of them that are drawn to from one point. */
enum { PL_CAUSTIC_MIRRORS = 24, PL_CAUSTIC_DRAWS = 6 };

/* Rougher lobes find the sun often enough by chance; by measurement (benchmarks/caustics.py). */
#define PL_CAUSTIC_ALPHA_MAX 0.15

/* A rectangle about facets that mirror the sun. */
typedef struct pl_caustic_mirror {
  uint32_t thing;
  pl_vec3 center; /* camera-relative, root axes, m */
  pl_basis basis; /* t, b: along the sides; n: on the side of the sun */
  float half[2];  /* of the sides, m */
  float area;     /* of the rectangle, m2 */
  float alpha;    /* GGX alpha of its lobe, with what its facets and the sun's disc add */
  pl_vec3f sun;   /* unit, root axes */
  pl_vec3f local; /* the same in the basis */
  pl_vec3f image; /* from anywhere towards the image of the sun: root axes, unit */
  float peak;     /* of the lobe: D(h) times this is the density of mirror directions, 1/sr */
  float light;    /* irradiance across the mirrored light, luminance, W m-2 */
} pl_caustic_mirror;

/* Read-only once built; shared by all workers. */
typedef struct pl_caustics {
  pl_caustic_mirror mirrors[PL_CAUSTIC_MIRRORS];
  size_t count;
  float sun; /* irradiance of the sun, W m-2 */
} pl_caustics;

/* Lists the mirrors of what the snapshot keeps whose light reaches other surfaces; `tracer` is set
 * to it. */
void pl_caustics_build(const pl_snapshot *shot, const pl_tracer *tracer, pl_detail detail,
                       pl_caustics *out);

/* What a point is drawn to. */
typedef struct pl_caustic_draw {
  const pl_caustic_mirror *mirror; /* borrowed */
  pl_vec3f from;                   /* the point from the mirror's centre, m */
  float chance;                    /* of the mirror; of all together 1 */
  float by_lobe;                   /* part of its draws that are by the lobe */
} pl_caustic_draw;
typedef struct pl_caustic_draws {
  int count;
  pl_caustic_draw draws[PL_CAUSTIC_DRAWS];
} pl_caustic_draws;

/* The mirrors that light a vertex. `wo` in the surface's frame. Returns a guess of the light that
 * it sends on of theirs, radiance; 0: none, `out` is not valid then. */
float pl_caustics_at(const pl_caustics *caustics, const pl_vertex *vertex, pl_vec3f wo,
                     pl_caustic_draws *out);

/* A unit direction, root axes; u in [0, 1)^2, `choice` in [0, 1). False if there is none. */
bool pl_caustics_sample(const pl_caustic_draws *draws, const float u[2], float choice,
                        pl_vec3f *direction);
/* Density of that, 1/sr. */
float pl_caustics_pdf(const pl_caustic_draws *draws, pl_vec3f direction);

#endif
