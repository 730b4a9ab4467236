/* Casts one ray at each cell of a disc, shaded in closed form with the reflectance levels of detail
 * that paths use. */
#include "render/body_radiance.h"

#include "geom/ellipsoid.h"
#include "math/color.h"
#include "render/air_path.h"
#include "render/reflectance_lod.h"
#include "render/render.h"
#include "render/medium.h"
#include "shade/reflectance.h"
#include "trace/intersect.h"

/* Albedo of bodies that have a shape: their facets are not evaluated. */
static const float SHAPE = 0.2f;

static double meet(const pl_shot_body *body, const pl_beam *beam) {
  const pl_vec3 origin =
      pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, beam->origin));
  double t;
  const pl_vec3 direction = pl_mat3_mul_vec(body->to_unit, beam->direction);
  return pl_unit_sphere_intersect(origin, direction, 0.0, &t) ? t : INFINITY;
}

/* True if another body hides the point at distance t. The body in which the ray starts is ignored.
 */
static bool is_hidden(const pl_snapshot *shot, uint32_t body, const pl_beam *beam, double t) {
  const pl_ray ray = {
      .origin = beam->origin, .direction = beam->direction, .t_max = t, .skip_body = body};
  size_t k = 0;
  for (uint32_t i; (i = pl_next_body(shot, &ray, t, &k)) != PL_NO_BODY;) {
    const pl_shot_body *other = &shot->bodies[i];
    const double apart = pl_vec3_norm(pl_vec3_sub(other->center, beam->origin));
    if (apart > other->radius_m && meet(other, beam) < t)
      return true;
  }
  return false;
}

static pl_vec3f ground_light(const pl_snapshot *shot, const pl_render_settings *settings,
                             const pl_media *media, uint32_t body, const pl_beam *beam, double t) {
  const pl_shot_body *own = &shot->bodies[body];
  const pl_hit hit = {.surface_id = pl_surface_of_body(body), .t = (float)t};
  pl_vertex vertex;
  pl_vertex_locate(shot, beam, &hit, false, &vertex);
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, vertex.position);
  const float width_m = pl_beam_width(beam, t), height = pl_vec3f_dot(vertex.ng, sun.direction);
  const pl_vec3f lit = pl_media_sunlight(media, NULL, shot, vertex.position, &sun, width_m);
  if (own->shape != NULL)
    return pl_vec3f_scale(lit, SHAPE / PL_PI_F * pl_maxf(height, 0.0f));
  pl_vertex_shade(shot, beam, settings->detail, &vertex);
  pl_reflectance_lod_apply(shot, settings, &vertex);
  const pl_surface *s = &vertex.surface;
  const pl_vec3f wo =
      pl_surface_to_local(s, pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0)));
  pl_vec3f out = {0.0f, 0.0f, 0.0f};
  if (pl_surface_admits(s, sun.direction))
    out = pl_vec3f_mul(lit, s->reflectance->evaluate(s, wo, pl_surface_to_local(s, sun.direction)));
  if (settings->air == NULL)
    return out;
  const pl_vec3f sky = pl_air_sky_reflected(settings->air, shot, &vertex, wo, false);
  return pl_vec3f_add(out, pl_media_dim_sky(media, shot, &vertex, width_m, sky));
}

/* Adds scattering and attenuation by the body's own air. */
static pl_vec3f through_air(const pl_snapshot *shot, const pl_air_view *air, uint32_t body,
                            const pl_beam *beam, pl_vec3f behind) {
  for (size_t i = 0; air != NULL && i < air->count; i++) {
    const pl_air_item *item = &air->items[i];
    pl_air_ray ray;
    if (item->body != body ||
        !pl_air_item_ray(item, shot, beam->origin, beam->direction, INFINITY, &ray))
      continue;
    ray.to_ground = false; /* the body stands for its ground as a smooth one */
    const pl_air_light light =
        pl_air_scatter(item->air, &ray, &item->sun, &air->rule, air->multiple);
    behind =
        pl_vec3f_madd(pl_vec3f_mul(behind, light.transmitted), item->irradiance, light.scattered);
  }
  return behind;
}

static float look(const pl_snapshot *shot, const pl_render_settings *settings, uint32_t body,
                  const pl_beam *beam) {
  const pl_media none = {.air = settings->air, .subpixel = PL_NO_BODY};
  const pl_media *media = settings->media != NULL ? settings->media : &none;
  const double t = meet(&shot->bodies[body], beam);
  pl_vec3f light = {0.0f, 0.0f, 0.0f};
  pl_medium_list list;
  if (is_hidden(shot, body, beam, t))
    return 0.0f;
  if (t < INFINITY)
    light = ground_light(shot, settings, media, body, beam, t);
  const pl_medium_ray ray = {.beam = beam, .t_max = t, .from_body = PL_NO_BODY};
  pl_media_cross(media, shot, &ray, &list);
  light = through_air(shot, settings->air, body, beam, pl_media_seen(&list, light));
  const float out = pl_luminance(light);
  return out > 0.0f && isfinite(out) ? out : 0.0f;
}

/* Sums over the cells. */
typedef struct sums {
  double light, square, x, y; /* weighted by solid angle */
} sums;

static void add_cell(const pl_body_disc *disc, const pl_disc_table *table, int turn, int ring,
                     double light, sums *sums) {
  const double from = (double)table->edge[ring], to = (double)table->edge[ring + 1];
  const double part = 0.5 * (from + to), turn_rad = 2.0 * PL_PI * (turn + 0.5) / PL_DISC_TURNS;
  double even;
  pl_disc_direction(disc, part, turn_rad, &even);
  const double angle = (to - from) / PL_DISC_TURNS / even;
  sums->light += light * angle;
  sums->square += light * light * angle;
  sums->x += sqrt(part) * cos(turn_rad) * light * angle;
  sums->y += sqrt(part) * sin(turn_rad) * light * angle;
}

bool pl_body_radiance_make(const pl_snapshot *shot, const pl_render_settings *settings,
                           uint32_t body, pl_vec3 sun, pl_vec3 point, pl_body_radiance *out) {
  pl_body_disc disc;
  float light[PL_DISC_TURNS][PL_DISC_RINGS];
  sums sums = {0};
  if (!pl_body_disc_make(&shot->bodies[body], sun, point, &disc))
    return false;
  *out = (pl_body_radiance){.body = body, .point = point, .most = disc.most};
  pl_disc_rings(&disc, &out->table);
  for (int k = 0; k < PL_DISC_TURNS; k++)
    for (int j = 0; j < PL_DISC_RINGS; j++) {
      const double wide = (double)(out->table.edge[j + 1] - out->table.edge[j]) / PL_DISC_TURNS;
      const pl_beam beam = {.origin = point,
                            .direction = pl_disc_middle(&disc, &out->table, k, j),
                            .spread = (float)sqrt(2.0 * PL_PI * disc.most * wide)};
      light[k][j] = look(shot, settings, body, &beam);
      add_cell(&disc, &out->table, k, j, (double)light[k][j], &sums);
    }
  if (!(sums.light > 0.0))
    return false;
  pl_disc_table_fill(light, &out->table);
  const double x = sums.x / sums.light, y = sums.y / sums.light;
  out->irradiance = (float)sums.light;
  out->wide_sr = (float)(sums.light * sums.light / sums.square);
  out->part = x * x + y * y;
  out->turn_rad = atan2(y, x);
  return true;
}
