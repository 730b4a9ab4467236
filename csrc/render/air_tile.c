/* The air of a tile's pixels, where it changes evenly: worked out at corners of squares of pixels.
 * A square whose middle is not what its corners say is cut in four; what is left of two pixels a
 * side is up to each sample. */
#include <string.h>

#include "math/color.h"
#include "render/air_path.h"
#include "render/path.h"

enum { WHOLE = 8 };               /* pixels a side of the largest squares */
static const float SHARE = 0.25f; /* of the noise that samples may leave */
/* Errors of what the ground sends count beside the least that it may send: of this albedo. */
static const float DARK = 0.05f;

typedef struct square {
  const pl_path_context *context;
  pl_tile_buffers *b;
  int x, y, side; /* pixels in the tile */
} square;

/* Where a ray that comes down meets the ground, in the body's scaled axes; false if it does not. */
static bool meet_ground(const pl_air_ray *ray, pl_vec3 *point) {
  const double along = pl_vec3_dot(ray->origin, ray->direction);
  const pl_vec3 lowest = pl_vec3_madd(ray->origin, -along, ray->direction);
  const double low = pl_vec3_dot(lowest, lowest) - 1.0;
  if (along >= 0.0 || low >= 0.0)
    return false;
  *point = pl_vec3_madd(lowest, -sqrt(-low), ray->direction);
  return true;
}

static void work_out(const pl_path_context *context, const pl_air_item *item, int x, int y,
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
  pl_air_corner *corner = &b->air.corners[y * PL_AIR_SIDE + x];
  if (corner->known == PL_AIR_UNKNOWN)
    work_out(context, b->air.item, x, y, corner);
  return corner;
}

static pl_vec3f weighted(const pl_vec3f v[4], const float w[4]) {
  pl_vec3f sum = pl_vec3f_scale(v[0], w[0]);
  for (int i = 1; i < 4; i++)
    sum = pl_vec3f_madd(sum, w[i], v[i]);
  return sum;
}

static pl_air_pixel mix(const pl_air_corner *const c[4], float u, float v) {
  const float w[4] = {(1.0f - u) * (1.0f - v), u * (1.0f - v), (1.0f - u) * v, u * v};
  pl_vec3f values[4][4];
  for (int i = 0; i < 4; i++) {
    values[0][i] = c[i]->air.light.scattered;
    values[1][i] = c[i]->air.light.transmitted;
    values[2][i] = c[i]->air.sunlight;
    values[3][i] = c[i]->air.skylight;
  }
  return (pl_air_pixel){{weighted(values[0], w), weighted(values[1], w)},
                        weighted(values[2], w),
                        weighted(values[3], w)};
}

/* Radiance of a white ground under the air, over the sun's irradiance: with the sun overhead, which
 * is more than it is, so that errors count for more. */
static pl_vec3f white_ground(const pl_air_pixel *air) {
  return pl_vec3f_scale(
      pl_vec3f_mul(air->light.transmitted, pl_vec3f_add(air->sunlight, air->skylight)),
      1.0f / PL_PI_F);
}

static float encode(float value) { return pl_srgb_encode(pl_minf(pl_maxf(value, 0.0f), 1.0f)); }

/* Digital numbers between what the corners say of the middle and what is there. */
static float off_dn(const pl_render_settings *settings, float irradiance, const pl_air_pixel *said,
                    const pl_air_pixel *is) {
  const pl_vec3f a = white_ground(said), b = white_ground(is);
  const float gray[2][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}};
  const pl_vec3f s = said->light.scattered, t = is->light.scattered;
  const float haze[2][3] = {{s.x, s.y, s.z}, {t.x, t.y, t.z}};
  const float white = irradiance / settings->white_radiance;
  float worst = 0.0f;
  for (int k = 0; k < 3; k++) {
    const float level = haze[1][k] + DARK * gray[1][k];
    const float error = fabsf(haze[0][k] - haze[1][k]) + fabsf(gray[0][k] - gray[1][k]);
    worst = pl_maxf(worst, encode(white * (level + error)) - encode(white * level));
  }
  return 255.0f * worst;
}

/* Whether nothing but the black of space can be behind the square's air. */
static bool is_clear(const square *s) {
  pl_vec3 axis;
  double half_angle;
  const pl_tile *tile = &s->context->tile;
  const double rect[4] = {tile->x0 + s->x - 0.5, tile->y0 + s->y - 0.5,
                          tile->x0 + s->x + s->side - 0.5, tile->y0 + s->y + s->side - 0.5};
  const pl_shot_body *body = &s->context->shot->bodies[s->b->air.item->body];
  pl_snapshot_cone(s->context->shot, rect, &axis, &half_angle);
  return !pl_sphere_in_cone(body->center, body->radius_m, axis, half_angle);
}

static bool is_even(const square *s, const pl_air_corner *const c[4]) {
  const pl_air_corner *middle = corner_at(s->context, s->b, s->x + s->side / 2, s->y + s->side / 2);
  for (int i = 0; i < 4; i++)
    if (c[i]->known != middle->known)
      return false;
  if (middle->known == PL_AIR_SPACE && !is_clear(s))
    return false;
  const pl_air_pixel said = mix(c, 0.5f, 0.5f);
  return off_dn(s->context->settings, s->b->air.item->irradiance, &said, &middle->air) <=
         SHARE * s->context->settings->noise_dn;
}

static void fill(const square *s, const pl_air_corner *const c[4]) {
  const float step = 1.0f / (float)s->side;
  for (int y = 0; y < s->side && s->y + y < s->context->tile.height; y++)
    for (int x = 0; x < s->side && s->x + x < s->context->tile.width; x++) {
      const int pixel = (s->y + y) * PL_TILE_SIDE + s->x + x;
      s->b->air.known[pixel] = (uint8_t)c[0]->known;
      s->b->air.pixels[pixel] = mix(c, ((float)x + 0.5f) * step, ((float)y + 0.5f) * step);
    }
}

static void take_square(const square *s) {
  if (s->x >= s->context->tile.width || s->y >= s->context->tile.height)
    return;
  const pl_air_corner *c[4];
  for (int i = 0; i < 4; i++)
    c[i] = corner_at(s->context, s->b, s->x + (i & 1) * s->side, s->y + (i >> 1) * s->side);
  if (is_even(s, c)) {
    fill(s, c);
    return;
  }
  for (int i = 0; s->side > 2 && i < 4; i++) {
    const int half = s->side / 2;
    const square part = {s->context, s->b, s->x + (i & 1) * half, s->y + (i >> 1) * half, half};
    take_square(&part);
  }
}

/* The only air in the tile, if no other body may be in it. */
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
  memset(b->air.known, 0, sizeof b->air.known);
  b->air.item = only_item(context, &b->air.any);
  if (b->air.item == NULL || !context->sharp || !(context->settings->noise_dn > 0.0f))
    return;
  for (int i = 0; i < PL_AIR_SIDE * PL_AIR_SIDE; i++)
    b->air.corners[i].known = PL_AIR_UNKNOWN;
  for (int y = 0; y < context->tile.height; y += WHOLE)
    for (int x = 0; x < context->tile.width; x += WHOLE) {
      const square whole = {context, b, x, y, WHOLE};
      take_square(&whole);
    }
}
