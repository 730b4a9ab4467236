/* Participating media along rays. */
#include "render/medium.h"

#include "render/path.h"
#include "render/medium_kinds.h"

/* One line per kind. */
/* clang-format off */
const pl_medium_kind *const pl_medium_kinds[] = {
    &pl_medium_clouds,
    &pl_medium_rings,
    &pl_medium_volumes,
};
/* clang-format on */
const size_t pl_medium_kind_count = sizeof pl_medium_kinds / sizeof pl_medium_kinds[0];
_Static_assert(sizeof pl_medium_kinds / sizeof pl_medium_kinds[0] <= PL_MEDIUM_KINDS_MAX,
               "too many");

static const pl_vec3f ALL = {1.0f, 1.0f, 1.0f};

void pl_medium_list_add(pl_medium_list *list, const pl_medium_crossing *crossing) {
  size_t i = list->count;
  if (i == PL_MEDIUM_CROSSINGS) {
    if (!(crossing->t < list->items[--i].t))
      return;
  } else {
    list->count++;
  }
  for (; i > 0 && list->items[i - 1].t > crossing->t; i--)
    list->items[i] = list->items[i - 1];
  list->items[i] = *crossing;
}

pl_status pl_media_build(const pl_snapshot *shot, const int *values, const pl_air_view *air,
                         pl_arena *arena, pl_media *out, bool *any) {
  *out = (pl_media){.air = air, .subpixel = PL_NO_BODY, .emitted_light = true};
  *any = false;
  for (size_t k = 0; k < pl_medium_kind_count; k++) {
    if (values[k] > 0)
      PL_TRY(pl_medium_kinds[k]->build(shot, values[k], arena, &out->own[k]));
    *any |= out->own[k] != NULL;
  }
  return PL_OK;
}

static bool in_cone(const pl_media *media, bool filtered, const pl_snapshot *shot, pl_vec3 axis,
                    double half_angle) {
  for (size_t k = 0; media != NULL && k < pl_medium_kind_count; k++)
    if (media->own[k] != NULL && (filtered || !pl_medium_kinds[k]->filtered) &&
        pl_medium_kinds[k]->in_cone(media->own[k], shot, axis, half_angle))
      return true;
  return false;
}

bool pl_media_in_cone(const pl_media *media, const pl_snapshot *shot, pl_vec3 axis,
                      double half_angle) {
  return in_cone(media, true, shot, axis, half_angle);
}

bool pl_media_rough_in_cone(const pl_media *media, const pl_snapshot *shot, pl_vec3 axis,
                            double half_angle) {
  return in_cone(media, false, shot, axis, half_angle);
}

bool pl_media_thin(const pl_media *media, const pl_snapshot *shot, const pl_beam *pixel,
                   double faint) {
  for (size_t k = 0; k < pl_medium_kind_count; k++)
    if (media->own[k] != NULL && pl_medium_kinds[k]->thin != NULL &&
        pl_medium_kinds[k]->thin(media->own[k], shot, pixel, faint))
      return true;
  return false;
}

bool pl_medium_ray_sees(const pl_media *media, const pl_medium_ray *ray, const pl_snapshot *shot,
                        uint32_t body) {
  if (!ray->camera)
    return true;
  return media->subpixel != PL_NO_BODY ? media->subpixel == body : !shot->bodies[body].subpixel;
}

void pl_media_cross(const pl_media *media, const pl_snapshot *shot, const pl_medium_ray *ray,
                    pl_medium_list *out) {
  out->count = 0;
  for (size_t k = 0; k < pl_medium_kind_count; k++)
    if (media->own[k] != NULL)
      pl_medium_kinds[k]->cross(media, media->own[k], shot, ray, out);
}

pl_vec3f pl_media_passed(const pl_media *media, const pl_air_view *air, const pl_snapshot *shot,
                         const pl_beam *beam, double t_max) {
  const pl_medium_ray ray = {
      .beam = beam, .t_max = t_max, .camera = true, .dark = true, .from_body = PL_NO_BODY};
  pl_medium_list list;
  pl_vec3f out = ALL;
  if (air != NULL)
    out = pl_air_toward_sun(air, shot, beam->origin, pl_vec3_to_float(beam->direction));
  if (media == NULL)
    return out;
  pl_media_cross(media, shot, &ray, &list);
  for (size_t i = 0; i < list.count; i++)
    out = pl_vec3f_mul(out, list.items[i].transmittance);
  return out;
}

static pl_vec3f toward_sun_but(const pl_media *media, const pl_medium_kind *left_out,
                               const pl_snapshot *shot, pl_vec3 point, const pl_sun_view *sun,
                               float width_m) {
  pl_vec3f out = ALL;
  for (size_t k = 0; k < pl_medium_kind_count; k++) {
    const pl_medium_kind *kind = pl_medium_kinds[k];
    if (media->own[k] != NULL && kind != left_out)
      out = pl_vec3f_mul(out, kind->toward_sun(media, media->own[k], shot, point, sun, width_m));
  }
  return out;
}

pl_vec3f pl_media_toward_sun(const pl_media *media, const pl_snapshot *shot, pl_vec3 point,
                             const pl_sun_view *sun, float width_m) {
  return toward_sun_but(media, NULL, shot, point, sun, width_m);
}

/* For its transmittance the sky is a disc about the zenith with this sine of its angular radius. */
static const float SKY_SINE = 0.5f;

/* Transmittance for sky light to a point of the ground, whose normal is `up`. */
static pl_vec3f toward_sky(const pl_media *media, const pl_snapshot *shot, pl_vec3 point,
                           pl_vec3f up, float width_m) {
  const pl_sun_view sky = {.direction = up, .sin_radius = SKY_SINE, .distance_m = INFINITY};
  pl_vec3f out = ALL;
  for (size_t k = 0; k < pl_medium_kind_count; k++) {
    const pl_medium_kind *kind = pl_medium_kinds[k];
    if (media->own[k] != NULL && kind->before_sky)
      out = pl_vec3f_mul(out, kind->toward_sun(media, media->own[k], shot, point, &sky, width_m));
  }
  return out;
}

pl_vec3f pl_media_dim_sky(const pl_media *media, const pl_snapshot *shot, const pl_vertex *vertex,
                          float width_m, pl_vec3f sky) {
  if (media == NULL || !(pl_vec3f_max(sky) > 0.0f))
    return sky;
  return pl_vec3f_mul(sky, toward_sky(media, shot, vertex->position, vertex->ng, width_m));
}

/* Fraction of a disc of radius `a` that a disc of radius `b` leaves visible; `apart`: the distance
 * of their centres. */
static double disc_left(double a, double b, double apart) {
  if (apart >= a + b)
    return 1.0;
  if (apart <= fabs(a - b))
    return b >= a ? 0.0 : 1.0 - b * b / (a * a);
  /* distance of the common chord from the first centre */
  const double x = (apart * apart + a * a - b * b) / (2.0 * apart);
  const double y = sqrt(fmax(0.0, a * a - x * x));
  const double own = a * a * atan2(y, x) - x * y;
  const double other = b * b * atan2(y, apart - x) - (apart - x) * y;
  return fmin(1.0, fmax(0.0, 1.0 - (own + other) / (PL_PI * a * a)));
}

/* Fraction of the sun's disc, taken as uniform, that a body leaves visible. The body's outline is
 * taken as the circle about its centre through the point where a ray towards the sun's centre would
 * be tangent. */
static double body_left(const pl_shot_body *body, pl_vec3 point, const pl_sun_view *sun) {
  const pl_vec3 toward = pl_vec3f_to_double(sun->direction);
  const pl_vec3 to_body = pl_vec3_sub(body->center, point);
  const double distance = pl_vec3_norm(to_body), along = pl_vec3_dot(to_body, toward);
  if (distance - body->radius_m > (double)sun->distance_m)
    return 1.0;
  const double low_m = pl_vec3_norm(pl_vec3_madd(to_body, -along, toward));
  const pl_vec3 o = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, point));
  const pl_vec3 d = pl_vec3_unit(pl_mat3_mul_vec(body->to_unit, toward));
  const double low = pl_vec3_norm(pl_vec3_madd(o, -pl_vec3_dot(o, d), d));
  const double radius = low > 1e-6 ? low_m / low : body->radius_m;
  return disc_left((double)sun->sin_radius, asin(fmin(1.0, radius / distance)),
                   atan2(low_m, along));
}

pl_vec3f pl_media_sunlight(const pl_media *media, const pl_medium_kind *kind,
                           const pl_snapshot *shot, pl_vec3 point, const pl_sun_view *sun,
                           float width_m) {
  double left = 1.0;
  size_t k = 0;
  uint32_t body;
  while (left > 0.0 &&
         (body = pl_sun_next_sphere(sun, &shot->body_tree, point, 0.0, &k)) != PL_NO_ITEM)
    left *= body_left(&shot->bodies[body], point, sun);
  if (!(left > 0.0))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  pl_vec3f out = toward_sun_but(media, kind, shot, point, sun, width_m);
  if (media->air != NULL)
    out = pl_vec3f_mul(out, pl_air_toward_sun(media->air, shot, point, sun->direction));
  return pl_vec3f_scale(out, (float)left * sun->irradiance);
}

/* Attenuates a path and adds the media's radiance, without air. */
static void pass(pl_path *path, const pl_medium_list *list, pl_vec3f *sink) {
  for (size_t i = 0; i < list->count; i++) {
    *sink = pl_vec3f_add(*sink, pl_vec3f_mul(path->throughput, list->items[i].radiance));
    path->throughput = pl_vec3f_mul(path->throughput, list->items[i].transmittance);
  }
}

pl_vec3f pl_media_seen(const pl_medium_list *list, pl_vec3f radiance) {
  for (size_t i = list->count; i-- > 0;)
    radiance =
        pl_vec3f_add(list->items[i].radiance, pl_vec3f_mul(list->items[i].transmittance, radiance));
  return radiance;
}

void pl_media_apply(const pl_path_context *context, int bounce, size_t count, pl_tile_buffers *b) {
  const pl_render_settings *settings = context->settings;
  const bool any = bounce > 0 || context->media;
  for (size_t i = 0; i < count; i++) {
    pl_path *path = &b->paths[i];
    const pl_hit *hit = &b->hits[i];
    const bool miss = pl_surface_is_none(hit->surface_id);
    if (bounce == 0 && !miss && pl_surface_same(b->prefiltered_id[path->pixel], hit->surface_id))
      continue; /* its radiance is known already */
    const pl_medium_ray ray = {
        .beam = &path->beam,
        .t_max = miss ? INFINITY : (double)hit->t,
        .camera = bounce == 0,
        .from_body = bounce > 0 ? b->rays[i].skip_body : PL_NO_BODY,
    };
    pl_medium_list list;
    list.count = 0;
    if (any)
      pl_media_cross(settings->media, context->shot, &ray, &list);
    if (settings->air != NULL)
      pl_air_pass(context, bounce, i, &list, b);
    else
      pass(path, &list, pl_path_sink(b, path->pixel, path->filtered));
  }
}
