/* Selection of the paths that are followed, and the record of their light. */
#include "render/irradiance_record.h"

#include "base/work.h"
#include "base/memory.h"
#include "math/color.h"
#include "shade/ggx.h"
#include "shade/reflectance.h"

/* Of PL_IRRADIANCE_ROW samples the first FOLLOWED are followed: consecutive points of the sequence
 * of draws are evenly distributed. Frames with at most PL_IRRADIANCE_ROW samples follow
 * FOLLOWED_FEW where filters find neighbours, because draws are spread over pixels there. The first
 * path of a patch is always followed. */
enum { FOLLOWED = 2, FOLLOWED_FEW = 1 };
/* A filter finds few neighbours if fewer than ALIKE of the four pixels at distance BESIDE show the
 * same surface. There all frames follow FOLLOWED paths. */
enum { BESIDE = 2, ALIKE = 3 };
/* A lobe is wide where the density of a draw is below this, 1/sr. A cosine lobe is wide everywhere.
 */
static const float WIDE_PDF_MAX = 0.4f;

/* Whether a pixel shows the surface of a spot; true for pixels outside the tile. */
static bool shows(const pl_path_context *context, const pl_tile_buffers *b, int x, int y,
                  const pl_spot *spot, float depth_m) {
  if (x < 0 || y < 0 || x >= context->tile.width || y >= context->tile.height)
    return true;
  const pl_pixel_patches *patches = &b->patches[y * PL_TILE_SIDE + x];
  for (uint32_t i = 0; i < patches->count; i++)
    if (pl_spot_fits(spot, &patches->patch[i].spot, depth_m))
      return true;
  return false;
}

/* Whether the filter of a patch would find few neighbours, as on thin or crumpled objects. */
static bool is_isolated(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel,
                        const pl_spot *spot) {
  const float depth_m = pl_spot_depth(spot, (float)context->pixel_rad);
  const int x = (int)(pixel % PL_TILE_SIDE), y = (int)(pixel / PL_TILE_SIDE);
  int alike = 0;
  for (int side = -BESIDE; side <= BESIDE; side += 2 * BESIDE) {
    alike += shows(context, b, x + side, y, spot, depth_m);
    alike += shows(context, b, x, y + side, spot, depth_m);
  }
  return alike < ALIKE;
}

/* Whether a path into a wide lobe is followed. */
static bool is_turn(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel,
                    const pl_patch *patch) {
  const int turn = b->counts[pixel] % PL_IRRADIANCE_ROW;
  if (patch->lit == 0 || turn < FOLLOWED_FEW || turn < b->followed[pixel])
    return true;
  return turn < FOLLOWED && (context->settings->samples > PL_IRRADIANCE_ROW ||
                             is_isolated(context, b, pixel, &patch->spot));
}

/* Counts a path that continues into a wide lobe; returns whether it is followed. */
static bool count_wide(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel,
                       pl_vec3f carried, pl_patch *patch) {
  patch->wide++;
  patch->weight = pl_vec3f_add(patch->weight, carried);
  if (!is_turn(context, b, pixel, patch))
    return false;
  patch->lit++;
  patch->lit_weight = pl_vec3f_add(patch->lit_weight, carried);
  return true;
}

bool pl_path_follow(const pl_path_context *context, const pl_vertex *vertex, pl_path *next,
                    pl_tile_buffers *b) {
  const uint32_t slot = b->slot[next->pixel];
  const pl_vec3f direction = pl_vec3_to_float(next->beam.direction);
  if (next->filtered || slot == PL_PATCH_NONE || next->lobe_pdf > WIDE_PDF_MAX ||
      !(pl_vec3f_dot(direction, vertex->surface.ng) > 0.0f))
    return true;
  /* As if the lobe had drawn it: the colour does not depend on how often bodies are sampled. */
  const pl_vec3f carried = pl_vec3f_scale(next->throughput, next->pdf / next->lobe_pdf);
  pl_patch *patch = &b->patches[next->pixel].patch[slot];
  next->filtered = count_wide(context, b, next->pixel, carried, patch);
  return next->filtered;
}

void pl_path_lose(const pl_path_context *context, const pl_vertex *vertex, const pl_path *path,
                  pl_tile_buffers *b) {
  const uint32_t slot = b->slot[path->pixel];
  if (path->filtered || slot == PL_PATCH_NONE)
    return;
  pl_patch *patch = &b->patches[path->pixel].patch[slot];
  const pl_vec3f carried = patch->wide > 0
                               ? pl_vec3f_scale(patch->weight, 1.0f / (float)patch->wide)
                               : pl_vec3f_mul(path->throughput, vertex->surface.color);
  count_wide(context, b, path->pixel, carried, patch);
}

bool pl_path_repeat(pl_patch *patch) {
  if (patch->lit == 0)
    return false;
  patch->weight = pl_vec3f_madd(patch->weight, 1.0f / (float)patch->wide, patch->weight);
  patch->wide++;
  return true;
}

pl_continuation pl_path_continuation(const pl_path_context *context, const pl_surface *surface,
                                     pl_vec3f wo, const pl_path *path, pl_tile_buffers *b) {
  const uint32_t slot = b->slot[path->pixel];
  if (slot == PL_PATCH_NONE || context->settings->emitters != NULL ||
      pl_surface_pdf_most(surface, wo) > WIDE_PDF_MAX)
    return PL_CONTINUATION_DRAWN;
  const float gloss = PL_DIELECTRIC_F0 * (1.0f - surface->metallic);
  const pl_vec3f albedo = {surface->color.x + gloss, surface->color.y + gloss,
                           surface->color.z + gloss};
  const bool followed = count_wide(context, b, path->pixel, pl_vec3f_mul(path->throughput, albedo),
                                   &b->patches[path->pixel].patch[slot]);
  return followed ? PL_CONTINUATION_FILTERED : PL_CONTINUATION_NONE;
}

/* As many records as a tile may have; cells are no more than patches. */
enum { BLOCK = PL_TILE_PIXELS * PL_PATCHES };
/* Tiles in a band: at least this many, and for each thread. */
enum { BAND_TILES = 64, BAND_SHARE = 32 };

pl_status pl_irradiance_init(pl_irradiance_record *irradiance) {
  *irradiance = (pl_irradiance_record){.held = 1};
  for (int k = 0; k < 2; k++)
    irradiance->half[k] = (pl_irradiance_half){
        .patches = {.bytes = sizeof(pl_irradiance_patch), .length = BLOCK},
        .cells = {.bytes = sizeof(pl_irradiance_cell), .length = BLOCK},
    };
  if (pthread_mutex_init(&irradiance->lock, NULL) != 0)
    return pl_fail(PL_E_MEMORY, "cannot make a lock");
  return PL_OK;
}

void pl_irradiance_clear(pl_irradiance_record *irradiance) {
  for (int k = 0; k < 2; k++) {
    pl_record_pool_clear(&irradiance->half[k].patches);
    pl_record_pool_clear(&irradiance->half[k].cells);
  }
  pl_free(irradiance->tiles);
  pthread_mutex_destroy(&irradiance->lock);
}

pl_status pl_irradiance_start(pl_irradiance_record *irradiance, int columns, int rows,
                              int threads) {
  const int least = BAND_SHARE * threads > BAND_TILES ? BAND_SHARE * threads : BAND_TILES;
  const int wanted = (least + columns - 1) / columns;
  irradiance->band = wanted < 2 ? 2 : wanted < rows ? wanted : rows;
  irradiance->held = 2 * irradiance->band < rows ? 2 * irradiance->band : rows;
  irradiance->columns = columns;
  irradiance->rows = rows;
  const size_t count = (size_t)columns * (size_t)irradiance->held;
  if (count > irradiance->room) {
    pl_irradiance_tile *grown = pl_realloc(irradiance->tiles, count, sizeof *grown);
    if (grown == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the light of %zu tiles", count);
    irradiance->tiles = grown;
    irradiance->room = count;
  }
  return PL_OK;
}

void pl_irradiance_turn(pl_irradiance_record *irradiance, int row) {
  irradiance->current = row / irradiance->band % 2;
  pl_record_pool_reset(&irradiance->half[irradiance->current].patches);
  pl_record_pool_reset(&irradiance->half[irradiance->current].cells);
  for (int y = row; y < row + irradiance->band && y < irradiance->rows; y++)
    for (int x = 0; x < irradiance->columns; x++)
      pl_irradiance_tile_at(irradiance, y, x)->lit = false;
}

pl_status pl_irradiance_reserve(pl_irradiance_record *irradiance) {
  PL_TRY(pl_record_pool_reserve(&irradiance->half[irradiance->current].patches));
  return pl_record_pool_reserve(&irradiance->half[irradiance->current].cells);
}

static pl_status make_room(pl_irradiance_record *irradiance, size_t patches, size_t cells,
                           pl_irradiance_tile *tile) {
  pl_irradiance_half *half = &irradiance->half[irradiance->current];
  void *room[2] = {NULL, NULL};
  pthread_mutex_lock(&irradiance->lock);
  pl_status status = pl_record_pool_take(&half->patches, patches, &room[0]);
  if (status == PL_OK)
    status = pl_record_pool_take(&half->cells, cells, &room[1]);
  pthread_mutex_unlock(&irradiance->lock);
  tile->patches = room[0];
  tile->cells = room[1];
  return status;
}

/* Radiance of a pixel without the filtered light. */
static pl_vec3f own_light(const pl_tile_buffers *b, uint32_t pixel) {
  pl_vec3f sum = b->radiance[pixel];
  for (uint32_t i = 0; i < pl_path_patch_count(b, pixel); i++)
    sum = pl_vec3f_add(sum, b->patches[pixel].patch[i].own);
  return pl_vec3f_scale(sum, 1.0f / (float)b->counts[pixel]);
}

/* Adds the sums that separate the noise of paths from true differences between pixels, see
 * irradiance_filter.c. */
static void add_scatter(const pl_patch *patch, pl_irradiance_cell *cell) {
  const float weight = pl_luminance(patch->lit_weight), light = pl_luminance(patch->filtered);
  if (!(weight > 0.0f))
    return;
  cell->pixels += 1.0f;
  cell->each += patch->lit_square * (float)patch->lit / weight;
  cell->together += light * light / weight;
  cell->weight_square += weight * weight;
}

/* The surfaces that were met in one cell, each by the spot of its first patch. */
typedef struct meeting {
  const pl_spot *spots[PL_CELL * PL_CELL * PL_PATCHES];
  uint32_t count;
} meeting;

/* The index of the surface that a patch belongs to; appends a new one. */
static uint32_t meet(meeting *met, const pl_patch *patch, float spread) {
  uint32_t i = 0;
  const float depth_m = met->count > 0 ? pl_spot_depth(&patch->spot, spread) : 0.0f;
  while (i < met->count && !pl_spot_fits(met->spots[i], &patch->spot, depth_m))
    i++;
  if (i == met->count)
    met->spots[met->count++] = &patch->spot;
  return i;
}

/* Adds a patch to the entry of its surface, a new one if `first`. */
static void merge(const pl_patch *patch, bool first, pl_irradiance_cell *cell) {
  if (first)
    *cell = (pl_irradiance_cell){.spot = patch->spot};
  cell->filtered = pl_vec3f_add(cell->filtered, patch->filtered);
  cell->weight = pl_vec3f_add(cell->weight, patch->lit_weight);
  cell->square += patch->lit_square;
  cell->count += (float)patch->lit;
  add_scatter(patch, cell);
}

/* The tile that is being recorded, and what is recorded so far. */
typedef struct keeping {
  const pl_tile_buffers *b;
  pl_irradiance_tile *tile;
  float spread;
  uint32_t patches, cells; /* their numbers */
} keeping;

static void keep_pixel(keeping *k, uint32_t pixel, meeting *met) {
  const pl_pixel_patches *patches = &k->b->patches[pixel];
  const float each = 1.0f / (float)k->b->counts[pixel];
  k->tile->rest[pixel] = k->b->radiance[pixel];
  for (uint32_t i = 0; i < patches->count; i++) {
    const pl_patch *patch = &patches->patch[i];
    if (patch->lit == 0)
      continue;
    const uint32_t known = met->count, cell = meet(met, patch, k->spread);
    merge(patch, cell == known, k->tile->cells + k->cells + cell);
    k->tile->patches[k->patches++] =
        (pl_irradiance_patch){.pixel = (uint16_t)pixel,
                              .cell = (uint16_t)cell,
                              .lit = patch->lit,
                              .part = each * (float)patch->wide,
                              .level = pl_luminance(patch->own) / (float)patch->seen,
                              .weight = pl_vec3f_scale(patch->weight, each),
                              .filtered = patch->filtered,
                              .lit_weight = patch->lit_weight};
  }
}

/* Counts the surfaces of a pixel's lit patches that are new in its cell. */
static void count_pixel(keeping *k, uint32_t pixel, meeting *met) {
  const pl_pixel_patches *patches = &k->b->patches[pixel];
  for (uint32_t i = 0; i < patches->count; i++)
    if (patches->patch[i].lit > 0) {
      meet(met, &patches->patch[i], k->spread);
      k->patches++;
    }
}

/* Cells are aligned to the image; rows of a tile may not be. */
static void visit_cell(keeping *k, pl_tile tile, int cell,
                       void (*visit)(keeping *k, uint32_t pixel, meeting *met)) {
  meeting met = {.count = 0};
  for (int i = 0; i < PL_CELL * PL_CELL; i++) {
    const int x = PL_CELL * (cell % PL_CELL_SIDE) + i % PL_CELL;
    const int y = PL_CELL * (cell / PL_CELL_SIDE) + i / PL_CELL - tile.y0 % PL_TILE_SIDE;
    if (y >= 0 && x < tile.width && y < tile.height)
      visit(k, (uint32_t)(y * PL_TILE_SIDE + x), &met);
  }
  k->cells += met.count;
}

pl_status pl_irradiance_keep(pl_irradiance_record *irradiance, int row, int column,
                             const pl_path_context *context, pl_tile_buffers *b) {
  const pl_tile tile = context->tile;
  keeping counted = {.b = b, .spread = (float)context->pixel_rad};
  for (int i = 0; i < PL_CELLS && context->filters_irradiance; i++)
    visit_cell(&counted, tile, i, count_pixel);
  for (int y = 0; y < tile.height; y++)
    for (int x = 0; x < tile.width; x++)
      b->radiance[y * PL_TILE_SIDE + x] = own_light(b, (uint32_t)(y * PL_TILE_SIDE + x));
  pl_work_add(PL_WORK_patches, counted.patches);
  if (counted.patches == 0)
    return PL_OK;
  pl_irradiance_tile *kept = pl_irradiance_tile_at(irradiance, row, column);
  PL_TRY(make_room(irradiance, counted.patches, counted.cells, kept));
  kept->tile = tile;
  keeping k = {.b = b, .tile = kept, .spread = counted.spread};
  for (int i = 0; i < PL_CELLS; i++) {
    kept->patch_start[i] = k.patches;
    kept->cell_start[i] = k.cells;
    visit_cell(&k, tile, i, keep_pixel);
  }
  kept->patch_start[PL_CELLS] = k.patches;
  kept->cell_start[PL_CELLS] = k.cells;
  kept->lit = true;
  return PL_OK;
}
