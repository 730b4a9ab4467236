/* Gathers the rays of a frame. */
#include "frame/measure.h"

#include "frame/instant.h"
#include "frame/renderer.h"
#include "frame/scan.h"
#include "light/sun.h"
#include "render/coverage_mask.h"
#include "render/geometry.h"
#include "render/render.h"
#include "terrain/cube.h"
#include "trace/ray_log.h"

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

/* What is measured, and the memory of it. */
typedef struct bench {
  pl_survey survey;
  pl_accelerators *kept;
  pl_arena arena;
  pl_coverage coverage;
  const pl_ray_source *source; /* NULL: rays of pixels, and to the sun */
  int repeats;
  pl_ray_times *primary, *shadow; /* the latter of pixels alone */
} bench;

static pl_status room_for(bench *b, size_t count, rays *out) {
  *out = (rays){pl_arena_alloc(&b->arena, count, sizeof(pl_ray)), 0};
  return out->items != NULL ? PL_OK : pl_fail(PL_E_MEMORY, "out of memory for rays");
}

/* The instant of the surveyed placement, with all of its terrain and meshes. */
static pl_status realise_whole(bench *b, const pl_instant **out) {
  const pl_choice choice = {
      .terrain_levels = PL_CUBE_LEVELS,
      .threads = 1,
      .settings.effects = {.far_casters = 1, .distortion = 1, .depth_of_field = 1}};
  return pl_realise(b->kept, &b->survey, &choice, &b->arena, out);
}

static pl_status measure_pixels(bench *b) {
  const size_t pixels = (size_t)b->survey.view.width * (size_t)b->survey.view.height;
  rays first, second;
  PL_TRY(room_for(b, pixels, &first));
  PL_TRY(room_for(b, pixels, &second));
  const pl_instant *instant;
  PL_TRY(realise_whole(b, &instant));
  const pl_snapshot *shot = &instant->shot;
  const pl_tracer *tracer = instant->tracer;
  PL_TRY(pl_coverage_update(&b->coverage, shot, 0, shot->rays.camera.height, 1, 1));
  gather_primary(shot, &b->coverage, &first);
  gather_shadow(shot, tracer, &first, &second);
  PL_TRY(
      pl_tracer_measure(b->kept, tracer, first.items, first.count, false, b->repeats, b->primary));
  return pl_tracer_measure(b->kept, tracer, second.items, second.count, true, b->repeats,
                           b->shadow);
}

static pl_status measure_scan(bench *b) {
  const size_t beams = b->source->kind->count(b->source);
  rays all;
  PL_TRY(room_for(b, beams * (size_t)b->source->sub_rays, &all));
  pl_choice choice = {
      .terrain_levels = PL_CUBE_LEVELS,
      .threads = 1,
      .settings.effects = {.distortion = 1},
      .beams = {.pixel_rad = fmax(b->source->divergence_rad, PL_SCAN_PIXEL_RAD)},
  };
  pl_ray_source_cone(b->source, &choice.beams.axis, &choice.beams.half_angle_rad);
  const pl_instant *instant;
  PL_TRY(pl_realise(b->kept, &b->survey, &choice, &b->arena, &instant));
  const pl_mat3 *to_root = &instant->shot.camera_to_root;
  for (size_t beam = 0; beam < beams; beam++)
    for (int sub = 0; sub < b->source->sub_rays; sub++) {
      pl_sensor_ray ray;
      pl_ray_source_ray(b->source, beam, sub, &ray);
      all.items[all.count++] = (pl_ray){.origin = pl_mat3_mul_vec(*to_root, ray.origin),
                                        .direction = pl_mat3_mul_vec(*to_root, ray.direction),
                                        .t_max = INFINITY,
                                        .skip_body = PL_NO_BODY};
    }
  return pl_tracer_measure(b->kept, instant->tracer, all.items, all.count, false, b->repeats,
                           b->primary);
}

static pl_status measure(const pl_scene *scene, const pl_placement *placement, bench *b) {
  const pl_frame_request request = {.samples = 1};
  pl_arena_init(&b->arena);
  pl_status status = pl_placement_check(scene, placement);
  if (status == PL_OK)
    status = pl_survey_place(scene, &request, placement, &b->arena, &b->survey);
  if (status == PL_OK)
    status = pl_accelerators_create(&b->kept);
  if (status == PL_OK)
    status = b->source != NULL ? measure_scan(b) : measure_pixels(b);
  pl_accelerators_destroy(b->kept);
  pl_coverage_clear(&b->coverage);
  pl_arena_clear(&b->arena);
  return status;
}

pl_status pl_measure_rays(const pl_scene *scene, const pl_placement *placement, int repeats,
                          pl_ray_times *primary, pl_ray_times *shadow) {
  bench b = {.repeats = repeats, .primary = primary, .shadow = shadow};
  return measure(scene, placement, &b);
}

static pl_status render_logged(pl_renderer *renderer, const pl_frame_request *request,
                               pl_ray_log *log) {
  if (request->threads != 1)
    return pl_fail(PL_E_RANGE, "threads must be 1 to keep the rays, not %d", request->threads);
  pl_frame_result result;
  pl_accelerators_log(renderer->accelerators, log);
  const pl_status status = pl_renderer_frame(renderer, request, &result);
  pl_accelerators_log(renderer->accelerators, NULL);
  if (status == PL_OK && log->full)
    return pl_fail(PL_E_MEMORY, "out of memory for the rays of a frame");
  return status;
}

static pl_status replay(bench *b, const pl_frame_request *request, const pl_scene *scene,
                        const pl_ray_log *log) {
  const pl_frame_request still = {.samples = 1};
  const pl_instant *instant;
  PL_TRY(pl_survey_place(scene, &still, &request->placement, &b->arena, &b->survey));
  PL_TRY(realise_whole(b, &instant));
  PL_TRY(pl_tracer_measure(b->kept, instant->tracer, log->rays[PL_LOG_CLOSEST],
                           log->count[PL_LOG_CLOSEST], false, b->repeats, b->primary));
  return pl_tracer_measure(b->kept, instant->tracer, log->rays[PL_LOG_SHADOW],
                           log->count[PL_LOG_SHADOW], true, b->repeats, b->shadow);
}

pl_status pl_measure_frame(pl_renderer *renderer, const pl_frame_request *request, int repeats,
                           pl_ray_times *closest, pl_ray_times *shadow) {
  bench b = {
      .kept = renderer->accelerators, .repeats = repeats, .primary = closest, .shadow = shadow};
  pl_ray_log log = {0};
  pl_status status = render_logged(renderer, request, &log);
  pl_arena_init(&b.arena);
  if (status == PL_OK)
    status = replay(&b, request, renderer->scene, &log);
  pl_ray_log_clear(&log);
  pl_arena_clear(&b.arena);
  return status;
}

pl_status pl_measure_scan(const pl_scene *scene, const pl_placement *placement,
                          const pl_ray_source *source, int repeats, pl_ray_times *out) {
  bench b = {.source = source, .repeats = repeats, .primary = out};
  PL_TRY(pl_ray_source_check(source));
  return measure(scene, placement, &b);
}
