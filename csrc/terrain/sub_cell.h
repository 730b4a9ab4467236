/* What a mesh of the ground leaves out, at a place: slopes of detail that is finer than its cells,
 * and how steep is what is finer still.
 *
 * A normal of the mesh is interpolated between posts, whose slopes are differences across two
 * cells. So it lacks not only the octaves of detail that are finer than its cells, but also parts
 * of those as wide. Down to the footprint of a sample they are evaluated here, to be added; of
 * everything else the laws of detail and craters have the variance. */
#ifndef PL_TERRAIN_SUB_CELL_H
#define PL_TERRAIN_SUB_CELL_H

#include "terrain/terrain.h"

typedef struct pl_sub_cell {
  pl_vec3 slope; /* to add to that of the mesh: rise over distance, along the ground, body axes */
  /* Of slopes along any one axis: of those that are still left out, and of `slope` and those. */
  double variance, whole;
  /* Share of the ground under rocks that are left out; their height over the ground, over their
   * width; variance of slopes of their surface along any one axis. */
  double stones, stone_height, stone_relief;
} pl_sub_cell;

/* In a unit direction, on a mesh with cells of a level of the lattice, over a footprint. Below the
 * posts of an elevation model, heights are taken to go on as the law of detail does. Without
 * `textures`, slopes of those that the mesh has not are all left out. */
pl_sub_cell pl_terrain_sub_cell(const pl_terrain *terrain, pl_vec3 direction, int level,
                                double footprint_m, bool textures);

/* Returns the variance of the slopes along any one axis that cells of a width leave out of the laws
 * of detail and craters. */
double pl_terrain_slope_variance(const pl_terrain *terrain, double cell_m);

/* Returns the variance of the slopes of detail and craters below roughness_baseline_m, which the
 * terrain has itself, as geometry or as variance: laws of reflectance have it no more. */
double pl_terrain_shared_variance(const pl_terrain *terrain);

/* Returns the part of Hapke's macroscopic roughness that is left without slopes of a variance along
 * an axis. */
double pl_roughness_without(double roughness_rad, double variance);

#endif
