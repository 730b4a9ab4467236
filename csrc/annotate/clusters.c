/* Triangles in Morton order of their centroids (Morton 1966), cut into runs of equal length. */
#include "annotate/clusters.h"

#include <math.h>

#include "base/memory.h"

/* Runs: as short as these allow. */
enum { CLUSTERS_MAX = 1024, TRIANGLES_MIN = 8 };
/* Radix of the sort; three digits make a code of 30 bits. */
enum { DIGIT_BITS = 10, DIGITS = 1 << DIGIT_BITS };

void pl_cluster_cache_init(pl_cluster_cache *cache) { *cache = (pl_cluster_cache){0}; }

void pl_cluster_cache_clear(pl_cluster_cache *cache) {
  for (size_t i = 0; i < cache->count; i++)
    pl_free(cache->items[i].boxes);
  pl_free(cache->items);
  pl_cluster_cache_init(cache);
}

static const float *corner_of(const pl_model *model, size_t triangle, size_t k) {
  return model->positions + 3 * (size_t)model->indices[3 * triangle + k];
}

/* Every third bit, from ten. */
static uint32_t spread(uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

static uint32_t morton_code(const pl_model *model, size_t triangle) {
  uint32_t code = 0;
  for (size_t k = 0; k < 3; k++) {
    const float low = model->bounds_min[k], size = model->bounds_max[k] - low;
    const float middle = (corner_of(model, triangle, 0)[k] + corner_of(model, triangle, 1)[k] +
                          corner_of(model, triangle, 2)[k]) /
                         3.0f;
    const float step = size > 0.0f ? (middle - low) / size * 1024.0f : 0.0f;
    const uint32_t cell = !(step > 0.0f) ? 0u : step >= 1023.0f ? 1023u : (uint32_t)step;
    code |= spread(cell) << k;
  }
  return code;
}

/* One pass of a stable counting sort of triangle numbers by a digit of their codes. */
static void sort_digit(const uint32_t *codes, unsigned shift, size_t count, const uint32_t *from,
                       uint32_t *to) {
  size_t first[DIGITS + 1] = {0};
  for (size_t i = 0; i < count; i++)
    first[(codes[i] >> shift & (DIGITS - 1)) + 1]++;
  for (size_t d = 0; d < DIGITS; d++)
    first[d + 1] += first[d];
  for (size_t i = 0; i < count; i++)
    to[first[codes[from[i]] >> shift & (DIGITS - 1)]++] = from[i];
}

static pl_cluster box_of(const pl_model *model, const uint32_t *triangles, size_t count) {
  pl_cluster box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t i = 0; i < 3 * count; i++) {
    const float *p = corner_of(model, triangles[i / 3], i % 3);
    for (size_t k = 0; k < 3; k++) {
      box.low[k] = fminf(box.low[k], p[k]);
      box.high[k] = fmaxf(box.high[k], p[k]);
    }
  }
  return box;
}

/* memory: three numbers a triangle. */
static void fill_boxes(const pl_model *model, size_t run, uint32_t *memory, pl_clusters *out) {
  const size_t count = model->triangle_count;
  uint32_t *codes = memory, *a = codes + count, *b = a + count;
  for (size_t t = 0; t < count; t++) {
    codes[t] = morton_code(model, t);
    a[t] = (uint32_t)t;
  }
  sort_digit(codes, 0, count, a, b);
  sort_digit(codes, DIGIT_BITS, count, b, a);
  sort_digit(codes, 2 * DIGIT_BITS, count, a, b);
  for (size_t i = 0; i < out->count; i++) {
    const size_t first = i * run, left = count - first;
    out->boxes[i] = box_of(model, b + first, left < run ? left : run);
  }
}

static pl_status create(const pl_model *model, pl_clusters *out) {
  void *memory, *boxes;
  const size_t triangles = model->triangle_count;
  const size_t even = (triangles + CLUSTERS_MAX - 1) / CLUSTERS_MAX;
  const size_t run = even > TRIANGLES_MIN ? even : TRIANGLES_MIN;
  const size_t count = (triangles + run - 1) / run;
  PL_TRY(pl_alloc_or_fail(count, sizeof(pl_cluster), "boxes of a model", &boxes));
  const pl_status status =
      pl_alloc_or_fail(3 * triangles, sizeof(uint32_t), "sorting triangles", &memory);
  if (status != PL_OK) {
    pl_free(boxes);
    return status;
  }
  *out = (pl_clusters){model, boxes, count};
  fill_boxes(model, run, memory, out);
  pl_free(memory);
  return PL_OK;
}

pl_status pl_cluster_cache_get(pl_cluster_cache *cache, const pl_model *model, pl_clusters *out) {
  for (size_t i = 0; i < cache->count; i++)
    if (cache->items[i].model == model) {
      *out = cache->items[i];
      return PL_OK;
    }
  pl_clusters *grown = pl_realloc(cache->items, cache->count + 1, sizeof *grown);
  if (grown == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the boxes of a model");
  cache->items = grown;
  PL_TRY(create(model, out));
  cache->items[cache->count++] = *out;
  return PL_OK;
}
