/* Following some paths, keeping what they bring, pooling it over neighbours. */
#include "render/share.h"

#include <string.h>

#include "base/memory.h"
#include "math/color.h"

/* Of so many samples in a row the first few are followed beyond the first surface: neighbours in
 * the sequence of draws lie evenly. The first on a patch is in any case. */
enum { ROW = 8, FOLLOWED = 2 };
/* A lobe is wide where the density of a draw is below this, 1/sr: a cosine lobe is so everywhere.
 */
static const float WIDE_PDF_MAX = 0.4f;
/* Pixels that a pool reaches to each side; first the near ones are asked, of so many paths, whether
 * they are enough. */
enum { REACH = 4, NEAR = 2, FEWEST = 24 };
/* Of so many paths that found light at least, counted as if all had found the same: where fewer
 * did, near ones may have missed it by luck, and the farthest are asked. */
static const float FOUND = 8.0f;
/* Nothing is made of fewer paths than about these: one that found no light would show. */
static const float ERROR_MAX = 0.36f; /* of the mean, by the scatter: 1/sqrt(8) and rounding */
/* A pool is quiet once its standard error is below so many tolerances. */
static const float QUIET = 1.0f;

/* Counts a path that goes on into a wide lobe; whether it is one of those that are followed. */
static bool count_wide(const pl_tile_buffers *b, uint32_t pixel, pl_vec3f carried,
                       pl_patch *patch) {
  patch->wide++;
  patch->weight = pl_vec3f_add(patch->weight, carried);
  if (patch->lit > 0 && b->counts[pixel] % ROW >= FOLLOWED)
    return false;
  patch->lit++;
  patch->lit_weight = pl_vec3f_add(patch->lit_weight, carried);
  return true;
}

bool pl_path_follow(const pl_vertex *vertex, pl_path *next, pl_tile_buffers *b) {
  const uint32_t slot = b->slot[next->pixel];
  const pl_vec3f direction = pl_vec3_to_float(next->beam.direction);
  if (slot == PL_PATCH_NONE || next->lobe_pdf > WIDE_PDF_MAX ||
      !(pl_vec3f_dot(direction, vertex->surface.ng) > 0.0f))
    return true;
  /* As if it were drawn by the lobe: evenly coloured however often bodies are drawn to. */
  const pl_vec3f carried = pl_vec3f_scale(next->throughput, next->pdf / next->lobe_pdf);
  next->shared = count_wide(b, next->pixel, carried, &b->patches[next->pixel].patch[slot]);
  return next->shared;
}

void pl_path_lose(const pl_vertex *vertex, const pl_path *path, pl_tile_buffers *b) {
  const uint32_t slot = b->slot[path->pixel];
  if (slot == PL_PATCH_NONE)
    return;
  pl_patch *patch = &b->patches[path->pixel].patch[slot];
  const pl_vec3f carried = patch->wide > 0
                               ? pl_vec3f_scale(patch->weight, 1.0f / (float)patch->wide)
                               : pl_vec3f_mul(path->throughput, vertex->surface.color);
  count_wide(b, path->pixel, carried, patch);
}

bool pl_path_repeat(pl_patch *patch) {
  if (patch->lit == 0)
    return false;
  patch->weight = pl_vec3f_madd(patch->weight, 1.0f / (float)patch->wide, patch->weight);
  patch->wide++;
  return true;
}

pl_status pl_share_init(pl_share *share) {
  *share = (pl_share){.block_count = 0};
  if (pthread_mutex_init(&share->lock, NULL) != 0)
    return pl_fail(PL_E_MEMORY, "cannot make a lock");
  return PL_OK;
}

void pl_share_clear(pl_share *share) {
  for (size_t i = 0; i < share->block_count; i++)
    pl_free(share->blocks[i]);
  pl_free(share->blocks);
  pl_free(share->tiles);
  pthread_mutex_destroy(&share->lock);
}

pl_status pl_share_start(pl_share *share, int columns, int rows, int row0) {
  const size_t count = (size_t)columns * (size_t)rows;
  if (count > share->room) {
    pl_share_tile *grown = pl_realloc(share->tiles, count, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the light of %zu tiles", count);
    share->tiles = grown;
    share->room = count;
  }
  for (size_t i = 0; i < count; i++)
    share->tiles[i].lit = false;
  share->block = share->used = 0;
  share->columns = columns;
  share->rows = rows;
  share->row0 = row0;
  return PL_OK;
}

static pl_status add_block(pl_share *share) {
  if (share->block_count == share->block_room) {
    const size_t room = 2 * share->block_room + 8;
    pl_patch **grown = pl_realloc(share->blocks, room, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for %zu blocks of light", room);
    share->blocks = grown;
    share->block_room = room;
  }
  void *block;
  PL_TRY(pl_alloc_or_fail(PL_SHARE_BLOCK, sizeof(pl_patch), "shared light", &block));
  share->blocks[share->block_count++] = block;
  return PL_OK;
}

/* Room for so many patches, with the lock held. */
static pl_status take_room(pl_share *share, size_t count, pl_patch **out) {
  if (share->used + count > PL_SHARE_BLOCK) {
    share->block++;
    share->used = 0;
  }
  if (share->block == share->block_count)
    PL_TRY(add_block(share));
  *out = share->blocks[share->block] + share->used;
  share->used += count;
  return PL_OK;
}

static pl_status make_room(pl_share *share, size_t count, pl_patch **out) {
  pthread_mutex_lock(&share->lock);
  const pl_status status = take_room(share, count, out);
  pthread_mutex_unlock(&share->lock);
  return status;
}

static size_t count_lit(const pl_tile_buffers *b, pl_tile tile) {
  size_t count = 0;
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++) {
      const pl_pixel_patches *patches = &b->patches[y * PL_TILE_SIDE + x];
      for (uint32_t i = 0; i < patches->count; i++)
        count += patches->patch[i].lit > 0;
    }
  return count;
}

/* Radiance of a pixel but for what is shared. */
static pl_vec3f own_light(const pl_tile_buffers *b, uint32_t pixel) {
  const pl_pixel_patches *patches = &b->patches[pixel];
  pl_vec3f sum = b->radiance[pixel];
  for (uint32_t i = 0; i < patches->count; i++)
    sum = pl_vec3f_add(sum, patches->patch[i].own);
  return pl_vec3f_scale(sum, 1.0f / (float)b->counts[pixel]);
}

static void keep_pixel(const pl_tile_buffers *b, uint32_t pixel, uint32_t *count,
                       pl_share_tile *tile) {
  const pl_pixel_patches *patches = &b->patches[pixel];
  tile->each[pixel] = 1.0f / (float)b->counts[pixel];
  tile->rest[pixel] = b->radiance[pixel];
  for (uint32_t i = 0; i < patches->count; i++)
    if (patches->patch[i].lit > 0)
      tile->patches[(*count)++] = patches->patch[i];
}

pl_status pl_share_keep(pl_share *share, size_t item, const pl_path_context *context,
                        pl_tile_buffers *b) {
  const pl_tile tile = context->tile;
  const size_t lit = context->pools ? count_lit(b, tile) : 0;
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++)
      b->radiance[y * PL_TILE_SIDE + x] = own_light(b, (uint32_t)(y * PL_TILE_SIDE + x));
  if (lit == 0)
    return PL_OK;
  pl_share_tile *kept = &share->tiles[item];
  PL_TRY(make_room(share, lit, &kept->patches));
  uint32_t count = 0;
  for (uint32_t pixel = 0; pixel < PL_TILE_PIXELS; pixel++) {
    kept->start[pixel] = count;
    if (pl_tile_has(tile, pixel))
      keep_pixel(b, pixel, &count, kept);
  }
  kept->start[PL_TILE_PIXELS] = count;
  kept->tile = tile;
  kept->lit = true;
  return PL_OK;
}

/* What the paths of patches like one bring, by their distance from its pixel: squares about it. */
typedef struct ring {
  pl_vec3f shared, weight;
  float square; /* sum of squared luminances */
  float count;  /* of paths */
} ring;

typedef struct pool {
  const pl_share *share;
  const pl_patch *like;
  float depth_m;
  ring rings[REACH + 1];
} pool;

/* The tile that pixel (x, y) of the image is in; NULL: none that is lit. */
static const pl_share_tile *tile_at(const pl_share *share, int x, int y) {
  const int column = x / PL_TILE_SIDE, row = y / PL_TILE_SIDE - share->row0;
  if (x < 0 || y < 0 || column >= share->columns || row < 0 || row >= share->rows)
    return NULL;
  const pl_share_tile *tile = &share->tiles[row * share->columns + column];
  const bool inside = tile->lit && y >= tile->tile.y0 && x < tile->tile.x0 + tile->tile.width &&
                      y < tile->tile.y0 + tile->tile.height;
  return inside ? tile : NULL;
}

static void add_pixel(pool *pool, int x, int y, ring *ring) {
  const pl_share_tile *tile = tile_at(pool->share, x, y);
  if (tile == NULL)
    return;
  const int pixel = (y - tile->tile.y0) * PL_TILE_SIDE + x - tile->tile.x0;
  for (uint32_t i = tile->start[pixel]; i < tile->start[pixel + 1]; i++) {
    const pl_patch *patch = &tile->patches[i];
    if (!pl_patch_fits(pool->like, patch, pool->depth_m))
      continue;
    ring->shared = pl_vec3f_add(ring->shared, patch->shared);
    ring->weight = pl_vec3f_add(ring->weight, patch->lit_weight);
    ring->square += patch->lit_square;
    ring->count += (float)patch->lit;
  }
}

static void add_ring(pool *pool, int x, int y, int r) {
  ring *ring = &pool->rings[r];
  for (int u = -r; u <= r; u++) {
    add_pixel(pool, x + u, y - r, ring);
    if (r > 0)
      add_pixel(pool, x + u, y + r, ring);
  }
  for (int v = 1 - r; v < r; v++) {
    add_pixel(pool, x - r, y + v, ring);
    add_pixel(pool, x + r, y + v, ring);
  }
}

static float ratio(float a, float b) { return b > 0.0f ? a / b : 0.0f; }

/* Downwards too: what lies beyond white may be in error by all that it is. */
static bool is_quiet(const pl_render_settings *settings, float level, float error) {
  const float down = pl_minf(error, level), limit = QUIET * settings->noise_dn;
  return pl_path_error_dn(settings, level, error) < limit &&
         pl_path_error_dn(settings, level - down, down) < limit;
}

/* Rings count less and less up to the first that does not: no edges of squares are to be seen. */
static float part_of(int r, int reach) { return 1.0f - (float)r / (float)(reach + 1); }

static float error_at(const pool *pool, int reach) {
  float sum = 0.0f, square = 0.0f;
  for (int r = 0; r <= reach; r++) {
    const float part = part_of(r, reach);
    sum += part * pool->rings[r].count;
    square += part * part * pool->rings[r].count;
  }
  return sqrtf(square) / sum;
}

/* How far around light is taken from, within what the pool holds: `most` when it never is quiet.
 * `part` of the pixel's samples go on. It is decided by the scatter of all that is held: that of
 * the light which is used would stop pools that luck has kept in the dark. */
static int reach_of(const pool *pool, const pl_render_settings *settings, float part, int most,
                    bool *quiet) {
  float light = 0.0f, square = 0.0f, count = 0.0f;
  for (int r = 0; r <= most; r++) {
    light += pl_luminance(pool->rings[r].shared);
    square += pool->rings[r].square;
    count += pool->rings[r].count;
  }
  *quiet = false;
  if (!(light * light > FOUND * square))
    return most;
  const float mean = light / count;
  const float scatter = part * sqrtf(pl_maxf(square / count - mean * mean, 0.0f));
  const float level = pl_luminance(pool->like->own) / (float)pool->like->seen + part * mean;
  for (int reach = 0; reach <= most; reach++) {
    const float error = error_at(pool, reach);
    *quiet = count >= FEWEST && error < ERROR_MAX && is_quiet(settings, level, scatter * error);
    if (*quiet)
      return reach;
  }
  return most;
}

/* What paths bring for what they carry on, in the pool; `reach` of it. */
static pl_vec3f pooled(pool *pool, const pl_render_settings *settings, int x, int y, float part,
                       int *out_reach) {
  bool quiet;
  for (int r = 0; r <= NEAR; r++)
    add_ring(pool, x, y, r);
  int reach = reach_of(pool, settings, part, NEAR, &quiet);
  if (!quiet) {
    for (int r = NEAR + 1; r <= REACH; r++)
      add_ring(pool, x, y, r);
    reach = reach_of(pool, settings, part, REACH, &quiet);
  }
  pl_vec3f all = {0.0f, 0.0f, 0.0f}, weight = all;
  for (int r = 0; r <= reach; r++) {
    all = pl_vec3f_madd(all, part_of(r, reach), pool->rings[r].shared);
    weight = pl_vec3f_madd(weight, part_of(r, reach), pool->rings[r].weight);
  }
  *out_reach = reach;
  return pl_vec3f_make(ratio(all.x, weight.x), ratio(all.y, weight.y), ratio(all.z, weight.z));
}

/* The light that was pooled last in a square of pixels. */
typedef struct pooled_light {
  const pl_patch *like; /* NULL: none */
  pl_vec3f light;
} pooled_light;
enum { SQUARE = 2, SQUARES = PL_TILE_SIDE / SQUARE };

/* Pools over many pixels hold nearly the same in all of a square: one is enough for them. */
static pl_vec3f light_of(const pl_render_settings *settings, pool *pool, int x, int y, float part,
                         pooled_light *last) {
  if (last->like != NULL && pl_patch_fits(pool->like, last->like, pool->depth_m))
    return last->light;
  int reach;
  const pl_vec3f light = pooled(pool, settings, x, y, part, &reach);
  if (reach > 0 || pool->rings[0].count < 3.0f)
    *last = (pooled_light){pool->like, light};
  return light;
}

void pl_share_light(const pl_share *share, size_t item, const pl_render_settings *settings,
                    double pixel_rad, pl_vec3f radiance[PL_TILE_PIXELS]) {
  const pl_share_tile *tile = &share->tiles[item];
  pooled_light last[SQUARES];
  memcpy(radiance, tile->rest, sizeof tile->rest);
  for (int pixel = 0; pixel < PL_TILE_PIXELS; pixel++) {
    const int i = pixel % PL_TILE_SIDE, j = pixel / PL_TILE_SIDE;
    if (i % SQUARE == 0 && j % SQUARE == 0)
      last[i / SQUARE].like = NULL;
    const float each = tile->each[pixel];
    for (uint32_t k = tile->start[pixel]; k < tile->start[pixel + 1]; k++) {
      const pl_patch *like = &tile->patches[k];
      pool pool = {.share = share, .like = like, .depth_m = pl_patch_depth(like, (float)pixel_rad)};
      const pl_vec3f light = light_of(settings, &pool, tile->tile.x0 + i, tile->tile.y0 + j,
                                      each * (float)like->wide, &last[i / SQUARE]);
      radiance[pixel] = pl_vec3f_madd(radiance[pixel], each, pl_vec3f_mul(like->weight, light));
    }
  }
}
