/* Light from other surfaces, shared between pixels. What reaches a rough surface by way of others
 * changes little from pixel to pixel, but the paths of one pixel find it by luck. So only some are
 * followed, and patches of one smooth surface in neighbouring pixels pool what their paths bring,
 * over what these carry on: colours stay sharp. A pool reaches no farther than it must to be quiet,
 * so that with more samples it is the pixel's own. Neighbours are those in the tile: the result
 * does not depend on threads. */
#include "math/color.h"
#include "render/path.h"
#include "shade/reflectance.h"

/* Of so many samples in a row the first few are followed beyond the first surface: neighbours in
 * the sequence of draws lie evenly. The first on a patch is in any case. */
enum { ROW = 8, FOLLOWED = 2 };
/* A lobe is wide where the density of a draw is below this, 1/sr: a cosine lobe is so everywhere.
 */
static const float WIDE_PDF_MAX = 0.4f;
/* Pixels that a pool reaches to each side. */
enum { REACH = 3 };
/* A pool is quiet once its standard error is below so many tolerances. */
static const float QUIET = 1.0f;

bool pl_path_follow(const pl_vertex *vertex, pl_path *next, pl_tile_buffers *b) {
  const uint32_t slot = b->slot[next->pixel];
  const pl_vec3f direction = pl_vec3_to_float(next->beam.direction);
  if (slot == PL_PATCH_NONE || next->pdf > WIDE_PDF_MAX ||
      !(pl_vec3f_dot(direction, vertex->surface.ng) > 0.0f))
    return true;
  pl_patch *patch = &b->patches[next->pixel].patch[slot];
  patch->wide++;
  patch->weight = pl_vec3f_add(patch->weight, next->throughput);
  if (patch->lit > 0 && b->counts[next->pixel] % ROW >= FOLLOWED)
    return false;
  patch->lit++;
  patch->lit_weight = pl_vec3f_add(patch->lit_weight, next->throughput);
  next->shared = true;
  return true;
}

bool pl_path_repeat(pl_patch *patch) {
  if (patch->lit == 0)
    return false;
  patch->weight = pl_vec3f_madd(patch->weight, 1.0f / (float)patch->wide, patch->weight);
  patch->wide++;
  return true;
}

typedef struct pool {
  const pl_path_context *context;
  const pl_tile_buffers *buffers;
  const pl_patch *like;
  float depth_m;
  pl_vec3f shared, weight;
  float square; /* of luminances */
  float count;
} pool;

static void add_pixel(pool *pool, int x, int y) {
  const pl_tile tile = pool->context->tile;
  if (x < 0 || y < 0 || x >= tile.width || y >= tile.height)
    return;
  const pl_pixel_patches *patches = &pool->buffers->patches[y * PL_TILE_SIDE + x];
  for (uint32_t i = 0; i < patches->count; i++) {
    const pl_patch *patch = &patches->patch[i];
    if (patch->lit == 0 || !pl_patch_fits(pool->like, patch, pool->depth_m))
      continue;
    pool->shared = pl_vec3f_add(pool->shared, patch->shared);
    pool->weight = pl_vec3f_add(pool->weight, patch->lit_weight);
    pool->square += patch->lit_square;
    pool->count += (float)patch->lit;
  }
}

/* The pixels of the square about (x, y) with sides of 2 r + 1. */
static void add_ring(pool *pool, int x, int y, int r) {
  for (int u = -r; u <= r; u++) {
    add_pixel(pool, x + u, y - r);
    if (r > 0)
      add_pixel(pool, x + u, y + r);
  }
  for (int v = 1 - r; v < r; v++) {
    add_pixel(pool, x - r, y + v);
    add_pixel(pool, x + r, y + v);
  }
}

static float ratio(float a, float b) { return b > 0.0f ? a / b : 0.0f; }

/* Downwards too: what lies beyond white may be in error by all that it is. */
static bool is_quiet(const pl_render_settings *settings, float level, float error) {
  const float down = pl_minf(error, level), limit = QUIET * settings->noise_dn;
  return pl_path_error_dn(settings, level, error) < limit &&
         pl_path_error_dn(settings, level - down, down) < limit;
}

/* What paths bring for what they carry on, at the patch and around it; `part` of the pixel's
 * samples go on like that. How far around is decided by the scatter within the whole reach: that of
 * the light which is used would stop pools that luck has kept in the dark. */
static pl_vec3f pooled(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel,
                       const pl_patch *like, float part) {
  const int x = (int)(pixel % PL_TILE_SIDE), y = (int)(pixel / PL_TILE_SIDE);
  const pl_render_settings *settings = context->settings;
  pool pools[REACH + 1], pool = {.context = context,
                                 .buffers = b,
                                 .like = like,
                                 .depth_m = pl_patch_depth(like, (float)context->pixel_rad)};
  for (int r = 0; r <= REACH; r++) {
    add_ring(&pool, x, y, r);
    pools[r] = pool;
  }
  const float mean = pl_luminance(pool.shared) / pool.count;
  const float scatter = part * sqrtf(pl_maxf(pool.square / pool.count - mean * mean, 0.0f));
  const float level = pl_luminance(like->own) / (float)like->seen + part * mean;
  int r = 0;
  while (r < REACH && !is_quiet(settings, level, scatter / sqrtf(pools[r].count)))
    r++;
  const pl_vec3f all = pools[r].shared, weight = pools[r].weight;
  return pl_vec3f_make(ratio(all.x, weight.x), ratio(all.y, weight.y), ratio(all.z, weight.z));
}

static pl_vec3f pixel_radiance(const pl_path_context *context, const pl_tile_buffers *b,
                               uint32_t pixel) {
  const pl_pixel_patches *patches = &b->patches[pixel];
  const float each = 1.0f / (float)b->counts[pixel];
  pl_vec3f sum = pl_vec3f_scale(b->radiance[pixel], each);
  for (uint32_t i = 0; i < patches->count; i++) {
    const pl_patch *patch = &patches->patch[i];
    sum = pl_vec3f_madd(sum, each, patch->own);
    if (patch->lit == 0)
      continue;
    const pl_vec3f light = pooled(context, b, pixel, patch, each * (float)patch->wide);
    sum = pl_vec3f_madd(sum, each, pl_vec3f_mul(patch->weight, light));
  }
  return sum;
}

void pl_path_resolve(const pl_path_context *context, pl_tile_buffers *b) {
  for (int y = 0; y < context->tile.height; y++)
    for (int x = 0; x < context->tile.width; x++) {
      const uint32_t pixel = (uint32_t)(y * PL_TILE_SIDE + x);
      b->radiance[pixel] = pixel_radiance(context, b, pixel);
    }
}
