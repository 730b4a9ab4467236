/* Builds mip pyramids with an exact box filter in linear light. Levels are stored in 8 bits, or as
 * floats for textures of numbers.
 *
 * Level k+1 has floor(side / 2) texels per side (at least 1), as in OpenGL. Where a side is odd, a
 * texel of level k+1 covers 2 + 1/n texels of level k. All covered texels are averaged, weighted by
 * the covered fraction (the polyphase box filter of Guthe & Heckbert, "Non-power-of-two
 * mipmapping", NVIDIA 2005), so that the mean of every level is the mean of the image and no edge
 * shifts. Each level is averaged from the unrounded values of the finer level. Rounding errors of
 * the 8-bit codes are diffused to the next texels of the row (Floyd and Steinberg, restricted to
 * rows), so that a level keeps its mean: half a code is 0.6 % at sRGB's middle grey. The stored
 * code is one of the two nearest to the true mean. A value that is exactly a code, as in areas of
 * one colour, keeps it. */
#include "geom/mipmap.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "math/color.h"

/* Returns the linear value of an 8-bit code; fractional codes are allowed. */
static float decode(float code, bool srgb) {
  return srgb ? pl_srgb_decode(code / 255.0f) : code / 255.0f;
}

enum { GUESSES = 4096 };

/* Inverse of a code table: a first guess in equal steps of linear light, followed by a comparison.
 */
typedef struct encoder {
  float upper[256];       /* linear value half-way between the codes c and c + 1 */
  uint8_t guess[GUESSES]; /* code of linear value i / GUESSES */
  float step[257]; /* from the linear value of code c - 1 to that of c; infinite at the ends */
} encoder;

static void encoder_init(bool srgb, const float decoded[256], encoder *out) {
  for (int c = 0; c < 255; c++)
    out->upper[c] = decode((float)c + 0.5f, srgb);
  out->upper[255] = INFINITY;
  int code = 0;
  for (int i = 0; i < GUESSES; i++) {
    while ((float)i / GUESSES >= out->upper[code])
      code++;
    out->guess[i] = (uint8_t)code;
  }
  out->step[0] = out->step[256] = INFINITY;
  for (int c = 1; c < 256; c++)
    out->step[c] = decoded[c] - decoded[c - 1];
}

/* Half-way values are at least 1 / (255 * 12.92) apart, farther than guesses, so that at most one
 * of them lies between a guess and the value. */
static inline unsigned encode(const encoder *table, float linear) {
  int i = (int)(linear * GUESSES);
  i = i < 0 ? 0 : i >= GUESSES ? GUESSES - 1 : i;
  const unsigned code = table->guess[i];
  return code + (linear >= table->upper[code] ? 1u : 0u);
}

/* Encodes a value as one of its two nearest codes, chosen by the accumulated rounding error:
 * without branches, since which of them is taken looks random. Of the first and last code the
 * neighbour beyond does not exist, at an infinite step. */
static inline uint8_t encode_carrying(const encoder *table, const float decoded[256], float value,
                                      float *carry) {
  /* in codes; smaller errors are rounding errors of the averages */
  static const float EXACT = 0.02f;
  const unsigned nearest = encode(table, value);
  const float error = value - decoded[nearest];
  const bool above = error > 0.0f;
  const float sign = above ? 1.0f : -1.0f;
  const float step = table->step[nearest + above];
  /* Steps between bright codes are larger than between dark ones, so the carried error is limited
   * to the current step. */
  const float sum = pl_minf(pl_maxf(*carry + error, -step), step);
  const bool rounds = step < INFINITY && !(fabsf(error) < EXACT * step);
  const bool moves = rounds && sign * sum > 0.5f * step;
  *carry = !rounds ? *carry : moves ? sum - sign * step : sum;
  return (uint8_t)(moves ? (above ? nearest + 1 : nearest - 1) : nearest);
}

/* Source texels covered by one destination texel along one axis. */
typedef struct span {
  int first, count; /* count 1..3 */
  float weight[3];  /* sums to 1 */
} span;

static span span_of(int i, int from, int to) {
  /* In units of 1/to of a source texel, the destination texel covers [i from, (i + 1) from). */
  const int64_t begin = (int64_t)i * from, end = begin + from;
  span s = {.first = (int)(begin / to)};
  for (int64_t k = s.first; k * to < end && s.count < 3; k++) {
    const int64_t low = k * to > begin ? k * to : begin;
    const int64_t high = (k + 1) * to < end ? (k + 1) * to : end;
    s.weight[s.count++] = (float)((double)(high - low) / (double)from);
  }
  return s;
}

/* Input of a level: the codes of the image, or the floats of the finer level. */
typedef struct source {
  int width, height;
  const uint8_t *codes; /* NULL when `linear` is used */
  const float *linear;  /* when codes is NULL */
} source;

typedef struct builder {
  pl_mip_pyramid *pyramid;
  encoder color, alpha;
} builder;

static inline const float *table_of(const pl_mip_pyramid *p, int channel, int channels) {
  return pl_mip_is_alpha(channel, channels) ? p->alpha_table : p->color_table;
}

static inline float texel_of(const source *from, const float *table, size_t at) {
  return from->codes != NULL ? table[from->codes[at]] : from->linear[at];
}

static void average(const builder *b, const source *from, span xs, span ys, float *out) {
  const pl_mip_pyramid *p = b->pyramid;
  const int n = p->channels;
  float sum[4] = {0};
  for (int j = 0; j < ys.count; j++) {
    for (int i = 0; i < xs.count; i++) {
      const size_t texel =
          ((size_t)(ys.first + j) * (size_t)from->width + (size_t)(xs.first + i)) * (size_t)n;
      const float weight = xs.weight[i] * ys.weight[j];
      for (int c = 0; c < n; c++)
        sum[c] += weight * texel_of(from, table_of(p, c, n), texel + (size_t)c);
    }
  }
  memcpy(out, sum, (size_t)n * sizeof *out);
}

/* As average, to the bit, for the two by two texels from `texel` on. */
static inline void average_of_four(const pl_mip_pyramid *p, const source *from, size_t texel, int n,
                                   float *out) {
  const size_t below = texel + (size_t)from->width * (size_t)n;
  for (int c = 0; c < n; c++) {
    const float *table = table_of(p, c, n);
    const size_t k = (size_t)c, next = (size_t)(c + n);
    out[c] = 0.25f * texel_of(from, table, texel + k) + 0.25f * texel_of(from, table, texel + next);
    out[c] += 0.25f * texel_of(from, table, below + k);
    out[c] += 0.25f * texel_of(from, table, below + next);
  }
}

/* Averages a row of a level; `n`: channels, known when this is compiled, as `halved` is: both sides
 * are half of the finer level's. */
static inline void average_row(const builder *b, const source *from, int y, int width, int height,
                               int n, bool halved, float *out) {
  if (halved) {
    const size_t first = 2 * (size_t)y * (size_t)from->width * (size_t)n;
    for (int x = 0; x < width; x++)
      average_of_four(b->pyramid, from, first + 2 * (size_t)x * (size_t)n, n, out + x * n);
    return;
  }
  const span ys = span_of(y, from->height, height);
  for (int x = 0; x < width; x++)
    average(b, from, span_of(x, from->width, width), ys, out + x * n);
}

static void average_row_of(const builder *b, const source *from, int y, int width, int height,
                           float *out) {
  const bool halved = from->width == 2 * width && from->height == 2 * height;
  switch (b->pyramid->channels) {
  case 1:
    average_row(b, from, y, width, height, 1, halved, out);
    break;
  case 2:
    average_row(b, from, y, width, height, 2, halved, out);
    break;
  case 3:
    average_row(b, from, y, width, height, 3, halved, out);
    break;
  default:
    average_row(b, from, y, width, height, 4, halved, out);
    break;
  }
}

/* Fills one level (texels is NULL for a pyramid of floats) and its unrounded copy `linear`.
 * `linear` may be the source array: a texel is written only after all source texels at or before
 * its position have been read. */
static void build_level(const builder *b, const source *from, int width, int height,
                        uint8_t *texels, float *linear) {
  const pl_mip_pyramid *p = b->pyramid;
  const size_t n = (size_t)p->channels, row = (size_t)width * n;
  float carry[4] = {0};
  for (int y = 0; y < height; y++, linear += row) {
    average_row_of(b, from, y, width, height, linear);
    if (texels == NULL)
      continue;
    for (size_t i = 0; i < row; i += n) {
      for (size_t c = 0; c < n; c++) {
        const bool alpha = pl_mip_is_alpha((int)c, (int)n);
        texels[i + c] =
            encode_carrying(alpha ? &b->alpha : &b->color, alpha ? p->alpha_table : p->color_table,
                            linear[i + c], &carry[c]);
      }
    }
    texels += row;
  }
}

/* Sets the sizes of all levels; returns the number of texels of levels 1 and above. */
static size_t lay_out(pl_mip_pyramid *p, int width, int height) {
  size_t texels = 0;
  p->level_count = 0;
  for (;;) {
    p->levels[p->level_count++] = (pl_mip_level){.width = width, .height = height};
    if (p->level_count > 1)
      texels += (size_t)width * (size_t)height;
    if (width == 1 && height == 1)
      return texels;
    width = width > 1 ? width / 2 : 1;
    height = height > 1 ? height / 2 : 1;
  }
}

static void fill(pl_mip_pyramid *p, bool srgb, float *linear) {
  builder b = {.pyramid = p};
  encoder_init(srgb, p->color_table, &b.color);
  encoder_init(false, p->alpha_table, &b.alpha);
  source from = {p->levels[0].width, p->levels[0].height, p->base, NULL};
  uint8_t *next = p->smaller;
  for (int k = 1; k < p->level_count; k++) {
    pl_mip_level *level = &p->levels[k];
    build_level(&b, &from, level->width, level->height, next, linear);
    level->texels = next;
    next += (size_t)level->width * (size_t)level->height * (size_t)p->channels;
    from = (source){level->width, level->height, NULL, linear};
  }
}

static pl_status allocate_and_fill(pl_mip_pyramid *p, bool srgb, size_t smaller) {
  if (p->level_count == 1)
    return PL_OK;
  const size_t n = (size_t)p->channels;
  const size_t first = (size_t)p->levels[1].width * (size_t)p->levels[1].height;
  void *memory;
  PL_TRY(pl_alloc_or_fail(smaller, n, "the mip levels of a texture", &memory));
  p->smaller = memory;
  p->bytes += smaller * n;
  PL_TRY(pl_alloc_or_fail(first, n * sizeof(float), "building mip levels", &memory));
  fill(p, srgb, memory);
  pl_free(memory);
  return PL_OK;
}

static bool has_sides(int width, int height) {
  return width >= 1 && height >= 1 && width <= 65536 && height <= 65536;
}

pl_status pl_mip_build(pl_image *image, bool srgb, pl_mip_pyramid *out) {
  const pl_image taken = *image;
  *image = (pl_image){0};
  *out = (pl_mip_pyramid){.channels = taken.channels, .base = taken.texels};
  if (taken.texels == NULL || taken.channels < 1 || taken.channels > 4 ||
      !has_sides(taken.width, taken.height)) {
    pl_mip_clear(out);
    return pl_fail(PL_E_ARGUMENT, "texture from an image of %d x %d texels, %d channels",
                   taken.width, taken.height, taken.channels);
  }
  for (int c = 0; c < 256; c++) {
    out->color_table[c] = decode((float)c, srgb);
    out->alpha_table[c] = decode((float)c, false);
  }
  const size_t smaller = lay_out(out, taken.width, taken.height);
  out->levels[0].texels = out->base;
  out->bytes = (size_t)taken.width * (size_t)taken.height * (size_t)taken.channels;
  const pl_status status = allocate_and_fill(out, srgb, smaller);
  if (status != PL_OK)
    pl_mip_clear(out);
  return status;
}

pl_status pl_mip_build_numbers(const float *numbers, int width, int height, pl_mip_pyramid *out) {
  *out = (pl_mip_pyramid){.channels = 1};
  if (numbers == NULL || !has_sides(width, height))
    return pl_fail(PL_E_ARGUMENT, "texture from numbers of %d x %d", width, height);
  const size_t first = (size_t)width * (size_t)height, all = first + lay_out(out, width, height);
  void *memory;
  PL_TRY(pl_alloc_or_fail(all, sizeof(float), "the mip levels of a map of numbers", &memory));
  out->numbers = memory;
  out->bytes = all * sizeof(float);
  memcpy(out->numbers, numbers, first * sizeof(float));
  out->levels[0].numbers = out->numbers;
  const builder b = {.pyramid = out};
  float *next = out->numbers + first;
  for (int k = 1; k < out->level_count; k++) {
    const pl_mip_level *above = &out->levels[k - 1];
    const source from = {above->width, above->height, NULL, above->numbers};
    pl_mip_level *level = &out->levels[k];
    build_level(&b, &from, level->width, level->height, NULL, next);
    level->numbers = next;
    next += (size_t)level->width * (size_t)level->height;
  }
  return PL_OK;
}

void pl_mip_clear(pl_mip_pyramid *pyramid) {
  pl_free(pyramid->base);
  pl_free(pyramid->smaller);
  pl_free(pyramid->numbers);
  *pyramid = (pl_mip_pyramid){0};
}
