/* The filter is computed once per surface in a cell, from the sums of the cells around it. */
#include "render/irradiance_filter.h"

#include <string.h>

#include "math/color.h"

/* Maximum radius of a filter, in cells; and minimum number of its paths. Radius 1 is tried first.
 */
enum { REACH = 3, FEWEST = 24 };
/* Maximum radius, cells. It shrinks with more samples, where the remaining noise is less than the
 * light's change over the distance. Measured: these radii minimise the error of a close view of a
 * spacecraft. */
static int reach_of(int samples) { return samples <= 8 ? REACH : samples <= 32 ? 2 : 1; }

/* Minimum effective number of contributing paths, (sum L)^2 / sum L^2. With fewer, the paths nearby
 * may have missed the light by chance, and the filter is widened. */
static const float FOUND = 8.0f;
/* No filter counts as converged with fewer paths than this: a path without light would be visible.
 */
static const float FEWEST_USED = 7.7f; /* 8, with a margin for rounding */
/* A filter counts as converged if its standard error is below this many tolerances. */
static const float QUIET = 1.0f;

/* Sums over the paths of one surface in the cells at one distance: a square ring around the
 * filter's cell. */
typedef struct ring {
  pl_vec3f filtered, weight;
  float square;                                /* sum of squared luminances */
  float count;                                 /* number of paths */
  float pixels, each, together, weight_square; /* as in pl_irradiance_cell */
} ring;

/* The cells of a tile and those around it. */
enum { SIDE = PL_CELL_SIDE + 2 * REACH };
typedef struct window {
  const pl_irradiance_cell *cells[SIDE * SIDE];
  uint32_t counts[SIDE * SIDE];
} window;

typedef struct filter {
  const window *window;
  const pl_spot *like;
  float depth_m;
  ring rings[REACH + 1];
} filter;

/* Variances of the ratio of radiance to throughput, luminances: of one path, times its throughput;
 * and of the pixels' true values. */
typedef struct scatter {
  float noise, truth;
} scatter;

/* The filtered light of the patches of one surface in a cell. */
typedef struct answer {
  bool known;
  pl_vec3f light; /* radiance over throughput */
  float enough;   /* number of paths; patches with at least as many are not filtered */
  scatter scatter;
} answer;

/* The tile at a place; NULL if there is none, or it is not lit. */
static const pl_irradiance_tile *tile_beside(const pl_irradiance_record *irradiance, int row,
                                             int column) {
  if (column < 0 || column >= irradiance->columns || row < 0 || row >= irradiance->rows)
    return NULL;
  const pl_irradiance_tile *tile = pl_irradiance_tile_at(irradiance, row, column);
  return tile->lit ? tile : NULL;
}

static void look_around(const pl_irradiance_record *irradiance, int row, int column, window *out) {
  const pl_irradiance_tile *tiles[9];
  for (int i = 0; i < 9; i++)
    tiles[i] = tile_beside(irradiance, row + i / 3 - 1, column + i % 3 - 1);
  for (int k = 0; k < SIDE * SIDE; k++) {
    const int x = k % SIDE - REACH + PL_CELL_SIDE, y = k / SIDE - REACH + PL_CELL_SIDE;
    const pl_irradiance_tile *tile = tiles[y / PL_CELL_SIDE * 3 + x / PL_CELL_SIDE];
    out->counts[k] = 0;
    if (tile == NULL)
      continue;
    const int i = y % PL_CELL_SIDE * PL_CELL_SIDE + x % PL_CELL_SIDE;
    out->cells[k] = tile->cells + tile->cell_start[i];
    out->counts[k] = tile->cell_start[i + 1] - tile->cell_start[i];
  }
}

static void add_cell(const filter *filter, int k, ring *ring) {
  const pl_irradiance_cell *cells = filter->window->cells[k];
  const uint32_t count = filter->window->counts[k];
  for (uint32_t i = 0; i < count; i++) {
    const pl_irradiance_cell *cell = &cells[i];
    if (!pl_spot_fits(filter->like, &cell->spot, filter->depth_m))
      continue;
    ring->filtered = pl_vec3f_add(ring->filtered, cell->filtered);
    ring->weight = pl_vec3f_add(ring->weight, cell->weight);
    ring->square += cell->square;
    ring->count += cell->count;
    ring->pixels += cell->pixels;
    ring->each += cell->each;
    ring->together += cell->together;
    ring->weight_square += cell->weight_square;
  }
}

static void add_ring(filter *filter, int k, int r) {
  ring *ring = &filter->rings[r];
  for (int u = -r; u <= r; u++) {
    add_cell(filter, k - r * SIDE + u, ring);
    if (r > 0)
      add_cell(filter, k + r * SIDE + u, ring);
  }
  for (int v = 1 - r; v < r; v++) {
    add_cell(filter, k + v * SIDE - r, ring);
    add_cell(filter, k + v * SIDE + r, ring);
  }
}

static float ratio(float a, float b) { return b > 0.0f ? a / b : 0.0f; }

static pl_vec3f light_of(pl_vec3f filtered, pl_vec3f weight) {
  return pl_vec3f_make(ratio(filtered.x, weight.x), ratio(filtered.y, weight.y),
                       ratio(filtered.z, weight.z));
}

/* The largest standard error with which `level` counts as converged: it shifts the displayed value
 * by at most `limit`, up or down. Light above white may be in error by all of its excess. */
static float quiet_under(float white, float limit, float level) {
  const float shown = pl_srgb_encode(pl_minf(level / white, 1.0f));
  const float up = shown + limit < 1.0f ? white * pl_srgb_decode(shown + limit) - level : INFINITY;
  const float down = shown > limit ? level - white * pl_srgb_decode(shown - limit) : INFINITY;
  return pl_minf(up, down);
}

static float quiet_error(const pl_render_settings *settings, float level) {
  const float limit = QUIET * settings->noise_dn / 255.0f, other = settings->white_other;
  const float found = quiet_under(settings->white_radiance, limit, level);
  return other > 0.0f ? pl_minf(found, quiet_under(other, limit, level)) : found;
}

/* Weight of a ring: falls linearly to 0 at `span`, so that the edges of squares do not show. */
static float part_of(int r, float span) { return pl_maxf(1.0f - (float)r / span, 0.0f); }

/* Effective number of paths of a filter whose rings are weighted by `span`. */
static float worth(const filter *filter, float span, int most) {
  float sum = 0.0f, square = 0.0f;
  for (int r = 0; r <= most; r++) {
    const float part = part_of(r, span);
    sum += part * filter->rings[r].count;
    square += part * part * filter->rings[r].count;
  }
  return sum * sum / square;
}

/* Chooses the radius of the filter within the rings it holds: all of them if it does not converge.
 * The variance is that of all paths held. That of the weighted paths alone would stop filters too
 * early whose paths missed the light by chance. */
static bool choose_span(const filter *filter, const pl_render_settings *settings,
                        const pl_irradiance_patch *patch, int most, float *span, float *enough) {
  static const float spans[] = {1.0f, 1.125f, 1.25f, 1.5f, 2.0f, 2.5f, 3.0f, 4.0f};
  enum { SPANS = sizeof spans / sizeof *spans };
  float light = 0.0f, square = 0.0f, count = 0.0f;
  for (int r = 0; r <= most; r++) {
    light += pl_luminance(filter->rings[r].filtered);
    square += filter->rings[r].square;
    count += filter->rings[r].count;
  }
  *span = (float)(most + 1);
  *enough = INFINITY;
  if (!(light * light > FOUND * square) || count < FEWEST)
    return false;
  const float mean = light / count;
  const float variance = pl_maxf(square / count - mean * mean, 0.0f);
  const float limit = quiet_error(settings, patch->level + patch->part * mean);
  *enough = pl_maxf(patch->part * patch->part * variance / (limit * limit), FEWEST_USED);
  for (int i = 0; i < SPANS && spans[i] <= (float)(most + 1); i++)
    if (worth(filter, spans[i], most) >= *enough) {
      *span = spans[i];
      return true;
    }
  return false;
}

/* The sum of rings 0 to `most`. */
static ring sum_rings(const filter *filter, int most) {
  ring sum = filter->rings[0];
  for (int r = 1; r <= most; r++) {
    const ring *ring = &filter->rings[r];
    sum.filtered = pl_vec3f_add(sum.filtered, ring->filtered);
    sum.weight = pl_vec3f_add(sum.weight, ring->weight);
    sum.count += ring->count;
    sum.pixels += ring->pixels;
    sum.each += ring->each;
    sum.together += ring->together;
    sum.weight_square += ring->weight_square;
  }
  return sum;
}

/* Number of additional paths assumed to have the variance of all paths together: a few paths that
 * found no light do not prove that there is no noise. */
static const float ASSUMED = 24.0f;

/* Variance of paths about the means of their pixels. */
static float noise_of(const ring *sum, float assumed, float scattered) {
  const float within = pl_maxf(sum->each - sum->together, 0.0f);
  const float freedom = pl_maxf(sum->count - sum->pixels, 0.0f);
  return (within + assumed * scattered) / (freedom + assumed);
}

/* One-way analysis of variance, pixels as groups of unequal size (Searle, Casella and McCulloch
 * 1992, Variance Components, 3.6): the variance of the pixels' means beyond the noise of their
 * paths is that of the true values. With more paths the noise tends to the noise of the filter's
 * own cell, which is lower in dark corners. */
static scatter scatter_of(const filter *filter, int most) {
  const ring sum = sum_rings(filter, most);
  const float light = pl_luminance(sum.filtered), weight = pl_luminance(sum.weight);
  scatter out = {0.0f, 0.0f};
  const float groups = weight - ratio(sum.weight_square, weight);
  if (!(groups > 0.0f) || !(sum.count > 1.0f))
    return out;
  const float mean = light * light / weight;
  const float noise = noise_of(&sum, ASSUMED, pl_maxf(sum.each - mean, 0.0f) / (sum.count - 1.0f));
  const float between = sum.together - mean;
  out.truth = pl_maxf((between - (sum.pixels - 1.0f) * noise) / groups, 0.0f);
  out.noise = noise_of(&filter->rings[0], ASSUMED, noise);
  return out;
}

/* Radiance over throughput, filtered around cell `k`. */
static answer ask(filter *filter, const pl_render_settings *settings,
                  const pl_irradiance_patch *patch, int k) {
  answer out = {.known = true};
  float span = 1.0f;
  add_ring(filter, k, 0);
  const int reach = reach_of(settings->samples);
  for (int most = 1; most <= reach; most++) {
    add_ring(filter, k, most);
    out.scatter = scatter_of(filter, most);
    if (choose_span(filter, settings, patch, most, &span, &out.enough))
      break;
  }
  pl_vec3f all = {0.0f, 0.0f, 0.0f}, weight = all;
  for (int r = 0; (float)r < span; r++) {
    all = pl_vec3f_madd(all, part_of(r, span), filter->rings[r].filtered);
    weight = pl_vec3f_madd(weight, part_of(r, span), filter->rings[r].weight);
  }
  out.light = light_of(all, weight);
  return out;
}

/* Shrinks a patch's own light towards the filtered one. The own light is weighted by the part of
 * the variance that is true: with more samples the noise falls, and in the limit the filter has no
 * weight (James and Stein 1961; Efron and Morris 1973). */
static pl_vec3f blend(const answer *answer, const pl_irradiance_patch *patch) {
  const pl_vec3f own = light_of(patch->filtered, patch->lit_weight);
  if ((float)patch->lit >= answer->enough)
    return own;
  const float truth = answer->scatter.truth * pl_luminance(patch->lit_weight);
  const float part = ratio(truth, truth + answer->scatter.noise);
  return pl_vec3f_madd(pl_vec3f_scale(answer->light, 1.0f - part), part, own);
}

static void light_cell(const pl_irradiance_tile *tile, int i, const window *window,
                       const pl_render_settings *settings, float spread, pl_vec3f *radiance) {
  const pl_irradiance_cell *cells = tile->cells + tile->cell_start[i];
  const int k = (i / PL_CELL_SIDE + REACH) * SIDE + i % PL_CELL_SIDE + REACH;
  answer answers[PL_CELL * PL_CELL * PL_PATCHES];
  for (uint32_t j = 0; j < tile->cell_start[i + 1] - tile->cell_start[i]; j++)
    answers[j].known = false;
  for (uint32_t j = tile->patch_start[i]; j < tile->patch_start[i + 1]; j++) {
    const pl_irradiance_patch *patch = &tile->patches[j];
    answer *answer = &answers[patch->cell];
    if (!answer->known) {
      const pl_spot *spot = &cells[patch->cell].spot;
      filter filter = {.window = window, .like = spot, .depth_m = pl_spot_depth(spot, spread)};
      *answer = ask(&filter, settings, patch, k);
    }
    const pl_vec3f light = blend(answer, patch);
    radiance[patch->pixel] =
        pl_vec3f_add(radiance[patch->pixel], pl_vec3f_mul(patch->weight, light));
  }
}

void pl_irradiance_filter_light(const pl_irradiance_record *irradiance, int row, int column,
                                const pl_render_settings *settings, double pixel_rad,
                                pl_vec3f radiance[PL_TILE_PIXELS]) {
  const pl_irradiance_tile *tile = pl_irradiance_tile_at(irradiance, row, column);
  window window;
  look_around(irradiance, row, column, &window);
  memcpy(radiance, tile->rest, sizeof tile->rest);
  for (int i = 0; i < PL_CELLS; i++)
    if (tile->patch_start[i] < tile->patch_start[i + 1])
      light_cell(tile, i, &window, settings, (float)pixel_rad, radiance);
}
