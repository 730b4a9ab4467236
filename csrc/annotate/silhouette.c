/* Amodal silhouettes: from the visible pixels of the frame, and from rays cast at one object alone
 * where those do not decide. */
#include "annotate/silhouette.h"

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
  pl_outline_cells cells;
  uint8_t *mask;
} search;

/* A tile, and its pixels that only a ray can decide. */
typedef struct doubts {
  const search *search;
  pl_outline_tile tile;
  pl_silhouette found;
  pl_vec3 directions[PL_OUTLINE_TILE_PIXELS];
  int16_t x[PL_OUTLINE_TILE_PIXELS], y[PL_OUTLINE_TILE_PIXELS]; /* relative to the corner */
  bool hits[PL_OUTLINE_TILE_PIXELS];
  size_t count;
} doubts;

void pl_silhouette_add(pl_silhouette *into, int x, int y, bool inside) {
  into->x0 = into->x0 < x ? into->x0 : x;
  into->y0 = into->y0 < y ? into->y0 : y;
  into->x1 = into->x1 > x ? into->x1 : x;
  into->y1 = into->y1 > y ? into->y1 : y;
  into->count++;
  into->inside += inside;
}

void pl_silhouette_merge(pl_silhouette *into, const pl_silhouette *from) {
  into->x0 = into->x0 < from->x0 ? into->x0 : from->x0;
  into->y0 = into->y0 < from->y0 ? into->y0 : from->y0;
  into->x1 = into->x1 > from->x1 ? into->x1 : from->x1;
  into->y1 = into->y1 > from->y1 ? into->y1 : from->y1;
  into->count += from->count;
  into->inside += from->inside;
  into->rays += from->rays;
}

static void add_pixel(doubts *doubts, int x, int y) {
  const pl_camera *camera = &doubts->search->job->shot->rays.camera;
  const bool inside = pl_silhouette_in_image(camera, x, y);
  pl_silhouette_add(&doubts->found, x, y, inside);
  if (inside && doubts->search->mask != NULL)
    doubts->search->mask[(size_t)y * (size_t)camera->width + (size_t)x] = 1;
}

/* Decides a pixel by its visible surface, or adds it to those that need a ray if the object may be
 * there. */
static void look(void *context, int x, int y, bool possible) {
  doubts *doubts = context;
  const search *search = doubts->search;
  const pl_snapshot *shot = search->job->shot;
  const int u = doubts->tile.x0 + x, v = doubts->tile.y0 + y;
  if (pl_silhouette_in_image(&shot->rays.camera, u, v)) {
    const pl_seen *seen = pl_silhouette_seen(search->job, u, v);
    if (pl_surface_is_none(seen->surface_id))
      return;
    const bool shows = pl_shot_slot(shot, seen->surface_id) == search->slot;
    if (shows)
      add_pixel(doubts, u, v);
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

static void cast_doubts(doubts *doubts) {
  if (doubts->count == 0)
    return;
  pl_solo_cast(doubts->search->job->solo, doubts->directions, doubts->hits, doubts->count);
  doubts->found.rays += (int64_t)doubts->count;
  for (size_t i = 0; i < doubts->count; i++)
    if (doubts->hits[i])
      add_pixel(doubts, doubts->tile.x0 + doubts->x[i], doubts->tile.y0 + doubts->y[i]);
}

static pl_status search_tile(void *context, size_t item, int worker) {
  const search *search = context;
  doubts doubts;
  doubts.search = search;
  doubts.tile = pl_outline_cells_tile(&search->cells, &search->job->shot->rays.camera, item);
  doubts.found = PL_SILHOUETTE_NOTHING;
  doubts.count = 0;
  pl_outline_tile_visit(&doubts.tile, search->cells.stride, look, &doubts);
  cast_doubts(&doubts);
  pl_silhouette_merge(&search->job->workers[worker], &doubts.found);
  return PL_OK;
}

/* For an object that is whole: the visible pixels are the silhouette. */
static pl_silhouette from_extent(const pl_extent *extent) {
  pl_silhouette out = PL_SILHOUETTE_NOTHING;
  if (extent->count > 0)
    out = (pl_silhouette){extent->x0,    extent->y0,    extent->x1, extent->y1,
                          extent->count, extent->count, 0};
  return out;
}

static pl_status choose_entity(const pl_silhouette_job *job, size_t slot) {
  const pl_snapshot *shot = job->shot;
  return slot < shot->object_count
             ? pl_solo_set(job->solo, &shot->objects[slot])
             : pl_solo_set_body(job->solo, &shot->bodies[slot - shot->object_count]);
}

pl_status pl_silhouette_find(const pl_silhouette_job *job, size_t slot, const pl_outline *outline,
                             const pl_extent *extent, uint8_t *mask, pl_silhouette *out) {
  if (pl_outline_is_nowhere(outline, extent) ||
      (outline->whole && (mask == NULL || extent->count == 0))) {
    *out = from_extent(extent);
    return PL_OK;
  }
  search search = {.job = job, .outline = outline, .slot = slot, .mask = mask};
  search.cells = pl_outline_cells_mark(outline, &job->shot->rays.camera, extent, job->cells);
  for (int i = 0; i < job->threads; i++)
    job->workers[i] = PL_SILHOUETTE_NOTHING;
  if (!outline->whole)
    PL_TRY(choose_entity(job, slot));
  PL_TRY(pl_parallel_for(job->threads, (size_t)search.cells.columns * (size_t)search.cells.rows,
                         search_tile, &search, job->cancel));
  *out = PL_SILHOUETTE_NOTHING;
  for (int i = 0; i < job->threads; i++)
    pl_silhouette_merge(out, &job->workers[i]);
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
