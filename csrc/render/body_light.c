/* Tells the points of a body apart by the light that others may throw onto them. */
#include "render/body_light.h"

#include "shade/ggx.h"
#include "shade/water.h"

bool pl_body_lit_by_others(const pl_snapshot *shot, const pl_vertex *vertex, pl_vec3f toward) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  const pl_surface *s = &vertex->surface;
  const bool water = s->reflectance == &pl_reflectance_water;
  const pl_senders_point point = {.position = vertex->position,
                                  .normal = s->n,
                                  .viewer = pl_vec3f_scale(toward, -1.0f),
                                  .alpha = water ? (double)pl_ggx_alpha(s->alpha) : 0.0};
  return body->bounced && (body->senders == NULL || pl_senders_light(body->senders, &point));
}
