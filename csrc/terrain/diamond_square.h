/* Refinement of elevation models by diamond-square: heights between posts by midpoint displacement
 * on the lattice of the raster itself, each level with half the distance of nodes.
 *
 * The posts Z are split by a Gaussian of PL_DIAMOND_SIGMA posts into low and high frequencies. The
 * low ones are interpolated as the layer says; the high ones are refined. New nodes have weights
 * and variances of `terrain/midpoint_weights.h`; nodes that are there never move.
 *
 * A random number is a hash of seed, level and the node's place in the lattice of the projection,
 * counted from its origin: it does not depend on where a raster is cut. A value depends on the
 * place and the level alone: nodes are computed in blocks, which each thread keeps. */
#ifndef PL_TERRAIN_DIAMOND_SQUARE_H
#define PL_TERRAIN_DIAMOND_SQUARE_H

#include "terrain/detail_law.h"
#include "terrain/midpoint_weights.h"
#include "terrain/raster.h"

#define PL_DIAMOND_SIGMA 1.25
/* Levels below the posts. */
enum { PL_DIAMOND_LEVELS = 32 };
/* Ratios of the width to the height of cells for which there are weights, 2^-4 to 2^2; between
 * them they are interpolated. */
enum { PL_DIAMOND_RATIOS = 25 };

/* Weights of a law's ranges of Hurst exponents. */
typedef struct pl_diamond_weights {
  pl_midpoint at[PL_DETAIL_RANGES][PL_DIAMOND_RATIOS][2]; /* diamonds, squares */
} pl_diamond_weights;
void pl_diamond_weights_init(const pl_terrain_detail *law, pl_diamond_weights *out);

/* How one raster is refined. */
typedef struct pl_diamond_square {
  const pl_raster *raster; /* borrowed */
  pl_raster_interpolation interpolation;
  uint64_t number; /* no other in the process has it: key of what threads keep */
  double spacing_m;
  bool curved;                         /* cells narrow towards the poles */
  const pl_raster_axis *across, *down; /* lattices of the raster, borrowed */
  double post_ratio; /* width of cells over their height, at the equator of a cylindrical map */
  double add_m;      /* no displacement is greater: a bound that heights are cut at */
  /* By level, from 1 on: hash of its random numbers; nu over half a cell along y of the level
   * before, twice the distance of its own nodes; range of the law. */
  uint64_t key[PL_DIAMOND_LEVELS + 1];
  double deviation_m[PL_DIAMOND_LEVELS + 1];
  int range[PL_DIAMOND_LEVELS + 1];
} pl_diamond_square;

/* `law` must pass pl_terrain_detail_check. */
void pl_diamond_square_init(const pl_raster *raster, pl_raster_interpolation interpolation,
                            const pl_terrain_detail *law, const pl_diamond_weights *weights,
                            double radius_m, pl_diamond_square *out);

/* Returns how many levels nodes with cells of a width resolve; 0: none. */
int pl_diamond_levels(const pl_diamond_square *refined, double cell_m);

/* Returns what refinement to a level adds to the interpolated posts, at a column and row. */
double pl_diamond_square_height(const pl_diamond_square *refined, const pl_diamond_weights *weights,
                                int level, double u, double v);

#endif
