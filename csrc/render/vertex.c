/* Positions in double; shading in float. */
#include "render/vertex.h"

#include "geom/ellipsoid.h"
#include "math/sampling.h"

static pl_vec3 corner_of(const pl_shot_object *object, uint32_t index) {
  const float *p = object->object->model->positions + 3 * (size_t)index;
  const pl_vec3 local = pl_vec3_scale(
      pl_vec3_sub((pl_vec3){p[0], p[1], p[2]}, object->object->offset), object->scale);
  return pl_vec3_add(object->position, pl_mat3_mul_vec(object->rotation, local));
}

/* Plane of the winning triangle in double; weights from areas. A sliver whose plane is undefined
 * keeps the tracer's own answer. */
static void locate_mesh(const pl_shot_object *object, const pl_beam *beam, const pl_hit *hit,
                        pl_vertex *out) {
  const uint32_t *corner = object->object->model->indices + 3 * (size_t)hit->triangle;
  const pl_vec3 a = corner_of(object, corner[0]);
  const pl_vec3 e1 = pl_vec3_sub(corner_of(object, corner[1]), a);
  const pl_vec3 e2 = pl_vec3_sub(corner_of(object, corner[2]), a);
  const pl_vec3 normal = pl_vec3_cross(e1, e2);
  const pl_vec3 from = pl_vec3_sub(beam->origin, a);
  const double facing = pl_vec3_dot(normal, beam->direction);
  const double area2 = pl_vec3_dot(normal, normal);
  double t = hit->t, u = hit->u, v = hit->v;
  if (fabs(facing) > 1e-9 * sqrt(area2)) {
    const double exact = -pl_vec3_dot(normal, from) / facing;
    if (fabs(exact - t) <=
        1e-3 * fabs(t) + 1e-3) { /* otherwise edge-on: rounding, not refinement */
      const pl_vec3 p = pl_vec3_madd(from, exact, beam->direction);
      t = exact;
      u = pl_vec3_dot(pl_vec3_cross(p, e2), normal) / area2;
      v = pl_vec3_dot(pl_vec3_cross(e1, p), normal) / area2;
    }
  }
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
  out->w[1] = fminf(fmaxf((float)u, 0.0f), 1.0f);
  out->w[2] = fminf(fmaxf((float)v, 0.0f), 1.0f - out->w[1]);
  out->w[0] = 1.0f - out->w[1] - out->w[2];
  out->ng = pl_vec3_to_float(pl_vec3_unit(normal));
}

static void locate_body(const pl_shot_body *body, const pl_beam *beam, const pl_hit *hit,
                        pl_vertex *out) {
  const pl_vec3 origin = pl_vec3_add(body->camera, pl_mat3_mul_vec_t(body->rotation, beam->origin));
  const pl_vec3 direction = pl_mat3_mul_vec_t(body->rotation, beam->direction);
  double t = hit->t;
  pl_ellipsoid_intersect(body->state->radii_m, origin, direction, 0.0, &t);
  const pl_vec3 local = pl_vec3_madd(origin, t, direction);
  const pl_vec3 normal = pl_ellipsoid_normal(body->state->radii_m, local);
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
  out->ng = pl_vec3_to_float(pl_mat3_mul_vec(body->rotation, normal));
  out->w[0] = out->w[1] = out->w[2] = 0.0f;
}

void pl_vertex_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit,
                      pl_vertex *out) {
  out->thing = hit->thing;
  out->triangle = hit->triangle;
  if (hit->thing < shot->object_count)
    locate_mesh(&shot->objects[hit->thing], beam, hit, out);
  else
    locate_body(&shot->bodies[hit->thing - shot->object_count], beam, hit, out);
}

/* The cone's ellipse on the tangent plane: across, and along the view direction's projection. */
static void footprint(const pl_vertex *vertex, const pl_beam *beam, pl_vec3f *a, pl_vec3f *b) {
  const float width = beam->width_m + beam->spread * (float)vertex->t;
  const pl_vec3f d = pl_vec3_to_float(beam->direction), n = vertex->ng;
  const float cosine = fmaxf(fabsf(pl_vec3f_dot(d, n)), 0.02f);
  pl_vec3f across = pl_vec3f_cross(n, d);
  if (pl_vec3f_dot(across, across) < 1e-8f)
    across = pl_basis_make(n).t;
  across = pl_vec3f_unit(across);
  *a = pl_vec3f_scale(across, width);
  *b = pl_vec3f_scale(pl_vec3f_cross(across, n), width / cosine);
}

static void set_frame(pl_surface *surface, pl_vec3f n, pl_vec3f tangent, float handedness) {
  const pl_vec3f t = pl_vec3f_madd(tangent, -pl_vec3f_dot(tangent, n), n);
  surface->n = n;
  if (pl_vec3f_dot(t, t) > 1e-12f) {
    surface->t = pl_vec3f_unit(t);
    surface->b = pl_vec3f_scale(pl_vec3f_cross(n, surface->t), handedness);
  } else {
    const pl_basis basis = pl_basis_make(n);
    surface->t = basis.t;
    surface->b = basis.b;
  }
}

static pl_vec3f mix3(const float *values, size_t stride, const uint32_t *corner, const float w[3]) {
  pl_vec3f out = {0.0f, 0.0f, 0.0f};
  for (int k = 0; k < 3; k++) {
    const float *v = values + stride * corner[k];
    out = pl_vec3f_madd(out, w[k], pl_vec3f_make(v[0], v[1], v[2]));
  }
  return out;
}

static pl_vec3f rotate(const pl_mat3 *m, pl_vec3f v) {
  return pl_vec3_to_float(pl_mat3_mul_vec(*m, pl_vec3f_to_double(v)));
}

static void shade_mesh(const pl_shot_object *object, const pl_beam *beam, bool maps,
                       pl_vertex *vertex) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)vertex->triangle;
  pl_surface *surface = &vertex->surface;
  pl_vec3f n = pl_vec3f_unit(rotate(&object->rotation, mix3(model->normals, 3, corner, vertex->w)));
  if (pl_vec3f_dot(n, vertex->ng) < 0.0f) /* normals and winding may disagree in published files */
    n = pl_vec3f_scale(n, -1.0f);
  pl_vec3f tangent = {0.0f, 0.0f, 0.0f};
  float handedness = 1.0f;
  if (model->tangents != NULL) {
    tangent = rotate(&object->rotation, mix3(model->tangents, 4, corner, vertex->w));
    handedness = model->tangents[4 * (size_t)corner[0] + 3] < 0.0f ? -1.0f : 1.0f;
  }
  set_frame(surface, n, tangent, handedness);
  pl_triangle_point point = {.triangle = vertex->triangle,
                             .w = {vertex->w[0], vertex->w[1], vertex->w[2]}};
  const pl_vec3 a = corner_of(object, corner[0]);
  point.edge1 = pl_vec3_to_float(pl_vec3_sub(corner_of(object, corner[1]), a));
  point.edge2 = pl_vec3_to_float(pl_vec3_sub(corner_of(object, corner[2]), a));
  footprint(vertex, beam, &point.footprint_a, &point.footprint_b);
  pl_material_surface(model, &point, maps, surface);
}

/* Change of longitude and latitude over a step in body axes, as map coordinates. The poles, where
 * longitude has no derivative, are kept a millionth of the radius away. */
static void map_step(pl_vec3 p, pl_vec3 step, float out[2]) {
  const double r2 = pl_vec3_dot(p, p);
  const double rho2 = fmax(p.x * p.x + p.y * p.y, 1e-12 * r2), rho = sqrt(rho2);
  const double lon = (p.x * step.y - p.y * step.x) / rho2;
  const double lat = (rho * step.z - p.z * (p.x * step.x + p.y * step.y) / rho) / r2;
  out[0] = (float)(lon / (2.0 * PL_PI));
  out[1] = (float)(-lat / PL_PI);
}

static void body_color(const pl_shot_body *body, const pl_vertex *vertex, const pl_beam *beam,
                       bool maps, float out[4]) {
  out[0] = out[1] = out[2] = out[3] = 1.0f;
  if (body->body->map == NULL)
    return;
  if (!maps) {
    pl_texture_mean(body->body->map, out);
    return;
  }
  const pl_vec3 local =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  pl_vec3f across, along;
  float a[2], b[2];
  double lon, lat;
  footprint(vertex, beam, &across, &along);
  map_step(local, pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(across)), a);
  map_step(local, pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(along)), b);
  pl_ellipsoid_lon_lat(local, &lon, &lat);
  const double u = 0.5 + (lon - body->body->map_center_lon_rad) / (2.0 * PL_PI);
  pl_texture_sample(body->body->map, (float)(u - floor(u)), (float)(0.5 - lat / PL_PI), a, b, out);
}

static void shade_body(const pl_shot_body *body, const pl_beam *beam, bool maps,
                       pl_vertex *vertex) {
  const pl_body_state *state = body->state;
  pl_surface *surface = &vertex->surface;
  float map[4];
  set_frame(surface, vertex->ng, (pl_vec3f){0.0f, 0.0f, 0.0f}, 1.0f);
  body_color(body, vertex, beam, maps, map);
  surface->color =
      pl_vec3f_make(fminf(map[0] * state->albedo[0], 1.0f), fminf(map[1] * state->albedo[1], 1.0f),
                    fminf(map[2] * state->albedo[2], 1.0f));
  surface->emission = pl_vec3f_make(state->emission[0], state->emission[1], state->emission[2]);
  surface->metallic = 0.0f;
  surface->alpha = 1.0f;
  surface->reflectance = body->body->reflectance;
}

/* Surfaces are two-sided: published models are not reliably wound. */
static void face_viewer(pl_surface *surface, pl_vec3f ng, pl_vec3f view) {
  surface->ng = ng;
  if (pl_vec3f_dot(ng, view) < 0.0f) {
    surface->ng = pl_vec3f_scale(ng, -1.0f);
    surface->n = pl_vec3f_scale(surface->n, -1.0f);
    surface->b = pl_vec3f_scale(surface->b, -1.0f);
  }
  /* An interpolated normal can lean away from the viewer; bring it back to grazing. */
  const float cosine = pl_vec3f_dot(surface->n, view);
  if (cosine < 1e-3f) {
    const pl_vec3f n = pl_vec3f_unit(pl_vec3f_madd(surface->n, 1e-3f - cosine, view));
    set_frame(surface, n, surface->t, 1.0f);
  }
}

void pl_vertex_shade(const pl_snapshot *shot, const pl_beam *beam, bool maps, pl_vertex *vertex) {
  if (vertex->thing < shot->object_count)
    shade_mesh(&shot->objects[vertex->thing], beam, maps, vertex);
  else
    shade_body(&shot->bodies[vertex->thing - shot->object_count], beam, maps, vertex);
  face_viewer(&vertex->surface, vertex->ng, pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0)));
}

pl_ray pl_vertex_ray(const pl_vertex *vertex, const pl_snapshot *shot, pl_vec3f direction,
                     float t_max) {
  const bool on_body = vertex->thing >= shot->object_count;
  const float side = pl_vec3f_dot(direction, vertex->surface.ng) < 0.0f ? -1.0f : 1.0f;
  const pl_vec3f p = pl_vec3_to_float(vertex->position);
  const float largest = fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
  const float offset = on_body ? 0.0f : side * (0x1p-19f * largest + 1e-6f);
  return (pl_ray){
      .origin = pl_vec3f_madd(p, offset, vertex->surface.ng),
      .t_max = t_max,
      .direction = direction,
      .skip_body = on_body ? vertex->thing - (uint32_t)shot->object_count : PL_NOTHING,
  };
}
