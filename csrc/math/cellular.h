/* Cellular texture in 3-D: one site in each unit cell, and distances to the nearest sites.
 *
 * Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996, with one site per cell: at randomness
 * 0 it is in the middle (cubes), at 1 anywhere in the cell; randomness is clamped to [0, 1].
 * Distances are Euclidean, in cells, and exact, because all cells that could contain a nearer site
 * are searched; hence they are continuous everywhere. */
#ifndef PL_MATH_CELLULAR_H
#define PL_MATH_CELLULAR_H

#include <stdint.h>

#include "math/lattice.h"
#include "math/vec.h"

/* Of all lanes: distances to the nearest site and the next, the way from the point to the nearest
 * (-to_site/first is the gradient of first), and the hash of its cell, which is constant over its
 * Voronoi region. Each lane has its own randomness. */
typedef struct pl_cellular_lanes {
  float first[PL_LANES], second[PL_LANES], to_site[3][PL_LANES];
  uint32_t id[PL_LANES];
} pl_cellular_lanes;
void pl_cellular_find_lanes(const pl_point_lanes *points, const float randomness[PL_LANES],
                            uint32_t seed, pl_cellular_lanes *cell);
/* pl_cellular_find_lanes with the gradient of the second distance. */
void pl_cellular_second_lanes(const pl_point_lanes *points, const float randomness[PL_LANES],
                              uint32_t seed, pl_cellular_lanes *cell, float gradient[3][PL_LANES]);

/* Distance to the nearest wall between two Voronoi regions, the plane halfway between their sites.
 * `cell` receives what pl_cellular_find_lanes finds; `gradient`, of the distance per cell, may be
 * NULL. */
void pl_cellular_edge_lanes(const pl_point_lanes *points, const float randomness[PL_LANES],
                            uint32_t seed, pl_cellular_lanes *cell, float out[PL_LANES],
                            float gradient[3][PL_LANES]);

/* Smooth minimum of the distances to sites: -s ln sum exp(-d/s) over all sites, with
 * s = smoothness / 8, smoothness clamped to [0, 1]; smoothness 0 gives the nearest distance. It is
 * lower than that by s ln 2 where two sites are equally near, and may be negative near sites. Sites
 * outside the search range cause discontinuities below 1e-4. `count` lanes are in use, the others
 * are those of lane 0. `cell` and `gradient` as for edges. */
void pl_cellular_smooth_lanes(size_t count, const pl_point_lanes *points,
                              const float randomness[PL_LANES], const float smoothness[PL_LANES],
                              uint32_t seed, pl_cellular_lanes *cell, float out[PL_LANES],
                              float gradient[3][PL_LANES]);

/* Three uniform numbers in [0, 1) for an id, independent of the position of its site. */
PL_WIDE_PART pl_vec3f pl_cellular_color(uint32_t id) {
  return pl_vec3f_make(pl_lattice_uniform(id, 3), pl_lattice_uniform(id, 4),
                       pl_lattice_uniform(id, 5));
}

/* Spatial means as a function of randomness; measured, within 5e-4 (0.4803 and 1/8 are exact at 0).
 */
float pl_cellular_mean_first(float randomness);
float pl_cellular_mean_second(float randomness);
float pl_cellular_mean_edge(float randomness);
float pl_cellular_mean_smooth(float randomness, float smoothness); /* within 2e-3 */

/* Factor on the deviation from the mean over a footprint, a disc with a diameter of `width` cells,
 * as in pl_noise_fade: for distances and colours, and for edge distances. */
#define PL_CELLULAR_WIDEST 2.5f
#define PL_CELLULAR_EDGE_WIDEST 1.5f
/* Over discs in random planes at randomness 1, the best factor for the first distance was measured
 * as 0.95 at a width of 0.3, 0.64 at 0.9, 0.38 at 1.45, 0.17 at 1.8; those for the second distance
 * and for colours are higher by up to 0.1. The curve is within 0.15 of all of them. */
PL_WIDE_PART float pl_cellular_fade(float width) {
  const float u = width * (1.0f / PL_CELLULAR_WIDEST);
  const float rest = 1.0f - u * u;
  return u < 1.0f ? rest * rest * rest : 0.0f;
}
/* Edge distances have half the wavelength. */
PL_WIDE_PART float pl_cellular_edge_fade(float width) {
  return pl_cellular_fade(width * (PL_CELLULAR_WIDEST / PL_CELLULAR_EDGE_WIDEST));
}

#endif
