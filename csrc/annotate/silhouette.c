/* Amodal silhouettes: from the visible pixels of the frame, and from rays cast at one object alone
 * where those do not decide. */
#include "annotate/silhouette.h"

#include <string.h>

/* Side of a tile (the work item of a thread) and of a cell (rays are cast for all of it or for
 * none), pixels. */
enum { TILE = 32, CELL = 8, TILE_PIXELS = TILE * TILE, TILE_CELLS = TILE / CELL };

static const pl_silhouette nothing = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN, 0, 0, 0};

void pl_seen_write(const pl_point *points, size_t stride, const int tile[4], int image_width,
                   pl_seen *seen) {
  for (int y = 0; y < tile[3]; y++) {
    pl_seen *out = seen + (size_t)(tile[1] + y) * (size_t)image_width + (size_t)tile[0];
    const pl_point *row = points + (size_t)y * stride;
    for (int x = 0; x < tile[2]; x++) {
      out[x].surface_id = row[x].surface_id;
      out[x].triangle = row[x].triangle;
      out[x].range_m = !pl_surface_is_none(row[x].surface_id) ? (float)row[x].t : 0.0f;
    }
  }
}

/* Search for one object's silhouette; work items are tiles of the box. */
typedef struct search {
  const pl_silhouette_job *job;
  const pl_outline *outline;
  size_t slot;
  pl_rect box;        /* the outline's rectangle, and the visible pixels */
  int columns;        /* tiles per row */
  size_t cell_stride; /* cells per row, counted in whole tiles */
  uint8_t *mask;
} search;

/* Pixels of a tile that only a ray can decide. */
typedef struct doubts {
  pl_vec3 directions[TILE_PIXELS];
  int16_t x[TILE_PIXELS], y[TILE_PIXELS]; /* relative to the tile's corner */
  bool hits[TILE_PIXELS];
  size_t count;
} doubts;

static bool in_image(const pl_camera *camera, int x, int y) {
  return x >= 0 && y >= 0 && x < camera->width && y < camera->height;
}

static void add_pixel(const search *search, int x, int y, pl_silhouette *into) {
  const pl_camera *camera = &search->job->shot->rays.camera;
  const bool inside = in_image(camera, x, y);
  into->x0 = into->x0 < x ? into->x0 : x;
  into->y0 = into->y0 < y ? into->y0 : y;
  into->x1 = into->x1 > x ? into->x1 : x;
  into->y1 = into->y1 > y ? into->y1 : y;
  into->count++;
  into->inside += inside;
  if (inside && search->mask != NULL)
    search->mask[(size_t)y * (size_t)camera->width + (size_t)x] = 1;
}

static void merge(pl_silhouette *into, const pl_silhouette *from) {
  into->x0 = into->x0 < from->x0 ? into->x0 : from->x0;
  into->y0 = into->y0 < from->y0 ? into->y0 : from->y0;
  into->x1 = into->x1 > from->x1 ? into->x1 : from->x1;
  into->y1 = into->y1 > from->y1 ? into->y1 : from->y1;
  into->count += from->count;
  into->inside += from->inside;
  into->rays += from->rays;
}

/* Whether a pixel shows the entity, or of it the parts that count. */
static bool is_seen(const pl_silhouette_job *job, size_t slot, const pl_seen *seen) {
  if (pl_surface_is_none(seen->surface_id) || pl_shot_slot(job->shot, seen->surface_id) != slot)
    return false;
  return job->parts == NULL ||
         job->parts[pl_object_part(job->shot->objects[slot].object, seen->triangle)] != 0;
}

void pl_silhouette_see_parts(const pl_silhouette_job *job, size_t slot, const pl_extent *within,
                             pl_extent *parts) {
  const pl_object *object = job->shot->objects[slot].object;
  const size_t width = (size_t)job->shot->rays.camera.width;
  for (size_t i = 0; i < object->part_count; i++)
    parts[i] = PL_EXTENT_NONE;
  for (int32_t y = within->y0; y <= within->y1; y++)
    for (int32_t x = within->x0; x <= within->x1; x++) {
      const pl_seen *seen = &job->seen[(size_t)y * width + (size_t)x];
      if (!pl_surface_is_none(seen->surface_id) &&
          pl_shot_slot(job->shot, seen->surface_id) == slot)
        pl_extent_merge(&parts[pl_object_part(object, seen->triangle)],
                        &(pl_extent){x, y, x, y, 1});
    }
}

/* Decides a pixel by its visible surface, or adds it to those that need a ray if the object may be
 * there. */
static void look(const search *search, const int tile[4], int x, int y, bool possible,
                 doubts *doubts, pl_silhouette *into) {
  const pl_snapshot *shot = search->job->shot;
  const int u = tile[0] + x, v = tile[1] + y;
  if (in_image(&shot->rays.camera, u, v)) {
    const pl_seen *seen =
        &search->job->seen[(size_t)v * (size_t)shot->rays.camera.width + (size_t)u];
    if (pl_surface_is_none(seen->surface_id))
      return;
    const bool shows = is_seen(search->job, search->slot, seen);
    if (shows)
      add_pixel(search, u, v, into);
    if (shows || seen->range_m > search->outline->far_m)
      return;
  }
  if (!possible)
    return;
  const pl_vec3 direction = pl_snapshot_ray(shot, u, v);
  if (pl_vec3_dot(direction, direction) == 0.0)
    return; /* outside the image, where the lens maps no ray */
  doubts->directions[doubts->count] = direction;
  doubts->x[doubts->count] = (int16_t)x;
  doubts->y[doubts->count++] = (int16_t)y;
}

static void cast_doubts(const search *search, const int tile[4], doubts *doubts,
                        pl_silhouette *into) {
  if (doubts->count == 0)
    return;
  pl_solo_cast(search->job->solo, doubts->directions, doubts->hits, doubts->count);
  into->rays += (int64_t)doubts->count;
  for (size_t i = 0; i < doubts->count; i++)
    if (doubts->hits[i])
      add_pixel(search, tile[0] + doubts->x[i], tile[1] + doubts->y[i], into);
}

/* Visits blocks of 4 x 2 pixels, so that a packet of eight rays is coherent. */
static void look_at_cell(const search *search, const int tile[4], int x0, int y0, bool possible,
                         doubts *doubts, pl_silhouette *into) {
  const int x1 = x0 + CELL < tile[2] ? x0 + CELL : tile[2];
  const int y1 = y0 + CELL < tile[3] ? y0 + CELL : tile[3];
  for (int by = y0; by < y1; by += 2)
    for (int bx = x0; bx < x1; bx += 4)
      for (int y = by; y < by + 2 && y < y1; y++)
        for (int x = bx; x < bx + 4 && x < x1; x++)
          look(search, tile, x, y, possible, doubts, into);
}

static pl_status search_tile(void *context, size_t item, int worker) {
  const search *search = context;
  const pl_camera *camera = &search->job->shot->rays.camera;
  const int column = (int)(item % (size_t)search->columns);
  const int row = (int)(item / (size_t)search->columns);
  const int x0 = search->box.x0 + TILE * column, y0 = search->box.y0 + TILE * row;
  const int w = search->box.x1 - x0 + 1, h = search->box.y1 - y0 + 1;
  const int tile[4] = {x0, y0, w < TILE ? w : TILE, h < TILE ? h : TILE};
  const bool outside =
      x0 + tile[2] <= 0 || y0 + tile[3] <= 0 || x0 >= camera->width || y0 >= camera->height;
  const uint8_t *cells = search->job->cells + (size_t)(row * TILE_CELLS) * search->cell_stride +
                         (size_t)(column * TILE_CELLS);
  pl_silhouette found = nothing;
  doubts doubts;
  doubts.count = 0;
  for (int y = 0; y < tile[3]; y += CELL, cells += search->cell_stride)
    for (int x = 0; x < tile[2]; x += CELL) {
      const bool possible = cells[x / CELL] != 0;
      if (possible || !outside)
        look_at_cell(search, tile, x, y, possible, &doubts, &found);
    }
  cast_doubts(search, tile, &doubts, &found);
  merge(&search->job->workers[worker], &found);
  return PL_OK;
}

/* The tiles of the canvas and one more along each axis, as a box need not begin at a tile
 * boundary. */
size_t pl_silhouette_cells(const pl_camera *camera) {
  const size_t columns = (3 * (size_t)camera->width + TILE) / TILE + 1;
  const size_t rows = (3 * (size_t)camera->height + TILE) / TILE + 1;
  return columns * rows * TILE_CELLS * TILE_CELLS;
}

static void mark_rect(const search *search, pl_rect r) {
  const pl_rect box = search->box;
  const size_t first = (size_t)((r.x0 - box.x0) / CELL), last = (size_t)((r.x1 - box.x0) / CELL);
  for (int y = (r.y0 - box.y0) / CELL; y <= (r.y1 - box.y0) / CELL; y++)
    memset(search->job->cells + (size_t)y * search->cell_stride + first, 1, last - first + 1);
}

/* Marks the cells that a box may project on. The rectangle of a long oblique box is much larger
 * than its projection, so large boxes are halved, at most `depth` times. Boxes that cross the
 * camera plane are not: halving costs much there and gains little. */
static void mark_box(const search *search, const pl_outline *piece, const pl_cluster *box,
                     int depth) {
  const int small = 4 * CELL;
  const pl_rect r = pl_outline_project(piece, &search->job->shot->rays.camera, box->low, box->high);
  if (r.x0 > r.x1)
    return;
  if (depth == 0 || (r.x1 - r.x0 < small && r.y1 - r.y0 < small) ||
      !pl_outline_before(piece, box->low, box->high)) {
    mark_rect(search, r);
    return;
  }
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (box->high[k] - box->low[k] > box->high[axis] - box->low[axis])
      axis = k;
  pl_cluster halves[2] = {*box, *box};
  halves[0].high[axis] = halves[1].low[axis] = 0.5f * (box->low[axis] + box->high[axis]);
  mark_box(search, piece, &halves[0], depth - 1);
  mark_box(search, piece, &halves[1], depth - 1);
}

/* Marks the cells where the object may project. */
static void mark_cells(const search *search, int rows) {
  const int depth = 6, anywhere = search->outline->model == NULL && search->outline->pieces == NULL;
  size_t count;
  const pl_outline *pieces = pl_outline_pieces(search->outline, &count);
  memset(search->job->cells, anywhere, search->cell_stride * (size_t)(rows * TILE_CELLS));
  for (size_t k = 0; k < count && !search->outline->whole; k++)
    for (size_t i = 0; i < pieces[k].clusters.count; i++)
      mark_box(search, &pieces[k], &pieces[k].clusters.boxes[i], depth);
}

/* For an object that is whole: the visible pixels are the silhouette. */
static pl_silhouette from_extent(const pl_extent *extent) {
  pl_silhouette out = nothing;
  if (extent->count > 0)
    out = (pl_silhouette){extent->x0,    extent->y0,    extent->x1, extent->y1,
                          extent->count, extent->count, 0};
  return out;
}

static search search_of(const pl_silhouette_job *job, size_t slot, const pl_outline *outline,
                        const pl_extent *extent) {
  search search = {.job = job, .outline = outline, .slot = slot};
  pl_extent box = *extent;
  if (!outline->whole) {
    const pl_rect r = outline->rect;
    pl_extent_merge(&box, &(pl_extent){r.x0, r.y0, r.x1, r.y1, 0});
  }
  search.box = (pl_rect){box.x0, box.y0, box.x1, box.y1};
  search.columns = (box.x1 - box.x0 + TILE) / TILE;
  search.cell_stride = (size_t)search.columns * TILE_CELLS;
  return search;
}

/* Nowhere on the canvas. */
static bool is_nowhere(const pl_outline *outline, const pl_extent *extent) {
  return extent->count == 0 && outline->rect.x0 > outline->rect.x1;
}

static pl_status choose_entity(const pl_silhouette_job *job, size_t slot) {
  const pl_snapshot *shot = job->shot;
  if (slot >= shot->object_count)
    return pl_solo_set_body(job->solo, &shot->bodies[slot - shot->object_count]);
  return job->parts == NULL ? pl_solo_set(job->solo, &shot->objects[slot])
                            : pl_solo_set_parts(job->solo, &shot->objects[slot], job->parts);
}

pl_status pl_silhouette_find(const pl_silhouette_job *job, size_t slot, const pl_outline *outline,
                             const pl_extent *extent, uint8_t *mask, pl_silhouette *out) {
  if (is_nowhere(outline, extent) || (outline->whole && (mask == NULL || extent->count == 0))) {
    *out = from_extent(extent);
    return PL_OK;
  }
  search search = search_of(job, slot, outline, extent);
  search.mask = mask;
  const int rows = (search.box.y1 - search.box.y0 + TILE) / TILE;
  for (int i = 0; i < job->threads; i++)
    job->workers[i] = nothing;
  mark_cells(&search, rows);
  if (!outline->whole)
    PL_TRY(choose_entity(job, slot));
  PL_TRY(pl_parallel_for(job->threads, (size_t)search.columns * (size_t)rows, search_tile, &search,
                         job->cancel));
  *out = nothing;
  for (int i = 0; i < job->threads; i++)
    merge(out, &job->workers[i]);
  return PL_OK;
}

static int32_t saturated(int64_t count) { return count > INT32_MAX ? INT32_MAX : (int32_t)count; }

void pl_silhouette_label(const pl_silhouette *silhouette, pl_object_label *label) {
  label->px_count_all = saturated(silhouette->count);
  label->px_count_valid = saturated(silhouette->inside);
  label->visib_fract = 0.0;
  if (silhouette->count > 0)
    label->visib_fract = (double)label->px_count_visib / (double)silhouette->count;
  if (label->px_count_visib <= 0)
    return;
  label->bbox_obj[0] = silhouette->x0;
  label->bbox_obj[1] = silhouette->y0;
  label->bbox_obj[2] = silhouette->x1 - silhouette->x0;
  label->bbox_obj[3] = silhouette->y1 - silhouette->y0;
}
