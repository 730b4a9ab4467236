/* Refinement of elevation models by diamond-square. */
#include "terrain/diamond_square.h"

#include <math.h>
#include <stdatomic.h>

#include "base/hash.h"
#include "terrain/diamond_blocks.h"
#include "terrain/interpolation.h"

/* Interpolation passes its posts by at most this part of their range (two Catmull-Rom curves). */
#define BEYOND (9.0 / 16.0)
/* Heights are cut off at this many standard deviations, as those of terrain/fractal_detail.h. */
#define BOUND 6.0

/* ---- the law on the lattice ----------------------------------------------------------------- */

static double ratio_of(int k) { return exp2(0.25 * k - 4.0); }

void pl_diamond_weights_init(const pl_terrain_detail *law, pl_diamond_weights *out) {
  for (size_t range = 0; range < law->range_count; range++)
    for (int k = 0; k < PL_DIAMOND_RATIOS; k++)
      for (int step = 0; step < 2; step++)
        out->at[range][k][step] =
            pl_midpoint_make(law->ranges[range].hurst, ratio_of(k), (pl_midpoint_step)step);
}

static int range_of(const pl_terrain_detail *law, double baseline_m) {
  int range = 0;
  while ((size_t)range + 1 < law->range_count && law->ranges[range + 1].from_m <= baseline_m)
    range++;
  return range;
}

static void set_levels(const pl_terrain_detail *law, double cell_m, pl_diamond_square *out) {
  const pl_projection *map = &pl_raster_frame_of(out->raster)->projection;
  for (int level = 1; level <= PL_DIAMOND_LEVELS; level++) {
    const double wide_m = ldexp(cell_m, 1 - level);
    const uint64_t words[4] = {law->seed, (uint64_t)level, (uint64_t)map->kind,
                               (uint64_t)llrint(4.0 * log2(cell_m))};
    out->key[level] = pl_hash(PL_HASH_SEED, words, sizeof words);
    out->range[level] = range_of(law, wide_m);
    out->deviation_m[level] =
        wide_m <= law->longest_m ? law->strength * pl_terrain_detail_deviation_m(law, wide_m) : 0.0;
  }
}

/* The widest cells have the greatest variance, relative to their width. */
static double bound_m(const pl_diamond_square *of, const pl_diamond_weights *weights) {
  double low, high, variance = 0.0;
  pl_raster_bounds(of->raster, PL_INTERPOLATION_BILINEAR, &low, &high);
  for (int level = 1; level <= PL_DIAMOND_LEVELS; level++)
    for (int step = 0; step < 2; step++) {
      double most = 0.0;
      for (int k = 0; k < PL_DIAMOND_RATIOS; k++)
        most = fmax(most, weights->at[of->range[level]][k][step].variance);
      variance += most * of->deviation_m[level] * of->deviation_m[level];
    }
  return BEYOND * (high - low) + BOUND * sqrt(variance);
}

void pl_diamond_square_init(const pl_raster *raster, pl_raster_interpolation interpolation,
                            const pl_terrain_detail *law, const pl_diamond_weights *weights,
                            double radius_m, pl_diamond_square *out) {
  static atomic_ullong numbers;
  const pl_raster_frame *frame = pl_raster_frame_of(raster);
  const double ratio = fabs(frame->dx / frame->dy);
  *out = (pl_diamond_square){.raster = raster, .interpolation = interpolation};
  out->number = atomic_fetch_add(&numbers, 1) + 1;
  out->curved = frame->projection.kind == PL_PROJECTION_CYLINDRICAL;
  out->post_ratio = ratio;
  out->spacing_m = pl_raster_spacing_m(raster, radius_m);
  out->across = pl_raster_across(raster);
  out->down = pl_raster_down(raster);
  set_levels(law, out->curved ? out->spacing_m : out->spacing_m / sqrt(ratio), out);
  out->add_m = bound_m(out, weights);
}

int pl_diamond_levels(const pl_diamond_square *refined, double cell_m) {
  const int levels = (int)lrint(log2(refined->spacing_m / cell_m));
  return levels < 0 ? 0 : levels < PL_DIAMOND_LEVELS ? levels : PL_DIAMOND_LEVELS;
}

enum { SIDE = PL_DIAMOND_SIDE, NODES = PL_DIAMOND_NODES, APRON = PL_DIAMOND_APRON };

/* ---- values --------------------------------------------------------------------------------- */

/* The value of a level's nodes at a column and row of it. */
static double value_at(const pl_diamond_square *of, const pl_diamond_weights *weights, int level,
                       double u, double v, pl_raster_interpolation how) {
  const double column = floor(u), row = floor(v), s = u - column, t = v - row;
  const double i = floor(column / SIDE), j = floor(row / SIDE);
  const pl_diamond_block *at = pl_diamond_block_at(of, weights, level, (int64_t)i, (int64_t)j);
  const double *h =
      &at->h_m[((int)(row - j * SIDE) + APRON) * NODES + (int)(column - i * SIDE) + APRON];
  double rows[4];
  if (how == PL_INTERPOLATION_BILINEAR)
    return pl_linear(pl_linear(h[0], h[1], s), pl_linear(h[NODES], h[NODES + 1], s), t);
  for (int k = 0; k < 4; k++)
    rows[k] = pl_catmull_rom(h + (k - 1) * NODES - 1, s);
  return pl_catmull_rom(rows, t);
}

double pl_diamond_square_height(const pl_diamond_square *refined, const pl_diamond_weights *weights,
                                int level, double u, double v) {
  const double fine =
      value_at(refined, weights, level, ldexp(u, level), ldexp(v, level), PL_INTERPOLATION_CUBIC);
  const double posts = value_at(refined, weights, 0, u, v, refined->interpolation);
  return fmin(fmax(fine - posts, -refined->add_m), refined->add_m);
}
