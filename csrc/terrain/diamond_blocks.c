/* Blocks of refined rasters: diamonds and squares. */
#include "terrain/diamond_blocks.h"

#include <math.h>
#include <pthread.h>

#include "base/memory.h"

enum { SIDE = PL_DIAMOND_SIDE, APRON = PL_DIAMOND_APRON, NODES = PL_DIAMOND_NODES };
/* Stencils of squares reach this far beyond a block. */
enum { REACH = 3, WIDE = NODES + 2 * REACH };
enum { FILTER = 4, WINDOW = NODES + 2 * FILTER };

/* ---- random numbers ------------------------------------------------------------------------- */

/* The finalizer of SplitMix64 (Stafford's mix 13). */
static inline uint64_t mix(uint64_t x) {
  x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
  return x ^ (x >> 31);
}

/* Sum of four uniform numbers, with a variance of 1: nearly normal, and never beyond 3.5. */
static inline double deviate(uint64_t key, int64_t i, int64_t j) {
  const uint64_t bits = mix(mix(key + (uint64_t)i * UINT64_C(0x9e3779b97f4a7c15)) + (uint64_t)j);
  const int64_t sum =
      (int64_t)((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48));
  return (double)(sum - 2 * 0xffff) * (1.7320508075688772 / 65536.0);
}

/* ---- blocks --------------------------------------------------------------------------------- */

typedef pl_diamond_block block;

/* Levels that follow each other never share a place, so a parent stays while its child is made. */
enum { KEPT_LEVELS = 2, KEPT_SIDE = 8, KEPT = KEPT_LEVELS * KEPT_SIDE * KEPT_SIDE };
static _Thread_local block *kept; /* owned: freed as the thread ends */
static pthread_key_t kept_key;
static pthread_once_t kept_once = PTHREAD_ONCE_INIT;
static bool kept_failed;

static void make_key(void) { kept_failed = pthread_key_create(&kept_key, pl_free) != 0; }

pl_status pl_diamond_blocks_ready(void) {
  void *memory;
  if (kept != NULL)
    return PL_OK;
  pthread_once(&kept_once, make_key);
  PL_TRY(pl_alloc_or_fail(KEPT, sizeof *kept, "blocks of refined ground", &memory));
  if (kept_failed || pthread_setspecific(kept_key, memory) != 0) {
    pl_free(memory);
    return pl_fail(PL_E_MEMORY, "no key for blocks of refined ground");
  }
  kept = memory;
  return PL_OK;
}

static int64_t floor_half(int64_t i) { return i >= 0 ? i / 2 : -((1 - i) / 2); }

/* Weights along one axis of the Gaussian that splits low from high frequencies. */
static void gaussian(double weights[2 * FILTER + 1]) {
  double sum = 0.0;
  for (int k = -FILTER; k <= FILTER; k++)
    sum += exp(-0.5 * k * k / (PL_DIAMOND_SIGMA * PL_DIAMOND_SIGMA));
  for (int k = -FILTER; k <= FILTER; k++)
    weights[k + FILTER] = exp(-0.5 * k * k / (PL_DIAMOND_SIGMA * PL_DIAMOND_SIGMA)) / sum;
}

/* High frequencies at the posts. */
static void make_posts(const pl_diamond_square *of, block *out) {
  double weights[2 * FILTER + 1], z[WINDOW][WINDOW], across[WINDOW][NODES];
  gaussian(weights);
  for (int j = 0; j < WINDOW; j++)
    for (int i = 0; i < WINDOW; i++)
      z[j][i] =
          pl_raster_value(of->raster, 0, (double)(out->i * SIDE + i - APRON - FILTER),
                          (double)(out->j * SIDE + j - APRON - FILTER), PL_INTERPOLATION_BILINEAR);
  for (int j = 0; j < WINDOW; j++)
    for (int i = 0; i < NODES; i++) {
      across[j][i] = 0.0;
      for (int k = 0; k <= 2 * FILTER; k++)
        across[j][i] += weights[k] * z[j][i + k];
    }
  for (int j = 0; j < NODES; j++)
    for (int i = 0; i < NODES; i++) {
      double low = 0.0;
      for (int k = 0; k <= 2 * FILTER; k++)
        low += weights[k] * across[j + k][i];
      out->h_m[j * NODES + i] = z[j + FILTER][i + FILTER] - low;
    }
}

/* Weights and standard deviations of one row of nodes. */
typedef struct row_law {
  double weights[2][PL_MIDPOINT_AROUND], deviation_m[2];
} row_law;

static row_law law_of_row(const pl_diamond_square *of, const pl_diamond_weights *weights, int level,
                          int64_t j) {
  const int64_t row = j + of->down->first * ((int64_t)1 << level);
  const double y = pl_raster_axis_lattice(of->down, ldexp((double)row, -level));
  const double ratio = of->post_ratio * (of->curved ? fabs(cos(y)) : 1.0);
  const double place =
      fmin(fmax(4.0 * (log2(fmax(ratio, 1e-9)) + 4.0), 0.0), PL_DIAMOND_RATIOS - 1.0);
  const int k = (int)fmin(place, PL_DIAMOND_RATIOS - 2.0);
  const double part = place - k;
  row_law out;
  for (int step = 0; step < 2; step++) {
    const pl_midpoint *a = &weights->at[of->range[level]][k][step];
    const pl_midpoint *b = &weights->at[of->range[level]][k + 1][step];
    for (int n = 0; n < PL_MIDPOINT_AROUND; n++)
      out.weights[step][n] = a->weights[n] + part * (b->weights[n] - a->weights[n]);
    out.deviation_m[step] =
        of->deviation_m[level] * sqrt(a->variance + part * (b->variance - a->variance));
  }
  return out;
}

/* What a block of a level is made from. */
typedef struct work {
  const pl_diamond_square *of;
  const block *parent;
  int level, from_i, from_j; /* node of the parent under the first node of the block */
  int64_t first_i, first_j;  /* place of that first node */
  int64_t columns;           /* around the body; 0: no wrap */
  row_law rows[WIDE];
  int square[PL_MIDPOINT_AROUND]; /* offsets of the neighbours of a square in h_m */
  double h_m[WIDE][WIDE];         /* with REACH nodes around the block */
} work;

static double random_m(const work *w, int i, int j, double deviation_m) {
  const int64_t nodes = (int64_t)1 << w->level;
  const int64_t row = w->first_j + j - REACH + nodes * w->of->down->first;
  int64_t column = w->first_i + i - REACH + nodes * w->of->across->first;
  if (w->columns > 0) {
    column %= w->columns;
    column += column < 0 ? w->columns : 0;
  }
  return deviation_m * deviate(w->of->key[w->level], column, row);
}

/* Coarser nodes stay. */
static void set_coarse(work *w) {
  for (int j = 1; j < WIDE; j += 2)
    for (int i = 1; i < WIDE; i += 2)
      w->h_m[j][i] =
          w->parent->h_m[(w->from_j + (j - REACH) / 2) * NODES + w->from_i + (i - REACH) / 2];
}

/* Middles of the cells. */
static void set_diamonds(work *w) {
  for (int j = 0; j < WIDE; j += 2)
    for (int i = 0; i < WIDE; i += 2) {
      const row_law *law = &w->rows[j];
      const double *weights = law->weights[PL_MIDPOINT_DIAMOND];
      const double *corner =
          &w->parent
               ->h_m[(w->from_j + (j - REACH - 3) / 2) * NODES + w->from_i + (i - REACH - 3) / 2];
      double sum = 0.0;
      for (int k = 0; k < 4; k++) {
        const double *h = corner + k * NODES, *by = weights + 4 * k;
        sum += by[0] * h[0] + by[1] * h[1] + (by[2] * h[2] + by[3] * h[3]);
      }
      w->h_m[j][i] = sum + random_m(w, i, j, law->deviation_m[PL_MIDPOINT_DIAMOND]);
    }
}

/* Middles of the sides. */
static void set_squares(work *w) {
  for (int j = REACH; j < WIDE - REACH; j++)
    for (int i = REACH + (j - REACH + 1) % 2; i < WIDE - REACH; i += 2) {
      const row_law *law = &w->rows[j];
      const double *weights = law->weights[PL_MIDPOINT_SQUARE], *middle = &w->h_m[j][i];
      double sum = 0.0;
      for (int k = 0; k < PL_MIDPOINT_AROUND; k += 4)
        sum +=
            weights[k] * middle[w->square[k]] + weights[k + 1] * middle[w->square[k + 1]] +
            (weights[k + 2] * middle[w->square[k + 2]] + weights[k + 3] * middle[w->square[k + 3]]);
      w->h_m[j][i] = sum + random_m(w, i, j, law->deviation_m[PL_MIDPOINT_SQUARE]);
    }
}

static void refine(const pl_diamond_square *of, const pl_diamond_weights *weights,
                   const block *parent, block *out) {
  work w;
  w.of = of;
  w.parent = parent;
  w.level = out->level;
  w.first_i = out->i * SIDE - APRON;
  w.first_j = out->j * SIDE - APRON;
  w.from_i = (int)(w.first_i / 2 - (parent->i * SIDE - APRON));
  w.from_j = (int)(w.first_j / 2 - (parent->j * SIDE - APRON));
  w.columns = of->across->period << out->level;
  for (int j = 0; j < WIDE; j++)
    w.rows[j] = of->curved || j == 0 ? law_of_row(of, weights, out->level, w.first_j + j - REACH)
                                     : w.rows[0];
  for (int k = 0; k < PL_MIDPOINT_AROUND; k++) {
    int x, y;
    pl_midpoint_offset(PL_MIDPOINT_SQUARE, k, &x, &y);
    w.square[k] = y * WIDE + x;
  }
  set_coarse(&w);
  set_diamonds(&w);
  set_squares(&w);
  for (int j = 0; j < NODES; j++)
    for (int i = 0; i < NODES; i++)
      out->h_m[j * NODES + i] = w.h_m[j + REACH][i + REACH];
}

/* Levels that share places are turned against each other. */
static block *place_of(int level, int64_t i, int64_t j) {
  const int64_t row = (j + level) & (KEPT_SIDE - 1), column = (i + 3 * level) & (KEPT_SIDE - 1);
  return &kept[((level % KEPT_LEVELS) * KEPT_SIDE + row) * KEPT_SIDE + column];
}

static bool holds(const block *at, const pl_diamond_square *of, int level, int64_t i, int64_t j) {
  return at->number == of->number && at->level == level && at->i == i && at->j == j;
}

const block *pl_diamond_block_at(const pl_diamond_square *of, const pl_diamond_weights *weights,
                                 int level, int64_t i, int64_t j) {
  /* Down to the finest level whose block is there. */
  int from = level;
  int64_t is[PL_DIAMOND_LEVELS + 1], js[PL_DIAMOND_LEVELS + 1];
  for (is[from] = i, js[from] = j; from > 0; from--) {
    if (holds(place_of(from, is[from], js[from]), of, from, is[from], js[from]))
      break;
    is[from - 1] = floor_half(is[from]);
    js[from - 1] = floor_half(js[from]);
  }
  block *at = place_of(from, is[from], js[from]);
  if (!holds(at, of, from, is[from], js[from])) {
    at->number = of->number;
    at->level = from;
    at->i = is[from];
    at->j = js[from];
    make_posts(of, at);
  }
  while (from < level) {
    const block *parent = at;
    from++;
    at = place_of(from, is[from], js[from]);
    at->number = of->number;
    at->level = from;
    at->i = is[from];
    at->j = js[from];
    refine(of, weights, parent, at);
  }
  return at;
}
