/* Pyramid of float grids; each level has half as many cells as the finer one along both axes. */
#include "geom/grid.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "math/vec.h"

enum { LEVELS_MAX = 17, SIDE_MAX = 65536 };

typedef struct grid_level {
  int width, height;
  float *cells; /* in pl_grid.memory */
} grid_level;

struct pl_grid {
  pl_grid_frame frame;
  int level_count;
  grid_level levels[LEVELS_MAX]; /* 0 is the full resolution, the last is one cell */
  float *memory;                 /* owned */
};

/* Adds `weight` times `count` values to `sum`. */
static void add(float *sum, const float *values, float weight, int count) {
  for (int c = 0; c < count; c++)
    sum[c] += weight * values[c];
}

/* Returns the fraction of coarse cell j of `coarse` that fine cell i of `fine` covers. */
static double overlap(int j, int coarse, int i, int fine) {
  const double ratio = (double)fine / coarse;
  const double low = fmax(j * ratio, i), high = fmin((j + 1) * ratio, i + 1.0);
  return fmax(high - low, 0.0) / ratio;
}

/* Computes a coarse cell as the mean of the fine cells that it covers; cells across its edge count
 * by their covered fraction. */
static void reduce_cell(const grid_level *from, const grid_level *to, int x, int y, int channels) {
  float *out = to->cells + ((size_t)y * (size_t)to->width + (size_t)x) * (size_t)channels;
  memset(out, 0, (size_t)channels * sizeof *out);
  for (int j = y * from->height / to->height; j < from->height; j++) {
    const double wy = overlap(y, to->height, j, from->height);
    if (!(wy > 0.0))
      break;
    for (int i = x * from->width / to->width; i < from->width; i++) {
      const double wx = overlap(x, to->width, i, from->width);
      if (!(wx > 0.0))
        break;
      const size_t cell = (size_t)j * (size_t)from->width + (size_t)i;
      add(out, from->cells + cell * (size_t)channels, (float)(wx * wy), channels);
    }
  }
}

static int half(int n) { return n > 1 ? n / 2 : 1; }

/* Sets the sizes of all levels; returns their total number of values. */
static size_t lay_out(pl_grid *grid) {
  int width = grid->frame.width, height = grid->frame.height;
  size_t values = 0;
  for (grid->level_count = 0;; width = half(width), height = half(height)) {
    grid->levels[grid->level_count++] = (grid_level){.width = width, .height = height};
    values += (size_t)width * (size_t)height * (size_t)grid->frame.channels;
    if (width == 1 && height == 1)
      return values;
  }
}

static void fill(pl_grid *grid, const float *values) {
  const int channels = grid->frame.channels;
  float *next = grid->memory;
  for (int k = 0; k < grid->level_count; k++) {
    grid_level *level = &grid->levels[k];
    level->cells = next;
    next += (size_t)level->width * (size_t)level->height * (size_t)channels;
    for (int y = 0; k > 0 && y < level->height; y++)
      for (int x = 0; x < level->width; x++)
        reduce_cell(level - 1, level, x, y, channels);
    if (k == 0)
      memcpy(level->cells, values, (size_t)(next - level->cells) * sizeof *values);
  }
}

static pl_status check(const pl_grid_frame *f, const float *values) {
  if (f->width < 1 || f->height < 1 || f->width > SIDE_MAX || f->height > SIDE_MAX ||
      f->channels < 1 || f->channels > PL_GRID_CHANNELS_MAX)
    return pl_fail(PL_E_RANGE, "a grid of %d x %d cells of %d values", f->width, f->height,
                   f->channels);
  if (!(f->north_rad > f->south_rad && isfinite(f->west_rad) && isfinite(f->north_rad) &&
        isfinite(f->south_rad)))
    return pl_fail(PL_E_RANGE, "a grid from %g down to %g rad of latitude", f->north_rad,
                   f->south_rad);
  const size_t count = (size_t)f->width * (size_t)f->height * (size_t)f->channels;
  for (size_t i = 0; i < count; i++)
    if (!isfinite(values[i]))
      return pl_fail(PL_E_RANGE, "value %zu of a grid is not finite", i);
  return PL_OK;
}

pl_status pl_grid_create(const pl_grid_frame *frame, const float *values, pl_grid **out) {
  void *memory;
  *out = NULL;
  PL_TRY(check(frame, values));
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_grid), "a grid", &memory));
  pl_grid *grid = memory;
  grid->frame = *frame;
  const size_t count = lay_out(grid);
  const pl_status status = pl_alloc_or_fail(count, sizeof(float), "cells of a grid", &memory);
  if (status != PL_OK) {
    pl_free(grid);
    return status;
  }
  grid->memory = memory;
  fill(grid, values);
  *out = grid;
  return PL_OK;
}

void pl_grid_destroy(pl_grid *grid) {
  if (grid == NULL)
    return;
  pl_free(grid->memory);
  pl_free(grid);
}

const pl_grid_frame *pl_grid_frame_of(const pl_grid *grid) { return &grid->frame; }

const float *pl_grid_mean(const pl_grid *grid) { return grid->levels[grid->level_count - 1].cells; }

const float *pl_grid_cell(const pl_grid *grid, int x, int y) {
  const size_t cell = (size_t)y * (size_t)grid->frame.width + (size_t)x;
  return grid->levels[0].cells + cell * (size_t)grid->frame.channels;
}

/* Adds `weight` times the bilinear value of a level at u (0..1, longitude) and v (0..1, from the
 * north). */
static void add_bilinear(const grid_level *level, double u, double v, float weight, int channels,
                         float *sum) {
  const double x = u * level->width - 0.5;
  const double y = fmin(fmax(v * level->height - 0.5, 0.0), level->height - 1.0);
  const int x0 = (int)floor(x), y0 = (int)y;
  const float fx = (float)(x - x0), fy = (float)(y - y0);
  const size_t column[2] = {(size_t)(x0 < 0 ? level->width - 1 : x0 % level->width),
                            (size_t)((x0 + 1) % level->width)};
  const size_t row[2] = {(size_t)y0, (size_t)(y0 + 1 < level->height ? y0 + 1 : y0)};
  const float wx[2] = {1.0f - fx, fx}, wy[2] = {1.0f - fy, fy};
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < 2; i++) {
      const float *cell =
          level->cells + (row[j] * (size_t)level->width + column[i]) * (size_t)channels;
      if (wx[i] * wy[j] > 0.0f)
        add(sum, cell, weight * wx[i] * wy[j], channels);
    }
}

void pl_grid_sample(const pl_grid *grid, double lon_rad, double lat_rad, double size_rad,
                    float *out) {
  const pl_grid_frame *f = &grid->frame;
  const double turn = (lon_rad - f->west_rad) / (2.0 * PL_PI);
  const double v = (f->north_rad - lat_rad) / (f->north_rad - f->south_rad);
  const double cell_rad = (f->north_rad - f->south_rad) / f->height;
  const double beyond = fmax(fmax(lat_rad - f->north_rad, f->south_rad - lat_rad), 0.0);
  const double top = grid->level_count - 1;
  const double level =
      fmin(fmax(log2(fmax(fmax(size_rad, 2.0 * beyond) / cell_rad, 1.0)), 0.0), top);
  const int fine = (int)level;
  const float coarse = (float)(level - fine);
  memset(out, 0, (size_t)f->channels * sizeof *out);
  add_bilinear(&grid->levels[fine], turn - floor(turn), v, 1.0f - coarse, f->channels, out);
  if (coarse > 0.0f)
    add_bilinear(&grid->levels[fine + 1], turn - floor(turn), v, coarse, f->channels, out);
}
