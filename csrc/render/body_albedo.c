/* Contrast is linear about the mean, as filtering is: brightness does not depend on the distance.
 */
#include "render/body_albedo.h"

#include <string.h>

#include "terrain/height_field.h"

/* Stack of rasters at a vertex, or its mean. */
static pl_raster_mix stack_at(const pl_raster_stack *stack, const pl_shot_body *body,
                              const pl_beam *beam, bool maps, const pl_vertex *vertex) {
  if (!maps || stack->count == 0)
    return stack->mean;
  const pl_vec3 local =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  const double cosine = fabs(pl_vec3_dot(beam->direction, pl_vec3f_to_double(vertex->ng)));
  const double width_m = (double)pl_beam_width(beam, vertex->t), distance_m = pl_vec3_norm(local);
  /* A circle with the area of the pixel's ellipse on the ground. */
  return pl_raster_stack_at(stack, pl_vec3_scale(local, 1.0 / distance_m),
                            width_m / (distance_m * sqrt(fmax(cosine, 0.02))));
}

static void lay(pl_raster_mix mix, float map[4]) {
  for (int k = 0; k < 3; k++)
    map[k] = (float)pl_raster_mixed(mix, (double)map[k]);
}

void pl_body_albedo_mean(const pl_shot_body *body, float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 1.0f;
  if (body->body->map != NULL) {
    pl_texture_mean(body->body->map, out);
  } else if (body->body->regolith_map != NULL) {
    pl_regolith_texel texel[3];
    memcpy(texel, pl_grid_mean(body->body->regolith_map), sizeof texel);
    for (int k = 0; k < 3; k++)
      out[k] = texel[k].w;
  }
  if (body->body->terrain != NULL && pl_terrain_albedo(body->body->terrain)->count > 0)
    lay(pl_terrain_albedo(body->body->terrain)->mean, out);
}

static void stretch(const pl_shot_body *body, float map[4]) {
  float mean[4];
  pl_body_albedo_mean(body, mean);
  for (int k = 0; k < 3; k++)
    map[k] = pl_maxf(map[k] + body->state->contrast * (map[k] - mean[k]), 0.0f);
}

/* Rocks have none: they are no ejecta of the craters about them. */
static void add_rays(const pl_shot_body *body, const pl_vertex *vertex, float map[4]) {
  const float excess =
      pl_height_field_rays(body->field, vertex->triangle, vertex->w[1], vertex->w[2]);
  const float factor =
      pl_maxf(1.0f + (float)pl_terrain_ray_brightness(body->body->terrain) * excess, 0.0f);
  for (int k = 0; k < 3; k++)
    map[k] *= factor;
}

/* Rocks have the roughness of their place. */
static double texture_at(pl_ground_texture_kind kind, const pl_shot_body *body, const pl_beam *beam,
                         const pl_vertex *vertex) {
  const pl_vec3 local =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  const double cosine = fabs(pl_vec3_dot(beam->direction, pl_vec3f_to_double(vertex->ng)));
  return pl_terrain_texture(body->body->terrain, kind, pl_vec3_unit(local),
                            (double)pl_beam_width(beam, vertex->t) / sqrt(fmax(cosine, 0.02)));
}

/* Rocks are clean: none lies in a track. */
static void add_tracks(const pl_shot_body *body, const pl_beam *beam, const pl_vertex *vertex,
                       float map[4]) {
  const pl_vec3 local =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  const float factor =
      (float)pl_wheel_tracks_albedo(pl_terrain_tracks(body->body->terrain), pl_vec3_unit(local),
                                    (double)pl_beam_width(beam, vertex->t));
  for (int k = 0; k < 3; k++)
    map[k] *= factor;
}

void pl_body_albedo_finish(const pl_shot_body *body, const pl_beam *beam, pl_detail detail,
                           const pl_vertex *vertex, float map[4]) {
  const pl_terrain *terrain = body->body->terrain;
  if (terrain != NULL && pl_terrain_albedo(terrain)->count > 0)
    lay(stack_at(pl_terrain_albedo(terrain), body, beam, detail.maps, vertex), map);
  if (body->state->contrast != 0.0f && detail.maps)
    stretch(body, map);
  if (body->field == NULL || pl_surface_kind_of(vertex->surface_id) != PL_SURFACE_HEIGHT_FIELD)
    return;
  if (detail.rays)
    add_rays(body, vertex, map);
  if (detail.maps && pl_terrain_has_textures(terrain)) {
    const float factor = (float)texture_at(PL_GROUND_ALBEDO, body, beam, vertex);
    for (int k = 0; k < 3; k++)
      map[k] *= factor;
  }
  if (detail.maps && pl_terrain_tracks(terrain) != NULL)
    add_tracks(body, beam, vertex, map);
}

pl_raster_mix pl_body_roughness(const pl_shot_body *body, const pl_beam *beam, bool maps,
                                const pl_vertex *vertex) {
  const pl_terrain *terrain = body->body->terrain;
  if (terrain == NULL)
    return (pl_raster_mix){0.0, 1.0};
  pl_raster_mix mix = stack_at(pl_terrain_roughness(terrain), body, beam, maps, vertex);
  if (maps && pl_terrain_has_textures(terrain)) {
    const double factor = texture_at(PL_GROUND_ROUGHNESS, body, beam, vertex);
    mix = (pl_raster_mix){factor * mix.value, factor * mix.below};
  }
  return mix;
}
