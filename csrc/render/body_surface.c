/* Maps are sampled where the ray hits the body, over the ray's footprint. Positions are in double
 * precision. */
#include "render/body_surface.h"

#include "render/body_albedo.h"
#include "render/geometry.h"
#include "render/ground.h"
#include "render/regolith.h"
#include "scene/shot_frame.h"
#include "shade/body_map.h"
#include "shade/reflectance.h"
#include "shade/graph_classes.h"

/* Oblateness for the latitude of the body's maps: 0 for planetocentric latitudes. */
static double oblate_of(const pl_shot_body *body) {
  return body->body->geodetic ? pl_body_map_oblate(body->state->radii_m) : 0.0;
}

static pl_body_place place_of(const pl_shot_body *body, const pl_vertex *vertex,
                              const pl_beam *beam) {
  pl_vec3f across, along;
  pl_vertex_footprint(vertex, beam, &across, &along);
  return (pl_body_place){
      .point = pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center)),
      .across = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(across)),
      .along = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(along)),
      .center_lon_rad = body->body->map_center_lon_rad,
      .oblate = oblate_of(body),
  };
}

static void body_color(const pl_shot_body *body, const pl_body_place *place, pl_detail detail,
                       float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 1.0f;
  if (body->body->map == NULL)
    return;
  if (detail.maps && detail.box)
    pl_body_map_box(body->body->map, place, detail.filter, out);
  else if (detail.maps)
    pl_body_map_sample(body->body->map, place, detail.filter, out);
  else
    pl_texture_mean(body->body->map, out);
}

/* The surface with the materials in the shape's file, and with their frame. */
static void dressed_surface(const pl_shot_body *body, const pl_beam *beam, pl_detail detail,
                            pl_vertex *vertex) {
  pl_triangle_point point = {.triangle = vertex->triangle,
                             .w = {vertex->w[0], vertex->w[1], vertex->w[2]},
                             .edge1 = vertex->edge1,
                             .edge2 = vertex->edge2};
  const float *light = body->state->emission;
  pl_vertex_footprint(vertex, beam, &point.footprint_a, &point.footprint_b);
  pl_shot_frame(body->shape, vertex->triangle, vertex->w, vertex->ng, &vertex->surface);
  pl_material_surface(body->shape->object->model, &point, detail, &vertex->surface);
  vertex->surface.emission = pl_vec3f_make(light[0], light[1], light[2]);
}

/* The body's own surface, without its frame. */
static void own_surface(const pl_shot_body *body, const pl_beam *beam, const pl_body_place *place,
                        pl_detail detail, pl_vertex *vertex) {
  const pl_body_state *state = body->state;
  pl_surface *surface = &vertex->surface;
  float map[4];
  if (body->body->dressed) {
    dressed_surface(body, beam, detail, vertex);
    return;
  }
  body_color(body, place, detail, map);
  if (!detail.color_only) {
    surface->emission = pl_vec3f_make(state->emission[0], state->emission[1], state->emission[2]);
    surface->metallic = 0.0f;
    surface->alpha = 1.0f;
    surface->lobes = pl_lobes_plain();
  }
  surface->reflectance = body->body->reflectance;
  if (surface->reflectance->photometric)
    pl_regolith_shade(body, beam, detail.maps, vertex, map);
  pl_body_albedo_finish(body, beam, detail, vertex, map);
  surface->color = pl_vec3f_make(pl_minf(map[0] * state->albedo[0], 1.0f),
                                 pl_minf(map[1] * state->albedo[1], 1.0f),
                                 pl_minf(map[2] * state->albedo[2], 1.0f));
}

/* The outward shading normal; interpolated on a body with a shape or terrain. */
static pl_vec3f normal_at(const pl_snapshot *shot, const pl_vertex *vertex) {
  const pl_geometry_kind *kind = pl_geometry_of(vertex->surface_id);
  return kind->smooth_normal != NULL ? kind->smooth_normal(shot, vertex) : vertex->ng;
}

/* Sets the frame for a graph: its t points east. */
static void set_frame(const pl_snapshot *shot, const pl_shot_body *body, const pl_body_place *place,
                      pl_vertex *vertex) {
  const pl_vec3 east = {-place->point.y, place->point.x, 0.0};
  pl_surface_set_frame(&vertex->surface, normal_at(shot, vertex),
                       pl_vec3_to_float(pl_mat3_mul_vec(body->rotation, pl_vec3_unit(east))), 1.0f);
}

/* The point of a graph, of a vertex with its frame. */
static pl_graph_point graph_point(const pl_shot_body *body, const pl_beam *beam,
                                  const pl_body_place *place, pl_detail detail,
                                  const pl_vertex *vertex) {
  const pl_surface *s = &vertex->surface;
  const double area = pl_vec3_norm(pl_vec3_cross(place->across, place->along));
  return (pl_graph_point){
      .object = pl_vec3_to_float(place->point),
      .world = pl_vec3_to_float(pl_vec3_sub(vertex->position, body->center)),
      .t = s->t,
      .b = s->b,
      .n = s->n,
      .ng = vertex->ng,
      .view = pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0)),
      .filter = detail.filter,
      .bumps = detail.bumps,
      .radius = detail.maps ? (float)sqrt(area / PL_PI) : INFINITY,
      .random = body->body->random,
      .scale = 1.0f,
      .body = &body->rotation,
      .place = place->point,
      .across = place->across,
      .along = place->along,
      .map_center_lon_rad = body->body->map_center_lon_rad,
      .map_oblate = place->oblate,
      .body_map = body->body->map,
      .body_albedo = body->state->albedo,
      .body_emission = body->state->emission,
  };
}

/* The surface from the body's graph. */
static void shade_body_graph(const pl_snapshot *shot, const pl_shot_body *body, const pl_beam *beam,
                             pl_detail detail, pl_vertex *vertex) {
  const pl_graph *graph = body->body->graph;
  const pl_body_place place = place_of(body, vertex, beam);
  set_frame(shot, body, &place, vertex);
  if (pl_graph_wraps(graph))
    own_surface(body, beam, &place, detail, vertex);
  const pl_graph_point point = graph_point(body, beam, &place, detail, vertex);
  pl_surface *const surface = &vertex->surface;
  if (detail.color_only)
    pl_graph_colors(graph, &point, 1, body->state->parameters, &surface);
  else
    pl_graph_surface(graph, &point, body->state->parameters, surface);
}

void pl_body_surface_classify(const pl_snapshot *shot, const pl_shot_body *body,
                              const pl_beam *beam, pl_vertex *vertex, uint16_t *ids) {
  const pl_beam thin = {.direction = beam->direction}; /* labels are those of the point itself */
  if (body->body->graph == NULL || !pl_graph_has_levels(body->body->graph))
    return;
  const pl_body_place place = place_of(body, vertex, &thin);
  set_frame(shot, body, &place, vertex);
  const pl_graph_point point = graph_point(body, &thin, &place, PL_DETAIL_FULL, vertex);
  pl_graph_classify(body->body->graph, &point, body->state->parameters, ids);
}

static bool has_ground(const pl_ground *ground) {
  return ground->ocean || ground->lights != NULL || pl_ground_has_relief(ground);
}

void pl_body_surface_shade(const pl_snapshot *shot, const pl_shot_body *body, const pl_beam *beam,
                           pl_detail detail, pl_vertex *vertex) {
  if (body->body->graph != NULL) {
    shade_body_graph(shot, body, beam, detail, vertex);
    return;
  }
  const bool ground = has_ground(&body->body->ground);
  pl_body_place place = {0};
  if (detail.maps && (ground || body->body->map != NULL))
    place = place_of(body, vertex, beam);
  if (!detail.color_only)
    pl_surface_set_frame(&vertex->surface, normal_at(shot, vertex), (pl_vec3f){0.0f, 0.0f, 0.0f},
                         1.0f);
  own_surface(body, beam, &place, detail, vertex);
  if (!ground || (detail.color_only && !pl_ground_tints(body)))
    return;
  pl_ground_bend(body, &place, detail, &vertex->surface);
  pl_ground_flood(body, &place, detail, &vertex->surface);
  if (detail.lights && body->body->ground.lights != NULL)
    pl_ground_light(body, &shot->sun, &place, detail, vertex);
}
