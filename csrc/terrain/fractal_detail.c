/* Fractal detail: octaves of B-spline noise on cubic lattices. */
#include "terrain/fractal_detail.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "base/wide.h"
#include "math/sampler.h"

enum { STRIP = PL_DETAIL_STRIP };
#define PRIME 0x9e3779b1u /* the odd number nearest 2^32/phi */

/* The sum of four bytes has mean 510 and variance 4 (256^2 - 1) / 12. The squares of the spline's
 * weights have the mean sum 151/315 an axis. */
#define BYTES_MEAN 510
#define BYTES_VARIANCE 21845.0
#define WEIGHTS (151.0 / 315.0)

void pl_fractal_detail_init(const pl_terrain_detail *detail, double radius_m,
                            pl_fractal_detail *out) {
  pl_detail_octaves(detail, radius_m, out->sigma_m);
  out->first = PL_CUBE_LEVELS;
  out->last = -1;
  for (int level = 0; level < PL_CUBE_LEVELS; level++) {
    const uint64_t words[2] = {detail->seed, (uint64_t)level};
    const uint64_t hash = pl_hash(PL_HASH_SEED, words, sizeof words);
    out->key[level] = pl_sampler_mix((uint32_t)(hash >> 32) ^ pl_sampler_mix((uint32_t)hash));
    if (out->sigma_m[level] > 0.0) {
      out->first = level < out->first ? level : out->first;
      out->last = level;
    }
  }
}

void pl_detail_cache_init(pl_detail_cache *cache) {
  for (int level = 0; level < PL_CUBE_LEVELS; level++)
    cache->cells[level].known = false;
}

/* ---- places in the lattice ----------------------------------------------------------------- */

/* Coordinates of unit directions in cells of a level: radius over width of a cell. */
static double cells_of(int level) { return ldexp(2.0 / PL_PI, level); }

/* The cell of a coordinate, modulo 2^32, and the place in it, in [0, 1]: rounds in the last bits of
 * the mantissa, which vectors can. */
static inline uint32_t split(double x, double *fraction) {
  const double shifted = (x - 0.5) + 0x1.8p52;
  uint64_t bits;
  memcpy(&bits, &shifted, sizeof bits);
  *fraction = x - (shifted - 0x1.8p52);
  return (uint32_t)bits;
}

static inline uint32_t hash(uint32_t key, uint32_t coordinate) {
  return pl_sampler_mix(key + coordinate * PRIME);
}

/* The number of a hash: the sum of its four bytes, without its mean. */
static inline int32_t number(uint32_t h) {
  const uint32_t pairs = (h & 0x00ff00ffu) + ((h >> 8) & 0x00ff00ffu);
  return (int32_t)((pairs & 0xffffu) + (pairs >> 16)) - BYTES_MEAN;
}

/* Factor of an octave's weighted sum of numbers, m. */
static double unit_of(const pl_fractal_detail *detail, int octave) {
  return detail->sigma_m[octave] / sqrt(BYTES_VARIANCE * WEIGHTS * WEIGHTS * WEIGHTS);
}

/* ---- fine octaves: nodes lie in different cells, so numbers are hashed for each ------------- */

typedef struct near_axis {
  uint32_t cell[STRIP]; /* the first of four */
  float weight[4][STRIP];
} near_axis;

PL_WIDE static void place_near(const double *restrict along, size_t count, double cells,
                               near_axis *restrict out) {
  for (size_t k = 0; k < count; k++) {
    double fraction;
    out->cell[k] = split(along[k] * cells, &fraction) - 1u;
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
    const float row = x->weight[0][k] * (float)number(hash(key[k], x->cell[k])) +
                      x->weight[1][k] * (float)number(hash(key[k], x->cell[k] + 1u)) +
                      (x->weight[2][k] * (float)number(hash(key[k], x->cell[k] + 2u)) +
                       x->weight[3][k] * (float)number(hash(key[k], x->cell[k] + 3u)));
    sums[k] += weight_z[k] * weight_y[k] * row;
  }
}

static void add_near(const pl_fractal_detail *detail, const pl_detail_strip *strip, int octave,
                     double *sums_m) {
  near_axis x, y, z;
  uint32_t key[STRIP], key_z[STRIP], key_y[STRIP];
  float sums[STRIP];
  const size_t count = strip->count;
  const double cells = cells_of(octave), unit = unit_of(detail, octave);
  place_near(strip->x, count, cells, &x);
  place_near(strip->y, count, cells, &y);
  place_near(strip->z, count, cells, &z);
  for (size_t k = 0; k < count; k++) {
    key[k] = detail->key[octave];
    sums[k] = 0.0f;
  }
  for (uint32_t a = 0; a < 4; a++) {
    hash_along(key, z.cell, a, count, key_z);
    for (uint32_t b = 0; b < 4; b++) {
      hash_along(key_z, y.cell, b, count, key_y);
      add_row(key_y, &x, z.weight[a], y.weight[b], count, sums);
    }
  }
  for (size_t k = 0; k < count; k++)
    sums_m[k] += unit * (double)sums[k];
}

/* ---- coarse octaves: many nodes lie in one cell, whose numbers are kept --------------------- */

typedef struct far_axis {
  uint32_t cell[STRIP];
  double weight[4][STRIP];
} far_axis;

PL_WIDE static void place_far(const double *restrict along, size_t count, double cells,
                              far_axis *restrict out) {
  for (size_t k = 0; k < count; k++) {
    double f;
    out->cell[k] = split(along[k] * cells, &f) - 1u;
    const double g = 1.0 - f;
    out->weight[0][k] = g * g * g * (1.0 / 6.0);
    out->weight[1][k] = (4.0 - 3.0 * f * f * (2.0 - f)) * (1.0 / 6.0);
    out->weight[2][k] = (4.0 - 3.0 * g * g * (2.0 - g)) * (1.0 / 6.0);
    out->weight[3][k] = f * f * f * (1.0 / 6.0);
  }
}

/* Numbers in the order z, y, x. */
static const double *numbers_of(uint32_t key, uint32_t x, uint32_t y, uint32_t z,
                                pl_detail_cell *kept) {
  if (kept->known && kept->cell[0] == x && kept->cell[1] == y && kept->cell[2] == z)
    return kept->numbers;
  for (uint32_t a = 0; a < 4; a++)
    for (uint32_t b = 0; b < 4; b++) {
      const uint32_t key_y = hash(hash(key, z + a), y + b);
      for (uint32_t c = 0; c < 4; c++)
        kept->numbers[16 * a + 4 * b + c] = (double)number(hash(key_y, x + c));
    }
  kept->known = true;
  kept->cell[0] = x;
  kept->cell[1] = y;
  kept->cell[2] = z;
  return kept->numbers;
}

/* Sums the numbers of one cell, for the nodes from `from` to `to`. */
PL_WIDE static void sum_cell(const double *restrict numbers, const far_axis *restrict x,
                             const far_axis *restrict y, const far_axis *restrict z, size_t from,
                             size_t to, double unit, double *restrict sums_m) {
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
    sums_m[k] += unit * sum;
  }
}

static void add_far(const pl_fractal_detail *detail, const pl_detail_strip *strip, int octave,
                    pl_detail_cell *kept, double *sums_m) {
  far_axis x, y, z;
  const double cells = cells_of(octave), unit = unit_of(detail, octave);
  place_far(strip->x, strip->count, cells, &x);
  place_far(strip->y, strip->count, cells, &y);
  place_far(strip->z, strip->count, cells, &z);
  for (size_t from = 0, to; from < strip->count; from = to) {
    for (to = from + 1; to < strip->count && x.cell[to] == x.cell[from] &&
                        y.cell[to] == y.cell[from] && z.cell[to] == z.cell[from];
         to++) {
    }
    const double *numbers =
        numbers_of(detail->key[octave], x.cell[from], y.cell[from], z.cell[from], kept);
    sum_cell(numbers, &x, &y, &z, from, to, unit, sums_m);
  }
}

/* ---- sums ---------------------------------------------------------------------------------- */

void pl_fractal_detail_add(const pl_fractal_detail *detail, const pl_detail_strip *strip,
                           int octave, int level, pl_detail_cache *cache, double *sums_m) {
  if (octave < detail->first || octave > detail->last)
    return;
  if (level - octave < PL_DETAIL_NEAR)
    add_near(detail, strip, octave, sums_m);
  else
    add_far(detail, strip, octave, &cache->cells[octave], sums_m);
}

double pl_fractal_detail_deviation_m(const pl_fractal_detail *detail, int coarsest, int level) {
  double variance = 0.0;
  for (int k = coarsest < 0 ? 0 : coarsest; k <= level && k < PL_CUBE_LEVELS; k++)
    variance += detail->sigma_m[k] * detail->sigma_m[k];
  return sqrt(variance);
}

static int finest_of(const pl_fractal_detail *detail, int level) {
  return level < detail->last ? level : detail->last;
}

static int coarsest_of(const pl_fractal_detail *detail, int coarsest) {
  return coarsest > detail->first ? coarsest : detail->first;
}

double pl_fractal_detail_height(const pl_fractal_detail *detail, pl_vec3 direction, int coarsest,
                                int level) {
  pl_detail_strip strip;
  strip.count = 1;
  strip.x[0] = direction.x;
  strip.y[0] = direction.y;
  strip.z[0] = direction.z;
  double sum_m = 0.0;
  for (int k = finest_of(detail, level); k >= coarsest_of(detail, coarsest); k--) {
    if (level - k < PL_DETAIL_NEAR) {
      add_near(detail, &strip, k, &sum_m);
    } else {
      pl_detail_cell cell;
      cell.known = false;
      add_far(detail, &strip, k, &cell, &sum_m);
    }
  }
  const double deviation_m = pl_fractal_detail_deviation_m(detail, coarsest, level);
  return pl_fractal_detail_cut(sum_m, PL_DETAIL_BOUND * deviation_m);
}

/* Weights of four cells and their slopes along one axis; returns the first cell. */
static uint32_t slopes_along(double x, double weight[4], double slope[4]) {
  double f;
  const uint32_t cell = split(x, &f) - 1u;
  const double g = 1.0 - f;
  weight[0] = g * g * g * (1.0 / 6.0);
  weight[1] = (4.0 - 3.0 * f * f * (2.0 - f)) * (1.0 / 6.0);
  weight[2] = (4.0 - 3.0 * g * g * (2.0 - g)) * (1.0 / 6.0);
  weight[3] = f * f * f * (1.0 / 6.0);
  slope[0] = -0.5 * g * g;
  slope[1] = 0.5 * f * (3.0 * f - 4.0);
  slope[2] = -0.5 * g * (3.0 * g - 4.0);
  slope[3] = 0.5 * f * f;
  return cell;
}

static pl_vec3 octave_gradient(uint32_t key, pl_vec3 place) {
  double wx[4], wy[4], wz[4], sx[4], sy[4], sz[4];
  const uint32_t x = slopes_along(place.x, wx, sx);
  const uint32_t y = slopes_along(place.y, wy, sy);
  const uint32_t z = slopes_along(place.z, wz, sz);
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (uint32_t a = 0; a < 4; a++) {
    const uint32_t key_z = hash(key, z + a);
    for (uint32_t b = 0; b < 4; b++) {
      const uint32_t key_y = hash(key_z, y + b);
      double row = 0.0, along = 0.0;
      for (uint32_t c = 0; c < 4; c++) {
        const double value = (double)number(hash(key_y, x + c));
        row += wx[c] * value;
        along += sx[c] * value;
      }
      sum.x += wz[a] * wy[b] * along;
      sum.y += wz[a] * sy[b] * row;
      sum.z += sz[a] * wy[b] * row;
    }
  }
  return sum;
}

pl_vec3 pl_fractal_detail_gradient(const pl_fractal_detail *detail, pl_vec3 direction, int coarsest,
                                   int level) {
  pl_vec3 sum = {0.0, 0.0, 0.0};
  for (int k = finest_of(detail, level); k >= coarsest_of(detail, coarsest); k--) {
    const double cells = cells_of(k);
    const pl_vec3 slope = octave_gradient(detail->key[k], pl_vec3_scale(direction, cells));
    sum = pl_vec3_madd(sum, unit_of(detail, k) * cells, slope);
  }
  return pl_vec3_madd(sum, -pl_vec3_dot(sum, direction), direction);
}
