/* Air in the pixels of a tile, where it varies smoothly. It is evaluated at nine pixel corners of a
 * square and interpolated to second order in between. A square in which test points disagree with
 * the interpolation is divided into four, down to single pixels, each of which gets its mean. If
 * that is not accurate either, the air is evaluated for each sample. */
#include <string.h>

#include "math/color.h"
#include "render/air_path.h"
#include "render/path.h"

enum { WHOLE = 16, LEAST = 4 };  /* sides of squares, in pixels */
static const float SHARE = 0.5f; /* largest error, as a part of the noise that samples may leave */
/* Factor by which the mean of a pixel's corners may be off at its centre. Their mean by Simpson's
 * rule is then off by at most a fortieth of this difference, if the density falls by e^3 across the
 * pixel. */
static const float SIMPSON = 10.0f;
/* Errors of the reflected light are weighed against the darkest level that the ground may have:
 * that of this albedo. */
static const float DARK = 0.05f;

typedef struct square {
  const pl_path_context *context;
  pl_tile_buffers *b;
  int x, y, side; /* in pixels of the tile */
} square;

/* Point where a descending ray meets the ground, in the body's scaled axes; false if it does not.
 */
static bool meet_ground(const pl_air_ray *ray, pl_vec3 *point) {
  const double along = pl_vec3_dot(ray->origin, ray->direction);
  const pl_vec3 lowest = pl_vec3_madd(ray->origin, -along, ray->direction);
  const double low = pl_vec3_dot(lowest, lowest) - 1.0;
  if (along >= 0.0 || low >= 0.0)
    return false;
  *point = pl_vec3_madd(lowest, -sqrt(-low), ray->direction);
  return true;
}

static void work_out(const pl_path_context *context, const pl_air_item *item, double x, double y,
                     pl_air_corner *out) {
  const pl_air_view *view = context->settings->air;
  const pl_vec3 direction =
      pl_snapshot_ray(context->shot, context->tile.x0 + x - 0.5, context->tile.y0 + y - 0.5);
  pl_air_ray ray;
  pl_vec3 point;
  out->known = PL_AIR_SPACE;
  out->air = (pl_air_pixel){.light = {{0.0f, 0.0f, 0.0f}, {1.0f, 1.0f, 1.0f}}};
  if (!pl_air_item_ray(item, context->shot, (pl_vec3){0.0, 0.0, 0.0}, direction, INFINITY, &ray))
    return;
  ray.to_ground = false; /* what is stored is for rays that meet the surface, or space */
  out->air.light = pl_air_scatter(item->air, &ray, &item->sun, &view->rule, view->multiple);
  if (!meet_ground(&ray, &point))
    return;
  out->known = PL_AIR_GROUND;
  out->air.sunlight =
      pl_air_transmittance(item->air, point, item->sun.direction, item->sun.stretch);
  out->air.skylight =
      pl_air_skylight(item->air, pl_vec3_dot(point, item->sun.direction), view->multiple);
}

static const pl_air_corner *corner_at(const pl_path_context *context, pl_tile_buffers *b, int x,
                                      int y) {
  pl_air_corner *corner = &b->air->corners[y * PL_AIR_SIDE + x];
  if (corner->known == PL_AIR_UNKNOWN)
    work_out(context, b->air->item, x, y, corner);
  return corner;
}

/* Adds a value times its weight to the sum. */
static void add_weighted(const pl_air_pixel *value, float weight, pl_air_pixel *sum) {
  sum->light.scattered = pl_vec3f_madd(sum->light.scattered, weight, value->light.scattered);
  sum->light.transmitted = pl_vec3f_madd(sum->light.transmitted, weight, value->light.transmitted);
  sum->sunlight = pl_vec3f_madd(sum->sunlight, weight, value->sunlight);
  sum->skylight = pl_vec3f_madd(sum->skylight, weight, value->skylight);
}

enum { NODES = 9 };

/* Lagrange polynomials of second order on the nodes 0, 1/2, 1. */
static void parabolas(float x, float out[3]) {
  out[0] = (1.0f - x) * (1.0f - 2.0f * x);
  out[1] = 4.0f * x * (1.0f - x);
  out[2] = x * (2.0f * x - 1.0f);
}

/* Parabolas undershoot where a value falls to zero. */
static pl_vec3f not_negative(pl_vec3f v) {
  return pl_vec3f_make(pl_maxf(v.x, 0.0f), pl_maxf(v.y, 0.0f), pl_maxf(v.z, 0.0f));
}

/* Interpolates at (u, v) of the square, each 0..1. */
static pl_air_pixel mix(const pl_air_corner *const nodes[NODES], float u, float v) {
  float across[3], down[3];
  pl_air_pixel sum = {0};
  parabolas(u, across);
  parabolas(v, down);
  for (int i = 0; i < NODES; i++)
    add_weighted(&nodes[i]->air, across[i % 3] * down[i / 3], &sum);
  sum.light.scattered = not_negative(sum.light.scattered);
  sum.light.transmitted = not_negative(sum.light.transmitted);
  sum.sunlight = not_negative(sum.sunlight);
  sum.skylight = not_negative(sum.skylight);
  return sum;
}

/* Radiance of a white ground under the air, over the sun's irradiance. The sun is taken to be
 * overhead, which overestimates the radiance and so the errors. */
static pl_vec3f white_ground(const pl_air_pixel *air) {
  return pl_vec3f_scale(
      pl_vec3f_mul(air->light.transmitted, pl_vec3f_add(air->sunlight, air->skylight)),
      1.0f / PL_PI_F);
}

static float encode(float value) { return pl_srgb_encode(pl_minf(pl_maxf(value, 0.0f), 1.0f)); }

/* Error of an interpolated value, in digital numbers. `white` is the irradiance over the radiance
 * displayed as white. */
static float off_under(float white, const pl_air_pixel *said, const pl_air_pixel *is) {
  const pl_vec3f a = white_ground(said), b = white_ground(is);
  const float gray[2][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}};
  const pl_vec3f s = said->light.scattered, t = is->light.scattered;
  const float haze[2][3] = {{s.x, s.y, s.z}, {t.x, t.y, t.z}};
  float worst = 0.0f;
  for (int k = 0; k < 3; k++) {
    const float level = haze[1][k] + DARK * gray[1][k];
    const float error = fabsf(haze[0][k] - haze[1][k]) + fabsf(gray[0][k] - gray[1][k]);
    const float shown = encode(white * level);
    worst = pl_maxf(worst, encode(white * (level + error)) - shown);
    /* An error above white is clipped, but the value may also be underestimated, down to black. */
    if (white * (level + error) > 1.0f)
      worst = pl_maxf(worst, shown - encode(white * (level - error)));
  }
  return 255.0f * worst;
}

static float off_dn(const pl_render_settings *settings, float irradiance, const pl_air_pixel *said,
                    const pl_air_pixel *is) {
  const float other = settings->white_other;
  const float worst = off_under(irradiance / settings->white_radiance, said, is);
  return other > 0.0f ? pl_maxf(worst, off_under(irradiance / other, said, is)) : worst;
}

/* True if only black space can be behind the square's air. */
static bool is_clear(const square *s) {
  pl_vec3 axis;
  double half_angle;
  const pl_tile *tile = &s->context->tile;
  const double rect[4] = {tile->x0 + s->x - 0.5, tile->y0 + s->y - 0.5,
                          tile->x0 + s->x + s->side - 0.5, tile->y0 + s->y + s->side - 0.5};
  const pl_shot_body *body = &s->context->shot->bodies[s->b->air->item->body];
  pl_snapshot_cone(s->context->shot, rect, &axis, &half_angle);
  return !pl_sphere_in_cone(body->center, body->radius_m, axis, half_angle);
}

static float fraction_of(const square *s, const pl_air_pixel *said, const pl_air_pixel *is) {
  const pl_render_settings *settings = s->context->settings;
  return off_dn(settings, s->b->air->item->irradiance, said, is) / (SHARE * settings->noise_dn);
}

/* True if the interpolation from the nodes is accurate a quarter of the way along the diagonals. */
static bool is_even(const square *s, const pl_air_corner *const nodes[NODES]) {
  for (int i = 1; i < NODES; i++)
    if (nodes[i]->known != nodes[0]->known)
      return false;
  if (nodes[0]->known == PL_AIR_SPACE && !is_clear(s))
    return false;
  for (int i = 0; i < 4; i++) {
    const int x = i & 1 ? 3 : 1, y = i >> 1 ? 3 : 1;
    const pl_air_corner *is =
        corner_at(s->context, s->b, s->x + x * s->side / 4, s->y + y * s->side / 4);
    const pl_air_pixel said = mix(nodes, 0.25f * (float)x, 0.25f * (float)y);
    if (is->known != nodes[0]->known || fraction_of(s, &said, &is->air) > 1.0f)
      return false;
  }
  return true;
}

static void fill(const square *s, const pl_air_corner *const nodes[NODES]) {
  const float step = 1.0f / (float)s->side;
  for (int y = 0; y < s->side && s->y + y < s->context->tile.height; y++)
    for (int x = 0; x < s->side && s->x + x < s->context->tile.width; x++) {
      const int pixel = (s->y + y) * PL_TILE_SIDE + s->x + x;
      s->b->air->known[pixel] = (uint8_t)nodes[0]->known;
      s->b->air->pixels[pixel] = mix(nodes, ((float)x + 0.5f) * step, ((float)y + 0.5f) * step);
    }
}

/* Stores the mean over a pixel, from its corners and its centre. */
static void take_pixel(const square *s) {
  pl_air_corner middle;
  pl_air_pixel around = {0}, mean = {0};
  if (s->x >= s->context->tile.width || s->y >= s->context->tile.height)
    return;
  work_out(s->context, s->b->air->item, s->x + 0.5, s->y + 0.5, &middle);
  for (int i = 0; i < 4; i++) {
    const pl_air_corner *corner = corner_at(s->context, s->b, s->x + (i & 1), s->y + (i >> 1));
    if (corner->known != middle.known)
      return;
    add_weighted(&corner->air, 0.25f, &around);
  }
  if ((middle.known == PL_AIR_SPACE && !is_clear(s)) ||
      fraction_of(s, &around, &middle.air) > SIMPSON)
    return;
  add_weighted(&around, 1.0f / 3.0f, &mean);
  add_weighted(&middle.air, 2.0f / 3.0f, &mean);
  s->b->air->known[s->y * PL_TILE_SIDE + s->x] = (uint8_t)middle.known;
  s->b->air->pixels[s->y * PL_TILE_SIDE + s->x] = mean;
}

static void take_square(const square *s) {
  if (s->x >= s->context->tile.width || s->y >= s->context->tile.height)
    return;
  const int half = s->side / 2;
  const pl_air_corner *nodes[NODES];
  for (int i = 0; i < NODES; i++)
    nodes[i] = corner_at(s->context, s->b, s->x + i % 3 * half, s->y + i / 3 * half);
  if (is_even(s, nodes)) {
    fill(s, nodes);
    return;
  }
  const int side = s->side > LEAST ? half : 1;
  for (int y = 0; y < s->side; y += side)
    for (int x = 0; x < s->side; x += side) {
      const square part = {s->context, s->b, s->x + x, s->y + y, side};
      if (side == 1)
        take_pixel(&part);
      else
        take_square(&part);
    }
}

/* The only atmosphere in the tile, if no other body may be in it; otherwise NULL. */
static const pl_air_item *only_item(const pl_path_context *context, bool *any) {
  const pl_air_view *view = context->settings->air;
  const pl_snapshot *shot = context->shot;
  const pl_tile *tile = &context->tile;
  const double rect[4] = {tile->x0 - 0.5, tile->y0 - 0.5, tile->x0 + tile->width - 0.5,
                          tile->y0 + tile->height - 0.5};
  const pl_air_item *found = NULL;
  size_t airs = 0, bodies = 0;
  pl_vec3 axis;
  double half_angle;
  pl_snapshot_cone(shot, rect, &axis, &half_angle);
  for (size_t i = 0; i < view->count; i++) {
    const pl_air_item *item = &view->items[i];
    if (!pl_snapshot_sees(shot, shot->bodies[item->body].center, item->reach_m, axis, half_angle))
      continue;
    airs++;
    found = item;
  }
  *any = airs > 0;
  for (size_t i = 0; found != NULL && i < shot->body_count; i++)
    bodies += i != found->body && pl_snapshot_sees(shot, shot->bodies[i].center,
                                                   shot->bodies[i].radius_m, axis, half_angle);
  return airs == 1 && bodies == 0 ? found : NULL;
}

void pl_air_prepare(const pl_path_context *context, pl_tile_buffers *b) {
  memset(b->air->known, 0, sizeof b->air->known);
  if (context->media) {
    memset(b->air->medium_t, 0, sizeof b->air->medium_t);
    memset(b->air->blocks, 0, sizeof b->air->blocks);
  }
  b->air->item = only_item(context, &b->air->any);
  if (b->air->item == NULL || !context->sharp || !(context->settings->noise_dn > 0.0f))
    return;
  for (int i = 0; i < PL_AIR_SIDE * PL_AIR_SIDE; i++)
    b->air->corners[i].known = PL_AIR_UNKNOWN;
  for (int y = 0; y < context->tile.height; y += WHOLE)
    for (int x = 0; x < context->tile.width; x += WHOLE) {
      const square whole = {context, b, x, y, WHOLE};
      take_square(&whole);
    }
}
