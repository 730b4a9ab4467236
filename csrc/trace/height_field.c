/* Makes the tiles of a frame and the scene of their instances. */
#include "base/work.h"
#include "trace/ground_tile_cache.h"
#include "trace/rock_instances.h"

/* One build. */
typedef struct build {
  pl_accelerators *kept;
  pl_ground_tiles *tiles;
  const pl_terrain *terrain;
  uint64_t number;              /* of the terrain */
  size_t first;                 /* index of the first new tile in the list */
  size_t first_mesh;            /* and of the first new mesh of rocks */
  const pl_ground_tile_id *ids; /* of the frame */
} build;

/* Embree reads whole vectors of 16 bytes at the last post: behind it lie the slopes. */
_Static_assert(offsetof(pl_ground_tile, slopes) + 16 <= sizeof(pl_ground_tile),
               "posts must have room behind");

static void attach_grid(const pl_accelerators *kept, RTCScene scene, const pl_kept_tile *tile) {
  RTCGeometry grid = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_GRID);
  rtcSetSharedGeometryBuffer(grid, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             tile->tile.positions, 0, 3 * sizeof(float),
                             PL_GROUND_TILE_SIDE * PL_GROUND_TILE_SIDE);
  struct RTCGrid *shape =
      rtcSetNewGeometryBuffer(grid, RTC_BUFFER_TYPE_GRID, 0, RTC_FORMAT_GRID, sizeof *shape, 1);
  if (shape != NULL)
    *shape = (struct RTCGrid){0, PL_GROUND_TILE_SIDE, PL_GROUND_TILE_SIDE, PL_GROUND_TILE_SIDE};
  rtcCommitGeometry(grid);
  rtcAttachGeometryByID(scene, grid, PL_TILE_GRID);
  rtcReleaseGeometry(grid);
}

static pl_status build_tile(void *context, size_t item, int worker) {
  (void)worker;
  const build *build = context;
  const pl_accelerators *kept = build->kept;
  pl_kept_tile *tile = build->tiles->list[build->first + item];
  RTCScene scene = rtcNewScene(kept->device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT | PL_EMBREE_QUERY_FILTERS);
  attach_grid(kept, scene, tile);
  pl_rock_instances_attach(kept, scene, tile->tile.rocks);
  rtcCommitScene(scene);
  tile->scene = scene;
  return pl_accelerator_check(kept, "building a tile of ground");
}

static pl_status make_tile(void *context, size_t item, int worker) {
  (void)worker;
  const build *build = context;
  pl_kept_tile *tile = build->tiles->list[build->first + item];
  const pl_ground_tile_id id = tile->tile.id;
  const pl_rock_field *rocks = pl_terrain_rocks(build->terrain);
  PL_TRY(pl_ground_tile_make(build->terrain, id, &tile->tile));
  if (rocks != NULL)
    PL_TRY(pl_ground_rocks_make(rocks, build->terrain, id, tile->tile.origin, &tile->tile.rocks));
  return PL_OK;
}

static pl_status make_mesh(void *context, size_t item, int worker) {
  (void)worker;
  const build *build = context;
  pl_rock_mesh *mesh = build->tiles->meshes.list[build->first_mesh + item];
  const pl_rock_variant *variants = pl_rock_field_variants(pl_terrain_rocks(build->terrain));
  PL_TRY(pl_rock_mesh_fill(mesh, &build->tiles->meshes, &variants[mesh->variant]));
  return pl_rock_instances_build(build->kept, mesh);
}

/* Makes the meshes of rocks that the new tiles are the first to need. */
static pl_status make_meshes(build *build, int threads, pl_cancel *cancel) {
  pl_rock_meshes *meshes = &build->tiles->meshes;
  for (size_t k = build->first; k < build->tiles->count; k++)
    if (build->tiles->list[k]->tile.rocks != NULL)
      PL_TRY(pl_ground_rocks_link(build->tiles->list[k]->tile.rocks, meshes));
  return pl_parallel_for(threads, meshes->count - build->first_mesh, make_mesh, build, cancel);
}

/* Each of the new tiles counts with its rocks and an equal fraction of what Embree allocated. */
static void count_new(const build *build, long long before) {
  pl_ground_tiles *tiles = build->tiles;
  const long long grids = atomic_load(&tiles->embree_bytes) - before;
  for (size_t k = build->first; k < tiles->count; k++) {
    const size_t made = tiles->count - build->first;
    const pl_ground_rocks *rocks = tiles->list[k]->tile.rocks;
    tiles->list[k]->bytes = sizeof(pl_kept_tile) + (rocks != NULL ? rocks->bytes : 0) +
                            (size_t)(grids > 0 ? grids : 0) / made;
    tiles->bytes += tiles->list[k]->bytes;
  }
}

static pl_status make_rays(void *context, size_t item, int worker) {
  (void)worker;
  const build *build = context;
  const pl_ground_tile_id id = build->ids[item];
  pl_kept_tile *tile = pl_ground_tiles_find(build->tiles, build->number, id);
  return tile->tile.rays == NULL ? pl_ground_rays_make(build->terrain, id, &tile->tile.rays)
                                 : PL_OK;
}

/* Tiles that are kept may have been made for frames without rays. */
static pl_status make_missing_rays(build *build, size_t count, int threads, pl_cancel *cancel) {
  size_t more = 0;
  for (size_t k = 0; k < count; k++)
    more += pl_ground_tiles_find(build->tiles, build->number, build->ids[k])->tile.rays == NULL;
  if (more == 0)
    return PL_OK;
  const pl_status status = pl_parallel_for(threads, count, make_rays, build, cancel);
  for (size_t k = 0; k < count; k++) {
    pl_kept_tile *tile = pl_ground_tiles_find(build->tiles, build->number, build->ids[k]);
    if (tile->tile.rays == NULL || tile->has_rays)
      continue;
    tile->has_rays = true;
    tile->bytes += sizeof *tile->tile.rays;
    build->tiles->bytes += sizeof *tile->tile.rays;
  }
  return status;
}

static pl_status make_missing(build *build, const pl_ground_tile_id *ids, size_t count, int threads,
                              pl_cancel *cancel) {
  pl_ground_tiles *tiles = build->tiles;
  const long long before = atomic_load(&tiles->embree_bytes);
  build->first = tiles->count;
  build->first_mesh = tiles->meshes.count;
  pl_status status = pl_ground_tiles_add(tiles, build->number, ids, count);
  if (status == PL_OK)
    status = pl_parallel_for(threads, tiles->count - build->first, make_tile, build, cancel);
  if (status == PL_OK)
    status = make_meshes(build, threads, cancel);
  if (status == PL_OK)
    status = pl_parallel_for(threads, tiles->count - build->first, build_tile, build, cancel);
  if (status == PL_OK)
    count_new(build, before);
  else {
    pl_ground_tiles_drop(tiles, build->first);
    pl_rock_instances_drop(&tiles->meshes, build->first_mesh);
  }
  return status;
}

static void attach(const pl_accelerators *kept, RTCScene scene, const pl_kept_tile *tile,
                   unsigned index, pl_vec3 origin) {
  const pl_vec3f shift = pl_vec3_to_float(pl_vec3_sub(tile->tile.origin, origin));
  const float place[12] = {1.0f, 0.0f, 0.0f, 0.0f,    1.0f,    0.0f,
                           0.0f, 0.0f, 1.0f, shift.x, shift.y, shift.z};
  RTCGeometry instance = rtcNewGeometry(kept->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, tile->scene);
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, place);
  rtcCommitGeometry(instance);
  rtcAttachGeometryByID(scene, instance, index);
  rtcReleaseGeometry(instance);
}

static pl_status build_scene(const build *build, const pl_ground_tile_id *ids,
                             pl_height_field *field) {
  const pl_accelerators *kept = build->kept;
  RTCScene scene = rtcNewScene(kept->device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | PL_EMBREE_QUERY_FILTERS);
  for (size_t k = 0; k < field->count; k++)
    attach(kept, scene, pl_ground_tiles_find(build->tiles, build->number, ids[k]), (unsigned)k,
           field->origin);
  rtcCommitScene(scene);
  PL_TRY(pl_ground_tiles_hold(build->tiles, scene));
  field->scene = scene;
  return pl_accelerator_check(kept, "building the ground");
}

/* Sets the spheres and the origin. It belongs to the finest tile that is nearest to the eye: sums
 * of floats must be finest there. */
static void measure(pl_height_field *field, pl_vec3 eye) {
  double nearest = INFINITY;
  int level = -1;
  for (size_t k = 0; k < field->count; k++) {
    const pl_ground_tile *tile = field->tiles[k];
    const double away = pl_vec3_norm(pl_vec3_sub(tile->origin, eye));
    const double rocks_m =
        tile->rocks != NULL ? pl_vec3_norm(tile->origin) + tile->rocks->radius_m : 0.0;
    field->radius_m = fmax(field->radius_m, fmax(tile->most_m, rocks_m));
    if (tile->id.level < level || (tile->id.level == level && away >= nearest))
      continue;
    level = tile->id.level;
    nearest = away;
    field->origin = tile->origin;
  }
}

/* Fails, before any is made, if there are to be too many rocks. */
static pl_status check_rocks(const pl_terrain *terrain, const pl_ground_tile_id *ids,
                             size_t count) {
  if (pl_terrain_rocks(terrain) == NULL)
    return PL_OK;
  double sum = 0.0;
  for (size_t k = 0; k < count; k++)
    sum +=
        pl_ground_rocks_expected(pl_terrain_rocks(terrain), pl_terrain_radius_m(terrain), ids[k]);
  if (sum <= PL_GROUND_ROCKS_MOST)
    return PL_OK;
  return pl_fail(PL_E_RANGE,
                 "some %.2g rocks are as large as %g cells of the ground's mesh or more; at most "
                 "%.2g: raise min_diameter_m or lower the density of rocks, or lower "
                 "cells_per_pixel",
                 sum, PL_ROCK_CELLS, PL_GROUND_ROCKS_MOST);
}

/* Numbers the triangles of rocks of all tiles. */
static pl_status number_rocks(pl_arena *arena, pl_height_field *field) {
  if (pl_terrain_rocks(field->terrain) == NULL)
    return PL_OK;
  uint32_t *first = pl_arena_alloc(arena, field->count + 1, sizeof *first);
  if (first == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the ground");
  size_t sum = 0;
  for (size_t k = 0; k <= field->count; k++) {
    first[k] = (uint32_t)sum;
    if (k < field->count && field->tiles[k]->rocks != NULL)
      sum += field->tiles[k]->rocks->triangle_count;
  }
  if (sum >= UINT32_MAX)
    return pl_fail(PL_E_RANGE,
                   "rocks of %zu triangles; raise min_diameter_m or lower the density of rocks",
                   sum);
  field->first_rocks = first;
  return PL_OK;
}

/* Makes the tiles that are not kept, and the rays that kept ones lack. What is made once is no work
 * of a frame: counts do not depend on the frames before it. */
static pl_status make_all(build *build, const pl_ground_tile_view *view,
                          const pl_ground_tile_choice *chosen, int threads, pl_cancel *cancel) {
  const pl_work_counts before = pl_work_done;
  build->ids = chosen->ids;
  PL_TRY(make_missing(build, chosen->ids, chosen->count, threads, cancel));
  if (view->rays && pl_terrain_ray_brightness(build->terrain) > 0.0)
    PL_TRY(make_missing_rays(build, chosen->count, threads, cancel));
  pl_work_done = before;
  return PL_OK;
}

pl_status pl_height_field_build(pl_accelerators *kept, const pl_terrain *terrain,
                                const pl_ground_tile_view *view, int threads, pl_cancel *cancel,
                                pl_arena *arena, const pl_height_field **out) {
  build build = {.kept = kept, .terrain = terrain, .number = pl_terrain_number(terrain)};
  pl_ground_tile_choice chosen;
  PL_TRY(pl_ground_tiles_open(kept, &build.tiles));
  pl_height_field *field = pl_arena_alloc(arena, 1, sizeof *field);
  if (field == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the ground");
  PL_TRY(pl_ground_tile_tree_choose(terrain, view, arena, &chosen));
  *field = (pl_height_field){.terrain = terrain,
                             .count = chosen.count,
                             .widened = chosen.widened,
                             .patch_missed = chosen.patch_missed};
  PL_TRY(check_rocks(terrain, chosen.ids, field->count));
  PL_TRY(make_all(&build, view, &chosen, threads, cancel));
  const pl_ground_tile **tiles = pl_arena_alloc(arena, field->count, sizeof *tiles);
  if (tiles == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the ground");
  for (size_t k = 0; k < field->count; k++)
    tiles[k] = &pl_ground_tiles_find(build.tiles, build.number, chosen.ids[k])->tile;
  field->tiles = tiles;
  measure(field, view->eye);
  PL_TRY(number_rocks(arena, field));
  PL_TRY(build_scene(&build, chosen.ids, field));
  *out = field;
  return PL_OK;
}
