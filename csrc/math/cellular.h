/* Cellular texture in space: one site in every unit cell, distances to the nearest of them.
 *
 * Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996, with one site a cell: `randomness`
 * 0 puts it in the middle (cubes), 1 anywhere in the cell; clamped to [0, 1]. Distances are
 * Euclidean, in cells, and exact: cells that could hold a nearer site are all searched, so that
 * they are continuous everywhere. */
#ifndef PL_MATH_CELLULAR_H
#define PL_MATH_CELLULAR_H

#include <stdint.h>

#include "math/vec.h"

typedef struct pl_cellular {
  float first, second; /* distances to the nearest site and the next */
  pl_vec3f to_site;    /* from the point to the nearest site; -to_site/first is first's gradient */
  uint32_t id;         /* hash of the cell of the nearest site: one value all over its region */
} pl_cellular;

pl_cellular pl_cellular_find(pl_vec3 point, float randomness, uint32_t seed);

/* Distance to the nearest wall between two regions, the plane halfway between their sites. What
 * pl_cellular_find gives is found on the way; `cell` may be NULL. */
float pl_cellular_edge(pl_vec3 point, float randomness, uint32_t seed, pl_cellular *cell);

/* The nearest distance with its creases rounded: -s ln sum exp(-d/s) over all sites, with
 * s = smoothness / 8, smoothness clamped to [0, 1]; 0 gives the distance itself. Below it by
 * s ln 2 where two sites are equally near, so it can be negative near sites. Sites that the
 * search does not see make steps below 1e-4. */
float pl_cellular_smooth(pl_vec3 point, float randomness, float smoothness, uint32_t seed);

/* Three uniform numbers in [0, 1) for an id, independent of where its site is. */
pl_vec3f pl_cellular_color(uint32_t id);

/* Means over space, by randomness; measured, within 5e-4 (0.4803 and 1/8 are exact at 0). */
float pl_cellular_mean_first(float randomness);
float pl_cellular_mean_second(float randomness);
float pl_cellular_mean_edge(float randomness);
float pl_cellular_mean_smooth(float randomness, float smoothness); /* within 2e-3 */

/* What is left of the departure from the mean over a footprint, a disc `width` cells across, as
 * pl_noise_fade: of distances and colours, and of edge distances. */
float pl_cellular_fade(float width);
float pl_cellular_edge_fade(float width);
#define PL_CELLULAR_WIDEST 2.5f
#define PL_CELLULAR_EDGE_WIDEST 1.5f

#endif
