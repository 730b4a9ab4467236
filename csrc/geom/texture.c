/* Filtered texture lookups: wrap modes, bilinear and trilinear filters, anisotropic footprints. */
#include "geom/texture.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"
#include "geom/mipmap.h"
#include "math/vec.h"

/* Largest number of taps along the longer axis of a footprint; longer footprints are blurred rather
 * than aliased. */
static const int TAPS[PL_FILTER_COUNT] = {1, 1, 1, 1, 2, 4, 8, 16};
/* A footprint of more texels covers the whole texture. The limit also keeps its square finite. */
static const float FOOTPRINT_LIMIT = 1e9f;

struct pl_texture {
  pl_mip_pyramid mips;
  pl_wrap wrap_u, wrap_v;
  const float *table[4]; /* code to linear for each stored channel; points into mips */
  float mean[4];         /* RGBA */
  float last[4];         /* unrounded values of the last level in stored channels: the mean */
  float ranges[PL_MIP_MAX_LEVELS];
};

/* Expands the stored channels to RGBA: grey is copied to RGB, missing alpha is 1. */
static void expand(const float stored[4], int channels, float out[4]) {
  const float *s = stored;
  out[0] = s[0];
  out[1] = channels < 3 ? s[0] : s[1];
  out[2] = channels < 3 ? s[0] : s[2];
  out[3] = channels == 4 ? s[3] : channels == 2 ? s[1] : 1.0f;
}

/* Histogram of the codes of one channel of a level. Texels in turn are counted apart: a processor
 * waits for the last count before it adds to it again, and neighbours are often alike. */
static void count_codes(const pl_texture *texture, int level_index, int channel,
                        uint64_t counts[256]) {
  enum { APART = 4 };
  const pl_mip_level *level = &texture->mips.levels[level_index];
  const size_t n = (size_t)texture->mips.channels;
  const size_t texels = (size_t)level->width * (size_t)level->height;
  const uint8_t *codes = level->texels + channel;
  uint64_t parts[APART][256] = {{0}};
  size_t i = 0;
  for (; i + APART <= texels; i += APART)
    for (size_t k = 0; k < APART; k++)
      parts[k][codes[(i + k) * n]]++;
  for (; i < texels; i++)
    parts[0][codes[i * n]]++;
  for (int code = 0; code < 256; code++)
    counts[code] = parts[0][code] + parts[1][code] + parts[2][code] + parts[3][code];
}

/* Computes the mean and the ranges of a channel from histograms: exact, and one addition per
 * texel. */
static void measure_channel(pl_texture *texture, int c) {
  const float *table = texture->table[c];
  const pl_mip_level *levels = texture->mips.levels;
  const double texels = (double)levels[0].width * (double)levels[0].height;
  double sum = 0.0;
  uint64_t counts[256];
  count_codes(texture, 0, c, counts);
  for (int code = 0; code < 256; code++)
    sum += (double)counts[code] * (double)table[code];
  texture->last[c] = (float)(sum / texels);
  float low = texture->last[c], high = low;
  for (int k = texture->mips.level_count - 2; k >= 0; k--) {
    count_codes(texture, k, c, counts);
    for (int code = 0; code < 256; code++) {
      low = counts[code] > 0 ? pl_minf(low, table[code]) : low;
      high = counts[code] > 0 ? pl_maxf(high, table[code]) : high;
    }
    texture->ranges[k] = pl_maxf(texture->ranges[k], high - low);
  }
}

/* The same for a pyramid of floats, whose levels are read texel by texel. */
static void measure_numbers(pl_texture *texture) {
  const pl_mip_level *levels = texture->mips.levels;
  const size_t texels = (size_t)levels[0].width * (size_t)levels[0].height;
  double sum = 0.0;
  for (size_t i = 0; i < texels; i++)
    sum += (double)levels[0].numbers[i];
  texture->last[0] = (float)(sum / (double)texels);
  float low = texture->last[0], high = low;
  for (int k = texture->mips.level_count - 2; k >= 0; k--) {
    const size_t count = (size_t)levels[k].width * (size_t)levels[k].height;
    for (size_t i = 0; i < count; i++) {
      low = pl_minf(low, levels[k].numbers[i]);
      high = pl_maxf(high, levels[k].numbers[i]);
    }
    texture->ranges[k] = high - low;
  }
  expand(texture->last, texture->mips.channels, texture->mean);
}

static void measure(pl_texture *texture) {
  for (int c = 0; c < texture->mips.channels; c++)
    measure_channel(texture, c);
  expand(texture->last, texture->mips.channels, texture->mean);
}

pl_status pl_texture_create(pl_image *image, bool srgb, pl_wrap wrap_u, pl_wrap wrap_v,
                            pl_texture **out) {
  *out = NULL;
  void *memory;
  pl_status status = pl_alloc_or_fail(1, sizeof(pl_texture), "a texture", &memory);
  if (status != PL_OK) {
    pl_image_clear(image);
    return status;
  }
  pl_texture *texture = memory;
  status = pl_mip_build(image, srgb, &texture->mips);
  if (status != PL_OK) {
    pl_free(texture);
    return status;
  }
  texture->wrap_u = wrap_u;
  texture->wrap_v = wrap_v;
  for (int c = 0; c < 4; c++)
    texture->table[c] = pl_mip_is_alpha(c, texture->mips.channels) ? texture->mips.alpha_table
                                                                   : texture->mips.color_table;
  measure(texture);
  *out = texture;
  return PL_OK;
}

pl_status pl_texture_of_numbers(const float *numbers, int width, int height, pl_wrap wrap_u,
                                pl_wrap wrap_v, pl_texture **out) {
  *out = NULL;
  void *memory;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_texture), "a texture", &memory));
  pl_texture *texture = memory;
  const pl_status status = pl_mip_build_numbers(numbers, width, height, &texture->mips);
  if (status != PL_OK) {
    pl_free(texture);
    return status;
  }
  texture->wrap_u = wrap_u;
  texture->wrap_v = wrap_v;
  measure_numbers(texture);
  *out = texture;
  return PL_OK;
}

void pl_texture_destroy(pl_texture *texture) {
  if (texture == NULL)
    return;
  pl_mip_clear(&texture->mips);
  pl_free(texture);
}

/* floorf for |x| < 2^31 without a library call (the baseline instruction set has no rounding). */
static inline float floor_small(float x) {
  const float whole = (float)(int)x;
  return whole > x ? whole - 1.0f : whole;
}

/* Finds the two texels next to coordinate t (|t| < 2^31, in texture widths) along an axis of `size`
 * texels; returns the weight of the second. Texel centres lie at (i + 0.5) / size. */
static inline float neighbours(float t, int size, pl_wrap wrap, int *low, int *high) {
  if (wrap == PL_WRAP_REPEAT) {
    t -= floor_small(t);
  } else if (wrap == PL_WRAP_CLAMP) {
    t = pl_minf(pl_maxf(t, 0.0f), 1.0f);
  } else {
    t -= 2.0f * floor_small(0.5f * t);
    t = t > 1.0f ? 2.0f - t : t;
  }
  /* t is in [0, 1] (1 by rounding), so i0 is in -1..size-1 and i1 in 0..size. */
  const float x = t * (float)size - 0.5f;
  const float below = floor_small(x);
  const int i0 = (int)below, i1 = i0 + 1;
  if (wrap == PL_WRAP_REPEAT) {
    *low = i0 < 0 ? size - 1 : i0;
    *high = i1 >= size ? 0 : i1;
  } else { /* mirroring maps the edge texel to itself */
    *low = i0 < 0 ? 0 : i0;
    *high = i1 >= size ? size - 1 : i1;
  }
  return x - below;
}

static inline void add_last(const pl_texture *texture, float weight, float sum[4]) {
  for (int c = 0; c < 4; c++)
    sum[c] += weight * texture->last[c];
}

/* The four texels around a point, as indices into their level, and their weights. */
typedef struct quad {
  size_t at[4];
  float weight[4];
} quad;

static inline void add_quad(const pl_texture *texture, const uint8_t *texels, const quad *q,
                            size_t channels, float sum[4]) {
  for (size_t c = 0; c < channels; c++) {
    const float *table = texture->table[c];
    sum[c] +=
        q->weight[0] * table[texels[q->at[0] + c]] + q->weight[1] * table[texels[q->at[1] + c]] +
        q->weight[2] * table[texels[q->at[2] + c]] + q->weight[3] * table[texels[q->at[3] + c]];
  }
}

static inline void add_numbers(const float *numbers, const quad *q, float sum[4]) {
  sum[0] += q->weight[0] * numbers[q->at[0]] + q->weight[1] * numbers[q->at[1]] +
            q->weight[2] * numbers[q->at[2]] + q->weight[3] * numbers[q->at[3]];
}

/* Adds `weight` times the bilinear value at (u, v) of one level to sum, in stored channels. */
static inline void add_bilinear(const pl_texture *texture, int level_index, float u, float v,
                                float weight, float sum[4]) {
  const pl_mip_level *level = &texture->mips.levels[level_index];
  const size_t n = (size_t)texture->mips.channels;
  if (level_index == texture->mips.level_count - 1) {
    add_last(texture, weight, sum);
    return;
  }
  int x0, x1, y0, y1;
  const float fx = neighbours(u, level->width, texture->wrap_u, &x0, &x1);
  const float fy = neighbours(v, level->height, texture->wrap_v, &y0, &y1);
  const size_t row = (size_t)level->width * n;
  const size_t top = (size_t)y0 * row, bottom = (size_t)y1 * row;
  const size_t left = (size_t)x0 * n, right = (size_t)x1 * n;
  const float low = weight * (1.0f - fy), high = weight * fy;
  const quad q = {{top + left, top + right, bottom + left, bottom + right},
                  {low * (1.0f - fx), low * fx, high * (1.0f - fx), high * fx}};
  if (n == 3)
    add_quad(texture, level->texels, &q, 3, sum);
  else if (level->numbers != NULL)
    add_numbers(level->numbers, &q, sum);
  else if (n == 1)
    add_quad(texture, level->texels, &q, 1, sum);
  else
    add_quad(texture, level->texels, &q, n, sum);
}

/* Adds the nearest texel of one level to sum. */
static void add_nearest(const pl_texture *texture, int level_index, float u, float v,
                        float sum[4]) {
  const pl_mip_level *level = &texture->mips.levels[level_index];
  const size_t n = (size_t)texture->mips.channels;
  int x0, x1, y0, y1;
  if (level_index == texture->mips.level_count - 1) {
    add_last(texture, 1.0f, sum);
    return;
  }
  const int x = neighbours(u, level->width, texture->wrap_u, &x0, &x1) < 0.5f ? x0 : x1;
  const int y = neighbours(v, level->height, texture->wrap_v, &y0, &y1) < 0.5f ? y0 : y1;
  const size_t at = ((size_t)y * (size_t)level->width + (size_t)x) * n;
  if (level->numbers != NULL) {
    sum[0] += level->numbers[at];
    return;
  }
  for (size_t c = 0; c < n; c++)
    sum[c] += texture->table[c][level->texels[at + c]];
}

/* Sampling pattern of a footprint: `taps` lookups at `level` (blended with the next by `blend`),
 * spaced by (step_u, step_v). */
typedef struct footprint {
  int taps;
  int level;
  float blend;
  float step_u, step_v; /* uv distance between two taps */
} footprint;

/* Maps the axes of a footprint to a mip level. */
typedef struct kernel {
  float least; /* texels: footprints with a longer axis up to this read the finest level once */
  float (*level)(float texels);
} kernel;

/* Binary logarithm of x >= 1, absolute error 1e-4, continuous: the exponent plus a polynomial of
 * the mantissa that is 0 and 1 at its ends. */
static inline float log2_near(float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  const float whole = (float)((int)(bits >> 23) - 127);
  bits = (bits & 0x7fffffu) | 0x3f800000u;
  float t;
  memcpy(&t, &bits, sizeof t);
  t -= 1.0f;
  return whole + t * (1.4418359f + t * ((-0.7083722f) +
                                        t * (0.4135551f + t * ((-0.1912625f) + t * 0.0442437f))));
}

/* ceilf for |x| < 2^31 without a library call. */
static inline int whole_above(float x) {
  const int whole = (int)x;
  return whole + ((float)whole < x);
}

/* Texels as wide as the axis: almost free of aliasing, but bilinear interpolation has three times
 * the variance of a box of the same width. */
static inline float level_smooth(float texels) { return texels > 1.0f ? log2_near(texels) : 0.0f; }
static const kernel SMOOTH = {1.0f, level_smooth};

/* Lookups in level k, whose texels are t = 2^k wide, are means over boxes of width t, filtered by a
 * tent of twice that width: variance t^2/12 + t^2/6. A box of s texels of the finest level, whose
 * lookups have a variance of 1/4 by the same formula, should have s^2/12 + 1/4. */
static inline float level_box(float texels) {
  return 0.5f * log2_near(1.0f + texels * texels / 3.0f);
}
static const kernel BOX = {0.5f, level_box};

/* Axes of the ellipse with the covariance of the parallelogram: the singular values of the Jacobian
 * [a b] in texels (Heckbert, "Fundamentals of texture mapping", 1989, section 3.5). The shorter
 * axis sets the level, taps lie along the longer one (McCormack et al., "Feline", SIGGRAPH 1999).
 * Unlike the vectors a and b, the singular values do not depend on the shear of the
 * parallelogram. */
static footprint footprint_of(const pl_texture *texture, const float a[2], const float b[2],
                              int max_taps, const kernel *kernel) {
  const pl_mip_pyramid *mips = &texture->mips;
  const footprint all = {1, mips->level_count - 1, 0.0f, 0.0f, 0.0f};
  const float w = (float)mips->levels[0].width, h = (float)mips->levels[0].height;
  const float ax = a[0] * w, ay = a[1] * h, bx = b[0] * w, by = b[1] * h;
  const float extent = fabsf(ax) + fabsf(ay) + fabsf(bx) + fabsf(by);
  if (!(extent < FOOTPRINT_LIMIT)) /* also true for nan */
    return all;
  const float xx = ax * ax + bx * bx, yy = ay * ay + by * by, xy = ax * ay + bx * by;
  const float half = 0.5f * (xx - yy), root = sqrtf(half * half + xy * xy);
  const float longer = sqrtf(0.5f * (xx + yy) + root);
  if (longer <= kernel->least)
    return (footprint){.taps = 1};
  const float shorter = fabsf(ax * by - ay * bx) / longer;
  const float ratio = pl_minf(longer / pl_maxf(shorter, 1.0f), (float)max_taps);
  footprint f = {.taps = whole_above(ratio - 1e-3f)};
  f.taps = f.taps < 1 ? 1 : f.taps;
  const float level = kernel->level(pl_maxf(shorter, longer / (float)max_taps));
  if (level >= (float)(mips->level_count - 1))
    return all;
  f.level = (int)level;
  f.blend = level - (float)f.level;
  if (f.taps > 1) {
    /* Eigenvector of the larger eigenvalue, from the better-conditioned row. */
    const float ex = half >= 0.0f ? half + root : xy, ey = half >= 0.0f ? xy : root - half;
    const float norm = sqrtf(ex * ex + ey * ey);
    const float stride = norm > 0.0f ? longer / (norm * (float)f.taps) : 0.0f;
    f.step_u = ex * stride / w;
    f.step_v = ey * stride / h;
  }
  return f;
}

/* One lookup in the nearest level: `blend` is rounded. */
static void read_level(const pl_texture *texture, const footprint *f, float u, float v, bool linear,
                       float sum[4]) {
  const int level = f->blend >= 0.5f ? f->level + 1 : f->level;
  if (linear)
    add_bilinear(texture, level, u, v, 1.0f, sum);
  else
    add_nearest(texture, level, u, v, sum);
}

static void read_taps(const pl_texture *texture, const footprint *f, float u, float v,
                      float sum[4]) {
  const float weight = 1.0f / (float)f->taps;
  for (int i = 0; i < f->taps; i++) {
    const float along = (float)i - 0.5f * (float)(f->taps - 1);
    const float tap_u = u + along * f->step_u, tap_v = v + along * f->step_v;
    add_bilinear(texture, f->level, tap_u, tap_v, weight * (1.0f - f->blend), sum);
    if (f->blend > 0.0f)
      add_bilinear(texture, f->level + 1, tap_u, tap_v, weight * f->blend, sum);
  }
}

void pl_texture_sample(const pl_texture *texture, float u, float v, const float a[2],
                       const float b[2], pl_filter filter, float out[4]) {
  /* A coordinate that is nan, or so large that it has no fraction, reads the origin. */
  u = fabsf(u) < FOOTPRINT_LIMIT ? u : 0.0f;
  v = fabsf(v) < FOOTPRINT_LIMIT ? v : 0.0f;
  float sum[4] = {0};
  if (filter == PL_FILTER_NONE) {
    add_nearest(texture, 0, u, v, sum);
  } else {
    const footprint f = footprint_of(texture, a, b, TAPS[filter], &SMOOTH);
    if (filter < PL_FILTER_TRILINEAR)
      read_level(texture, &f, u, v, filter == PL_FILTER_BILINEAR, sum);
    else
      read_taps(texture, &f, u, v, sum);
  }
  expand(sum, texture->mips.channels, out);
}

/* Where fine and coarse texels differ by more than this, one lookup in each level is no accurate
 * mean. */
static const float EVEN = 0.04f;

/* Reads the two levels around a box; returns true if their values agree. */
static bool read_even(const pl_texture *texture, const footprint *f, float u, float v,
                      float sum[4]) {
  float fine[4] = {0}, coarse[4] = {0}, most = 0.0f;
  const footprint one = {f->taps, f->level, 0.0f, f->step_u, f->step_v};
  const footprint two = {f->taps, f->level + 1, 0.0f, f->step_u, f->step_v};
  read_taps(texture, &one, u, v, fine);
  read_taps(texture, &two, u, v, coarse);
  for (int c = 0; c < texture->mips.channels; c++) {
    const float change = coarse[c] - fine[c];
    sum[c] = fine[c] + f->blend * change;
    most = pl_maxf(most, fabsf(change));
  }
  return most <= EVEN;
}

/* Averages four quarters of the footprint, each filtered as a box. */
static void read_quarters(const pl_texture *texture, float u, float v, const float a[2],
                          const float b[2], int max_taps, float sum[4]) {
  const float ha[2] = {0.5f * a[0], 0.5f * a[1]}, hb[2] = {0.5f * b[0], 0.5f * b[1]};
  const footprint f = footprint_of(texture, ha, hb, max_taps, &BOX);
  for (int c = 0; c < 4; c++)
    sum[c] = 0.0f;
  for (int i = 0; i < 4; i++) {
    const float p = i % 2 == 0 ? -0.5f : 0.5f, q = i / 2 == 0 ? -0.5f : 0.5f;
    read_taps(texture, &f, u + p * ha[0] + q * hb[0], v + p * ha[1] + q * hb[1], sum);
  }
  for (int c = 0; c < 4; c++)
    sum[c] *= 0.25f;
}

void pl_texture_box(const pl_texture *texture, float u, float v, const float a[2], const float b[2],
                    pl_filter filter, float out[4]) {
  if (filter < PL_FILTER_TRILINEAR || !(fabsf(u) < FOOTPRINT_LIMIT && fabsf(v) < FOOTPRINT_LIMIT)) {
    pl_texture_sample(texture, u, v, a, b, filter, out);
    return;
  }
  const footprint f = footprint_of(texture, a, b, TAPS[filter], &BOX);
  float sum[4] = {0};
  if (f.level == texture->mips.level_count - 1 || (f.taps == 1 && !(f.blend > 0.0f)))
    read_taps(texture, &f, u, v, sum);
  else if (!read_even(texture, &f, u, v, sum))
    read_quarters(texture, u, v, a, b, TAPS[filter], sum);
  expand(sum, texture->mips.channels, out);
}

void pl_texture_mean(const pl_texture *texture, float out[4]) {
  for (int c = 0; c < 4; c++)
    out[c] = texture->mean[c];
}

const float *pl_texture_ranges(const pl_texture *texture, int *levels) {
  *levels = texture->mips.level_count;
  return texture->ranges;
}

void pl_texture_size(const pl_texture *texture, int *width, int *height, int *channels) {
  *width = texture->mips.levels[0].width;
  *height = texture->mips.levels[0].height;
  *channels = texture->mips.channels;
}

size_t pl_texture_bytes(const pl_texture *texture) { return sizeof *texture + texture->mips.bytes; }

/* Returns the texel index of i (any integer) along an axis. */
static int wrapped(int64_t i, int size, pl_wrap wrap) {
  if (wrap == PL_WRAP_CLAMP)
    return (int)(i < 0 ? 0 : i >= size ? size - 1 : i);
  const int64_t period = wrap == PL_WRAP_MIRROR ? 2 * (int64_t)size : size;
  const int64_t at = ((i % period) + period) % period;
  return (int)(at < size ? at : period - 1 - at);
}

/* Returns the first texel that coordinates from `low` to `high` touch along an axis, and the number
 * of texels: at most one period. */
static int64_t touched(float low, float high, int size, pl_wrap wrap, int64_t *count) {
  const double limit = 1e15, n = (double)size; /* keeps sums of indices finite */
  const double first = floor(fmin(fmax((double)low * n, -limit), limit) - 0.5);
  const double last = floor(fmin(fmax((double)high * n, -limit), limit) - 0.5) + 1.0;
  const double all = wrap == PL_WRAP_MIRROR ? 2.0 * n : wrap == PL_WRAP_CLAMP ? INFINITY : n;
  if (wrap == PL_WRAP_CLAMP) { /* beyond an edge only the edge texel is read */
    const double a = fmin(fmax(first, 0.0), n - 1.0), b = fmin(fmax(last, 0.0), n - 1.0);
    *count = (int64_t)(b - a) + 1;
    return (int64_t)a;
  }
  *count = (int64_t)fmin(last - first + 1.0, all);
  return (int64_t)first;
}

void pl_texture_alpha_range(const pl_texture *texture, const float low[2], const float high[2],
                            float range[2]) {
  const pl_mip_level *level = &texture->mips.levels[0];
  const int n = texture->mips.channels;
  int64_t columns, rows;
  range[0] = range[1] = 1.0f;
  if (!pl_mip_is_alpha(n - 1, n))
    return;
  const int64_t x0 = touched(low[0], high[0], level->width, texture->wrap_u, &columns);
  const int64_t y0 = touched(low[1], high[1], level->height, texture->wrap_v, &rows);
  range[0] = 1.0f;
  range[1] = 0.0f;
  for (int64_t y = 0; y < rows; y++) {
    const size_t row = (size_t)wrapped(y0 + y, level->height, texture->wrap_v);
    for (int64_t x = 0; x < columns; x++) {
      const size_t column = (size_t)wrapped(x0 + x, level->width, texture->wrap_u);
      const size_t at = (row * (size_t)level->width + column) * (size_t)n + (size_t)(n - 1);
      const float alpha = texture->table[n - 1][level->texels[at]];
      range[0] = pl_minf(range[0], alpha);
      range[1] = pl_maxf(range[1], alpha);
    }
  }
}
