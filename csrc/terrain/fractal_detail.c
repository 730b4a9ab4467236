/* Fractal detail: octaves of B-spline noise on cubic lattices. */
#include "terrain/fractal_detail.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "base/wide.h"
#include "base/work.h"
#include "math/philox.h"
#include "math/rotation.h"
#include "math/sampler.h"

enum { STRIP = PL_DETAIL_STRIP };
#define PRIME 0x9e3779b1u /* the odd number nearest 2^32/phi */

/* Variance of a number, uniform among all integers of 32 bits. The squares of the spline's weights
 * have the mean sum 151/315 an axis. */
#define NUMBER_VARIANCE (0x1p64 / 12.0)
#define WEIGHTS (151.0 / 315.0)

/* Axes of a uniformly distributed rotation (Shoemake 1992), as long as the radius is wide in cells
 * of the level. */
static void turn(const uint64_t key[2], int level, pl_vec3 axes[3]) {
  const uint64_t counter[4] = {0};
  uint64_t words[4];
  pl_philox(key, counter, words);
  const double u = pl_philox_double(words[0]), v = 2.0 * PL_PI * pl_philox_double(words[1]);
  const double w = 2.0 * PL_PI * pl_philox_double(words[2]), cells = ldexp(2.0 / PL_PI, level);
  const pl_quat q = {sqrt(u) * cos(w), sqrt(1.0 - u) * sin(v), sqrt(1.0 - u) * cos(v),
                     sqrt(u) * sin(w)};
  axes[0] = pl_vec3_scale(pl_quat_rotate(q, (pl_vec3){1.0, 0.0, 0.0}), cells);
  axes[1] = pl_vec3_scale(pl_quat_rotate(q, (pl_vec3){0.0, 1.0, 0.0}), cells);
  axes[2] = pl_vec3_scale(pl_quat_rotate(q, (pl_vec3){0.0, 0.0, 1.0}), cells);
}

void pl_fractal_detail_init(const pl_terrain_detail *detail, double radius_m,
                            pl_fractal_detail *out) {
  pl_detail_octaves(detail, radius_m, out->sigma_m);
  out->first = PL_CUBE_LEVELS;
  out->last = -1;
  for (int level = 0; level < PL_CUBE_LEVELS; level++) {
    const uint64_t words[2] = {detail->seed, (uint64_t)level};
    const uint64_t hash = pl_hash(PL_HASH_SEED, words, sizeof words);
    turn(words, level, out->axes[level]);
    out->key[level] = pl_sampler_mix((uint32_t)(hash >> 32) ^ pl_sampler_mix((uint32_t)hash));
    if (out->sigma_m[level] > 0.0) {
      out->first = level < out->first ? level : out->first;
      out->last = level;
    }
  }
}

void pl_detail_cache_init(pl_detail_cache *cache) {
  for (int k = 0; k < PL_DETAIL_CELLS; k++)
    cache->cells[k].octave = -1;
}

/* ---- places in the lattice ----------------------------------------------------------------- */

/* The cell of a coordinate, modulo 2^32, and the place in it, in [0, 1]: rounds in the last bits of
 * the mantissa, which vectors can. */
static inline uint32_t split(double x, double *fraction) {
  const double shifted = (x - 0.5) + 0x1.8p52;
  uint64_t bits;
  memcpy(&bits, &shifted, sizeof bits);
  *fraction = x - (shifted - 0x1.8p52);
  return (uint32_t)bits;
}

/* Cells are kept as multiples of PRIME: neighbours are PRIME apart. */
static inline uint32_t hash(uint32_t key, uint32_t cell) { return pl_sampler_mix(key + cell); }

/* The number of a cell of a row. As pl_sampler_mix, but for its last step, which mixes the high
 * bits into the low ones; it is the high ones that count. */
static inline int32_t number(uint32_t key, uint32_t cell) {
  uint32_t h = key + cell;
  h ^= h >> 16;
  h *= 0x7feb352du;
  h ^= h >> 15;
  h *= 0x846ca68bu;
  return (int32_t)h;
}

/* Factor of an octave's weighted sum of numbers, m. */
static double unit_of(const pl_fractal_detail *detail, int octave) {
  return detail->sigma_m[octave] / sqrt(NUMBER_VARIANCE * WEIGHTS * WEIGHTS * WEIGHTS);
}

/* A coordinate of a node, in cells. */
static inline double along(const pl_detail_strip *strip, pl_vec3 axis, size_t k) {
  return axis.x * strip->x[k] + axis.y * strip->y[k] + axis.z * strip->z[k];
}

/* ---- fine octaves: nodes lie in different cells, so numbers are hashed for each ------------- */

typedef struct near_axis {
  uint32_t cell[STRIP]; /* the first of four */
  float weight[4][STRIP];
} near_axis;

PL_WIDE static void place_near(const pl_detail_strip *restrict strip, size_t count, pl_vec3 axis,
                               near_axis *restrict out) {
  for (size_t k = 0; k < count; k++) {
    double fraction;
    out->cell[k] = (split(along(strip, axis, k), &fraction) - 1u) * PRIME;
    const float f = (float)fraction, g = 1.0f - f;
    out->weight[0][k] = g * g * g * (1.0f / 6.0f);
    out->weight[1][k] = (4.0f - 3.0f * f * f * (2.0f - f)) * (1.0f / 6.0f);
    out->weight[2][k] = (4.0f - 3.0f * g * g * (2.0f - g)) * (1.0f / 6.0f);
    out->weight[3][k] = f * f * f * (1.0f / 6.0f);
  }
}

PL_WIDE static void hash_along(const uint32_t *restrict key, const uint32_t *restrict cell,
                               uint32_t step, size_t count, uint32_t *restrict out) {
  for (size_t k = 0; k < count; k++)
    out[k] = hash(key[k], cell[k] + step);
}

/* Adds a row of four numbers along x. */
PL_WIDE static void add_row(const uint32_t *restrict key, const near_axis *restrict x,
                            const float *restrict weight_z, const float *restrict weight_y,
                            size_t count, float *restrict sums) {
  for (size_t k = 0; k < count; k++) {
    const float row = x->weight[0][k] * (float)number(key[k], x->cell[k]) +
                      x->weight[1][k] * (float)number(key[k], x->cell[k] + 1u * PRIME) +
                      (x->weight[2][k] * (float)number(key[k], x->cell[k] + 2u * PRIME) +
                       x->weight[3][k] * (float)number(key[k], x->cell[k] + 3u * PRIME));
    sums[k] += weight_z[k] * weight_y[k] * row;
  }
}

static void add_near(const pl_fractal_detail *detail, const pl_detail_strip *strip, int octave,
                     double *sums_m) {
  near_axis x, y, z;
  uint32_t key[STRIP], key_z[STRIP], key_y[STRIP];
  float sums[STRIP];
  const size_t count = pl_detail_strip_lanes(strip);
  const double unit = unit_of(detail, octave);
  const pl_vec3 *axes = detail->axes[octave];
  place_near(strip, count, axes[0], &x);
  place_near(strip, count, axes[1], &y);
  place_near(strip, count, axes[2], &z);
  for (size_t k = 0; k < count; k++) {
    key[k] = detail->key[octave];
    sums[k] = 0.0f;
  }
  for (uint32_t a = 0; a < 4; a++) {
    hash_along(key, z.cell, a * PRIME, count, key_z);
    for (uint32_t b = 0; b < 4; b++) {
      hash_along(key_z, y.cell, b * PRIME, count, key_y);
      add_row(key_y, &x, z.weight[a], y.weight[b], count, sums);
    }
  }
  for (size_t k = 0; k < strip->count; k++)
    sums_m[k] += unit * (double)sums[k];
}

/* ---- coarse octaves: many nodes lie in one cell, whose numbers are kept --------------------- */

typedef struct far_axis {
  uint32_t cell[STRIP];
  double weight[4][STRIP];
} far_axis;

PL_WIDE static void place_far(const pl_detail_strip *restrict strip, size_t count, pl_vec3 axis,
                              far_axis *restrict out) {
  for (size_t k = 0; k < count; k++) {
    double f;
    out->cell[k] = (split(along(strip, axis, k), &f) - 1u) * PRIME;
    const double g = 1.0 - f;
    out->weight[0][k] = g * g * g * (1.0 / 6.0);
    out->weight[1][k] = (4.0 - 3.0 * f * f * (2.0 - f)) * (1.0 / 6.0);
    out->weight[2][k] = (4.0 - 3.0 * g * g * (2.0 - g)) * (1.0 / 6.0);
    out->weight[3][k] = f * f * f * (1.0 / 6.0);
  }
}

/* Writes the numbers from a cell on, in the order z, y, x. */
static void draw(uint32_t key, const pl_detail_cell *cell, double numbers[64]) {
  for (uint32_t a = 0; a < 4; a++)
    for (uint32_t b = 0; b < 4; b++) {
      const uint32_t key_y = hash(hash(key, cell->z + a * PRIME), cell->y + b * PRIME);
      for (uint32_t c = 0; c < 4; c++)
        numbers[16 * a + 4 * b + c] = (double)number(key_y, cell->x + c * PRIME);
    }
}

static const double *numbers_of(uint32_t key, const pl_detail_cell *cell, pl_detail_cache *cache) {
  const uint32_t mixed = cell->x + 3u * cell->y + 5u * cell->z + 7u * (uint32_t)cell->octave;
  const uint32_t slot = mixed % PL_DETAIL_CELLS;
  pl_detail_cell *kept = &cache->cells[slot];
  if (kept->octave != cell->octave || kept->x != cell->x || kept->y != cell->y ||
      kept->z != cell->z) {
    *kept = *cell;
    draw(key, cell, cache->numbers[slot]);
  }
  return cache->numbers[slot];
}

/* Weighs the numbers of one cell, for the nodes from `from` to `to`. */
PL_WIDE static void weigh_cell(const double *restrict numbers, const far_axis *restrict x,
                               const far_axis *restrict y, const far_axis *restrict z, size_t from,
                               size_t to, double *restrict sums) {
  for (size_t k = from; k < to; k++) {
    double sum = 0.0;
    for (int a = 0; a < 4; a++) {
      double plane = 0.0;
      for (int b = 0; b < 4; b++) {
        const double *row = &numbers[16 * a + 4 * b];
        plane += y->weight[b][k] * (x->weight[0][k] * row[0] + x->weight[1][k] * row[1] +
                                    (x->weight[2][k] * row[2] + x->weight[3][k] * row[3]));
      }
      sum += z->weight[a][k] * plane;
    }
    sums[k] = sum;
  }
}

/* The last lanes of a run are computed with the wrong numbers, then again by the next run. */
static void add_far(const pl_fractal_detail *detail, const pl_detail_strip *strip, int octave,
                    pl_detail_cache *cache, double *sums_m) {
  enum { LANES = 4 };
  far_axis x, y, z;
  double sums[STRIP];
  const size_t lanes = pl_detail_strip_lanes(strip);
  const double unit = unit_of(detail, octave);
  const pl_vec3 *axes = detail->axes[octave];
  place_far(strip, lanes, axes[0], &x);
  place_far(strip, lanes, axes[1], &y);
  place_far(strip, lanes, axes[2], &z);
  for (size_t from = 0, to; from < strip->count; from = to) {
    const pl_detail_cell cell = {octave, x.cell[from], y.cell[from], z.cell[from]};
    for (to = from + 1;
         to < strip->count && x.cell[to] == cell.x && y.cell[to] == cell.y && z.cell[to] == cell.z;
         to++) {
    }
    const size_t end = from + (to - from + LANES - 1) / LANES * LANES;
    weigh_cell(numbers_of(detail->key[octave], &cell, cache), &x, &y, &z, from,
               end < lanes ? end : lanes, sums);
  }
  for (size_t k = 0; k < strip->count; k++)
    sums_m[k] += unit * sums[k];
}

/* ---- sums ---------------------------------------------------------------------------------- */

void pl_fractal_detail_add(const pl_fractal_detail *detail, const pl_detail_strip *strip,
                           int octave, int level, pl_detail_cache *cache, double *sums_m) {
  if (octave < detail->first || octave > detail->last)
    return;
  if (level - octave < PL_DETAIL_NEAR)
    add_near(detail, strip, octave, sums_m);
  else
    add_far(detail, strip, octave, cache, sums_m);
}

double pl_fractal_detail_deviation_m(const pl_fractal_detail *detail, int coarsest, int level) {
  double variance = 0.0;
  for (int k = coarsest < 0 ? 0 : coarsest; k <= level && k < PL_CUBE_LEVELS; k++)
    variance += detail->sigma_m[k] * detail->sigma_m[k];
  return sqrt(variance);
}

/* Weights of four cells along one axis, and their slopes. */
typedef struct slope_axis {
  uint32_t cell; /* the first of four */
  float weight[4], slope[4];
} slope_axis;

static slope_axis slopes_along(double x) {
  slope_axis out;
  double fraction;
  out.cell = (split(x, &fraction) - 1u) * PRIME;
  const float f = (float)fraction, g = 1.0f - f;
  out.weight[0] = g * g * g * (1.0f / 6.0f);
  out.weight[1] = (4.0f - 3.0f * f * f * (2.0f - f)) * (1.0f / 6.0f);
  out.weight[2] = (4.0f - 3.0f * g * g * (2.0f - g)) * (1.0f / 6.0f);
  out.weight[3] = f * f * f * (1.0f / 6.0f);
  out.slope[0] = -0.5f * g * g;
  out.slope[1] = 0.5f * f * (3.0f * f - 4.0f);
  out.slope[2] = -0.5f * g * (3.0f * g - 4.0f);
  out.slope[3] = 0.5f * f * f;
  return out;
}

/* Sums rows of four numbers along x, by their weights and by their slopes. */
PL_WIDE static void sum_rows(const uint32_t *restrict key, const slope_axis *restrict x,
                             float *restrict rows, float *restrict along) {
  for (int k = 0; k < 16; k++) {
    const float value[4] = {
        (float)number(key[k], x->cell), (float)number(key[k], x->cell + 1u * PRIME),
        (float)number(key[k], x->cell + 2u * PRIME), (float)number(key[k], x->cell + 3u * PRIME)};
    rows[k] = x->weight[0] * value[0] + x->weight[1] * value[1] +
              (x->weight[2] * value[2] + x->weight[3] * value[3]);
    along[k] = x->slope[0] * value[0] + x->slope[1] * value[1] +
               (x->slope[2] * value[2] + x->slope[3] * value[3]);
  }
}

static pl_vec3 octave_gradient(uint32_t key, pl_vec3 place) {
  const slope_axis x = slopes_along(place.x), y = slopes_along(place.y), z = slopes_along(place.z);
  uint32_t keys[16];
  float rows[16], along[16], sum[3] = {0.0f, 0.0f, 0.0f};
  for (uint32_t a = 0; a < 4; a++) {
    const uint32_t key_z = hash(key, z.cell + a * PRIME);
    for (uint32_t b = 0; b < 4; b++)
      keys[4 * a + b] = hash(key_z, y.cell + b * PRIME);
  }
  sum_rows(keys, &x, rows, along);
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < 4; b++) {
      sum[0] += z.weight[a] * y.weight[b] * along[4 * a + b];
      sum[1] += z.weight[a] * y.slope[b] * rows[4 * a + b];
      sum[2] += z.slope[a] * y.weight[b] * rows[4 * a + b];
    }
  return (pl_vec3){(double)sum[0], (double)sum[1], (double)sum[2]};
}

pl_vec3 pl_fractal_detail_octave_gradient(const pl_fractal_detail *detail, pl_vec3 direction,
                                          int octave) {
  const pl_vec3 *axes = detail->axes[octave];
  pl_work_add(PL_WORK_noise_octaves, 1);
  const pl_vec3 place = {pl_vec3_dot(axes[0], direction), pl_vec3_dot(axes[1], direction),
                         pl_vec3_dot(axes[2], direction)};
  const pl_vec3 slope =
      pl_vec3_scale(octave_gradient(detail->key[octave], place), unit_of(detail, octave));
  const pl_vec3 sum = pl_vec3_madd(pl_vec3_scale(axes[0], slope.x), slope.y, axes[1]);
  return pl_vec3_madd(sum, slope.z, axes[2]);
}

/* The squares of the slopes of the spline's weights have the mean sum 2/3. */
double pl_fractal_detail_slope_variance(const pl_fractal_detail *detail, int octave,
                                        double radius_m) {
  const double ratio = detail->sigma_m[octave] / pl_cube_cell_m(octave, radius_m);
  return ratio * ratio * (2.0 / 3.0) / WEIGHTS;
}
