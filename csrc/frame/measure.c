/* Gathers the rays of a frame. */
#include "frame/measure.h"

#include "frame/instant.h"
#include "light/sun.h"
#include "render/coverage_mask.h"
#include "render/geometry.h"
#include "render/render.h"
#include "terrain/cube.h"

typedef struct rays {
  pl_ray *items; /* in the arena */
  size_t count;
} rays;

/* Collects primary rays in rendering order. */
static void gather_primary(const pl_snapshot *shot, const pl_coverage *coverage, rays *out) {
  const int w = shot->rays.camera.width, h = shot->rays.camera.height;
  for (int y0 = 0; y0 < h; y0 += PL_TILE_SIDE)
    for (int x0 = 0; x0 < w; x0 += PL_TILE_SIDE)
      for (int y = y0; y < y0 + PL_TILE_SIDE && y < h; y++)
        for (int x = x0; x < x0 + PL_TILE_SIDE && x < w; x++)
          if (pl_coverage_pixel(coverage, x, y))
            out->items[out->count++] = (pl_ray){.t_max = INFINITY,
                                                .direction = pl_snapshot_ray(shot, x, y),
                                                .skip_body = PL_NO_BODY};
}

/* Collects one ray to the sun from each sunlit point of a mesh or of terrain that a primary ray
 * hits. */
static void gather_shadow(const pl_snapshot *shot, const pl_tracer *tracer, const rays *primary,
                          rays *out) {
  for (size_t i = 0; i < primary->count; i++) {
    pl_hit hit;
    pl_vertex vertex;
    pl_tracer_closest(tracer, &primary->items[i], &hit, 1, true, true);
    if (pl_surface_is_none(hit.surface_id) || pl_surface_is_ellipsoid(hit.surface_id))
      continue;
    const pl_beam beam = {.direction = primary->items[i].direction};
    pl_vertex_locate(shot, &beam, &hit, false, &vertex);
    pl_vertex_orient(shot, &beam, &vertex);
    const pl_sun_view sun = pl_sun_view_at(&shot->sun, vertex.position);
    if (pl_vec3f_dot(sun.direction, vertex.surface.ng) > 0.0f)
      out->items[out->count++] = pl_vertex_ray(&vertex, shot, sun.direction, sun.distance_m);
  }
}

static pl_status measure(const pl_survey *survey, pl_accelerators *kept, pl_coverage *coverage,
                         pl_arena *arena, int repeats, pl_ray_times *primary,
                         pl_ray_times *shadow) {
  const size_t pixels = (size_t)survey->view.width * (size_t)survey->view.height;
  rays first = {pl_arena_alloc(arena, pixels, sizeof(pl_ray)), 0};
  rays second = {pl_arena_alloc(arena, pixels, sizeof(pl_ray)), 0};
  if (first.items == NULL || second.items == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for rays");
  const pl_choice choice = {
      .terrain_levels = PL_CUBE_LEVELS,
      .threads = 1,
      .settings.effects = {.far_casters = 1, .distortion = 1, .depth_of_field = 1}};
  const pl_instant *instant;
  PL_TRY(pl_realise(kept, survey, &choice, arena, &instant));
  const pl_snapshot *shot = &instant->shot;
  const pl_tracer *tracer = instant->tracer;
  PL_TRY(pl_coverage_update(coverage, shot, 0, shot->rays.camera.height, 1, 1));
  gather_primary(shot, coverage, &first);
  gather_shadow(shot, tracer, &first, &second);
  PL_TRY(pl_tracer_measure(kept, tracer, first.items, first.count, false, repeats, primary));
  return pl_tracer_measure(kept, tracer, second.items, second.count, true, repeats, shadow);
}

pl_status pl_measure_rays(const pl_scene *scene, const pl_placement *placement, int repeats,
                          pl_ray_times *primary, pl_ray_times *shadow) {
  pl_arena arena;
  pl_survey survey;
  const pl_frame_request request = {.samples = 1};
  pl_coverage coverage = {0};
  pl_accelerators *kept = NULL;
  pl_arena_init(&arena);
  pl_status status = pl_placement_check(scene, placement);
  if (status == PL_OK)
    status = pl_survey_place(scene, &request, placement, &arena, &survey);
  if (status == PL_OK)
    status = pl_accelerators_create(&kept);
  if (status == PL_OK)
    status = measure(&survey, kept, &coverage, &arena, repeats, primary, shadow);
  pl_accelerators_destroy(kept);
  pl_coverage_clear(&coverage);
  pl_arena_clear(&arena);
  return status;
}
