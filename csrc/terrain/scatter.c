#include "terrain/scatter.h"

#include <string.h>

#include "base/memory.h"
#include "math/philox.h"

/* What random numbers are for; part of their counter. */
enum { FOR_COUNT, FOR_SITE };
enum { NUMBER_BITS = 10 };

/* Number of the first cell of a level among those of all levels, from 1 on. */
static uint64_t first_cell(int level) {
  return 1 + 2 * ((UINT64_C(1) << (2 * level)) - 1); /* 1 + 6 (4^level - 1) / 3 */
}

static uint64_t id_of(const pl_scatter_cell *cell, uint64_t n) {
  const int level = cell->level;
  const uint64_t in_level = ((uint64_t)cell->face << (2 * level)) | (cell->i << level) | cell->j;
  return ((first_cell(level) + in_level) << NUMBER_BITS) | n;
}

void pl_scatter_words(const pl_scatter *scatter, uint64_t id, uint64_t purpose, uint64_t words[4]) {
  const uint64_t counter[4] = {id, purpose, 0, 0};
  pl_philox(scatter->key, counter, words);
}

uint64_t pl_scatter_count(const pl_scatter *scatter, const pl_scatter_cell *cell) {
  const pl_scatter_octave *octave = &scatter->octaves[cell->level];
  if (octave->count <= 1)
    return 0;
  uint64_t words[4];
  pl_scatter_words(scatter, id_of(cell, 0), FOR_COUNT, words);
  const double u = pl_philox_double(words[0]);
  size_t low = 0, high = octave->count - 1;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (octave->cumulative[middle] > u)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

static bool is_inside(const pl_scatter_window *window, double s, double t) {
  return s >= window->from[0] && s <= window->to[0] && t >= window->from[1] && t <= window->to[1];
}

bool pl_scatter_draw(const pl_scatter *scatter, const pl_scatter_cell *cell, uint64_t n,
                     const pl_scatter_window *window, pl_scatter_site *out) {
  uint64_t words[4];
  out->id = id_of(cell, n);
  out->cell = *cell;
  pl_scatter_words(scatter, out->id, FOR_SITE, words);
  const pl_scatter_octave *octave = &scatter->octaves[cell->level];
  const double s = -1.0 + octave->width * ((double)cell->i + pl_philox_double(words[0]));
  const double t = -1.0 + octave->width * ((double)cell->j + pl_philox_double(words[1]));
  if (window != NULL && !is_inside(window, s, t))
    return false;
  const double a = pl_cube_tangent(s), b = pl_cube_tangent(t), a1 = 1.0 + a * a, b1 = 1.0 + b * b;
  const double q = a1 + b * b;
  /* Solid angle of a piece of the lattice over that at the centre of a face: a1 b1 / q^(3/2). */
  if (pl_philox_double(words[2]) * q * sqrt(q) >= a1 * b1)
    return false;
  out->direction = pl_cube_tangent_direction(cell->face, a, b);
  if (window != NULL) {
    const pl_vec3 to = pl_vec3_sub(out->direction, window->axis);
    if (pl_vec3_dot(to, to) > window->chord2)
      return false;
  }
  out->place[0] = words[0] >> 11;
  out->place[1] = words[1] >> 11;
  out->diameter_m =
      pl_size_table_draw(scatter->sizes, octave->low_m, octave->high_m, pl_philox_double(words[3]));
  return true;
}

bool pl_scatter_find(const pl_scatter *scatter, uint64_t id, pl_scatter_site *out) {
  const uint64_t number = id >> NUMBER_BITS, n = id & ((UINT64_C(1) << NUMBER_BITS) - 1);
  pl_scatter_cell cell = {.level = 0};
  while (cell.level < PL_SCATTER_LEVELS && number >= first_cell(cell.level + 1))
    cell.level++;
  if (number == 0 || cell.level < scatter->first || cell.level > scatter->last)
    return false;
  const uint64_t in_level = number - first_cell(cell.level);
  const uint64_t mask = (UINT64_C(1) << cell.level) - 1;
  cell.face = (int)(in_level >> (2 * cell.level));
  cell.i = (in_level >> cell.level) & mask;
  cell.j = in_level & mask;
  return n < pl_scatter_count(scatter, &cell) && pl_scatter_draw(scatter, &cell, n, NULL, out);
}

pl_status pl_scatter_check(const char *noun, double radius_m, double min_m, double max_m) {
  const double least = PL_SCATTER_MIN_OF_RADIUS * radius_m;
  const double most = PL_SCATTER_MAX_OF_RADIUS * radius_m;
  if (!(radius_m > 0.0 && isfinite(radius_m)))
    return pl_fail(PL_E_RANGE, "%s on a body of radius %g m; must be above 0", noun, radius_m);
  if (min_m >= least && max_m > min_m && max_m <= most)
    return PL_OK;
  return pl_fail(PL_E_RANGE,
                 "%s of %g to %g m; on a body of radius %g m they must be of %.3g to %.6g m, the "
                 "least below the greatest",
                 noun, min_m, max_m, radius_m, least, most);
}

bool pl_scatter_sizes(int level, double radius_m, double min_m, double max_m, double *low_m,
                      double *high_m) {
  const double cell = pl_cube_cell_m(level, radius_m);
  *low_m = fmax(cell / PL_SCATTER_CELLS_OVER_LEAST, min_m);
  *high_m = fmin(2.0 * cell / PL_SCATTER_CELLS_OVER_LEAST, max_m);
  return *low_m < *high_m;
}

/* Cuts sizes into octaves by the widths of cells. Returns the mean number in a cell as large as
 * those at the centres of faces. */
static double octave_of(pl_scatter *scatter, int level, double min_m, double max_m) {
  const double cell = pl_cube_cell_m(level, scatter->radius_m);
  pl_scatter_octave *octave = &scatter->octaves[level];
  octave->width = ldexp(2.0, -level);
  if (!pl_scatter_sizes(level, scatter->radius_m, min_m, max_m, &octave->low_m, &octave->high_m))
    return 0.0;
  return cell * cell *
         (pl_size_table_density(scatter->sizes, octave->low_m) -
          pl_size_table_density(scatter->sizes, octave->high_m));
}

/* Cumulative Poisson probabilities, up to rounding to 1. Terms are computed from their logarithms:
 * exp(-mean) alone may underflow. Returns their number. */
static size_t poisson_cumulative(double mean, double *cumulative) {
  double log_factorial = 0.0, sum = 0.0;
  size_t k = 0;
  for (; k < PL_SCATTER_CELL_MOST; k++) {
    log_factorial += k > 0 ? log((double)k) : 0.0;
    const double term =
        mean > 0.0 ? exp((double)k * log(mean) - mean - log_factorial) : (k == 0 ? 1.0 : 0.0);
    cumulative[k] = sum += term;
    if ((double)k >= mean && term < 1e-18)
      break;
  }
  const size_t count = k < PL_SCATTER_CELL_MOST ? k + 1 : k;
  cumulative[count - 1] = 1.0;
  return count;
}

static pl_status make_octaves(pl_scatter *scatter, double min_m, double max_m) {
  void *cumulative;
  size_t used = 0;
  PL_TRY(pl_alloc_or_fail((size_t)PL_SCATTER_LEVELS * PL_SCATTER_CELL_MOST, sizeof(double),
                          "numbers of scattered things", &cumulative));
  scatter->cumulative = cumulative;
  for (int level = 0; level < PL_SCATTER_LEVELS; level++) {
    pl_scatter_octave *octave = &scatter->octaves[level];
    const double mean = octave_of(scatter, level, min_m, max_m);
    if (octave->low_m >= octave->high_m)
      continue;
    /* 10 standard deviations below the most that fit. */
    if (!(mean + 10.0 * sqrt(mean) < PL_SCATTER_CELL_MOST))
      return pl_fail(PL_E_RANGE,
                     "%.3g things of %g to %g m per km^2 overlap everywhere: raise the least "
                     "diameter or lower the density",
                     1e6 * pl_size_table_density(scatter->sizes, octave->low_m), octave->low_m,
                     octave->high_m);
    octave->cumulative = scatter->cumulative + used;
    octave->count = poisson_cumulative(mean, scatter->cumulative + used);
    used += octave->count;
    scatter->first = scatter->first < level ? scatter->first : level;
    scatter->last = level;
  }
  return PL_OK;
}

pl_status pl_scatter_init(double radius_m, uint64_t seed, uint64_t purpose,
                          pl_size_density_fn density, const void *law, double min_m, double max_m,
                          pl_scatter *out) {
  memset(out, 0, sizeof *out);
  out->radius_m = radius_m;
  out->key[0] = seed;
  out->key[1] = purpose;
  out->first = PL_SCATTER_LEVELS;
  out->last = -1;
  pl_status status = pl_size_table_create(density, law, min_m, max_m, &out->sizes);
  if (status == PL_OK)
    status = make_octaves(out, min_m, max_m);
  if (status != PL_OK)
    pl_scatter_clear(out);
  return status;
}

void pl_scatter_clear(pl_scatter *scatter) {
  pl_size_table_destroy(scatter->sizes);
  pl_free(scatter->cumulative);
  memset(scatter, 0, sizeof *scatter);
}
