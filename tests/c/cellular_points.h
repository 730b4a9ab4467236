/* The cellular texture at one point: that of all lanes with the same point in each. */
#ifndef PL_TESTS_CELLULAR_POINTS_H
#define PL_TESTS_CELLULAR_POINTS_H

#include "math/cellular.h"

typedef struct cellular {
  float first, second; /* distances to the nearest site and the next */
  pl_vec3f to_site;    /* from the point to the nearest site; -to_site/first is first's gradient */
  uint32_t id;         /* hash of the cell of the nearest site: constant over its Voronoi region */
} cellular;

/* The same point in all lanes. */
static inline pl_point_lanes everywhere(pl_vec3 point, float randomness, float spread[PL_LANES]) {
  pl_point_lanes out;
  for (size_t i = 0; i < PL_LANES; i++) {
    out.at[0][i] = point.x;
    out.at[1][i] = point.y;
    out.at[2][i] = point.z;
    spread[i] = randomness;
  }
  return out;
}

static inline cellular first_of(const pl_cellular_lanes *cell) {
  return (cellular){
      cell->first[0],
      cell->second[0],
      {cell->to_site[0][0], cell->to_site[1][0], cell->to_site[2][0]},
      cell->id[0],
  };
}

static inline cellular cellular_find(pl_vec3 point, float randomness, uint32_t seed) {
  float spread[PL_LANES];
  pl_cellular_lanes cell;
  const pl_point_lanes points = everywhere(point, randomness, spread);
  pl_cellular_find_lanes(&points, spread, seed, &cell);
  return first_of(&cell);
}

/* `cell` may be NULL. */
static inline float cellular_edge(pl_vec3 point, float randomness, uint32_t seed, cellular *cell) {
  float spread[PL_LANES], out[PL_LANES];
  pl_cellular_lanes cells;
  const pl_point_lanes points = everywhere(point, randomness, spread);
  pl_cellular_edge_lanes(&points, spread, seed, &cells, out, NULL);
  if (cell != NULL)
    *cell = first_of(&cells);
  return out[0];
}

static inline float cellular_smooth(pl_vec3 point, float randomness, float smoothness,
                                    uint32_t seed) {
  float spread[PL_LANES], out[PL_LANES];
  pl_cellular_lanes cells;
  const pl_point_lanes points = everywhere(point, randomness, spread);
  const float smooth[PL_LANES] = {smoothness};
  pl_cellular_smooth_lanes(1, &points, spread, smooth, seed, &cells, out, NULL);
  return out[0];
}

#endif
