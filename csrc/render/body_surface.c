/* Maps are read where the ray meets the body, over the ray's footprint; positions in double. */
#include "render/body_surface.h"

#include "render/regolith.h"
#include "scene/shot_frame.h"
#include "shade/body_map.h"
#include "shade/reflectance.h"

/* A point of a body and the footprint about it, body axes, m. */
typedef struct body_footprint {
  pl_vec3 point, across, along;
} body_footprint;

static void find_footprint(const pl_shot_body *body, const pl_vertex *vertex, const pl_beam *beam,
                           body_footprint *out) {
  pl_vec3f across, along;
  out->point = pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  pl_vertex_footprint(vertex, beam, &across, &along);
  out->across = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(across));
  out->along = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(along));
}

static void body_color(const pl_shot_body *body, const pl_vertex *vertex, const pl_beam *beam,
                       pl_detail detail, float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 1.0f;
  if (body->body->map == NULL)
    return;
  if (!detail.maps) {
    pl_texture_mean(body->body->map, out);
    return;
  }
  body_footprint print;
  find_footprint(body, vertex, beam, &print);
  const pl_body_place place = {print.point, print.across, print.along,
                               body->body->map_center_lon_rad};
  pl_body_map_sample(body->body->map, &place, detail.filter, out);
}

/* The body's own surface, but for its frame. */
static void own_surface(const pl_shot_body *body, const pl_beam *beam, pl_detail detail,
                        pl_vertex *vertex) {
  const pl_body_state *state = body->state;
  pl_surface *surface = &vertex->surface;
  float map[4];
  body_color(body, vertex, beam, detail, map);
  surface->color = pl_vec3f_make(pl_minf(map[0] * state->albedo[0], 1.0f),
                                 pl_minf(map[1] * state->albedo[1], 1.0f),
                                 pl_minf(map[2] * state->albedo[2], 1.0f));
  surface->emission = pl_vec3f_make(state->emission[0], state->emission[1], state->emission[2]);
  surface->metallic = 0.0f;
  surface->alpha = 1.0f;
  surface->lobes = pl_lobes_plain();
  surface->reflectance = body->body->reflectance;
  if (surface->reflectance->photometric)
    pl_regolith_shade(body, beam, detail.maps, vertex);
}

/* The outward normal that is shaded: smooth on the shape of a body. */
static pl_vec3f normal_at(const pl_shot_body *body, const pl_vertex *vertex) {
  return body->shape == NULL ? vertex->ng
                             : pl_shot_normal(body->shape, vertex->triangle, vertex->w, vertex->ng);
}

/* The surface by the body's graph; its frame's t points east. */
static void shade_body_graph(const pl_shot_body *body, const pl_beam *beam, pl_detail detail,
                             pl_vertex *vertex) {
  const pl_graph *graph = body->body->graph;
  body_footprint print;
  find_footprint(body, vertex, beam, &print);
  const pl_vec3 east = {-print.point.y, print.point.x, 0.0};
  pl_surface_set_frame(&vertex->surface, normal_at(body, vertex),
                       pl_vec3_to_float(pl_mat3_mul_vec(body->rotation, pl_vec3_unit(east))), 1.0f);
  if (pl_graph_wraps(graph))
    own_surface(body, beam, detail, vertex);
  pl_surface *s = &vertex->surface;
  const double area = pl_vec3_norm(pl_vec3_cross(print.across, print.along));
  const pl_graph_point point = {
      .object = pl_vec3_to_float(print.point),
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
      .place = print.point,
      .across = print.across,
      .along = print.along,
      .map_center_lon_rad = body->body->map_center_lon_rad,
      .body_map = body->body->map,
      .body_albedo = body->state->albedo,
      .body_emission = body->state->emission,
  };
  pl_graph_surface(graph, &point, body->state->parameters, s);
}

void pl_body_surface_shade(const pl_shot_body *body, const pl_beam *beam, pl_detail detail,
                           pl_vertex *vertex) {
  if (body->body->graph != NULL) {
    shade_body_graph(body, beam, detail, vertex);
    return;
  }
  pl_surface_set_frame(&vertex->surface, normal_at(body, vertex), (pl_vec3f){0.0f, 0.0f, 0.0f},
                       1.0f);
  own_surface(body, beam, detail, vertex);
}
