/* Caustics: sunlight reflected by mirrors onto other surfaces. Paths from a diffuse surface hit
 * such a mirror, and the sun in it, so rarely that the result is fireflies. In a flat mirror,
 * however, the place of the sun is known: its mirror image, blurred by the mirror's lobe. Each
 * frame has a table of flat, sunlit mirrors. The next direction of a path is sampled from the
 * surface's BSDF, towards bodies (planetshine.h), or from the table: from the lobe about a mirror's
 * image of the sun, or over the mirror's rectangle where that is the smaller of the two. The sample
 * is weighted by the combined density of all these strategies (Veach 1997, one-sample balance
 * heuristic). What a path hits is shaded as usual, so that a mirror that is curved, hidden or
 * missing from the table adds noise but no bias. */
#ifndef PL_RENDER_CAUSTICS_H
#define PL_RENDER_CAUSTICS_H

#include "math/sampling.h"
#include "render/vertex.h"

/* Number of mirrors of a frame, and number that one point samples. */
enum { PL_CAUSTIC_MIRRORS = 24, PL_CAUSTIC_DRAWS = 6 };

/* BSDF sampling finds the sun often enough in rougher lobes; measured with benchmarks/caustics.py.
 */
#define PL_CAUSTIC_ALPHA_MAX 0.15

/* A rectangle that bounds facets which mirror the sun. */
typedef struct pl_caustic_mirror {
  pl_surface_id surface_id;
  pl_vec3 center; /* camera-relative, root axes, m */
  pl_basis basis; /* t, b: along the sides; n: on the sun's side */
  float half[2];  /* half lengths of the sides, m */
  float area;     /* of the rectangle, m2 */
  float alpha;  /* GGX alpha of its lobe, widened by the spread of its facets and the sun's disc */
  pl_vec3f sun; /* direction to the sun: unit, root axes */
  pl_vec3f local; /* the same in the basis */
  pl_vec3f image; /* direction from any point to the image of the sun: unit, root axes */
  float peak;     /* D(h) times this is the density of mirror directions, 1/sr */
  float light;    /* luminance of the irradiance across the reflected beam, W m-2 */
} pl_caustic_mirror;

/* Read-only once built; shared by all workers. */
typedef struct pl_caustics {
  pl_caustic_mirror mirrors[PL_CAUSTIC_MIRRORS];
  size_t count;
  float sun; /* irradiance of the sun, W m-2 */
} pl_caustics;

/* Lists the mirrors on objects kept in the snapshot whose light reaches other surfaces. `tracer`
 * must be set to the snapshot. */
void pl_caustics_build(const pl_snapshot *shot, const pl_tracer *tracer, pl_detail detail,
                       pl_caustics *out);

/* A mirror as it is sampled from a point. */
typedef struct pl_caustic_draw {
  const pl_caustic_mirror *mirror; /* borrowed */
  pl_vec3f from;                   /* the point from the mirror's centre, m */
  float chance;                    /* probability of this mirror; all together 1 */
  float by_lobe;                   /* probability that a sample of it is drawn from its lobe */
} pl_caustic_draw;
typedef struct pl_caustic_draws {
  int count;
  pl_caustic_draw draws[PL_CAUSTIC_DRAWS];
} pl_caustic_draws;

/* Selects the mirrors that light a vertex. `wo` in the surface's frame. Returns an estimate of the
 * radiance that the vertex reflects of their light, W m-2 sr-1; if it is 0 there are none and `out`
 * is not valid. */
float pl_caustics_at(const pl_caustics *caustics, const pl_vertex *vertex, pl_vec3f wo,
                     pl_caustic_draws *out);

/* Samples a unit direction, root axes; u in [0, 1)^2, `choice` in [0, 1). False if the sample is
 * invalid. */
bool pl_caustics_sample(const pl_caustic_draws *draws, const float u[2], float choice,
                        pl_vec3f *direction);
/* Density of pl_caustics_sample at a direction, 1/sr. */
float pl_caustics_pdf(const pl_caustic_draws *draws, pl_vec3f direction);

#endif
