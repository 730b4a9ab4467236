/* Triangles are sorted in Morton order of their centroids (Morton 1966) and split at the highest
 * bit in which the codes of a run differ (Lauterbach et al. 2009) until the runs are short: no box
 * spans a gap of the order. */
#include "annotate/clusters.h"

#include <math.h>

#include "base/memory.h"

/* A run is short when it has fewer triangles than this, or less than this fraction of the
 * model's. */
enum { TRIANGLES_SHORT = 4, PART_SHORT = 1024 };
/* Radix of the sort; three digits make a 30-bit code. */
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

/* Spreads ten bits to every third bit. */
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

/* One pass of a stable counting sort of triangle indices by one digit of their codes. */
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

typedef struct order {
  const pl_model *model;
  const uint32_t *codes;     /* by triangle index */
  const uint32_t *triangles; /* sorted by code */
  size_t longest;            /* largest length of a run */
} order;

/* Returns the position where the highest differing bit of the run's codes changes, or `first` when
 * all codes are the same. */
static size_t halve(const order *order, size_t first, size_t end) {
  const uint32_t low = order->codes[order->triangles[first]];
  const uint32_t high = order->codes[order->triangles[end - 1]];
  size_t begin = first;
  uint32_t bit = 1u << (3 * DIGIT_BITS - 1);
  if (low == high)
    return first;
  while (((low ^ high) & bit) == 0)
    bit >>= 1;
  while (begin < end) { /* search for the first code with the bit set */
    const size_t middle = begin + (end - begin) / 2;
    if ((order->codes[order->triangles[middle]] & bit) != 0)
      end = middle;
    else
      begin = middle + 1;
  }
  return begin;
}

/* Counts the boxes of a run and writes them unless `boxes` is NULL. The recursion is at most as
 * deep as a code has bits. */
static size_t cut(const order *order, size_t first, size_t end, pl_cluster *boxes) {
  const size_t middle = end - first > order->longest ? halve(order, first, end) : first;
  if (middle == first) {
    if (boxes != NULL)
      *boxes = box_of(order->model, order->triangles + first, end - first);
    return 1;
  }
  const size_t left = cut(order, first, middle, boxes);
  return left + cut(order, middle, end, boxes != NULL ? boxes + left : NULL);
}

/* memory: three numbers per triangle. */
static pl_status fill_boxes(const pl_model *model, uint32_t *memory, pl_clusters *out) {
  const size_t count = model->triangle_count;
  uint32_t *codes = memory, *a = codes + count, *b = a + count;
  for (size_t t = 0; t < count; t++) {
    codes[t] = morton_code(model, t);
    a[t] = (uint32_t)t;
  }
  sort_digit(codes, 0, count, a, b);
  sort_digit(codes, DIGIT_BITS, count, b, a);
  sort_digit(codes, 2 * DIGIT_BITS, count, a, b);
  const size_t part = count / PART_SHORT;
  const order order = {model, codes, b, part > TRIANGLES_SHORT ? part : TRIANGLES_SHORT};
  void *boxes;
  *out = (pl_clusters){model, NULL, count > 0 ? cut(&order, 0, count, NULL) : 0};
  PL_TRY(pl_alloc_or_fail(out->count, sizeof(pl_cluster), "boxes of a model", &boxes));
  out->boxes = boxes;
  if (count > 0)
    cut(&order, 0, count, boxes);
  return PL_OK;
}

static pl_status create(const pl_model *model, pl_clusters *out) {
  void *memory;
  PL_TRY(
      pl_alloc_or_fail(3 * model->triangle_count, sizeof(uint32_t), "sorting triangles", &memory));
  const pl_status status = fill_boxes(model, memory, out);
  pl_free(memory);
  return status;
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
