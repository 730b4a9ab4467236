/* Sums what meshes send to a point of a body. */
#include "scene/senders.h"

#include <math.h>

static double decode(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

static pl_sender sender_of(const pl_view *view, const pl_view_entity *body,
                           const pl_view_entity *source) {
  const double light = pl_view_light_at(view, body, source);
  return (pl_sender){.center = {source->center_m[0], source->center_m[1], source->center_m[2]},
                     .radius_m = source->radius_m,
                     .intensity = light * source->radius_m * source->radius_m};
}

pl_status pl_senders_make(const pl_view *view, size_t meshes, size_t body, double tolerance_dn,
                          pl_arena *arena, pl_senders **out) {
  const pl_view_entity *entity = &view->entities[body];
  const double series = pl_view_series(view, view->max_bounces);
  const double least = view->white_radiance * decode(fmin(tolerance_dn / 255.0, 1.0)) / series;
  double rest = pl_view_received(view, body);
  *out = NULL;
  if (view->tree != NULL || !(least > 0.0) || entity->graphed)
    return PL_OK;
  rest *= 1.0 + 1e-9; /* rounding of the difference */
  for (size_t k = 0; k < meshes; k++)
    rest -= pl_view_transfer(entity, &view->entities[k]) *
            pl_view_light_at(view, entity, &view->entities[k]);
  rest = fmax(rest, 0.0);
  if (rest >= least)
    return PL_OK;
  pl_senders *made = pl_arena_alloc(arena, 1, sizeof *made);
  pl_sender *items = pl_arena_alloc(arena, meshes, sizeof *items);
  if (made == NULL || items == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for light of others on a body");
  for (size_t k = 0; k < meshes; k++)
    items[k] = sender_of(view, entity, &view->entities[k]);
  *made = (pl_senders){.items = items,
                       .count = meshes,
                       .rest = rest,
                       .albedo = fmin(entity->albedo_max, 1.0),
                       .least = least};
  *out = made;
  return PL_OK;
}

/* Upper bound of pi times BRDF times cosine of waves for light from a ball in direction `from`:
 * F D G / (4 cos(o)) with F, G <= 1 and Beckmann's D, which falls with the angle to the normal for
 * waves that are not too steep. Half vectors to points of the ball are off that to its centre by at
 * most its angular radius. */
static double waves(const pl_senders_point *point, pl_vec3 from, double sine) {
  const double steep = 0.6, square = point->alpha * point->alpha;
  const double cosine = fmax((double)fabsf(pl_vec3f_dot(point->normal, point->viewer)), 1e-6);
  const pl_vec3 half = pl_vec3_unit(pl_vec3_add(from, pl_vec3f_to_double(point->viewer)));
  const double along = pl_vec3_dot(half, pl_vec3f_to_double(point->normal));
  const double off = acos(fmax(-1.0, fmin(1.0, along))) - asin(fmin(sine, 1.0)) - 1e-3;
  const double tangent = point->alpha < steep ? tan(fmax(0.0, fmin(off, 1.5))) : 0.0;
  const double wide = 1.0 + tangent * tangent;
  return 0.25 * wide * wide * exp(-tangent * tangent / square) / (square * cosine);
}

bool pl_senders_light(const pl_senders *senders, const pl_senders_point *point) {
  const double others = 1.06; /* as in plan/view.c */
  double sum = 0.0;
  for (size_t k = 0; k < senders->count; k++) {
    const pl_sender *at = &senders->items[k];
    const pl_vec3 to = pl_vec3_sub(at->center, point->position);
    const double far = pl_vec3_norm(to), gap = far - at->radius_m;
    if (!(gap > 0.0))
      return true;
    const double gain =
        others +
        (point->alpha > 0.0 ? waves(point, pl_vec3_scale(to, 1.0 / far), at->radius_m / far) : 0.0);
    sum += gain * at->intensity / (gap * gap);
  }
  return senders->rest + senders->albedo * sum > senders->least;
}
