/* Tracing of scans. A ray is placed by the sensor's pose at its own time, while the tracer has all
 * surfaces where they are at an instant. For each surface that moves in between, and whose bounds
 * the ray touches, the ray is moved as that surface's axes see it and traced again; only its own
 * hits count. The nearest of all is exact at the time of the ray. */
#include "frame/scan_trace.h"

#include "base/memory.h"
#include "render/geometry.h"
#include "scene/shutter.h"
#include "trace/height_field.h"
#include "terrain/cube.h"

/* --- motion ----------------------------------------------------------------------------------- */

/* Rigid motion from a ray's time to the instant: p -> to + turn (p - from). */
typedef struct carry {
  pl_mat3 turn;
  pl_vec3 from, to; /* camera-relative at the instant, m */
  bool moves;
} carry;

static const pl_motion *motion_of(const pl_scan_job *job, pl_surface_id id) {
  const pl_placement *placement = &job->request->placement;
  const size_t index = pl_surface_index(id);
  if (!pl_surface_is_mesh(id))
    return &placement->bodies[index].motion;
  const int body = job->scene->objects[index].body;
  return body >= 0 ? &placement->bodies[body].motion : &placement->objects[index].motion;
}

static bool same_pose(const pl_pose *a, const pl_pose *b) {
  return a->t.x == b->t.x && a->t.y == b->t.y && a->t.z == b->t.z && a->q.w == b->q.w &&
         a->q.x == b->q.x && a->q.y == b->q.y && a->q.z == b->q.z;
}

/* Fraction of the frame's time at which poses are taken; see pl_placement_at. */
static double held(const pl_scan_job *job, double u) {
  const pl_motion *camera = &job->request->placement.camera.motion;
  const int steps = camera->keys != NULL ? camera->key_count - 1 : 1;
  return job->request->placement.shutter.held ? floor(u * steps + 0.5) / steps : u;
}

static carry carry_of(const pl_scan_job *job, double u, pl_surface_id id) {
  if (!job->moves)
    return (carry){.moves = false};
  const pl_motion *motion = motion_of(job, id);
  const pl_pose then = pl_motion_at(motion, held(job, u)),
                now = pl_motion_at(motion, held(job, job->u));
  if (same_pose(&then, &now))
    return (carry){.moves = false};
  const pl_vec3 camera = job->instant->shot.camera_position;
  return (carry){
      .turn = pl_mat3_mul(pl_mat3_from_quat(now.q), pl_mat3_transpose(pl_mat3_from_quat(then.q))),
      .from = pl_vec3_sub(then.t, camera),
      .to = pl_vec3_sub(now.t, camera),
      .moves = true,
  };
}

static pl_vec3 carry_point(const carry *by, pl_vec3 p) {
  return pl_vec3_add(by->to, pl_mat3_mul_vec(by->turn, pl_vec3_sub(p, by->from)));
}

pl_vec3 pl_scan_position(const pl_scan_job *job, const pl_scan_ray *ray, const pl_vertex *vertex) {
  const carry by = carry_of(job, ray->u, vertex->surface_id);
  const pl_vec3 back =
      by.moves
          ? pl_vec3_add(by.from, pl_mat3_mul_vec_t(by.turn, pl_vec3_sub(vertex->position, by.to)))
          : vertex->position;
  return pl_vec3_add(job->instant->shot.camera_position, back);
}

pl_vec3f pl_scan_vector(const pl_scan_job *job, const pl_scan_ray *ray, const pl_vertex *vertex,
                        pl_vec3f v) {
  const carry by = carry_of(job, ray->u, vertex->surface_id);
  return by.moves ? pl_vec3_to_float(pl_mat3_mul_vec_t(by.turn, pl_vec3f_to_double(v))) : v;
}

/* --- rays of a chunk -------------------------------------------------------------------------- */

void pl_scan_place(const pl_scan_job *job, pl_scan_ray *ray) {
  const pl_snapshot *shot = &job->instant->shot;
  const double window_s = pl_shutter_window_s(&job->request->placement);
  ray->u = window_s > 0.0 ? fmin(fmax(ray->own.time_s / window_s, 0.0), 1.0) : 0.5;
  pl_mat3 to_root = shot->camera_to_root;
  pl_vec3 moved = {0.0, 0.0, 0.0};
  if (job->moves) {
    const pl_pose pose = pl_motion_at(&job->request->placement.camera.motion, held(job, ray->u));
    to_root = pl_mat3_from_quat(pose.q);
    moved = pl_vec3_sub(pose.t, shot->camera_position);
  }
  ray->origin = pl_vec3_add(moved, pl_mat3_mul_vec(to_root, ray->own.origin));
  ray->direction = pl_mat3_mul_vec(to_root, ray->own.direction);
}

static void start_ray(const pl_scan_job *job, uint32_t index, pl_scan_chunk *chunk) {
  const pl_scan_ray *ray = &chunk->rays[index];
  const pl_ray_source *source = &job->scan->source;
  const float part = 1.0f / sqrtf((float)source->sub_rays);
  const bool there = pl_vec3_dot(ray->direction, ray->direction) > 0.0;
  chunk->ways[index] = (pl_echo_ray){
      .beam = {.origin = ray->origin,
               .direction = ray->direction,
               .width_m = part * (float)source->aperture_m,
               .spread = part * (float)source->divergence_rad},
      .passed = 1.0f,
      .index = index,
  };
  chunk->queries[index] =
      there
          ? (pl_ray){.origin = ray->origin,
                     .t_max = INFINITY,
                     .direction = ray->direction,
                     .skip_body = PL_NO_BODY}
          : (pl_ray){.t_max = -1.0, .direction = {0.0, 0.0, 1.0}, .skip_body = PL_EVERY_ELLIPSOID};
}

static void fill_beams(const pl_scan_job *job, size_t item, pl_scan_chunk *chunk) {
  const pl_ray_source *source = &job->scan->source;
  const size_t each = (size_t)source->sub_rays;
  const size_t depth = job->shades ? PL_ECHO_DEPTH : 1;
  const size_t room = PL_SCAN_RAYS / depth / each, per_chunk = room > 0 ? room : 1;
  const size_t from = item * per_chunk, left = job->beam_count - from;
  chunk->ray_count = 0;
  for (size_t b = from; b < from + (left < per_chunk ? left : per_chunk); b++)
    for (int sub = 0; sub < source->sub_rays; sub++) {
      pl_scan_ray *ray = &chunk->rays[chunk->ray_count++];
      ray->beam = job->beams[b];
      pl_ray_source_ray(source, ray->beam, sub, &ray->own);
      pl_scan_place(job, ray);
    }
}

static size_t chunks_of(const pl_scan_job *job) {
  const pl_camera *camera = &job->scan->source.camera;
  if (job->tiled)
    return (size_t)((camera->width + PL_TILE_SIDE - 1) / PL_TILE_SIDE) *
           (size_t)((camera->height + PL_TILE_SIDE - 1) / PL_TILE_SIDE);
  const size_t depth = job->shades ? PL_ECHO_DEPTH : 1;
  const size_t room = PL_SCAN_RAYS / depth / (size_t)job->scan->source.sub_rays;
  const size_t per_chunk = room > 0 ? room : 1;
  return (job->beam_count + per_chunk - 1) / per_chunk;
}

/* All rays of a full tile, in the order of render.c: packets are then the same. */
static void fill_tile(const pl_scan_job *job, size_t item, pl_scan_chunk *chunk) {
  const pl_ray_source *source = &job->scan->source;
  const int width = source->camera.width;
  const size_t columns = (size_t)((width + PL_TILE_SIDE - 1) / PL_TILE_SIDE);
  const int x0 = (int)(item % columns) * PL_TILE_SIDE, y0 = (int)(item / columns) * PL_TILE_SIDE;
  chunk->ray_count = PL_TILE_PIXELS;
  for (uint32_t i = 0; i < PL_TILE_PIXELS; i++) {
    const uint32_t pixel = pl_tile_pixel(i);
    const int x = x0 + (int)(pixel % PL_TILE_SIDE), y = y0 + (int)(pixel / PL_TILE_SIDE);
    pl_scan_ray *ray = &chunk->rays[i];
    ray->beam = SIZE_MAX;
    if (x < width && y < source->camera.height) {
      ray->beam = (size_t)y * (size_t)width + (size_t)x;
      pl_ray_source_ray(source, ray->beam, 0, &ray->own);
    } else {
      ray->own = (pl_sensor_ray){.direction = source->kind->at(source, x, y)};
    }
    pl_scan_place(job, ray);
  }
}

/* --- tracing ---------------------------------------------------------------------------------- */

/* Surfaces of one motion, as rays meet them: an object, a body, or all that stands still. */
typedef struct group {
  const pl_motion *motion; /* NULL: all that stands still between the ray's time and the instant */
  carry by;
} group;

/* Number of surfaces of other motions that a ray passes before it is given up. */
enum { PASSES = 64 };

static bool is_of(const pl_scan_job *job, const pl_scan_ray *ray, const group *group,
                  pl_surface_id id) {
  return group->motion != NULL ? motion_of(job, id) == group->motion
                               : !carry_of(job, ray->u, id).moves;
}

/* Lets a ray go on behind a hit; returns by how far its origin moved. */
static double pass(const pl_scan_job *job, const pl_hit *hit, pl_ray *query) {
  const double part = 1e-6, rounding = 1e-12;
  if (pl_surface_is_ellipsoid(hit->surface_id)) {
    query->skip_body = (uint32_t)pl_surface_index(hit->surface_id);
    return 0.0;
  }
  const pl_geometry_bounds bounds =
      pl_geometry_of(hit->surface_id)->bounds(&job->instant->shot, hit->surface_id);
  const double step = hit->t * (1.0 + rounding) + part * bounds.radius_m;
  query->origin = pl_vec3_madd(query->origin, step, query->direction);
  return step;
}

/* Finds where a ray meets the surfaces of a group first, as these see it at its time: others are
 * where they are at the instant, and do not count. */
static bool meet_group(const pl_scan_job *job, const pl_scan_ray *ray, const group *group,
                       const pl_ray *query, pl_hit *hit) {
  pl_ray moved = *query;
  double passed_m = 0.0;
  if (group->by.moves) {
    moved.origin = carry_point(&group->by, query->origin);
    moved.direction = pl_mat3_mul_vec(group->by.turn, query->direction);
  }
  for (int i = 0; i < PASSES; i++) {
    pl_tracer_closest(job->instant->tracer, &moved, hit, 1, false, true);
    if (pl_surface_is_none(hit->surface_id))
      return false;
    if (is_of(job, ray, group, hit->surface_id)) {
      hit->t += passed_m;
      return true;
    }
    passed_m += pass(job, hit, &moved);
  }
  return false;
}

/* Whether a ray touches the bounds of a surface, moved to the ray's time, before `limit_m`. */
static bool may_meet(const pl_scan_job *job, const pl_ray *query, const carry *by, pl_surface_id id,
                     double limit_m) {
  const pl_geometry_bounds at = pl_geometry_of(id)->bounds(&job->instant->shot, id);
  const pl_vec3 center =
      pl_vec3_add(by->from, pl_mat3_mul_vec_t(by->turn, pl_vec3_sub(at.center, by->to)));
  const pl_vec3 to = pl_vec3_sub(center, query->origin);
  const double along = pl_vec3_dot(to, query->direction), square = pl_vec3_dot(to, to);
  const double radius = at.radius_m * (1.0 + 1e-6), off = square - along * along;
  if (off > radius * radius + 1e-9 * square || (along < 0.0 && square > radius * radius))
    return false;
  return along - radius < limit_m;
}

/* Replaces the hit of way `i` if a surface that moves is met before. */
static void offer(const pl_scan_job *job, size_t i, pl_surface_id id, pl_scan_chunk *chunk) {
  const pl_scan_ray *ray = &chunk->rays[chunk->ways[i].index];
  const group group = {motion_of(job, id), carry_of(job, ray->u, id)};
  pl_hit *best = &chunk->hits[i], hit;
  const double limit_m = pl_surface_is_none(best->surface_id) ? INFINITY : best->t;
  if (!group.by.moves || !may_meet(job, &chunk->queries[i], &group.by, id, limit_m) ||
      !meet_group(job, ray, &group, &chunk->queries[i], &hit) || !(hit.t < limit_m))
    return;
  *best = hit;
  chunk->ways[i].beam.origin = carry_point(&group.by, chunk->queries[i].origin);
  chunk->ways[i].beam.direction = pl_mat3_mul_vec(group.by.turn, chunk->queries[i].direction);
}

/* Finds the first hit of way `i` with everything where it is at the ray's time. */
static void closest_at_its_time(const pl_scan_job *job, size_t i, pl_scan_chunk *chunk) {
  const pl_snapshot *shot = &job->instant->shot;
  const group still = {.motion = NULL};
  if (!meet_group(job, &chunk->rays[chunk->ways[i].index], &still, &chunk->queries[i],
                  &chunk->hits[i]))
    chunk->hits[i].surface_id = PL_NO_SURFACE;
  for (size_t k = 0; k < shot->object_count; k++)
    offer(job, i, shot->objects[k].id, chunk);
  for (size_t k = 0; k < shot->body_count; k++)
    if (shot->bodies[k].shape == NULL)
      offer(job, i, pl_shot_surface_of(&shot->bodies[k], k), chunk);
}

/* Adds the surface that way `i` meets. */
static pl_vertex *meet(const pl_scan_job *job, size_t i, pl_scan_chunk *chunk) {
  const pl_snapshot *shot = &job->instant->shot;
  const pl_echo_ray *way = &chunk->ways[i];
  const size_t at = chunk->echo_count++;
  pl_vertex *point = &chunk->points[at];
  pl_vertex_locate(shot, &way->beam, &chunk->hits[i], true, point);
  if (job->shades) {
    pl_echo_at(shot, way, job->scan->band, point, &chunk->echoes[at]);
  } else {
    pl_vertex_orient(shot, &way->beam, point);
    chunk->echoes[at] = (pl_echo){.range_m = point->t, .index = way->index};
  }
  return point;
}

static void trace_chunk(const pl_scan_job *job, pl_scan_chunk *chunk) {
  const pl_instant *instant = job->instant;
  size_t count = chunk->ray_count;
  chunk->echo_count = 0;
  for (size_t i = 0; i < count; i++)
    start_ray(job, (uint32_t)i, chunk);
  for (int depth = 0; count > 0; depth++) {
    size_t kept = 0;
    if (job->moves && depth == 0)
      for (size_t i = 0; i < count; i++)
        closest_at_its_time(job, i, chunk);
    else
      pl_tracer_closest(instant->tracer, chunk->queries, chunk->hits, count, job->tiled, true);
    for (size_t i = 0; i < count; i++) {
      if (pl_surface_is_none(chunk->hits[i].surface_id) ||
          chunk->rays[chunk->ways[i].index].beam == SIZE_MAX)
        continue;
      const pl_vertex *point = meet(job, i, chunk);
      const pl_echo_ray way = chunk->ways[i];
      if (job->shades && depth + 1 < PL_ECHO_DEPTH &&
          pl_echo_continue(&instant->shot, &way, job->scan->band, point, &chunk->ways[kept],
                           &chunk->queries[kept]))
        kept++;
    }
    count = kept;
  }
}

static pl_status run_chunk(void *context, size_t item, int worker) {
  const pl_scan_job *job = context;
  pl_scan_chunk *chunk = &job->chunks[worker];
  if (job->tiled)
    fill_tile(job, item, chunk);
  else
    fill_beams(job, item, chunk);
  trace_chunk(job, chunk);
  job->take(job, chunk);
  return PL_OK;
}

/* --- instants --------------------------------------------------------------------------------- */

/* Instant of a beam. */
static int instant_of(const pl_scan *scan, double window_s, int instants, size_t beam) {
  pl_sensor_ray ray;
  if (instants == 1)
    return 0;
  scan->source.kind->ray(&scan->source, beam, 0, &ray);
  return (int)fmin(fmax(floor(ray.time_s / window_s * instants), 0.0), instants - 1);
}

/* Sorts beams by instant: those of instant k are beams[first[k]..first[k + 1]]. */
static void sort_beams(const pl_scan *scan, double window_s, int instants, size_t *beams,
                       size_t *first) {
  const size_t count = scan->source.kind->count(&scan->source);
  for (int k = 0; k <= instants; k++)
    first[k] = 0;
  for (size_t i = 0; i < count; i++)
    first[instant_of(scan, window_s, instants, i) + 1]++;
  for (int k = 0; k < instants; k++)
    first[k + 1] += first[k];
  for (size_t i = 0; i < count; i++)
    beams[first[instant_of(scan, window_s, instants, i)]++] = i;
  for (int k = instants; k > 0; k--)
    first[k] = first[k - 1];
  first[0] = 0;
}

/* Makes the world of the job's instant, with everything in it. */
static pl_status realise(pl_renderer *renderer, pl_scan_job *job) {
  pl_arena *arena = &renderer->instants;
  pl_survey survey;
  const pl_frame_request *request = job->request;
  const pl_placement *placement = &request->placement;
  pl_choice choice = {
      .settings.effects = {.distortion = 1},
      .terrain_levels = PL_CUBE_LEVELS,
      .threads = request->threads,
      .cancel = request->cancel,
      .beams = {.pixel_rad = fmax(job->scan->source.divergence_rad, PL_SCAN_PIXEL_RAD)},
  };
  pl_arena_reset(arena);
  if (!job->scan->source.kind->camera)
    pl_ray_source_cone(&job->scan->source, &choice.beams.axis, &choice.beams.half_angle_rad);
  else
    choice.beams.pixel_rad = 0.0;
  if (job->moves) {
    pl_placement *now = pl_arena_alloc(arena, 1, sizeof *now);
    if (now == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for an instant of a scan");
    PL_TRY(pl_placement_at(job->scene, placement, job->u, arena, now));
    placement = now;
  }
  PL_TRY(pl_survey_place(job->scene, request, placement, arena, &survey));
  return pl_realise(renderer->accelerators, &survey, &choice, arena, &job->instant);
}

static pl_status run_instants(pl_renderer *renderer, pl_scan_job *job, int instants,
                              const size_t *beams, const size_t *first) {
  for (int k = 0; k < instants; k++) {
    job->beams = beams + first[k];
    job->beam_count = first[k + 1] - first[k];
    job->u = (k + 0.5) / instants;
    if (job->beam_count == 0)
      continue;
    const size_t grounds = pl_ground_scenes(renderer->accelerators);
    PL_TRY(realise(renderer, job));
    PL_TRY(pl_parallel_for(job->request->threads, chunks_of(job), run_chunk, job,
                           job->request->cancel));
    pl_ground_scenes_release(renderer->accelerators, grounds);
  }
  return PL_OK;
}

static pl_status check(const pl_frame_request *request, const pl_scan *scan) {
  const double window_s = pl_shutter_window_s(&request->placement);
  const double last_s = scan->source.kind->duration_s(&scan->source);
  PL_TRY(pl_ray_source_check(&scan->source));
  if (scan->instants < 1 || scan->instants > PL_SCAN_INSTANTS_MAX)
    return pl_fail(PL_E_RANGE, "instants must be in 1..%d, not %d", PL_SCAN_INSTANTS_MAX,
                   scan->instants);
  if (scan->band < 0 || scan->band > 2)
    return pl_fail(PL_E_RANGE, "the band must be 0, 1 or 2, not %d", scan->band);
  if (request->threads < 1 || request->threads > 256)
    return pl_fail(PL_E_RANGE, "threads must be in 1..256, not %d", request->threads);
  if (window_s > 0.0 && last_s > window_s * (1.0 + 1e-9))
    return pl_fail(PL_E_RANGE, "the last ray leaves at %g s, after the frame's time of %g s",
                   last_s, window_s);
  return PL_OK;
}

pl_status pl_scan_run(pl_renderer *renderer, const pl_frame_request *request, const pl_scan *given,
                      bool shades, pl_scan_fn take, const void *context) {
  pl_scan scan = *given;
  scan.source.camera = request->placement.camera;
  scan.source.shutter = request->placement.shutter;
  PL_TRY(check(request, &scan));
  PL_TRY(pl_placement_check(renderer->scene, &request->placement));
  const double window_s = pl_shutter_window_s(&request->placement);
  const int instants = window_s > 0.0 ? scan.instants : 1;
  pl_scan_job job = {
      .scene = renderer->scene,
      .request = request,
      .scan = &scan,
      .moves = window_s > 0.0,
      .shades = shades,
      .tiled = !shades && !(window_s > 0.0) && scan.source.kind == &pl_ray_source_pixels,
      .take = take,
      .context = context,
  };
  pl_arena_reset(&renderer->arena);
  pl_ground_tiles_trim(renderer->accelerators);
  const size_t count = scan.source.kind->count(&scan.source);
  size_t *beams = pl_arena_alloc(&renderer->arena, count, sizeof *beams);
  size_t *first = pl_arena_alloc(&renderer->arena, (size_t)instants + 1, sizeof *first);
  job.chunks = pl_arena_alloc(&renderer->arena, (size_t)request->threads, sizeof *job.chunks);
  if (beams == NULL || first == NULL || job.chunks == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the rays of a scan");
  sort_beams(&scan, window_s, instants, beams, first);
  return run_instants(renderer, &job, instants, beams, first);
}
