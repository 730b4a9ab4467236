/* Atmospheres along rays and at vertices. Camera rays in pixels with interpolated air are cheap:
 * see air_tile.c. */
#include "render/air_path.h"

#include "light/sun.h"
#include "render/path.h"
#include "render/medium.h"
#include "shade/reflectance.h"

static pl_air_item item_of(const pl_snapshot *shot, uint32_t index) {
  const pl_shot_body *body = &shot->bodies[index];
  const pl_air *air = body->body->air;
  const pl_sun_view sun = pl_sun_view_at(&shot->sun, body->center);
  const pl_vec3 toward = pl_vec3_unit(pl_vec3_sub(shot->sun.position, body->center));
  const pl_vec3 scaled = pl_mat3_mul_vec(body->to_unit, toward);
  const double norm = pl_vec3_norm(scaled), reach_m = pl_air_reach_m(air, body->radius_m);
  return (pl_air_item){
      .air = air,
      .body = index,
      .toward_sun = pl_vec3_to_float(toward),
      .sun = {pl_vec3_scale(scaled, 1.0 / norm), norm * pl_air_radius_m(air),
              asin(fmin(1.0, (double)sun.sin_radius))},
      .irradiance = sun.irradiance,
      .reach_m = reach_m,
      .distance_m = fmax(0.0, pl_vec3_norm(body->center) - reach_m),
  };
}

/* Sorts by the distance of body centres from the camera, which is the order in which camera rays
 * cross the atmospheres. */
static void sort_items(const pl_snapshot *shot, pl_air_view *view) {
  for (size_t i = 1; i < view->count; i++)
    for (size_t k = i; k > 0; k--) {
      const pl_air_item a = view->items[k - 1], b = view->items[k];
      if (pl_vec3_norm(shot->bodies[a.body].center) <= pl_vec3_norm(shot->bodies[b.body].center))
        break;
      view->items[k - 1] = b;
      view->items[k] = a;
    }
}

pl_status pl_air_view_build(const pl_snapshot *shot, int steps, pl_arena *arena, pl_air_view *out) {
  *out = (pl_air_view){.rule = pl_air_rule_make(steps)};
  size_t count = 0;
  for (size_t i = 0; i < shot->body_count; i++)
    count += shot->bodies[i].body->air != NULL;
  if (count == 0)
    return PL_OK;
  out->items = pl_arena_alloc(arena, count, sizeof *out->items);
  if (out->items == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for atmospheres");
  for (size_t i = 0; i < shot->body_count; i++)
    if (shot->bodies[i].body->air != NULL)
      out->items[out->count++] = item_of(shot, (uint32_t)i);
  sort_items(shot, out);
  return PL_OK;
}

bool pl_air_in_cone(const pl_air_view *view, const pl_snapshot *shot, pl_vec3 axis,
                    double half_angle) {
  for (size_t i = 0; view != NULL && i < view->count; i++)
    if (pl_snapshot_sees(shot, shot->bodies[view->items[i].body].center, view->items[i].reach_m,
                         axis, half_angle))
      return true;
  return false;
}

bool pl_air_item_ray(const pl_air_item *item, const pl_snapshot *shot, pl_vec3 origin,
                     pl_vec3 direction, double end_m, pl_air_ray *ray) {
  const pl_shot_body *body = &shot->bodies[item->body];
  const pl_vec3 scaled = pl_mat3_mul_vec(body->to_unit, direction);
  const double norm = pl_vec3_norm(scaled);
  if (!(norm > 0.0)) /* no ray: the pixel is outside the lens's field */
    return false;
  *ray = (pl_air_ray){
      .origin = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, origin)),
      .direction = pl_vec3_scale(scaled, 1.0 / norm),
      .stretch = norm * pl_air_radius_m(item->air),
      .end = end_m * norm,
      .to_ground = body->has_terrain,
      .sun_cosine = pl_vec3f_dot(pl_vec3_to_float(direction), item->toward_sun),
  };
  return pl_air_meets(item->air, ray);
}

/* True if the air stored for the pixel is the air that a camera path crosses on its way to the hit.
 */
static bool is_known(const pl_air_tile *tile, uint32_t pixel, const pl_hit *hit) {
  if (tile->known[pixel] == PL_AIR_GROUND)
    return pl_surface_same(hit->surface_id, pl_surface_of_body(tile->item->body));
  return tile->known[pixel] == PL_AIR_SPACE && pl_surface_is_none(hit->surface_id);
}

/* A ray through the atmosphere of one item. */
typedef struct passage {
  const pl_air_item *item;
  pl_air_ray ray;
  pl_air_light light; /* along the whole ray */
  bool known;         /* whether `light` is stored for the whole pixel */
} passage;

/* Samples of a pixel with stored air share the light up to a medium if their distances to it differ
 * by less than this relative amount. */
static const double VEIL_STEP = 0.002;

/* Pixels of a block share one integral if their distances to the medium differ by less than this
 * relative amount. Each pixel has its own light along the whole ray; the light up to the medium is
 * scaled in proportion. */
static const double BLOCK_STEP = 0.02;

static pl_air_block *block_of(pl_air_tile *tile, uint32_t pixel) {
  const uint32_t x = pixel % PL_TILE_SIDE / PL_AIR_BLOCK, y = pixel / PL_TILE_SIDE / PL_AIR_BLOCK;
  return &tile->blocks[y * (PL_TILE_SIDE / PL_AIR_BLOCK) + x];
}

static float ratio(float a, float b) { return b > 0.0f ? a / b : 1.0f; }

static pl_vec3f ratios(pl_vec3f a, pl_vec3f b) {
  return pl_vec3f_make(ratio(a.x, b.x), ratio(a.y, b.y), ratio(a.z, b.z));
}

/* Scales the block's light up to a medium to a pixel. About half of the air is assumed to lie
 * before the medium: its optical depth changes by half as much as along the whole ray. */
static pl_air_light light_of_block(const pl_air_block *block, const pl_air_light *whole) {
  const pl_vec3f dims = ratios(whole->transmitted, block->whole.transmitted);
  const pl_vec3f half = pl_vec3f_make(sqrtf(dims.x), sqrtf(dims.y), sqrtf(dims.z));
  const pl_vec3f glows = ratios(whole->scattered, block->whole.scattered);
  return (pl_air_light){.scattered = pl_vec3f_mul(block->to_medium.scattered, glows),
                        .transmitted = pl_vec3f_mul(block->to_medium.transmitted, half)};
}

/* Light along a ray up to a medium; false if there is no air before it. In pixels with stored air,
 * samples share the result. */
static bool light_to_medium(const pl_air_view *view, const passage *p, double t, double norm,
                            pl_air_tile *tile, uint32_t pixel, pl_air_light *out) {
  pl_air_ray ray = p->ray;
  const bool kept = p->known && fabs(tile->medium_t[pixel] - t) < VEIL_STEP * t;
  if (kept) {
    *out = tile->to_medium[pixel];
    return true;
  }
  pl_air_block *block = p->known ? block_of(tile, pixel) : NULL;
  if (block != NULL && fabs(block->t - t) < BLOCK_STEP * t) {
    *out = light_of_block(block, &p->light);
  } else {
    ray.end = fmin(ray.end, t * norm);
    if (!pl_air_meets(p->item->air, &ray))
      return false;
    *out = pl_air_scatter(p->item->air, &ray, &p->item->sun, &view->rule, view->multiple);
    if (block != NULL)
      *block = (pl_air_block){.t = t, .to_medium = *out, .whole = p->light};
  }
  if (p->known && tile->medium_t[pixel] == 0.0) {
    tile->medium_t[pixel] = t;
    tile->to_medium[pixel] = *out;
  }
  return true;
}

/* Returns the light that an atmosphere scatters along a ray on which each medium transmits a part
 * of the light from beyond it. way[k] is multiplied by the transmittance of the air up to medium k.
 */
static pl_vec3f scatter_between(const pl_air_view *view, const passage *p,
                                const pl_medium_list *list, pl_vec3f *way, pl_air_tile *tile,
                                uint32_t pixel) {
  pl_vec3f sum = {0.0f, 0.0f, 0.0f}, left = {1.0f, 1.0f, 1.0f}, before = sum;
  const double norm = list->count > 0 ? p->ray.stretch / pl_air_radius_m(p->item->air) : 1.0;
  for (size_t k = 0; k < list->count; k++) {
    pl_air_light light;
    if (light_to_medium(view, p, list->items[k].t, norm, tile, pixel, &light)) {
      sum = pl_vec3f_add(sum, pl_vec3f_mul(left, pl_vec3f_sub(light.scattered, before)));
      before = light.scattered;
      way[k] = pl_vec3f_mul(way[k], light.transmitted);
    }
    left = pl_vec3f_mul(left, list->items[k].transmittance);
  }
  return pl_vec3f_add(sum, pl_vec3f_mul(left, pl_vec3f_sub(p->light.scattered, before)));
}

/* Adds the light of the media, attenuated by the air before them; returns the product of their
 * transmittances. */
static pl_vec3f add_media(const pl_medium_list *list, const pl_vec3f *way, pl_vec3f *sum) {
  pl_vec3f left = {1.0f, 1.0f, 1.0f};
  for (size_t k = 0; k < list->count; k++) {
    const pl_vec3f radiance = pl_vec3f_mul(way[k], list->items[k].radiance);
    *sum = pl_vec3f_add(*sum, pl_vec3f_mul(left, radiance));
    left = pl_vec3f_mul(left, list->items[k].transmittance);
  }
  return left;
}

/* Sets the passage of path i's ray through the air of out->item up to its hit; false if there is no
 * air. The ray itself is set only if `pieces` of it are needed or its light is not stored. */
static bool find_passage(const pl_path_context *context, int bounce, size_t i, bool pieces,
                         const pl_tile_buffers *b, passage *out) {
  const pl_air_item *item = out->item;
  const pl_air_view *view = context->settings->air;
  const pl_hit *hit = &b->hits[i];
  const pl_path *path = &b->paths[i];
  const bool miss = pl_surface_is_none(hit->surface_id);
  const bool ground = pl_surface_same(hit->surface_id, pl_surface_of_body(item->body));
  if (out->known)
    out->light = b->air->pixels[path->pixel].light;
  if (out->known && !pieces)
    return true;
  if (bounce == 0 && !miss && !ground && hit->t < item->distance_m)
    return false;
  if (!pl_air_item_ray(item, context->shot, path->beam.origin, path->beam.direction,
                       miss || ground ? INFINITY : (double)hit->t, &out->ray))
    return false;
  if (!out->known)
    out->light = pl_air_scatter(item->air, &out->ray, &item->sun, &view->rule, view->multiple);
  return true;
}

/* Whether a surface is the ground of a body that is no ellipsoid, or lies on it. */
static bool is_terrain(pl_surface_id id, uint32_t body) {
  return pl_surface_same(id, pl_surface_make(PL_SURFACE_HEIGHT_FIELD, body)) ||
         pl_surface_same(id, pl_surface_make(PL_SURFACE_ROCKS, body));
}

/* Whether the light that the air of a body scatters along a bounced ray is left out: where it is
 * part of the body's own skylight already, or where the skylight of terrain is off. */
static bool leaves_out(const pl_air_view *view, const pl_ray *ray, uint32_t body) {
  return view->skylight ? ray->skip_body == body : is_terrain(ray->from_surface, body);
}

void pl_air_pass(const pl_path_context *context, int bounce, size_t i, const pl_medium_list *list,
                 pl_tile_buffers *b) {
  const pl_air_view *view = context->settings->air;
  pl_path *path = &b->paths[i];
  pl_vec3f *sink = pl_path_sink(b, path->pixel, path->filtered), through = path->throughput;
  pl_vec3f way[PL_MEDIUM_CROSSINGS];
  const bool known = bounce == 0 && is_known(b->air, path->pixel, &b->hits[i]);
  for (size_t k = 0; k < list->count; k++)
    way[k] = through;
  for (size_t n = 0; n < (known ? 1 : view->count) && (bounce > 0 || b->air->any); n++) {
    passage p = {.item = known ? b->air->item : &view->items[n], .known = known};
    if (!find_passage(context, bounce, i, list->count > 0, b, &p))
      continue;
    const bool scattered = !(bounce > 0 && leaves_out(view, &b->rays[i], p.item->body));
    const pl_vec3f light = scatter_between(view, &p, list, way, b->air, path->pixel);
    if (scattered)
      *sink = pl_vec3f_madd(*sink, p.item->irradiance, pl_vec3f_mul(through, light));
    through = pl_vec3f_mul(through, p.light.transmitted);
  }
  path->throughput = pl_vec3f_mul(through, add_media(list, way, sink));
}

void pl_air_apply(const pl_path_context *context, int bounce, size_t count, pl_tile_buffers *b) {
  const pl_medium_list none = {.count = 0};
  if (bounce == 0 && !b->air->any)
    return;
  for (size_t i = 0; i < count; i++) {
    const uint32_t pixel = b->paths[i].pixel;
    if (bounce > 0 || !pl_surface_same(b->prefiltered_id[pixel], b->hits[i].surface_id) ||
        pl_surface_is_none(b->hits[i].surface_id))
      pl_air_pass(context, bounce, i, &none, b);
  }
}

pl_vec3f pl_air_toward_sun(const pl_air_view *view, const pl_snapshot *shot, pl_vec3 point,
                           pl_vec3f toward) {
  pl_vec3f out = {1.0f, 1.0f, 1.0f};
  for (size_t i = 0; i < view->count; i++) {
    pl_air_ray ray;
    if (!pl_air_item_ray(&view->items[i], shot, point, pl_vec3f_to_double(toward), INFINITY, &ray))
      continue;
    out = pl_vec3f_mul(
        out, pl_air_transmittance(view->items[i].air, ray.origin, ray.direction, ray.stretch));
  }
  return out;
}

/* Cosine of the zenith angle from which skylight is taken to arrive on surfaces without a closed
 * form for it: the mean over a uniform sky, weighted by irradiance. */
static const float SKY_COSINE = 2.0f / 3.0f;

/* Skylight by the sun's height over a vertex on the item's body. */
static pl_vec3f skylight_at(const pl_air_view *view, const pl_air_item *item,
                            const pl_snapshot *shot, const pl_vertex *vertex) {
  const pl_shot_body *body = &shot->bodies[item->body];
  const pl_vec3 point =
      pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, vertex->position));
  const double sine = pl_vec3_dot(pl_vec3_unit(point), item->sun.direction);
  const pl_vec3f sky = pl_air_skylight(item->air, sine, view->multiple);
  if (pl_surface_is_ellipsoid(vertex->surface_id))
    return sky;
  return pl_vec3f_mul(
      sky, pl_air_above(item->air, (pl_vec3_norm(point) - 1.0) * pl_air_radius_m(item->air)));
}

static pl_vec3f reflect_sky(const pl_surface *s, pl_vec3f wo, pl_vec3f irradiance) {
  if (s->reflectance->under_sky != NULL)
    return pl_vec3f_scale(pl_vec3f_mul(s->reflectance->under_sky(s, wo), irradiance),
                          1.0f / PL_PI_F);
  const float across = sqrtf(0.5f * (1.0f - SKY_COSINE * SKY_COSINE));
  const pl_vec3f wi = {across, across, SKY_COSINE};
  const pl_vec3f sent = s->reflectance->evaluate(s, wo, wi); /* includes the cosine */
  return pl_vec3f_scale(pl_vec3f_mul(sent, irradiance), 1.0f / SKY_COSINE);
}

pl_vec3f pl_air_sky_reflected(const pl_air_view *view, const pl_snapshot *shot,
                              const pl_vertex *vertex, pl_vec3f wo, bool traced) {
  for (size_t i = 0; view->skylight && i < view->count; i++) {
    const pl_air_item *item = &view->items[i];
    if (!pl_surface_same(vertex->surface_id, pl_surface_of_body(item->body)) &&
        (traced || !is_terrain(vertex->surface_id, item->body)))
      continue;
    const pl_vec3f sky = skylight_at(view, item, shot, vertex);
    return pl_vec3f_scale(reflect_sky(&vertex->surface, wo, sky), item->irradiance);
  }
  return (pl_vec3f){0.0f, 0.0f, 0.0f};
}

/* Uses the values stored for the pixel if there are any, otherwise those of the vertex. */
pl_vec3f pl_air_ground_light(const pl_path_context *context, uint32_t pixel,
                             const pl_vertex *vertex, pl_vec3f direct, float width_m,
                             const pl_tile_buffers *b) {
  const pl_air_view *view = context->settings->air;
  const pl_snapshot *shot = context->shot;
  const pl_vec3f toward =
      pl_vec3_to_float(pl_vec3_unit(pl_vec3_sub(shot->sun.position, vertex->position)));
  const pl_vec3f wo = pl_surface_to_local(
      &vertex->surface, pl_vec3_to_float(pl_vec3_scale(pl_vec3_unit(vertex->position), -1.0)));
  if (b->air->known[pixel] != PL_AIR_GROUND || b->air->item == NULL ||
      !pl_surface_same(vertex->surface_id, pl_surface_of_body(b->air->item->body))) {
    const pl_vec3f sky = pl_air_sky_reflected(view, shot, vertex, wo, false);
    return pl_vec3f_add(
        pl_vec3f_mul(direct, pl_air_toward_sun(view, shot, vertex->position, toward)),
        pl_media_dim_sky(context->settings->media, shot, vertex, width_m, sky));
  }
  const pl_air_pixel *air = &b->air->pixels[pixel];
  const pl_vec3f light = pl_vec3f_mul(direct, air->sunlight);
  if (!view->skylight)
    return light;
  const pl_vec3f sky =
      pl_vec3f_scale(reflect_sky(&vertex->surface, wo, air->skylight), b->air->item->irradiance);
  return pl_vec3f_add(light,
                      pl_media_dim_sky(context->settings->media, shot, vertex, width_m, sky));
}

/* Sets the passage from the camera through the air of out->item to a pixel's point; false if there
 * is no air. */
static bool find_seen(const pl_path_context *context, const pl_point *point, bool pieces,
                      const pl_air_pixel *pixel, passage *out) {
  const pl_air_view *view = context->settings->air;
  const bool ground = pl_surface_same(point->surface_id, pl_surface_of_body(out->item->body));
  if (out->known)
    out->light = pixel->light;
  if (out->known && !pieces)
    return true;
  if (!pl_air_item_ray(out->item, context->shot, (pl_vec3){0.0, 0.0, 0.0},
                       pl_vec3_unit(point->position), ground ? INFINITY : point->t, &out->ray))
    return false;
  if (!out->known)
    out->light =
        pl_air_scatter(out->item->air, &out->ray, &out->item->sun, &view->rule, view->multiple);
  return true;
}

pl_vec3f pl_air_seen(const pl_path_context *context, uint32_t pixel, pl_vec3f radiance,
                     const pl_medium_list *list, pl_tile_buffers *b) {
  const pl_air_view *view = context->settings->air;
  const pl_point *point = &b->points[pixel];
  const bool known = b->air->item != NULL && b->air->known[pixel] == PL_AIR_GROUND &&
                     pl_surface_same(point->surface_id, pl_surface_of_body(b->air->item->body));
  pl_vec3f sum = {0.0f, 0.0f, 0.0f}, through = {1.0f, 1.0f, 1.0f};
  pl_vec3f way[PL_MEDIUM_CROSSINGS];
  for (size_t k = 0; k < list->count; k++)
    way[k] = through;
  for (size_t n = 0; n < (known ? 1 : view->count); n++) {
    passage p = {.item = known ? b->air->item : &view->items[n], .known = known};
    if (!find_seen(context, point, list->count > 0, &b->air->pixels[pixel], &p))
      continue;
    const pl_vec3f light = scatter_between(view, &p, list, way, b->air, pixel);
    sum = pl_vec3f_madd(sum, p.item->irradiance, pl_vec3f_mul(through, light));
    through = pl_vec3f_mul(through, p.light.transmitted);
  }
  const pl_vec3f left = add_media(list, way, &sum);
  return pl_vec3f_add(sum, pl_vec3f_mul(pl_vec3f_mul(through, left), radiance));
}

bool pl_air_alone(const pl_path_context *context, uint32_t pixel, pl_vec3f behind,
                  pl_vec3f *radiance, const pl_tile_buffers *b) {
  if (b->air->known[pixel] != PL_AIR_SPACE || context->sun)
    return false;
  const pl_air_light *light = &b->air->pixels[pixel].light;
  *radiance = pl_vec3f_madd(pl_vec3f_mul(behind, light->transmitted), b->air->item->irradiance,
                            light->scattered);
  return true;
}
