/* Gathers the data for object labels and masks, and writes them. */
#include "frame/labels.h"

#include <string.h>

#include "annotate/part_silhouettes.h"
#include "base/memory.h"

void pl_label_tools_init(pl_label_tools *tools) {
  *tools = (pl_label_tools){.solo = NULL};
  pl_cluster_cache_init(&tools->clusters);
  pl_adjacency_cache_init(&tools->adjacencies);
}

void pl_label_tools_clear(pl_label_tools *tools) {
  pl_solo_destroy(tools->solo);
  pl_cluster_cache_clear(&tools->clusters);
  pl_adjacency_cache_clear(&tools->adjacencies);
  for (int to = 0; to < PL_FLOW_FRAMES; to++)
    pl_coverage_clear(&tools->others[to]);
  pl_label_tools_init(tools);
}

static pl_status take(pl_arena *arena, size_t count, size_t size, void **out) {
  *out = pl_arena_alloc(arena, count, size);
  return *out != NULL ? PL_OK : pl_fail(PL_E_MEMORY, "out of memory for object labels");
}

/* Slots that extents have. */
static size_t slots_of(const pl_snapshot *shot) { return shot->object_count + shot->body_count; }

/* Whether a body has a label. */
static bool has_label(const pl_shot_body *body) { return body->body->obj_id != 0; }

/* Slot of the surface of a body. */
static size_t slot_of_body(const pl_snapshot *shot, size_t body) {
  const pl_shot_object *shape = shot->bodies[body].shape;
  return shape != NULL ? pl_surface_index(shape->id) : shot->object_count + body;
}

static size_t pixels_of(const pl_snapshot *shot) {
  return (size_t)shot->rays.camera.width * (size_t)shot->rays.camera.height;
}

static pl_status prepare_silhouettes(pl_label_tools *tools, pl_arena *arena, pl_labels *out) {
  void *memory;
  PL_TRY(take(arena, pl_outline_count(out->shot), sizeof(pl_outline), &memory));
  out->outlines = memory;
  PL_TRY(pl_outline_build(out->shot, &tools->clusters, arena, out->outlines));
  bool needed = out->request->masks != NULL || out->request->group_labels != NULL ||
                out->first_body != PL_EXTENT_NO_BODIES;
  for (size_t i = 0; i < out->shot->craft_count; i++)
    needed |= !out->outlines[i].whole;
  if (!needed)
    return PL_OK;
  PL_TRY(take(arena, pixels_of(out->shot), sizeof(pl_seen), &memory));
  out->seen = memory;
  return PL_OK;
}

static pl_status prepare_ground(pl_arena *arena, pl_labels *out) {
  void *memory;
  pl_ground_map *map = &out->ground;
  if (!pl_ground_map_init(out->shot, &out->request->ground, out->request->channels, map))
    return PL_OK;
  PL_TRY(pl_ground_map_check(map));
  PL_TRY(take(arena, pixels_of(out->shot), sizeof(pl_ground_point), &memory));
  map->points = memory;
  if (map->images[PL_GROUND_HAZARD] == NULL)
    return PL_OK;
  const size_t memos = (size_t)out->request->threads * PL_ROCK_MEMOS;
  PL_TRY(take(arena, memos, sizeof(pl_rock_memo), &memory));
  map->memos = memset(memory, 0, memos * sizeof(pl_rock_memo));
  return PL_OK;
}

/* Edges of the models in view, by object. */
static pl_status prepare_coverage(const pl_snapshot *shot, pl_label_tools *tools, pl_arena *arena,
                                  pl_instance_coverage *out) {
  void *memory;
  PL_TRY(pl_instance_coverage_check(out));
  PL_TRY(take(arena, shot->object_count, sizeof(const pl_adjacency *), &memory));
  const pl_adjacency **list = memory;
  for (size_t i = 0; i < shot->object_count; i++) {
    list[i] = NULL;
    if (shot->objects[i].in_frame)
      PL_TRY(pl_adjacency_cache_get(&tools->adjacencies, shot->objects[i].object->model, &list[i]));
  }
  out->adjacencies = list;
  return PL_OK;
}

pl_status pl_labels_prepare(const pl_frame_request *request, const pl_snapshot *shot,
                            pl_label_tools *tools, pl_arena *arena, pl_labels *out) {
  void *memory;
  const size_t extents = (size_t)request->threads * slots_of(shot);
  *out = (pl_labels){.request = request, .shot = shot, .first_body = PL_EXTENT_NO_BODIES};
  for (size_t i = 0; i < shot->body_count; i++)
    if (has_label(&shot->bodies[i]))
      out->first_body = shot->object_count;
  PL_TRY(prepare_ground(arena, out));
  out->clouds = pl_cloud_map_find(request->channels);
  if (pl_instance_coverage_init(&request->coverage, request->channels, &out->coverage))
    PL_TRY(prepare_coverage(shot, tools, arena, &out->coverage));
  if (request->objects == NULL && request->masks == NULL && request->group_labels == NULL)
    return PL_OK;
  PL_TRY(take(arena, extents, sizeof(pl_extent), &memory));
  out->extents = memory;
  for (size_t i = 0; i < extents; i++)
    out->extents[i] = PL_EXTENT_NONE;
  const bool whole = request->amodal || request->masks != NULL || request->group_labels != NULL;
  return whole ? prepare_silhouettes(tools, arena, out) : PL_OK;
}

void pl_labels_tile(const pl_labels *labels, const pl_snapshot *shot, const pl_tile_result *result,
                    int worker) {
  const size_t count = slots_of(labels->shot);
  const int tile[4] = {result->tile.x0, result->tile.y0, result->tile.width, result->tile.height};
  if (labels->ground.points != NULL)
    pl_ground_map_take(&labels->ground, shot, result->points, PL_TILE_SIDE, tile);
  if (labels->coverage.parts != NULL || labels->coverage.ids != NULL)
    pl_instance_coverage_write(&labels->coverage, shot, result);
  if (labels->clouds != NULL)
    pl_cloud_map_write(labels->clouds, shot, result);
  if (labels->flow != NULL)
    pl_flow_write(labels->flow, shot, result->empty ? NULL : result->points, PL_TILE_SIDE, tile);
  if (labels->seen != NULL)
    pl_seen_write(result->points, PL_TILE_SIDE, tile, labels->shot->rays.camera.width,
                  labels->seen);
  if (labels->extents != NULL && !result->empty)
    pl_extent_add(labels->extents + (size_t)worker * count, labels->first_body, result->points,
                  PL_TILE_SIDE, tile);
}

static pl_status find_silhouette(const pl_labels *labels, const pl_silhouette_job *job, size_t slot,
                                 size_t row, const pl_extent *extent) {
  const pl_frame_request *request = labels->request;
  const pl_snapshot *shot = labels->shot;
  const size_t pixels = pixels_of(shot);
  const bool mesh = slot < shot->object_count;
  const pl_outline of_body =
      mesh ? (pl_outline){0} : pl_outline_of_body(shot, &shot->bodies[slot - shot->object_count]);
  const pl_outline *outline = mesh ? &labels->outlines[slot] : &of_body;
  uint8_t *mask = request->masks != NULL ? request->masks + row * pixels : NULL;
  pl_silhouette silhouette;
  if (mask != NULL)
    memset(mask, 0, pixels);
  PL_TRY(pl_silhouette_find(job, slot, outline, extent, mask, &silhouette));
  if (request->objects != NULL && request->amodal)
    pl_silhouette_label(&silhouette, &request->objects[row]);
  return PL_OK;
}

static pl_extent extent_of(const pl_labels *labels, size_t slot) {
  pl_extent extent = PL_EXTENT_NONE;
  for (size_t w = 0; w < (size_t)labels->request->threads; w++)
    pl_extent_merge(&extent, &labels->extents[w * slots_of(labels->shot) + slot]);
  return extent;
}

/* `slot`: of the entity; `row`: of its label. */
static pl_status label_entity(const pl_labels *labels, const pl_silhouette_job *job, size_t slot,
                              size_t row) {
  const pl_snapshot *shot = labels->shot;
  const pl_extent extent = extent_of(labels, slot);
  if (labels->request->objects != NULL)
    pl_object_label_fill(shot, slot, &extent, &labels->request->objects[row]);
  return labels->outlines != NULL ? find_silhouette(labels, job, slot, row, &extent) : PL_OK;
}

/* Groups of one object that follow each other are looked at together. */
static pl_status label_groups(const pl_labels *labels, const pl_silhouette_job *job,
                              pl_arena *arena) {
  const pl_frame_request *request = labels->request;
  const size_t count = request->group_labels != NULL ? request->group_count : 0;
  for (size_t i = 0, next; i < count; i = next) {
    const size_t object = request->groups[i].object;
    const pl_extent extent = extent_of(labels, object);
    for (next = i + 1; next < count && request->groups[next].object == object;)
      next++;
    PL_TRY(pl_part_silhouettes_label(job, &request->groups[i], next - i, &labels->outlines[object],
                                     &extent, arena, &request->group_labels[i]));
  }
  return PL_OK;
}

static pl_status label_entities(const pl_labels *labels, const pl_silhouette_job *job) {
  const pl_snapshot *shot = labels->shot;
  size_t row = 0;
  for (; row < shot->craft_count; row++)
    PL_TRY(label_entity(labels, job, row, row));
  for (size_t i = 0; i < shot->body_count; i++)
    if (has_label(&shot->bodies[i]))
      PL_TRY(label_entity(labels, job, slot_of_body(shot, i), row++));
  return PL_OK;
}

static pl_status write_ground_rows(void *context, size_t item, int worker) {
  const pl_labels *labels = context;
  const pl_ground_map *map = &labels->ground;
  const int height = map->shot->rays.camera.height, y0 = (int)item * PL_GROUND_ROWS;
  const int y1 = y0 + PL_GROUND_ROWS < height ? y0 + PL_GROUND_ROWS : height;
  return pl_ground_map_write(map, y0, y1, worker);
}

static pl_status finish_ground(const pl_labels *labels) {
  const size_t height = (size_t)labels->shot->rays.camera.height;
  pl_labels all = *labels;
  if (labels->ground.points == NULL)
    return PL_OK;
  return pl_parallel_for(labels->request->threads, (height + PL_GROUND_ROWS - 1) / PL_GROUND_ROWS,
                         write_ground_rows, &all, labels->request->cancel);
}

pl_status pl_labels_finish(const pl_labels *labels, pl_accelerators *kept, pl_label_tools *tools,
                           pl_arena *arena) {
  void *workers, *cells = NULL;
  const int threads = labels->request->threads;
  PL_TRY(finish_ground(labels));
  if (labels->extents == NULL)
    return PL_OK;
  PL_TRY(take(arena, (size_t)threads, sizeof(pl_silhouette), &workers));
  if (labels->seen != NULL)
    PL_TRY(take(arena, pl_outline_cells_size(&labels->shot->rays.camera), 1, &cells));
  if (labels->seen != NULL && tools->solo == NULL)
    PL_TRY(pl_solo_create(kept, &tools->solo));
  const pl_silhouette_job job = {
      .shot = labels->shot,
      .seen = labels->seen,
      .solo = tools->solo,
      .cells = cells,
      .workers = workers,
      .threads = threads,
      .cancel = labels->request->cancel,
  };
  PL_TRY(label_entities(labels, &job));
  return label_groups(labels, &job, arena);
}
