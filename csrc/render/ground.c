/* Maps are read only if the row of the effect is on and the map has an effect at the point. */
#include "render/ground.h"

#include "scene/shot_frame.h"
#include "shade/towns.h"
#include "shade/water.h"

static void read_map(const pl_texture *map, const pl_body_place *place, pl_detail detail,
                     float out[4]) {
  if (detail.maps)
    pl_body_map_sample(map, place, detail.filter, out);
  else
    pl_texture_mean(map, out);
}

/* Without maps there is nothing to do: the mean slope over a whole body is zero. */
void pl_ground_bend(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                    pl_surface *surface) {
  if (!detail.relief || !detail.maps || !pl_ground_has_relief(&body->body->ground))
    return;
  const pl_vec3 up = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(surface->n));
  const pl_vec3 slope =
      pl_ground_slope(&body->body->ground, &body->state->ground, place, up, detail.filter);
  const pl_vec3 bent = pl_mat3_mul_vec(body->rotation, pl_vec3_unit(pl_vec3_sub(up, slope)));
  pl_surface_set_frame(surface, pl_vec3_to_float(bent), surface->t, 1.0f);
}

bool pl_ground_tints(const pl_shot_body *body) {
  const float *water = body->state->ground.water;
  return body->body->ground.ocean && !(isnan(water[0]) && isnan(water[1]) && isnan(water[2]));
}

void pl_ground_flood(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                     pl_surface *surface) {
  const pl_ground *ground = &body->body->ground;
  const pl_ground_state *state = &body->state->ground;
  float part[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  if (!detail.glint || !ground->ocean)
    return;
  if (ground->water != NULL)
    read_map(ground->water, place, detail, part);
  if (!(part[0] > 0.0f))
    return;
  float color[3] = {surface->color.x, surface->color.y, surface->color.z}, below[3];
  for (int k = 0; k < 3; k++) {
    below[k] = part[0] * (isnan(state->water[k]) ? color[k] : state->water[k]);
    color[k] = (1.0f - part[0]) * color[k] + below[k];
  }
  surface->color = pl_vec3f_make(color[0], color[1], color[2]);
  surface->below = pl_vec3f_make(below[0], below[1], below[2]);
  surface->water = part[0];
  surface->alpha = pl_water_alpha(state->wind_m_s);
  surface->reflectance = &pl_reflectance_water;
}

/* Sine of 6 deg. */
static const float TWILIGHT = 0.10452846f;

/* Cells of the city-light pattern are at most this part of the body's radius. Coarse maps have
 * texels that are a large part of the body, which is no size for towns. */
static const double TOWNS_PER_RADIUS = 100.0;

/* Factor by which the pattern of towns changes a map's brightness, for a footprint as wide as its
 * longer side, so that oblique views do not flicker. */
static float towns_at(const pl_shot_body *body, const pl_body_place *place, float brightness) {
  const float asked_m = body->state->ground.towns_m;
  double size_m = (double)asked_m;
  if (!(brightness > 0.0f) || asked_m == 0.0f)
    return 1.0f;
  if (isnan(asked_m)) {
    const double radius_m = body->state->radii_m.x;
    int width, height, channels;
    pl_texture_size(body->body->ground.lights, &width, &height, &channels);
    size_m = fmin(2.0 * PL_PI * radius_m / width, radius_m / TOWNS_PER_RADIUS);
  }
  const double side_m = fmax(pl_vec3_norm(place->across), pl_vec3_norm(place->along));
  return pl_towns_factor(place->point, size_m, (float)side_m, brightness);
}

void pl_ground_light(const pl_shot_body *body, const pl_shot_sun *sun, const pl_body_place *place,
                     pl_detail detail, pl_vertex *vertex) {
  const float *white = body->state->ground.lights;
  const pl_vec3 toward = pl_vec3_unit(pl_vec3_sub(sun->position, vertex->position));
  const float below = -pl_vec3f_dot(pl_vec3_to_float(toward), vertex->ng) / TWILIGHT;
  if (!(below > 0.0f))
    return;
  float map[4];
  const float x = pl_minf(below, 1.0f);
  float lit = x * x * (3.0f - 2.0f * x);
  read_map(body->body->ground.lights, place, detail, map);
  if (detail.maps)
    lit *= towns_at(body, place, pl_maxf(map[0], pl_maxf(map[1], map[2])));
  vertex->surface.emission = pl_vec3f_add(
      vertex->surface.emission,
      pl_vec3f_make(lit * map[0] * white[0], lit * map[1] * white[1], lit * map[2] * white[2]));
}
