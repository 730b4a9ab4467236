/* The volumes of a frame, and their intervals along a ray. */
#include "render/volume.h"

#include <math.h>

#include "render/volume_march.h"

/* Number of cells of the shadow tables, across and along. */
enum { SIDE_MIN = 8, SIDE_MAX = 64 };

static int side_of(int steps) {
  return steps < SIDE_MIN ? SIDE_MIN : steps > SIDE_MAX ? SIDE_MAX : steps;
}

static pl_status build_item(const pl_snapshot *shot, const pl_shot_volume *from, int steps,
                            pl_arena *arena, pl_volume_item *out) {
  const pl_volume *volume = from->volume;
  const float *e = volume->extinction;
  *out = (pl_volume_item){.shot = from,
                          .sun = pl_sun_view_at(&shot->sun, from->center),
                          .extinction_max = pl_maxf(e[0], pl_maxf(e[1], e[2]))};
  out->toward = pl_vec3_unit(
      pl_mat3_mul_vec_t(from->rotation, pl_vec3_sub(shot->sun.position, from->center)));
  return volume->graph != NULL
             ? pl_volume_columns_build(from, out->toward, side_of(steps), arena, &out->columns)
             : PL_OK;
}

pl_status pl_volume_view_build(const pl_snapshot *shot, int steps, pl_arena *arena,
                               const pl_volume_view **out) {
  *out = NULL;
  if (shot->volume_count == 0)
    return PL_OK;
  pl_volume_view *view = pl_arena_alloc(arena, 1, sizeof *view);
  if (view == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for volumes");
  view->steps = steps;
  view->count = shot->volume_count;
  for (size_t i = 0; i < view->count; i++)
    PL_TRY(build_item(shot, &shot->volumes[i], steps, arena, &view->items[i]));
  *out = view;
  return PL_OK;
}

static pl_vec3 local_point(const pl_shot_volume *shot, pl_vec3 point) {
  return pl_mat3_mul_vec_t(shot->rotation, pl_vec3_sub(point, shot->origin));
}

/* Column density of one volume towards the sun: density times length, m. */
static float column_of(const pl_volume_item *item, pl_vec3 point) {
  const pl_volume *volume = item->shot->volume;
  const pl_vec3 at = local_point(item->shot, point);
  double t[2];
  if (item->columns != NULL)
    return pl_volume_column(item->columns, at);
  if (!pl_bound_span(volume->bound, volume->size, &item->shot->ball, at, item->toward, t) ||
      !(t[1] > 0.0))
    return 0.0f;
  return (float)(t[1] - fmax(0.0, t[0]));
}

pl_vec3f pl_volume_toward_sun(const pl_volume_view *view, pl_vec3 point) {
  pl_vec3f depth = {0.0f, 0.0f, 0.0f};
  for (size_t i = 0; i < view->count; i++) {
    const pl_volume_item *item = &view->items[i];
    const float *e = item->shot->volume->extinction;
    if (!(item->extinction_max > 0.0f))
      continue;
    depth = pl_vec3f_madd(depth, column_of(item, point), pl_vec3f_make(e[0], e[1], e[2]));
  }
  return pl_vec3f_make(expf(-depth.x), expf(-depth.y), expf(-depth.z));
}

/* The interval of a ray within a volume; false if it misses it. */
static bool span_of(const pl_volume_item *item, const pl_volume_ray *ray, double t[2]) {
  const pl_shot_volume *shot = item->shot;
  const pl_volume *volume = shot->volume;
  if (ray->camera && !shot->in_frame)
    return false;
  const pl_vec3 direction = pl_mat3_mul_vec_t(shot->rotation, ray->direction);
  if (!pl_bound_span(volume->bound, volume->size, &shot->ball, local_point(shot, ray->origin),
                     direction, t))
    return false;
  t[0] = fmax(t[0], 0.0);
  t[1] = fmin(t[1], ray->t_max);
  return t[0] < t[1];
}

/* All ends of the volumes' intervals along the ray, in ascending order. */
static size_t sort_ends(const pl_volume_spans *spans, double ends[2 * PL_VOLUMES_MAX]) {
  size_t count = 0;
  for (size_t i = 0; i < spans->count; i++)
    for (int side = 0; side < 2; side++) {
      size_t k = count++;
      for (; k > 0 && ends[k - 1] > spans->t[i][side]; k--)
        ends[k] = ends[k - 1];
      ends[k] = spans->t[i][side];
    }
  return count;
}

size_t pl_volume_cross(const pl_volume_view *view, const pl_volume_ray *ray,
                       pl_volume_stretch out[PL_VOLUMES_MAX]) {
  pl_volume_spans spans = {.count = 0};
  double ends[2 * PL_VOLUMES_MAX];
  size_t found = 0;
  if (!(pl_vec3_dot(ray->direction, ray->direction) > 0.0)) /* the lens has no ray here */
    return 0;
  for (size_t i = 0; i < view->count; i++)
    if (span_of(&view->items[i], ray, spans.t[spans.count]))
      spans.item[spans.count++] = &view->items[i];
  const size_t count = sort_ends(&spans, ends);
  for (size_t k = 0; k + 1 < count; k++) {
    pl_volume_part part = {.start = ends[k], .end = ends[k + 1]};
    for (size_t i = 0; i < spans.count; i++)
      if (spans.t[i][0] <= part.start && spans.t[i][1] >= part.end)
        part.items[part.count++] = spans.item[i];
    if (!(part.start < part.end) || part.count == 0)
      continue;
    if (found == 0 || out[found - 1].end < part.start)
      out[found++] = (pl_volume_stretch){.start = part.start, .transmittance = {1.0f, 1.0f, 1.0f}};
    out[found - 1].end = part.end;
    pl_volume_march(view, ray, &part, &out[found - 1]);
  }
  return found;
}
