/* Makes the plan's view of a snapshot. */
#include "scene/snapshot.h"

#include "plan/view_tree.h"
#include "scene/volumes.h"
#include "shade/towns.h"
#include "shade/water.h"
#include "terrain/ground_levels.h"
#include "terrain/rock_relief.h"

double pl_shot_irradiance_max(const pl_snapshot *shot, pl_vec3 center, double radius_m) {
  const pl_vec3 to_sun = pl_vec3_sub(shot->sun.position, center);
  const double distance = pl_vec3_norm(to_sun);
  const double step = fmin(radius_m, fmax(0.0, distance - shot->sun.radius_m));
  return pl_shot_sun_irradiance(&shot->sun, pl_vec3_madd(center, step / distance, to_sun));
}

static void set_center(pl_view_entity *entity, pl_vec3 center) {
  entity->center_m[0] = center.x;
  entity->center_m[1] = center.y;
  entity->center_m[2] = center.z;
  entity->distance_m = pl_vec3_norm(center);
}

/* True if a piece is placed without stretching it. */
static bool is_rigid(const pl_shot_piece *piece, double scale) {
  const double tolerance = 1e-6;
  double length[3], skew = 0.0;
  pl_vec3 axis[3];
  for (int k = 0; k < 3; k++) {
    axis[k] = pl_mat3_mul_vec(piece->linear, (pl_vec3){k == 0, k == 1, k == 2});
    length[k] = pl_vec3_norm(axis[k]);
  }
  for (int k = 0; k < 3; k++) {
    skew = fmax(skew, fabs(pl_vec3_dot(axis[k], axis[(k + 1) % 3])) / (scale * scale));
    skew = fmax(skew, fabs(length[k] / scale - 1.0));
  }
  return skew < tolerance;
}

/* As pl_view_entity.sent_gain. Mirrors send the sun's radiance. */
static double sent_gain(const pl_snapshot *shot, const pl_shot_object *object) {
  const pl_sent_light *sent = &object->object->sent;
  for (size_t k = 0; k < object->piece_count; k++)
    if (object->pieces[k].present && !is_rigid(&object->pieces[k], object->scale))
      return 0.0;
  const double far =
      pl_vec3_norm(pl_vec3_sub(shot->sun.position, object->center)) + object->radius_m;
  const double ratio = far / shot->sun.radius_m, size = object->radius_m / object->scale;
  if (!(size > 0.0))
    return 0.0;
  return (sent->area_gain + sent->mirrors * ratio * ratio) / (PL_PI * size * size);
}

static pl_view_entity craft_entity(const pl_snapshot *shot, const pl_shot_object *object) {
  const pl_model_summary *summary = &object->object->summary;
  pl_view_entity entity = {
      .in_frame = object->in_frame,
      .textured = summary->textured,
      .radius_m = object->radius_m,
      .albedo_max = summary->albedo_max,
      .ggx_alpha_min = summary->ggx_alpha_min,
      .sent_gain = sent_gain(shot, object),
      .irradiance = pl_shot_irradiance_max(shot, object->center, object->radius_m),
      .emission_max = summary->emission_max,
      .coat_max = summary->coat_max,
      .transmission_max = summary->transmission_max,
      .pictured = summary->pictured,
      .bumped = summary->bumped,
      .diffuse = summary->diffuse,
  };
  set_center(&entity, object->center);
  return entity;
}

/* Lower bound of the texels of a body's map per metre of its surface. A step s on the tangent plane
 * rotates the direction from the centre by at least s cos(e)/r, where e is the angle between normal
 * and direction (cos(e) >= 2ab/(a^2 + b^2) for semi-axes from a to b: Kantorovich's inequality).
 * The combined step in longitude and latitude is at least as large as this rotation. */
static double map_density(const pl_body_state *state, const pl_texture *map) {
  int width, height, channels;
  pl_texture_size(map, &width, &height, &channels);
  const pl_vec3 r = state->radii_m;
  const double low = fmin(r.x, fmin(r.y, r.z)), high = fmax(r.x, fmax(r.y, r.z));
  const double texels_per_rad = fmin(0.5 * width, height) / PL_PI;
  return texels_per_rad * 2.0 * low / (low * low + high * high);
}

/* Applies a body's graph: its values replace those of the body, or combine with them if the graph
 * uses them. */
static void add_graph(const pl_body *body, pl_view_entity *entity) {
  const pl_model_summary *summary = &body->summary;
  const bool own = pl_graph_uses_own(body->graph);
  const double strength =
      pl_graph_sets_emission(body->graph) ? pl_graph_own_emission(body->graph) : 1.0;
  entity->textured = summary->textured || (own && entity->textured);
  entity->albedo_max = own ? fmax(summary->albedo_max, entity->albedo_max) : summary->albedo_max;
  entity->ggx_alpha_min = summary->ggx_alpha_min;
  entity->emission_max = fmax(summary->emission_max, strength * entity->emission_max);
  entity->coat_max = summary->coat_max;
  entity->transmission_max = summary->transmission_max;
  entity->pictured = summary->pictured || (own && (entity->pictured || entity->map.ranges != NULL));
  entity->bumped = summary->bumped;
  entity->diffuse = summary->diffuse && (entity->diffuse || !own);
  entity->graphed = true;
  entity->map.ranges = NULL; /* there is no bound on how the graph transforms a map */
}

/* Upper bound of the maps of albedo in a band, over which rasters and their contrast may go. */
static float map_max(const pl_body *body, const pl_body_state *state, int band) {
  const bool mapped = body->regolith_map != NULL && body->map == NULL;
  float most = mapped ? body->brightest[band].w : 1.0f;
  if (body->terrain != NULL)
    most = fmaxf(most, (float)pl_terrain_albedo(body->terrain)->high);
  if (body->terrain != NULL && pl_terrain_tracks(body->terrain) != NULL)
    most *= (float)pl_wheel_tracks_brightest(pl_terrain_tracks(body->terrain));
  if (body->terrain != NULL)
    most *= (float)pl_terrain_texture_brightest(body->terrain);
  if (body->terrain != NULL && pl_terrain_rocks(body->terrain) != NULL)
    most *= (float)PL_ROCK_TINT_MOST;
  most *= 1.0f + fmaxf(state->contrast, 0.0f);
  return body->terrain != NULL ? most * (float)(1.0 + pl_terrain_ray_brightness(body->terrain))
                               : most;
}

/* Rasters and textures of terrain, and the grain of its rocks. */
static bool has_rasters(const pl_body *body) {
  return body->terrain != NULL &&
         (pl_terrain_albedo(body->terrain)->count > 0 ||
          pl_terrain_roughness(body->terrain)->count > 0 ||
          pl_terrain_has_textures(body->terrain) || pl_terrain_tracks(body->terrain) != NULL ||
          pl_terrain_rocks(body->terrain) != NULL);
}

/* Upper bound of the albedo: the reflectance of the body's brightest soil in its brightest
 * direction. Coats over a diffuse base can reflect all light at grazing angles. */
static double albedo_max(const pl_body *body, const pl_body_state *state) {
  float color[3];
  for (int k = 0; k < 3; k++)
    color[k] = fminf(state->albedo[k] * map_max(body, state, k), 1.0f);
  if (body->reflectance == &pl_reflectance_lambert)
    return (double)fmaxf(color[0], fmaxf(color[1], color[2]));
  if (!body->reflectance->photometric)
    return 1.0;
  pl_surface surface = {.reflectance = body->reflectance, .regolith = state->regolith};
  for (int k = 0; k < 3; k++) {
    surface.regolith.band[k] = body->brightest[k].band;
    pl_regolith_band_take(&state->regolith.band[k], &surface.regolith.band[k]);
    float *roughness = &surface.regolith.band[k].roughness_rad; /* which takes light away */
    if (body->terrain != NULL && pl_terrain_roughness(body->terrain)->count > 0)
      *roughness = fminf(*roughness, (float)pl_terrain_roughness(body->terrain)->low);
    if (body->terrain != NULL &&
        (pl_terrain_has_textures(body->terrain) || pl_terrain_rocks(body->terrain) != NULL))
      *roughness = 0.0f;
  }
  surface.color = pl_vec3f_make(color[0], color[1], color[2]);
  return pl_regolith_peak(&surface);
}

static bool varies(const pl_texture *map) {
  int levels;
  return map != NULL && pl_texture_ranges(map, &levels)[0] > 0.0f;
}

/* Open water can reflect all light at grazing angles; its radiance in one direction is bounded by
 * its waves as for microfacets (tests/c/test_water.c). */
static void add_ground(const pl_ground *ground, const pl_ground_state *state,
                       pl_view_entity *entity) {
  const pl_texture *maps[] = {ground->heights, ground->normals,
                              ground->ocean ? ground->water : NULL, ground->lights};
  for (size_t i = 0; i < sizeof maps / sizeof *maps; i++) {
    entity->textured = entity->textured || maps[i] != NULL;
    entity->pictured = entity->pictured || varies(maps[i]);
  }
  entity->relief = pl_ground_has_relief(ground);
  entity->ocean = ground->ocean;
  if (ground->ocean) {
    entity->diffuse = false;
    entity->albedo_max = 1.0;
    entity->ggx_alpha_min = (double)pl_water_bound_alpha(state->wind_m_s);
  }
  if (ground->lights == NULL)
    return;
  const float *lights = state->lights;
  const double peak = state->towns_m == 0.0f ? 1.0 : (double)PL_TOWNS_PEAK;
  entity->lights_max = peak * fmax(lights[0], fmax(lights[1], lights[2]));
  entity->emission_max += entity->lights_max;
}

static pl_view_entity body_entity(const pl_snapshot *shot, const pl_shot_body *body) {
  const pl_body_state *state = body->state;
  const bool diffuse = body->body->reflectance == &pl_reflectance_lambert;
  pl_view_entity entity = {
      .is_body = true,
      .is_world = true,
      .in_frame = body->in_frame || body->clouds_in_frame,
      .textured =
          body->body->map != NULL || body->body->regolith_map != NULL || has_rasters(body->body),
      .radius_m = body->radius_m,
      .albedo_max = albedo_max(body->body, state),
      .ggx_alpha_min = 1.0,
      .diffuse = diffuse,
      .pictured = body->body->regolith_map != NULL || has_rasters(body->body),
      .air = body->body->air,
      .air_in_frame = body->air_in_frame,
      .clouds = state->clouds.altitude_m > 0.0 ? &state->clouds : NULL,
      .clouds_in_frame = body->clouds_in_frame,
      .irradiance = pl_shot_irradiance_max(shot, body->center, body->radius_m),
      .emission_max = fmax(state->emission[0], fmax(state->emission[1], state->emission[2])),
  };
  const bool plain = state->contrast == 0.0f && !has_rasters(body->body);
  entity.pictured = entity.pictured || (body->body->map != NULL && !plain);
  if (body->body->map != NULL && plain) {
    entity.map.ranges = pl_texture_ranges(body->body->map, &entity.map.levels);
    entity.map.texels_per_m = diffuse ? map_density(state, body->body->map) : 0.0;
  }
  if (body->body->graph != NULL)
    add_graph(body->body, &entity);
  else
    add_ground(&body->body->ground, &state->ground, &entity);
  for (int k = 0; entity.clouds != NULL && k < 3; k++) /* clouds may be brighter than the ground */
    entity.albedo_max = fmax(entity.albedo_max, (double)state->clouds.color[k]);
  set_center(&entity, body->center);
  return entity;
}

/* Shape of a body: the body's surface on a mesh. Bounds of a map on an ellipsoid do not hold on an
 * arbitrary mesh, and reflectance levels of detail are not used. */
/* Adds the materials of the shape's file to the properties that the graph gives. */
static void add_materials(const pl_model_summary *summary, pl_view_entity *entity) {
  entity->textured |= summary->textured;
  entity->pictured |= summary->pictured;
  entity->bumped |= summary->bumped;
  entity->diffuse &= summary->diffuse;
  entity->albedo_max = fmax(entity->albedo_max, summary->albedo_max);
  entity->ggx_alpha_min = fmin(entity->ggx_alpha_min, summary->ggx_alpha_min);
  entity->coat_max = fmax(entity->coat_max, summary->coat_max);
}

static pl_view_entity shape_entity(const pl_snapshot *shot, const pl_shot_object *object) {
  const pl_shot_body *body = &shot->bodies[object->object->body];
  pl_view_entity entity = body_entity(shot, body);
  if (body->body->dressed && (body->body->graph == NULL || pl_graph_uses_own(body->body->graph)))
    add_materials(&object->object->model_summary, &entity);
  entity.is_body = false;
  entity.in_frame = object->in_frame;
  entity.radius_m = object->radius_m;
  entity.irradiance = pl_shot_irradiance_max(shot, object->center, object->radius_m);
  entity.pictured = entity.pictured || entity.map.ranges != NULL;
  entity.map.ranges = NULL;
  entity.air = NULL;
  set_center(&entity, object->center);
  return entity;
}

/* Terrain: the body's surface on a height field, which shades and lights itself as a mesh does. */
static pl_view_entity terrain_entity(const pl_snapshot *shot, const pl_shot_body *body) {
  pl_view_entity entity = body_entity(shot, body);
  const pl_ground_tile_view view = {.eye = body->camera,
                                    .pixel_rad =
                                        1.0 / fmax(shot->rays.camera.fx, shot->rays.camera.fy),
                                    .cells_per_pixel = body->body->cells_per_pixel,
                                    .finest_m = body->body->finest_cell_m};
  entity.is_body = false;
  entity.terrain = pl_ground_levels(body->body->terrain, &view);
  entity.sampled = pl_ground_textures_seen(body->body->terrain, &view);
  entity.rays = body->body->graph == NULL && pl_terrain_ray_brightness(body->body->terrain) > 0.0;
  entity.radius_m = body->outer_m;
  entity.irradiance = pl_shot_irradiance_max(shot, body->center, body->outer_m);
  entity.pictured = entity.pictured || entity.map.ranges != NULL;
  entity.map.ranges = NULL;
  return entity;
}

/* Entity of a body that its shape replaces: it has no surface. */
static pl_view_entity hollow_entity(const pl_shot_body *body) {
  pl_view_entity entity = {.ggx_alpha_min = 1.0, .diffuse = true};
  set_center(&entity, body->center);
  return entity;
}

static pl_view_entity entity_of(const pl_snapshot *shot, size_t index) {
  if (index < shot->craft_count)
    return craft_entity(shot, &shot->objects[index]);
  if (index < shot->object_count)
    return shape_entity(shot, &shot->objects[index]);
  const pl_shot_body *body = &shot->bodies[index - shot->object_count];
  if (body->shape != NULL)
    return hollow_entity(body);
  return body->has_terrain ? terrain_entity(shot, body) : body_entity(shot, body);
}

static double corner_tangent(const pl_camera *camera) {
  const double x = fmax(fabs(camera->cx), fabs(camera->width - 1.0 - camera->cx)) / camera->fx;
  const double y = fmax(fabs(camera->cy), fabs(camera->height - 1.0 - camera->cy)) / camera->fy;
  return hypot(x, y);
}

/* Returns the diameter of the circle of confusion at a depth, in pixels of the undistorted image.
 */
static double confusion_px(const pl_camera *camera, double depth_m) {
  const double off = fabs(1.0 / depth_m - camera->focus_per_m);
  return depth_m > 0.0 ? fmax(camera->fx, camera->fy) * camera->aperture_m * off : INFINITY;
}

/* Returns the largest circle of confusion of any point in a sphere. A visible point at distance d
 * has a depth of at least d cos(half), where `half` is the angle between the image's corners and
 * the axis. */
static double sphere_defocus_px(const pl_snapshot *shot, double half, pl_vec3 center,
                                double radius_m) {
  const double depth = pl_mat3_mul_vec_t(shot->camera_to_root, center).z;
  const double nearest = (pl_vec3_norm(center) - radius_m) * cos(half);
  return fmax(confusion_px(&shot->rays.camera, fmax(depth - radius_m, nearest)),
              confusion_px(&shot->rays.camera, depth + radius_m));
}

/* No point of the rings is nearer to the sun than the centre's distance less their radius. */
static pl_view_rings rings_of(const pl_snapshot *shot, const pl_shot_body *body) {
  const pl_rings_light_bounds bounds = pl_rings_light_bounds_of(body->body->rings);
  const pl_vec3 axis = pl_mat3_mul_vec(body->rotation, (pl_vec3){0.0, 0.0, 1.0});
  const double radius_m = pl_rings_outer_m(body->body->rings);
  return (pl_view_rings){
      .in_frame = body->rings_in_frame,
      .radius_m = radius_m,
      .axis = {axis.x, axis.y, axis.z},
      .depth = bounds.depth,
      .light = bounds.scattered * pl_shot_irradiance_max(shot, body->center, radius_m),
  };
}

/* The body whose surface entity `index` is; NULL for spacecraft and hollow entities. */
static const pl_shot_body *body_shown_by(const pl_snapshot *shot, size_t index) {
  if (index < shot->craft_count)
    return NULL;
  if (index < shot->object_count)
    return &shot->bodies[shot->objects[index].object->body];
  const pl_shot_body *body = &shot->bodies[index - shot->object_count];
  return body->shape == NULL ? body : NULL;
}

static pl_status make_entities(const pl_snapshot *shot, pl_arena *arena, pl_view_entity *out,
                               size_t count) {
  for (size_t i = 0; i < count; i++) {
    const pl_shot_body *body = body_shown_by(shot, i);
    out[i] = entity_of(shot, i);
    if (body == NULL || body->body->rings == NULL)
      continue;
    pl_view_rings *rings = pl_arena_alloc(arena, 1, sizeof *rings);
    if (rings == NULL)
      return pl_fail(PL_E_MEMORY, "out of memory for the view");
    *rings = rings_of(shot, body);
    out[i].rings = rings;
  }
  return PL_OK;
}

static double defocus_px(const pl_snapshot *shot, const pl_view *view) {
  const pl_vec3 axis = pl_mat3_mul_vec(shot->camera_to_root, (pl_vec3){0.0, 0.0, 1.0});
  double half = 0.0, most = 0.0;
  if (!(shot->rays.camera.aperture_m > 0.0))
    return 0.0;
  for (int corner = 0; corner < 4; corner++) {
    const pl_vec3 ray = pl_snapshot_ray(shot, -0.5 + (corner & 1 ? shot->rays.camera.width : 0),
                                        -0.5 + (corner & 2 ? shot->rays.camera.height : 0));
    half = fmax(half, acos(fmin(1.0, pl_vec3_dot(ray, axis))));
  }
  if (view->sun_in_frame)
    most = sphere_defocus_px(shot, half, shot->sun.position, shot->sun.radius_m);
  for (size_t i = 0; i < view->entity_count; i++) {
    const pl_view_entity *entity = &view->entities[i];
    const pl_vec3 center = {entity->center_m[0], entity->center_m[1], entity->center_m[2]};
    if (entity->in_frame)
      most = fmax(most, sphere_defocus_px(shot, half, center, entity->radius_m));
    if (pl_view_shows_rings(entity))
      most = fmax(most, sphere_defocus_px(shot, half, center, entity->rings->radius_m));
  }
  for (size_t i = 0; i < shot->volume_count; i++)
    if (shot->volumes[i].in_frame)
      most = fmax(
          most, sphere_defocus_px(shot, half, shot->volumes[i].center, shot->volumes[i].radius_m));
  return most;
}

/* For large views: builds the tree of entities and marks those that shadows fall on. */
static pl_status index_entities(pl_arena *arena, pl_view *view) {
  PL_TRY(pl_view_tree_build(arena, view));
  if (view->tree == NULL)
    return PL_OK;
  bool *shadowed = pl_arena_alloc(arena, view->entity_count, sizeof *shadowed);
  if (shadowed == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the view");
  for (size_t i = 0; i < view->entity_count; i++)
    shadowed[i] = pl_view_shadowed(view, i);
  view->shadowed = shadowed;
  return PL_OK;
}

pl_status pl_snapshot_view(const pl_snapshot *shot, pl_arena *arena, pl_view *out) {
  const size_t count = shot->object_count + shot->body_count;
  pl_view_entity *entities = pl_arena_alloc(arena, count, sizeof *entities);
  if (entities == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the view");
  PL_TRY(make_entities(shot, arena, entities, count));
  const pl_vec3 sun = shot->sun.position;
  const double distance = pl_vec3_norm(sun);
  const pl_vec3 axis = pl_mat3_mul_vec(shot->camera_to_root, (pl_vec3){0.0, 0.0, 1.0});
  *out = (pl_view){
      .width = shot->rays.camera.width,
      .height = shot->rays.camera.height,
      .pixel_rad = 1.0 / fmax(shot->rays.camera.fx, shot->rays.camera.fy),
      .corner_tangent = corner_tangent(&shot->rays.camera),
      .sun_radius_rad = asin(fmin(1.0, shot->sun.radius_m / distance)),
      .sun_position_m = {sun.x, sun.y, sun.z},
      .sun_radius_m = shot->sun.radius_m,
      .sun_axis_rad = atan2(pl_vec3_norm(pl_vec3_cross(axis, sun)), pl_vec3_dot(axis, sun)),
      .sun_irradiance = pl_shot_sun_irradiance(&shot->sun, (pl_vec3){0.0, 0.0, 0.0}),
      .sun_in_frame = shot->sun.in_frame,
      .lens_shift_px = pl_camera_lens_shift(&shot->rays.camera),
      .entities = entities,
      .entity_count = count,
  };
  PL_TRY(pl_volumes_view(shot, arena, out));
  PL_TRY(index_entities(arena, out));
  out->defocus_px = defocus_px(shot, out);
  return PL_OK;
}
