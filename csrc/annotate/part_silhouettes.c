/* Silhouettes of groups of parts: rays note all parts that they meet. */
#include "annotate/part_silhouettes.h"

#include <string.h>

#define NO_PART UINT32_MAX

/* Search for the silhouettes of all groups; work items are tiles of the object's box. */
typedef struct search {
  const pl_silhouette_job *job;
  const pl_outline *outline;
  const pl_object *object;
  size_t index; /* of the object */
  pl_outline_cells cells;
  size_t groups, words; /* 64-bit words of a set of parts */
  /* Groups that part k belongs to: of[first[k]] to of[first[k + 1] - 1]. */
  const uint32_t *first, *of;
  pl_silhouette *found; /* by thread and group */
  uint64_t *sets;       /* of the rays of a packet, by thread */
  uint64_t *marks;      /* by thread and group: 1 + the last pixel that was added to it */
  uint64_t *pixels;     /* by thread: number of pixels so far */
} search;

/* A tile, and the pixels in which parts may be. */
typedef struct candidates {
  const search *search;
  pl_outline_tile tile;
  pl_vec3 directions[PL_OUTLINE_TILE_PIXELS];
  int16_t x[PL_OUTLINE_TILE_PIXELS], y[PL_OUTLINE_TILE_PIXELS]; /* relative to the corner */
  uint32_t seen[PL_OUTLINE_TILE_PIXELS];                        /* part that is visible */
  size_t count;
} candidates;

/* The part of the object that a pixel shows. */
static uint32_t part_of(const search *search, const pl_seen *seen) {
  return !pl_surface_is_none(seen->surface_id) &&
                 pl_shot_slot(search->job->shot, seen->surface_id) == search->index
             ? pl_object_part(search->object, seen->triangle)
             : NO_PART;
}

/* Adds a pixel that shows the object, or before which the object may be. */
static void look(void *context, int x, int y, bool possible) {
  candidates *to = context;
  const search *search = to->search;
  const pl_snapshot *shot = search->job->shot;
  const int u = to->tile.x0 + x, v = to->tile.y0 + y;
  uint32_t part = NO_PART;
  if (pl_silhouette_in_image(&shot->rays.camera, u, v)) {
    const pl_seen *seen = pl_silhouette_seen(search->job, u, v);
    part = part_of(search, seen);
    if (pl_surface_is_none(seen->surface_id) ||
        (part == NO_PART && seen->range_m > search->outline->far_m))
      return;
  }
  if (!possible && part == NO_PART)
    return;
  const pl_vec3 direction = pl_snapshot_ray(shot, u, v);
  if (pl_vec3_dot(direction, direction) == 0.0)
    return; /* outside the image, where the lens maps no ray */
  to->directions[to->count] = direction;
  to->seen[to->count] = part;
  to->x[to->count] = (int16_t)x;
  to->y[to->count++] = (int16_t)y;
}

/* Adds a pixel to the groups that the parts belong to which its ray meets and which it shows, to
 * each group once. */
static void add_pixel(const candidates *from, size_t index, uint64_t *set, int worker) {
  const search *search = from->search;
  pl_silhouette *found = search->found + (size_t)worker * search->groups;
  uint64_t *marks = search->marks + (size_t)worker * search->groups;
  const uint64_t mark = ++search->pixels[worker];
  const int x = from->tile.x0 + from->x[index], y = from->tile.y0 + from->y[index];
  const bool inside = pl_silhouette_in_image(&search->job->shot->rays.camera, x, y);
  const uint32_t seen = from->seen[index];
  if (seen != NO_PART)
    set[seen / 64] |= UINT64_C(1) << seen % 64;
  for (size_t word = 0; word < search->words; word++)
    for (uint64_t rest = set[word]; rest != 0; rest &= rest - 1) {
      const size_t part = 64 * word + (size_t)__builtin_ctzll(rest);
      for (uint32_t i = search->first[part]; i < search->first[part + 1]; i++) {
        const uint32_t group = search->of[i];
        if (marks[group] != mark)
          pl_silhouette_add(&found[group], x, y, inside);
        marks[group] = mark;
      }
    }
}

static pl_status search_tile(void *context, size_t item, int worker) {
  const search *search = context;
  const size_t words = search->words;
  uint64_t *sets = search->sets + (size_t)worker * PL_TRACER_PACKET * words;
  candidates from;
  from.search = search;
  from.tile = pl_outline_cells_tile(&search->cells, &search->job->shot->rays.camera, item);
  from.count = 0;
  pl_outline_tile_visit(&from.tile, search->cells.stride, look, &from);
  for (size_t i = 0; i < from.count; i += PL_TRACER_PACKET) {
    const size_t rays = from.count - i < PL_TRACER_PACKET ? from.count - i : PL_TRACER_PACKET;
    pl_solo_find_parts(search->job->solo, &search->job->shot->objects[search->index],
                       from.directions + i, rays, sets, words);
    for (size_t k = 0; k < rays; k++)
      add_pixel(&from, i + k, sets + k * words, worker);
  }
  return PL_OK;
}

static pl_status take(pl_arena *arena, size_t count, size_t size, void **out) {
  *out = pl_arena_alloc(arena, count, size);
  if (*out == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for silhouettes of parts");
  memset(*out, 0, count * size);
  return PL_OK;
}

/* Lists the groups of each part. */
static pl_status list_groups(const pl_part_group *groups, size_t count, size_t parts,
                             pl_arena *arena, search *out) {
  void *first, *of;
  size_t entries = 0;
  for (size_t g = 0; g < count; g++)
    for (size_t part = 0; part < parts; part++)
      entries += groups[g].parts[part] != 0;
  PL_TRY(take(arena, parts + 1, sizeof *out->first, &first));
  PL_TRY(take(arena, entries + 1, sizeof *out->of, &of));
  uint32_t next = 0;
  for (size_t part = 0; part < parts; part++) {
    ((uint32_t *)first)[part] = next;
    for (size_t g = 0; g < count; g++)
      if (groups[g].parts[part] != 0)
        ((uint32_t *)of)[next++] = (uint32_t)g;
  }
  ((uint32_t *)first)[parts] = next;
  out->first = first;
  out->of = of;
  return PL_OK;
}

static pl_status make_room(pl_arena *arena, search *out) {
  const size_t threads = (size_t)out->job->threads;
  void *found, *sets, *marks, *pixels;
  PL_TRY(take(arena, threads * out->groups, sizeof *out->found, &found));
  PL_TRY(take(arena, threads * PL_TRACER_PACKET * out->words, sizeof *out->sets, &sets));
  PL_TRY(take(arena, threads * out->groups, sizeof *out->marks, &marks));
  PL_TRY(take(arena, threads, sizeof *out->pixels, &pixels));
  out->found = found;
  out->sets = sets;
  out->marks = marks;
  out->pixels = pixels;
  for (size_t i = 0; i < threads * out->groups; i++)
    out->found[i] = PL_SILHOUETTE_NOTHING;
  return PL_OK;
}

/* Finds the silhouettes, into those of the first thread. */
static pl_status find(search *search, const pl_extent *extent, uint8_t *cells) {
  const pl_silhouette_job *job = search->job;
  if (pl_outline_is_nowhere(search->outline, extent) ||
      (search->outline->whole && extent->count == 0))
    return PL_OK;
  search->cells = pl_outline_cells_mark(search->outline, &job->shot->rays.camera, extent, cells);
  PL_TRY(pl_solo_set(job->solo, &job->shot->objects[search->index]));
  PL_TRY(pl_parallel_for(job->threads, (size_t)search->cells.columns * (size_t)search->cells.rows,
                         search_tile, search, job->cancel));
  for (int i = 1; i < job->threads; i++)
    for (size_t g = 0; g < search->groups; g++)
      pl_silhouette_merge(&search->found[g], &search->found[(size_t)i * search->groups + g]);
  return PL_OK;
}

/* Finds the extents of the visible pixels of each part, within those of the object. */
static void see_parts(const search *search, const pl_extent *within, pl_extent *parts) {
  for (size_t i = 0; i < search->object->part_count; i++)
    parts[i] = PL_EXTENT_NONE;
  for (int32_t y = within->y0; y <= within->y1; y++)
    for (int32_t x = within->x0; x <= within->x1; x++) {
      const uint32_t part = part_of(search, pl_silhouette_seen(search->job, x, y));
      if (part != NO_PART)
        pl_extent_merge(&parts[part], &(pl_extent){x, y, x, y, 1});
    }
}

pl_status pl_part_silhouettes_label(const pl_silhouette_job *job, const pl_part_group *groups,
                                    size_t count, const pl_outline *outline,
                                    const pl_extent *extent, pl_arena *arena,
                                    pl_object_label *labels) {
  const size_t index = groups[0].object;
  const pl_object *object = job->shot->objects[index].object;
  search search = {.job = job, .outline = outline, .object = object, .index = index};
  void *parts;
  search.groups = count;
  search.words = object->part_count / 64 + 1;
  PL_TRY(list_groups(groups, count, object->part_count, arena, &search));
  PL_TRY(make_room(arena, &search));
  PL_TRY(take(arena, object->part_count, sizeof(pl_extent), &parts));
  PL_TRY(find(&search, extent, job->cells));
  see_parts(&search, extent, parts);
  for (size_t g = 0; g < count; g++) {
    pl_extent own = PL_EXTENT_NONE;
    for (size_t i = 0; i < object->part_count; i++)
      if (groups[g].parts[i] != 0)
        pl_extent_merge(&own, &((pl_extent *)parts)[i]);
    pl_object_label_fill(job->shot, index, &own, &labels[g]);
    pl_silhouette_label(&search.found[g], &labels[g]);
  }
  return PL_OK;
}
