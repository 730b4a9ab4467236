/* Rings: flat layers in the equatorial plane of a body. A ray crosses them as one medium, even
 * where its cone intersects them in several places. */
#include "render/medium_kinds.h"
#include "rings/rings.h"

typedef struct ring_item {
  const pl_rings *rings;
  uint32_t body;
} ring_item;

typedef struct ring_list {
  size_t count;
  ring_item *items;
} ring_list;

static pl_status build(const pl_snapshot *shot, int value, pl_arena *arena, const void **own) {
  (void)value;
  ring_list *list = pl_arena_alloc(arena, 1, sizeof *list);
  ring_item *items = pl_arena_alloc(arena, shot->body_count, sizeof *items);
  if (list == NULL || items == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for rings");
  *list = (ring_list){.items = items};
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].body->rings != NULL)
      items[list->count++] = (ring_item){shot->bodies[i].body->rings, (uint32_t)i};
  *own = list->count > 0 ? list : NULL;
  return PL_OK;
}

/* Whether a cone may contain points of a circle about the z axis, with all vectors in the body's
 * axes. No point of the circle is farther than half a step from one of ARCS points. slack_m:
 * maximum error of the cone's apex. */
enum { ARCS = 64 };
static bool circle_in_cone(double radius_m, pl_vec3 apex, pl_vec3 axis, double half_angle,
                           double slack_m) {
  const double step_m = radius_m * PL_PI / ARCS + slack_m;
  for (int i = 0; i < ARCS; i++) {
    const double turn = 2.0 * PL_PI * i / ARCS;
    const pl_vec3 to =
        pl_vec3_sub((pl_vec3){radius_m * cos(turn), radius_m * sin(turn), 0.0}, apex);
    const double off = atan2(pl_vec3_norm(pl_vec3_cross(to, axis)), pl_vec3_dot(to, axis));
    const double far = pl_vec3_norm(to);
    if (!(far > step_m) || off < half_angle + asin(step_m / far))
      return true;
  }
  return false;
}

/* The intersection of a cone with the plane has no holes. It therefore meets the rings if its
 * centre lies on them, or if one of their edges is inside the cone. */
static bool may_see(const ring_item *item, const pl_snapshot *shot, pl_vec3 axis,
                    double half_angle) {
  const pl_shot_body *body = &shot->bodies[item->body];
  const double inner = pl_rings_inner_m(item->rings), outer = pl_rings_outer_m(item->rings);
  if (!pl_snapshot_sees(shot, body->center, outer, axis, half_angle))
    return false;
  const pl_vec3 apex = body->camera, along = pl_mat3_mul_vec_t(body->rotation, axis);
  const pl_vec3 at = pl_vec3_madd(apex, -apex.z / along.z, along);
  const double r = hypot(at.x, at.y), slack_m = shot->rays.camera.aperture_m;
  return !(r < inner || r > outer) || circle_in_cone(inner, apex, along, half_angle, slack_m) ||
         circle_in_cone(outer, apex, along, half_angle, slack_m);
}

static bool in_cone(const void *own, const pl_snapshot *shot, pl_vec3 axis, double half_angle) {
  const ring_list *list = own;
  for (size_t i = 0; i < list->count; i++)
    if (may_see(&list->items[i], shot, axis, half_angle))
      return true;
  return false;
}

/* A camera-relative ray in the body's axes. */
static pl_rings_ray ray_of(const pl_shot_body *body, pl_vec3 origin, pl_vec3 direction) {
  return (pl_rings_ray){.origin =
                            pl_vec3_add(body->camera, pl_mat3_mul_vec_t(body->rotation, origin)),
                        .direction = pl_mat3_mul_vec_t(body->rotation, direction)};
}

/* Sets the sunlight that a part of the rings scatters along the ray; returns its transmittance. */
static float look(const ring_item *item, const pl_media *media, const pl_snapshot *shot,
                  const pl_rings_ray *ray, const pl_rings_piece *piece, pl_vec3f *radiance) {
  const pl_shot_body *body = &shot->bodies[item->body];
  const pl_vec3 point = pl_vec3_add(body->center, pl_mat3_mul_vec(body->rotation, piece->point));
  const pl_sun_view view = pl_sun_view_at(&shot->sun, point);
  const pl_rings_sun sun = {pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(view.direction)),
                            (double)view.sin_radius};
  const pl_rings_light light = pl_rings_scatter(item->rings, piece, ray->direction, &sun);
  const pl_vec3f scattered = pl_vec3f_make((float)light.scattered[0], (float)light.scattered[1],
                                           (float)light.scattered[2]);
  const float width_m = (float)(ray->width_m + ray->spread * piece->t);
  if (pl_vec3f_max(scattered) > 0.0f)
    *radiance = pl_vec3f_mul(
        scattered, pl_media_sunlight(media, &pl_medium_rings, shot, point, &view, width_m));
  return (float)light.transmittance;
}

static float straight(const pl_rings *rings, const pl_rings_piece *piece) {
  return 1.0f -
         (float)pl_rings_average(rings, piece->low_m, piece->high_m, 1.0 / piece->sine).opacity;
}

static void cross_item(const ring_item *item, const pl_media *media, const pl_snapshot *shot,
                       const pl_medium_ray *ray, pl_medium_list *out) {
  const pl_shot_body *body = &shot->bodies[item->body];
  pl_rings_ray own = ray_of(body, ray->beam->origin, ray->beam->direction);
  pl_rings_piece pieces[PL_RINGS_PIECES];
  own.width_m = (double)ray->beam->width_m;
  own.spread = (double)ray->beam->spread;
  own.end_m = ray->t_max;
  const size_t count = pl_rings_cut(item->rings, &own, pieces);
  /* Light that a body's rings scatter to its own ground is left out. */
  const bool dark = ray->dark || ray->from_body == item->body;
  pl_medium_crossing crossing = {0};
  float held = 0.0f;
  double weights = 0.0;
  for (size_t i = 0; i < count; i++) {
    pl_vec3f radiance = {0.0f, 0.0f, 0.0f};
    const float fraction = (float)pieces[i].fraction;
    const float transmittance = dark ? straight(item->rings, &pieces[i])
                                     : look(item, media, shot, &own, &pieces[i], &radiance);
    held += fraction * (1.0f - transmittance);
    crossing.radiance = pl_vec3f_madd(crossing.radiance, fraction, radiance);
    crossing.t += pieces[i].fraction * pieces[i].t;
    weights += pieces[i].fraction;
  }
  if (!(held > 0.0f))
    return;
  const float left = pl_maxf(0.0f, 1.0f - held);
  crossing.t = fmin(crossing.t / weights, ray->t_max);
  crossing.transmittance = (pl_vec3f){left, left, left};
  pl_medium_list_add(out, &crossing);
}

static void cross(const pl_media *media, const void *own, const pl_snapshot *shot,
                  const pl_medium_ray *ray, pl_medium_list *out) {
  const ring_list *list = own;
  for (size_t i = 0; i < list->count; i++)
    if (pl_medium_ray_sees(media, ray, shot, list->items[i].body))
      cross_item(&list->items[i], media, shot, ray, out);
}

/* Larger differences of the opacity are visible. */
static const double ALIKE = 0.01;

/* A pixel contains sharp edges or lines of the rings if its centre differs from its mean. If the
 * centre hits nothing, a few samples may miss all, and any opacity in the beam counts. */
static bool thin(const void *own, const pl_snapshot *shot, const pl_beam *pixel, double faint) {
  const ring_list *list = own;
  for (size_t i = 0; i < list->count; i++) {
    pl_rings_ray ray = ray_of(&shot->bodies[list->items[i].body], pixel->origin, pixel->direction);
    ray.end_m = INFINITY;
    const double middle = pl_rings_passed(list->items[i].rings, &ray);
    ray.spread = (double)pixel->spread;
    const double whole = pl_rings_passed(list->items[i].rings, &ray);
    if (fabs(whole - middle) > (middle < 1.0 ? ALIKE : fmin(faint, ALIKE)))
      return true;
  }
  return false;
}

/* Width of a uniform strip whose variance across it is that of a uniform disc of radius 1 along any
 * diameter. */
static const double STRIP = 1.7320508075688772;

/* The rings are intersected with a cone as wide as the sun's disc and the footprint. */
static pl_vec3f toward_sun(const pl_media *media, const void *own, const pl_snapshot *shot,
                           pl_vec3 point, const pl_sun_view *sun, float width_m) {
  const ring_list *list = own;
  double out = 1.0;
  (void)media;
  for (size_t i = 0; i < list->count; i++) {
    const ring_item *item = &list->items[i];
    pl_rings_ray ray = ray_of(&shot->bodies[item->body], point, pl_vec3f_to_double(sun->direction));
    ray.width_m = (double)width_m;
    ray.spread = STRIP * (double)sun->sin_radius;
    ray.end_m = (double)sun->distance_m;
    out *= pl_rings_passed(item->rings, &ray);
  }
  return (pl_vec3f){(float)out, (float)out, (float)out};
}

const pl_medium_kind pl_medium_rings = {
    .effect = &pl_effect_rings,
    .build = build,
    .in_cone = in_cone,
    .cross = cross,
    .toward_sun = toward_sun,
    .thin = thin,
};
