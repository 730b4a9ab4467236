/* Detail at the posts of rasters, and its interpolation between them. */
#include "terrain/terrain_parts.h"

#include <math.h>
#include <string.h>

void pl_posts_init(pl_posts *posts, int level) {
  posts->level = level;
  posts->count = 0;
  pl_detail_cache_init(&posts->cache);
  posts->strip.count = 0;
  memset(posts->layer, -1, sizeof posts->layer);
}

/* Gives the posts in the strip their values. */
static void flush(pl_posts *posts, const pl_terrain *terrain, int layer) {
  const pl_fractal_detail *detail = &terrain->detail;
  const int coarsest = terrain->layers[layer].coarsest;
  double sums_m[PL_DETAIL_STRIP] = {0.0};
  pl_detail_strip_close(&posts->strip);
  for (int k = posts->level < detail->last ? posts->level : detail->last; k >= coarsest; k--)
    pl_fractal_detail_add(detail, &posts->strip, k, posts->level, &posts->cache, sums_m);
  const double bound_m =
      PL_DETAIL_BOUND * pl_fractal_detail_deviation_m(detail, coarsest, posts->level);
  for (size_t k = 0; k < posts->strip.count; k++)
    posts->q_m[posts->pending[k]] = pl_fractal_detail_cut(sums_m[k], bound_m);
  posts->strip.count = 0;
}

static uint32_t slot_of(int layer, int column, int row) {
  const uint32_t hash = ((uint32_t)column * 0x9e3779b1u + (uint32_t)row) * 0x85ebca6bu;
  return (hash ^ (hash >> 15) ^ (uint32_t)layer) % PL_POSTS;
}

/* Returns the index of a post in the table, into which it is put if it is not there. */
static int find(pl_posts *posts, const pl_terrain *terrain, int layer, int column, int row) {
  uint32_t slot = slot_of(layer, column, row);
  for (; posts->layer[slot] >= 0; slot = (slot + 1) % PL_POSTS)
    if (posts->column[slot] == column && posts->row[slot] == row && posts->layer[slot] == layer)
      return (int)slot;
  posts->layer[slot] = (int16_t)layer;
  posts->column[slot] = column;
  posts->row[slot] = row;
  posts->count++;
  pl_detail_strip *strip = &posts->strip;
  const pl_vec3 direction =
      pl_raster_direction(terrain->layers[layer].given.raster, (double)column, (double)row);
  strip->x[strip->count] = direction.x;
  strip->y[strip->count] = direction.y;
  strip->z[strip->count] = direction.z;
  posts->pending[strip->count++] = (int)slot;
  if (strip->count == PL_DETAIL_STRIP)
    flush(posts, terrain, layer);
  return (int)slot;
}

/* The posts around a place: 2 x 2 of a bilinear, 4 x 4 of a cubic interpolation. */
typedef struct stencil {
  int side, slots[PL_STENCIL];
} stencil;

static void place(pl_posts *posts, const pl_terrain *terrain, int layer, int column, int row,
                  stencil *out) {
  const bool cubic = terrain->layers[layer].given.interpolation == PL_INTERPOLATION_CUBIC;
  const int before = cubic ? 1 : 0;
  out->side = cubic ? 4 : 2;
  for (int b = 0; b < out->side; b++)
    for (int a = 0; a < out->side; a++)
      out->slots[b * out->side + a] =
          find(posts, terrain, layer, column + a - before, row + b - before);
}

/* Weights of the posts along one axis, as those of pl_raster_value. */
static void weigh(int side, double f, double weights[4]) {
  if (side == 2) {
    weights[0] = 1.0 - f;
    weights[1] = f;
    return;
  }
  weights[0] = 0.5 * f * (f * (2.0 - f) - 1.0);
  weights[1] = 0.5 * (f * f * (3.0 * f - 5.0) + 2.0);
  weights[2] = 0.5 * f * (f * (4.0 - 3.0 * f) + 1.0);
  weights[3] = 0.5 * f * f * (f - 1.0);
}

static double interpolate(const pl_posts *posts, const stencil *at, double fu, double fv) {
  double across[4], down[4], sum = 0.0;
  weigh(at->side, fu, across);
  weigh(at->side, fv, down);
  for (int b = 0; b < at->side; b++) {
    double row = 0.0;
    for (int a = 0; a < at->side; a++)
      row += across[a] * posts->q_m[at->slots[b * at->side + a]];
    sum += down[b] * row;
  }
  return sum;
}

void pl_posts_interpolate(pl_posts *posts, const pl_terrain *terrain, int layer, size_t count,
                          const double *u, const double *v, const bool *wanted, double *out_m) {
  stencil around[PL_DETAIL_STRIP];
  if (posts->count > PL_POSTS - 2 * PL_DETAIL_STRIP * PL_STENCIL)
    pl_posts_init(posts, posts->level);
  int column = INT32_MIN, row = INT32_MIN;
  size_t last = 0;
  for (size_t k = 0; k < count; k++) {
    if (!wanted[k])
      continue;
    const int c = (int)floor(u[k]), r = (int)floor(v[k]);
    if (c == column && r == row)
      around[k] = around[last];
    else
      place(posts, terrain, layer, c, r, &around[k]);
    column = c;
    row = r;
    last = k;
  }
  flush(posts, terrain, layer);
  for (size_t k = 0; k < count; k++)
    if (wanted[k])
      out_m[k] = interpolate(posts, &around[k], u[k] - floor(u[k]), v[k] - floor(v[k]));
}
