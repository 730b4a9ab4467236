/* Clouds: shells about bodies. A shell is an infinitely thin ellipsoid, except that rays near the
 * horizontal have a path of finite length in it. */
#include "geom/ellipsoid.h"
#include "math/color.h"
#include "render/cloud_opacity.h"
#include "render/medium_kinds.h"
#include "shade/body_map.h"
#include "shade/clouds.h"

typedef struct cloud_item {
  const pl_clouds *clouds;
  pl_cloud_cover cover;
  uint32_t body;
  pl_vec3 radii_m; /* of the shell */
  double reach_m;
} cloud_item;

typedef struct cloud_list {
  size_t count;
  cloud_item *items;
} cloud_list;

static cloud_item item_of(const pl_snapshot *shot, uint32_t index, int detail) {
  const pl_shot_body *body = &shot->bodies[index];
  const pl_clouds *clouds = &body->state->clouds;
  const pl_vec3 r = body->state->radii_m;
  const double h = clouds->altitude_m;
  const pl_vec3 shell = {r.x + h, r.y + h, r.z + h};
  pl_cloud_cover cover = pl_cloud_cover_make(clouds, body->body->cloud_map, detail);
  cover.oblate = body->body->geodetic_clouds ? pl_body_map_oblate(shell) : 0.0;
  return (cloud_item){
      .clouds = clouds,
      .cover = cover,
      .body = index,
      .radii_m = shell,
      .reach_m = body->radius_m + h,
  };
}

static pl_status build(const pl_snapshot *shot, int value, pl_arena *arena, const void **own) {
  cloud_list *list = pl_arena_alloc(arena, 1, sizeof *list);
  cloud_item *items = pl_arena_alloc(arena, shot->body_count, sizeof *items);
  if (list == NULL || items == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for clouds");
  *list = (cloud_list){.items = items};
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].state->clouds.altitude_m > 0.0)
      items[list->count++] = item_of(shot, (uint32_t)i, value);
  *own = list->count > 0 ? list : NULL;
  return PL_OK;
}

static bool in_cone(const void *own, const pl_snapshot *shot, pl_vec3 axis, double half_angle) {
  const cloud_list *list = own;
  for (size_t i = 0; i < list->count; i++)
    if (pl_snapshot_sees(shot, shot->bodies[list->items[i].body].center, list->items[i].reach_m,
                         axis, half_angle))
      return true;
  return false;
}

static pl_vec3 divide(pl_vec3 a, pl_vec3 b) { return (pl_vec3){a.x / b.x, a.y / b.y, a.z / b.z}; }

/* Intersection of a ray and a shell, in body axes. */
typedef struct meeting {
  pl_vec3 origin, direction; /* m from the body's centre */
  double t[2];               /* entry and exit */
} meeting;

/* A ray whose start is closer to the shell than this, relative to its radius, starts on it and does
 * not cross it there. Otherwise rounding would make some rays cross it and others not. */
static const double ON_SHELL = 1e-12;

static bool meet(const cloud_item *item, const pl_snapshot *shot, pl_vec3 origin, pl_vec3 direction,
                 meeting *out) {
  const pl_shot_body *body = &shot->bodies[item->body];
  out->origin = pl_vec3_add(body->camera, pl_mat3_mul_vec_t(body->rotation, origin));
  out->direction = pl_mat3_mul_vec_t(body->rotation, direction);
  const pl_vec3 o = divide(out->origin, item->radii_m), d = divide(out->direction, item->radii_m);
  const double a = pl_vec3_dot(d, d);
  if (!(a > 0.0)) /* no ray: the pixel is outside the lens's field */
    return false;
  const double middle = -pl_vec3_dot(o, d) / a;
  const pl_vec3 lowest = pl_vec3_madd(o, middle, d);
  const double left = 1.0 - pl_vec3_dot(lowest, lowest);
  if (!(left > 0.0))
    return false;
  const double half = sqrt(left / a);
  out->t[0] = middle - half;
  out->t[1] = middle + half;
  if (fabs(pl_vec3_dot(o, o) - 1.0) < ON_SHELL) { /* one of the two is at the start of the ray */
    out->t[0] = fmin(0.0, 2.0 * middle);
    out->t[1] = fmax(0.0, 2.0 * middle);
  }
  return out->t[1] > 0.0;
}

/* True if a ray from outside the body meets its surface. */
static bool lands(const pl_shot_body *body, const meeting *m) {
  const pl_vec3 r = body->state->radii_m;
  double t;
  return pl_ellipsoid_intersect(r, m->origin, m->direction, 0.0, &t);
}

/* A point of the shell, and how a ray crosses it there. */
typedef struct place {
  pl_vec3 point, normal; /* body axes */
  float mu;              /* cosine to the normal, for a curved layer */
  float cover, depth, unsure;
  pl_vec3f slope; /* of the cloud tops */
} place;

static float mu_of(const cloud_item *item, double cosine) {
  const double bent = 2.0 * item->clouds->thickness_m / item->reach_m;
  return (float)fmin(1.0, sqrt(cosine * cosine + fmin(bent, 1.0)));
}

static void set_cover(const pl_cloud_place *seen, place *at) {
  at->cover = seen->cover;
  at->depth = seen->depth;
  at->unsure = seen->unsure;
  at->slope = seen->slope;
}

/* Sets the cloud properties seen by a footprint about the point. */
static void cover_place(const cloud_item *item, pl_vec3 across, pl_vec3 along, unsigned wants,
                        place *at) {
  const pl_cloud_place seen = pl_cloud_place_at(&item->cover, at->point, across, along, wants);
  set_cover(&seen, at);
}

/* Places a crossing of the shell; returns its footprint. */
static pl_cloud_spot meet_shell(const cloud_item *item, const meeting *m, double t, float width_m,
                                place *out) {
  out->point = pl_vec3_madd(m->origin, t, m->direction);
  out->normal = pl_ellipsoid_normal(item->radii_m, out->point);
  const double cosine = fabs(pl_vec3_dot(m->direction, out->normal));
  out->mu = mu_of(item, cosine);
  pl_vec3 across = pl_vec3_cross(out->normal, m->direction);
  if (!(pl_vec3_dot(across, across) > 1e-16))
    across = pl_vec3_cross(out->normal, fabs(out->normal.z) < 0.7 ? (pl_vec3){0.0, 0.0, 1.0}
                                                                  : (pl_vec3){1.0, 0.0, 0.0});
  across = pl_vec3_scale(pl_vec3_unit(across), (double)width_m);
  const pl_vec3 along = pl_vec3_scale(pl_vec3_cross(across, out->normal), 1.0 / fmax(cosine, 0.02));
  return (pl_cloud_spot){out->point, across, along};
}

static void find_place(const cloud_item *item, const meeting *m, double t, float width_m,
                       unsigned wants, place *out) {
  const pl_cloud_spot spot = meet_shell(item, m, t, width_m, out);
  cover_place(item, spot.across, spot.along, wants, out);
}

/* Transmittance of a covered point. Over the ground, all light that is not reflected counts, since
 * on average as much light is scattered into the ray as out of it. For other entities only direct
 * transmittance counts. Light reflected between ground and clouds is neglected. */
static float through(const place *at, bool ground) {
  return ground ? 1.0f - pl_cloud_reflected(at->depth, at->mu)
                : pl_cloud_straight(at->depth, at->mu);
}

static float passed_at(const place *at, bool ground) {
  return at->cover > 0.0f ? 1.0f - at->cover * (1.0f - through(at, ground)) : 1.0f;
}

/* Relative change of the sunlight on tops that are tilted towards the sun or away from it. It is
 * limited symmetrically so that the mean over the slopes is preserved: this stands for shadowing
 * and interreflection between the tops. */
static const float TILT_MAX = 0.8f;
static float tilt_of(const pl_shot_body *body, const place *at, const pl_sun_view *sun,
                     float height) {
  const pl_vec3 toward = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(sun->direction));
  const pl_vec3 flat = pl_vec3_madd(toward, -pl_vec3_dot(toward, at->normal), at->normal);
  const float rise = pl_vec3f_dot(at->slope, pl_vec3_to_float(flat));
  const float most = TILT_MAX * height;
  return -pl_maxf(-most, pl_minf(rise, most)) / pl_maxf(height, 1e-6f);
}

/* The sun at a point of the shell, as seen from the start of the ray. */
typedef struct lighting {
  pl_vec3 point; /* camera-relative, root axes */
  pl_sun_view sun;
  float height, mu; /* cosines to the normal; `mu` for a curved layer */
  bool same_side;   /* the sun and the start of the ray are on the same side of the shell */
} lighting;

static lighting light_place(const cloud_item *item, const pl_snapshot *shot, const meeting *m,
                            const place *at) {
  const pl_shot_body *body = &shot->bodies[item->body];
  lighting out = {.point = pl_vec3_add(body->center, pl_mat3_mul_vec(body->rotation, at->point))};
  out.sun = pl_sun_view_at(&shot->sun, out.point);
  const pl_vec3 normal = pl_mat3_mul_vec(body->rotation, at->normal);
  const double height = pl_vec3_dot(normal, pl_vec3f_to_double(out.sun.direction));
  out.same_side = (height > 0.0) == (pl_vec3_dot(m->direction, at->normal) < 0.0);
  out.height = (float)fabs(height);
  out.mu = mu_of(item, height);
  return out;
}

/* Part of the sunlight at the point that it scatters towards the start of the ray, 1/sr. It is
 * Lambertian, as for a layer in which multiple scattering has made the light isotropic. */
static float sent_by(const cloud_item *item, const pl_snapshot *shot, const lighting *from,
                     const place *at) {
  float part = pl_cloud_reflected(at->depth, from->mu);
  if (!from->same_side)
    part = pl_maxf(0.0f, 1.0f - part - pl_cloud_straight(at->depth, from->mu));
  else if (item->clouds->relief_m > 0.0f)
    part *= 1.0f + tilt_of(&shot->bodies[item->body], at, &from->sun, from->height);
  return part * at->cover * from->height / PL_PI_F;
}

/* Means over the footprint of a ray in one crossing of the shell. */
typedef struct means {
  float cover, transmittance, sent, unsure;
} means;

static void add_place(const cloud_item *item, const pl_snapshot *shot, const lighting *from,
                      const place *at, bool ground, float part, means *sum) {
  sum->cover += part * at->cover;
  sum->transmittance += part * passed_at(at, ground);
  sum->unsure = hypotf(sum->unsure, part * at->unsure); /* errors of the parts are independent */
  if (from != NULL)
    sum->sent += part * sent_by(item, shot, from, at);
}

/* The same, averaged over parts x parts points of the footprint in the tangent plane at `at`. */
static void look_closer(const cloud_item *item, const pl_snapshot *shot, const meeting *m, double t,
                        const pl_medium_ray *ray, const lighting *from, bool ground, place at,
                        unsigned wants, means *sum) {
  const pl_shot_body *body = &shot->bodies[item->body];
  const double down = pl_vec3_dot(m->direction, at.normal);
  const pl_vec3 middle = at.point;
  const float part = 1.0f / (float)(ray->parts * ray->parts);
  pl_vec3 side[2];
  for (int k = 0; k < 2; k++) {
    const pl_vec3 turn = pl_mat3_mul_vec_t(body->rotation, ray->pixel[k]);
    const double off = pl_vec3_dot(turn, at.normal) / copysign(fmax(fabs(down), 0.02), down);
    side[k] = pl_vec3_scale(pl_vec3_madd(turn, -off, m->direction), t / ray->parts);
  }
  for (int i = 0; i < ray->parts * ray->parts; i++) {
    const double u = i % ray->parts - 0.5 * (ray->parts - 1);
    const double v = i / ray->parts - 0.5 * (ray->parts - 1);
    at.point = pl_vec3_madd(pl_vec3_madd(middle, u, side[0]), v, side[1]);
    cover_place(item, side[0], side[1], wants, &at);
    add_place(item, shot, from, &at, ground, part, sum);
  }
}

static void cross_at(const cloud_item *item, const pl_media *media, const pl_snapshot *shot,
                     const pl_medium_ray *ray, const meeting *m, double t, bool ground,
                     pl_medium_list *out) {
  place at;
  means mean = {0};
  lighting from;
  const bool lit = !ray->dark && ray->from_body != item->body;
  const float width_m = pl_beam_width(ray->beam, t);
  const unsigned wants =
      (ray->dark ? 0u : PL_CLOUD_TOPS) | (ray->parts > 0 ? PL_CLOUD_UNSURE | PL_CLOUD_BOX : 0u);
  find_place(item, m, t, width_m, wants, &at);
  if (!(at.cover > 0.0f))
    return;
  if (lit)
    from = light_place(item, shot, m, &at);
  if (ray->parts > 1)
    look_closer(item, shot, m, t, ray, lit ? &from : NULL, ground, at, wants, &mean);
  else
    add_place(item, shot, lit ? &from : NULL, &at, ground, 1.0f, &mean);
  pl_medium_crossing crossing = {
      .t = t, .transmittance = {mean.transmittance, mean.transmittance, mean.transmittance}};
  if (mean.sent > 0.0f) {
    const float *c = item->clouds->color;
    const pl_vec3f light =
        pl_media_sunlight(media, &pl_medium_clouds, shot, from.point, &from.sun, width_m);
    crossing.radiance =
        pl_vec3f_scale(pl_vec3f_mul(light, pl_vec3f_make(c[0], c[1], c[2])), mean.sent);
  }
  crossing.unsure = mean.cover > 0.0f ? mean.unsure / mean.cover : 0.0f;
  pl_medium_list_add(out, &crossing);
}

static void cross_item(const cloud_item *item, const pl_media *media, const pl_snapshot *shot,
                       const pl_medium_ray *ray, pl_medium_list *out) {
  meeting m;
  if (!meet(item, shot, ray->beam->origin, ray->beam->direction, &m))
    return;
  const bool ground = lands(&shot->bodies[item->body], &m);
  for (int i = 0; i < 2; i++)
    if (m.t[i] > 0.0 && m.t[i] < ray->t_max)
      cross_at(item, media, shot, ray, &m, m.t[i], ground && i == 0, out);
}

static void cross(const pl_media *media, const void *own, const pl_snapshot *shot,
                  const pl_medium_ray *ray, pl_medium_list *out) {
  const cloud_list *list = own;
  for (size_t i = 0; i < list->count; i++)
    if (pl_medium_ray_sees(media, ray, shot, list->items[i].body))
      cross_item(&list->items[i], media, shot, ray, out);
}

/* Below the clouds, all light that they transmit counts as coming from the sun. The night side of a
 * body is handled elsewhere. */
static pl_vec3f toward_sun(const pl_media *media, const void *own, const pl_snapshot *shot,
                           pl_vec3 point, const pl_sun_view *sun, float width_m) {
  const cloud_list *list = own;
  pl_vec3f out = {1.0f, 1.0f, 1.0f};
  (void)media;
  for (size_t i = 0; i < list->count; i++) {
    const cloud_item *item = &list->items[i];
    meeting m;
    if (!meet(item, shot, point, pl_vec3f_to_double(sun->direction), &m))
      continue;
    const bool below = !(m.t[0] > 0.0);
    for (int k = 0; k < 2; k++) {
      if (!(m.t[k] > 0.0 && m.t[k] < (double)sun->distance_m))
        continue;
      place at;
      const float disc_m = 2.0f * sun->sin_radius * (float)m.t[k];
      find_place(item, &m, m.t[k], width_m + disc_m, 0, &at);
      out = pl_vec3f_scale(out, passed_at(&at, below));
    }
  }
  return out;
}

/* Crossings of the shell that wait for their cover, which costs less for several together. */
typedef struct waiting {
  size_t count;
  place places[PL_LANES];
  pl_cloud_spot spots[PL_LANES];
  float *passed[PL_LANES]; /* transmittance of the ray */
} waiting;

static void pass_waiting(const cloud_item *item, waiting *w) {
  pl_cloud_place seen[PL_LANES];
  pl_cloud_places(&item->cover, w->spots, w->count, 0, seen);
  for (size_t i = 0; i < w->count; i++) {
    set_cover(&seen[i], &w->places[i]);
    *w->passed[i] *= passed_at(&w->places[i], false);
  }
  w->count = 0;
}

/* Lets a ray through both crossings of a shell, straight on. */
static void pass_item(const cloud_item *item, const pl_snapshot *shot, const pl_cloud_rays *rays,
                      size_t ray, waiting *w, float *passed) {
  meeting m;
  if (!meet(item, shot, (pl_vec3){0.0, 0.0, 0.0}, rays->directions[ray], &m))
    return;
  for (int k = 0; k < 2; k++) {
    if (!(m.t[k] > 0.0 && m.t[k] < rays->t_max[ray]))
      continue;
    w->passed[w->count] = passed;
    w->spots[w->count] =
        meet_shell(item, &m, m.t[k], (float)(m.t[k] * (double)rays->spread), &w->places[w->count]);
    if (++w->count == PL_LANES)
      pass_waiting(item, w);
  }
}

void pl_cloud_pass(const pl_snapshot *shot, const pl_cloud_rays *rays, float *transmittance) {
  waiting w;
  w.count = 0;
  for (uint32_t i = 0; i < shot->body_count; i++) {
    const pl_clouds *clouds = &shot->bodies[i].state->clouds;
    if (!(clouds->altitude_m > 0.0))
      continue;
    const cloud_item item = item_of(shot, i, (int)ceilf(clouds->octaves));
    for (size_t k = 0; k < rays->count; k++)
      pass_item(&item, shot, rays, k, &w, &transmittance[k]);
    if (w.count > 0)
      pass_waiting(&item, &w);
  }
}

const pl_medium_kind pl_medium_clouds = {
    .effect = &pl_effect_clouds,
    .build = build,
    .in_cone = in_cone,
    .cross = cross,
    .toward_sun = toward_sun,
    .before_sky = true,
    .filtered = true,
};
