/* Pixels whose colour needs no sampling: the middle of a body, away from terminator and shadow. A
 * Lambert surface under a sun that is wholly above (or below) the horizon has a closed form, a
 * photometric law away from opposition all but one, and the map is filtered over the pixel's
 * footprint, so one shading is the pixel's mean. */
#include "light/sun.h"
#include "render/laws.h"
#include "render/path.h"
#include "shade/water.h"

/* The whole disc clears the horizon when the sun is higher than its radius; the rest allows for
 * the change of the normal across a pixel. */
static const float HORIZON_MARGIN = 3.0f;
/* Towards the limb a pixel's footprint grows until one value is no mean any more: the view must be
 * this steep, and the footprint this short against the body's radius. */
static const float COSINE_MIN = 0.15f, ARC_MAX_RAD = 0.01f;

/* Whether a sphere, widened by `margin_m`, covers part of the sun's disc as seen from a point. */
static bool overlaps_sun(pl_vec3 center, double radius_m, double margin_m, pl_vec3 point,
                         const pl_sun_view *sun) {
  const pl_vec3 to_center = pl_vec3_sub(center, point);
  const double distance = pl_vec3_norm(to_center), reach = radius_m + margin_m;
  if (distance <= reach)
    return true;
  const pl_vec3 toward = pl_vec3f_to_double(sun->direction);
  const double angle =
      atan2(pl_vec3_norm(pl_vec3_cross(to_center, toward)), pl_vec3_dot(to_center, toward));
  return angle < asin(reach / distance) + asin(fmin(1.0, (double)sun->sin_radius));
}

/* Whether a shadow's edge or inside may come near a point of a body. */
static bool near_shadow(const pl_snapshot *shot, const pl_vertex *vertex, const pl_sun_view *sun,
                        double margin_m) {
  const pl_vec3 p = vertex->position;
  for (size_t i = 0; i < shot->object_count; i++)
    if (overlaps_sun(shot->objects[i].center, shot->objects[i].radius_m, margin_m, p, sun))
      return true;
  for (size_t i = 0; i < shot->body_count; i++)
    if (vertex->thing != shot->object_count + i &&
        overlaps_sun(shot->bodies[i].center, shot->bodies[i].radius_m, margin_m, p, sun))
      return true;
  return false;
}

/* Whether a volume may shade a part of the pixel. */
static bool near_volume(const pl_path_context *context, const pl_vertex *vertex,
                        const pl_sun_view *sun, double margin_m) {
  const pl_snapshot *shot = context->shot;
  for (size_t i = 0; context->settings->veils != NULL && i < shot->volume_count; i++)
    if (overlaps_sun(shot->volumes[i].center, shot->volumes[i].radius_m, margin_m, vertex->position,
                     sun))
      return true;
  return false;
}

/* Whether the body is a Lambert surface whose map alone varies. The colours of a graph that varies
 * are at best functions of filtered patterns, whose value at the centre is not the pixel's mean. */
static bool is_plain(const pl_body *body) {
  if (body->graph == NULL)
    return body->reflectance == &pl_reflectance_lambert;
  return pl_graph_reflectance(body->graph) == &pl_reflectance_lambert &&
         pl_graph_is_uniform(body->graph);
}

/* Whether the body follows a photometric law that hardly bends over the sun's disc here. What the
 * surges, sharp as they may be, and the lobes of b up to 0.6 change by taking the disc for its
 * centre is rho^2/8 of their second derivative, at most rho^2/(4 g^2): 3e-4 at this angle for the
 * sun at 1 AU. */
static const float PHASE_MIN_RAD = 0.15f;
static bool is_calm(const pl_body *body, pl_vec3f toward, const pl_sun_view *sun) {
  if (body->graph != NULL || !body->reflectance->photometric || sun->sin_radius > 0.01f)
    return false;
  const float cosine = -pl_vec3f_dot(toward, sun->direction); /* of the phase angle */
  return fabsf(cosine) < cosf(PHASE_MIN_RAD);
}

/* What the shaded body sends on of the sun's light, W m-2 sr-1. */
static pl_vec3f reflected(const pl_surface *s, pl_vec3f toward, const pl_sun_view *sun,
                          float height) {
  if (s->reflectance == &pl_reflectance_lambert)
    return pl_vec3f_scale(s->color, (height > 0.0f ? height * sun->irradiance : 0.0f) / PL_PI_F);
  if (!(height > 0.0f))
    return (pl_vec3f){0.0f, 0.0f, 0.0f};
  const pl_vec3f wo = pl_surface_to_local(s, pl_vec3f_scale(toward, -1.0f));
  const pl_vec3f wi = pl_surface_to_local(s, sun->direction);
  return pl_vec3f_scale(s->reflectance->evaluate(s, wo, wi), sun->irradiance);
}

/* Relief and water change within a pixel. The slopes that it hides turn none of it away from a sun
 * that is so high over them; and over waves of at least the calm sea's slopes the disc of a small
 * sun counts as its centre: by rho^2/(2 alpha^2), 4e-3 of the glint for the sun at 1 AU. */
static const float HEIGHT_OVER_RELIEF = 0.3f, WAVES_MIN = 0.05f;
static bool is_even(const pl_surface *s, const pl_sun_view *sun, float height) {
  if (s->reflectance == &pl_reflectance_water &&
      !(s->alpha > WAVES_MIN && sun->sin_radius < 0.1f * s->alpha))
    return false;
  const bool bent = pl_vec3f_dot(s->n, s->ng) < 1.0f - 1e-6f;
  return !bent || height < 0.0f ||
         (height > HEIGHT_OVER_RELIEF && pl_vec3f_dot(sun->direction, s->n) > HEIGHT_OVER_RELIEF);
}

/* Radiance of the body at the pixel's centre for the pixel as a whole; false if it must be sampled.
 */
static bool settle_pixel(const pl_path_context *context, uint32_t pixel, pl_tile_buffers *b) {
  const pl_snapshot *shot = context->shot;
  pl_vertex vertex = b->points[pixel];
  if (vertex.thing == PL_NOTHING || vertex.thing < shot->object_count)
    return false;
  const pl_shot_body *body = &shot->bodies[vertex.thing - shot->object_count];
  const pl_render_settings *settings = context->settings;
  const bool plain = is_plain(body->body);
  if ((body->dot && !settings->see_dots) || !context->sharp || context->veils ||
      (!plain && !body->body->reflectance->photometric) || settings->emitters_on_bodies ||
      (settings->body_bounces && body->bounced && (!context->pools || settings->air != NULL)))
    return false;
  const pl_vec3f toward = pl_vec3_to_float(pl_vec3_unit(vertex.position));
  const float cosine = fabsf(pl_vec3f_dot(toward, vertex.ng));
  const double footprint_m = vertex.t * context->pixel_rad / pl_maxf(cosine, COSINE_MIN);
  const pl_vec3 radii = body->state->radii_m;
  if (cosine < COSINE_MIN || footprint_m > ARC_MAX_RAD * fmin(radii.x, fmin(radii.y, radii.z)))
    return false;
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, vertex.position);
  const float height = pl_vec3f_dot(sun.direction, vertex.ng);
  if (!plain && !is_calm(body->body, toward, &sun))
    return false;
  if (fabsf(height) < HORIZON_MARGIN * sun.sin_radius ||
      (settings->cast_shadows && body->shadowed && near_shadow(shot, &vertex, &sun, footprint_m)) ||
      near_volume(context, &vertex, &sun, footprint_m))
    return false;
  const pl_beam beam = {
      .direction = pl_vec3_unit(vertex.position),
      .spread = (float)context->pixel_rad,
  };
  pl_vertex_shade(shot, &beam, settings->detail, &vertex);
  pl_laws_apply(shot, settings, &vertex);
  if (!is_even(&vertex.surface, &sun, height))
    return false;
  const float over = height > 0.0f ? pl_vec3f_dot(sun.direction, vertex.surface.n) : height;
  b->settled[pixel] = reflected(&vertex.surface, toward, &sun, over);
  if (settings->veils != NULL)
    b->settled[pixel] =
        pl_vec3f_mul(b->settled[pixel], pl_veils_toward_sun(settings->veils, shot, vertex.position,
                                                            &sun, (float)footprint_m));
  if (settings->air != NULL)
    b->settled[pixel] = pl_air_ground_light(context, pixel, &vertex, b->settled[pixel], b);
  if (settings->emission)
    b->settled[pixel] = pl_vec3f_add(b->settled[pixel], vertex.surface.emission);
  if (settings->air != NULL)
    b->settled[pixel] = pl_air_seen(context, pixel, b->settled[pixel], b);
  return true;
}

/* Whether the corners of each pixel lie on the tile's only body: its outline is convex, so the
 * pixel does too. */
static void cover_pixels(const pl_path_context *context, bool covered[PL_TILE_PIXELS]) {
  enum { CORNERS = PL_TILE_SIDE + 1 };
  pl_ray ray = {.t_max = INFINITY, .skip_body = PL_NOTHING};
  bool corner[CORNERS][CORNERS];
  for (int y = 0; y <= context->tile.height; y++)
    for (int x = 0; x <= context->tile.width; x++) {
      pl_hit hit;
      ray.direction = pl_vec3_to_float(
          pl_snapshot_ray(context->shot, context->tile.x0 + x - 0.5, context->tile.y0 + y - 0.5));
      pl_tracer_closest(context->tracer, &ray, &hit, 1, false, false);
      corner[y][x] = hit.thing != PL_NOTHING;
    }
  for (int y = 0; y < context->tile.height; y++)
    for (int x = 0; x < context->tile.width; x++)
      covered[y * PL_TILE_SIDE + x] =
          corner[y][x] && corner[y][x + 1] && corner[y + 1][x] && corner[y + 1][x + 1];
}

static bool is_lit_by_others(const pl_path_context *context, uint32_t thing) {
  const pl_snapshot *shot = context->shot;
  return context->settings->body_bounces && shot->bodies[thing - shot->object_count].bounced;
}

/* How a pixel outside the meshes' reach is dealt with: true when its radiance is known. */
static bool finish_pixel(const pl_path_context *context, uint32_t pixel, bool covered,
                         pl_tile_buffers *b) {
  const bool empty = !context->bodies && !context->sun && !context->air && !context->veils;
  const pl_vec3f nothing = {0.0f, 0.0f, 0.0f};
  const pl_vec3f behind = context->settings->backdrop != NULL ? b->backdrop[pixel] : nothing;
  if (context->air && !context->veils &&
      pl_air_alone(context, pixel, behind, &b->radiance[pixel], b)) {
    b->counts[pixel] = 1;
    return true;
  }
  const uint32_t thing = b->settled_thing[pixel];
  const bool settled = covered && thing != PL_NOTHING;
  b->single[pixel] = settled && is_lit_by_others(context, thing);
  if (!empty && (!settled || b->single[pixel]))
    return false;
  b->counts[pixel] = 1;
  b->radiance[pixel] = empty ? behind : b->settled[pixel];
  return true;
}

static void reset_pixel(uint32_t pixel, pl_tile_buffers *b) {
  b->counts[pixel] = 0;
  b->single[pixel] = false;
  b->square[pixel] = 0.0f;
  b->sample[pixel] = b->shared[pixel] = (pl_vec3f){0.0f, 0.0f, 0.0f};
  b->patches[pixel].count = 0;
}

/* Appends a pixel to the active ones; those that may see a mesh stay in front. */
static void activate(uint32_t pixel, bool mesh, pl_tile_buffers *b) {
  b->active[b->active_count++] = pixel;
  if (!mesh)
    return;
  b->active[b->active_count - 1] = b->active[b->active_meshes];
  b->active[b->active_meshes++] = pixel;
}

void pl_path_settle(const pl_path_context *context, pl_tile_buffers *b) {
  /* Of slices with few of the pixels it is quicker to trace those than all corners. */
  const pl_slice *slice = context->settings->slice;
  const bool sparse = slice != NULL && slice->count > context->settings->samples;
  const bool one_body = context->body != PL_NOTHING && !context->sun && !sparse;
  bool covered[PL_TILE_PIXELS] = {false};
  if (one_body)
    cover_pixels(context, covered);
  b->active_count = b->active_meshes = 0;
  for (int y = 0; y < context->tile.height; y++) {
    for (int x = 0; x < context->tile.width; x++) {
      const uint32_t pixel = (uint32_t)(y * PL_TILE_SIDE + x);
      const bool mesh = pl_reach_pixel(context->reach, context->tile.x0 + x, context->tile.y0 + y);
      const bool settled = settle_pixel(context, pixel, b);
      b->settled_thing[pixel] = settled ? b->points[pixel].thing : PL_NOTHING;
      reset_pixel(pixel, b);
      if (mesh || !finish_pixel(context, pixel, covered[pixel], b))
        activate(pixel, mesh, b);
    }
  }
}
