/* The pyramid of a raster: means of cells, row by row. */
#include "terrain/raster_levels.h"

#include <float.h>

#include "base/memory.h"
#include "math/vec.h"

enum { ROWS_MAX = 3 };

/* Reads a row as floats, which hold all types exactly. */
static void read_row(const pl_raster_level *level, int row, float *restrict out) {
  const size_t start = (size_t)row * level->stride, count = (size_t)level->width;
  const void *samples = level->samples;
  switch (level->type) {
  case PL_RASTER_UINT8:
    for (size_t i = 0; i < count; i++)
      out[i] = (float)((const uint8_t *)samples)[start + i];
    break;
  case PL_RASTER_INT16:
    for (size_t i = 0; i < count; i++)
      out[i] = (float)((const int16_t *)samples)[start + i];
    break;
  case PL_RASTER_UINT16:
    for (size_t i = 0; i < count; i++)
      out[i] = (float)((const uint16_t *)samples)[start + i];
    break;
  default:
    for (size_t i = 0; i < count; i++)
      out[i] = ((const float *)samples)[start + i];
  }
}

static pl_status survey_row(pl_raster *r, int row, const float *values) {
  float low = values[0], high = values[0];
  int bad = 0;
  for (int i = 0; i < r->columns; i++) {
    low = pl_minf(low, values[i]);
    high = pl_maxf(high, values[i]);
    bad |= !(fabsf(values[i]) <= FLT_MAX);
  }
  for (int i = 0; bad && i < r->columns; i++)
    if (!isfinite(values[i]))
      return pl_fail(PL_E_RANGE, "the sample in column %d, row %d of a raster is not finite", i,
                     row);
  r->least = fmin(r->least, (double)low);
  r->greatest = fmax(r->greatest, (double)high);
  return PL_OK;
}

static pl_status survey(pl_raster *r, float *row_buffer) {
  r->least = INFINITY;
  r->greatest = -INFINITY;
  for (int row = 0; row < r->rows; row++) {
    read_row(&r->levels[0], row, row_buffer);
    PL_TRY(survey_row(r, row, row_buffer));
  }
  return PL_OK;
}

/* Fine cells under coarse cell j, and their weights, which sum to 1. */
typedef struct overlap {
  int first, count;
  double weights[ROWS_MAX];
} overlap;

static overlap overlap_of(int j, int coarse, int fine) {
  const double ratio = (double)fine / coarse, low = j * ratio, high = (j + 1) * ratio;
  overlap o = {.first = (int)((int64_t)j * fine / coarse)};
  for (int i = o.first; i < fine && i < high && o.count < ROWS_MAX; i++)
    o.weights[o.count++] = (fmin(high, i + 1.0) - fmax(low, i)) / ratio;
  return o;
}

/* Means of 2 x 2 cells. */
static void halve(const float *restrict a, const float *restrict b, int count,
                  float *restrict out) {
  for (int i = 0; i < count; i++) {
    const double above = (double)a[2 * i] + (double)a[2 * i + 1];
    const double below = (double)b[2 * i] + (double)b[2 * i + 1];
    out[i] = (float)(0.25 * (above + below));
  }
}

/* Computes a row of means; `rows`: a buffer for ROWS_MAX rows of the finer level. */
static void reduce_row(const pl_raster_level *from, const pl_raster_level *to, int row, float *rows,
                       float *out) {
  const overlap y = overlap_of(row, to->height, from->height);
  const size_t width = (size_t)from->width;
  for (int j = 0; j < y.count; j++)
    read_row(from, y.first + j, rows + (size_t)j * width);
  if (from->width == 2 * to->width && from->height == 2 * to->height) {
    halve(rows, rows + width, to->width, out);
    return;
  }
  for (int column = 0; column < to->width; column++) {
    const overlap x = overlap_of(column, to->width, from->width);
    double sum = 0.0;
    for (int j = 0; j < y.count; j++)
      for (int i = 0; i < x.count; i++)
        sum +=
            y.weights[j] * x.weights[i] * (double)rows[(size_t)j * width + (size_t)(x.first + i)];
    out[column] = (float)sum;
  }
}

static void reduce(pl_raster *r, float *rows) {
  float *next = r->memory;
  for (int k = 1; k < r->level_count; k++) {
    pl_raster_level *level = &r->levels[k];
    level->samples = next;
    for (int row = 0; row < level->height; row++, next += level->width)
      reduce_row(level - 1, level, row, rows, next);
  }
}

pl_status pl_raster_fill(pl_raster *r) {
  void *rows;
  PL_TRY(pl_alloc_or_fail((size_t)ROWS_MAX * (size_t)r->columns, sizeof(float), "rows of a raster",
                          &rows));
  const pl_status status = survey(r, rows);
  if (status == PL_OK)
    reduce(r, rows);
  pl_free(rows);
  return status;
}
