/* Vertices of paths. Positions are in double precision, shading in single. */
#include "render/vertex.h"

#include "geom/ellipsoid.h"
#include "math/sampling.h"
#include "render/body_surface.h"
#include "scene/shot_frame.h"

static void set_weights(pl_vertex *vertex, double u, double v) {
  vertex->w[1] = pl_minf(pl_maxf((float)u, 0.0f), 1.0f);
  vertex->w[2] = pl_minf(pl_maxf((float)v, 0.0f), 1.0f - vertex->w[1]);
  vertex->w[0] = 1.0f - vertex->w[1] - vertex->w[2];
}

/* Copies the tracer's hit. */
static void locate_mesh(const pl_shot_object *object, const pl_beam *beam, const pl_hit *hit,
                        pl_vertex *out) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)hit->triangle;
  const float *a = model->positions + 3 * (size_t)corner[0];
  const pl_shot_piece *piece = pl_shot_piece_of(object, hit->triangle);
  const float *to_view = piece != NULL ? piece->to_view : object->to_view;
  out->edge1 = pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[1]);
  out->edge2 = pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[2]);
  out->ng = pl_vec3f_across(out->edge1, out->edge2);
  if (piece != NULL)
    out->ng = pl_vec3f_scale(out->ng, piece->side);
  out->t = hit->t;
  out->position = pl_vec3_madd(beam->origin, out->t, beam->direction);
  set_weights(out, hit->u, hit->v);
}

/* Intersects the plane of the hit triangle in double precision, with barycentric weights from
 * areas. A sliver whose plane is undefined or seen edge-on keeps the tracer's result. */
static void refine_mesh(const pl_shot_object *object, const pl_beam *beam, const pl_hit *hit,
                        pl_vertex *out) {
  const uint32_t *corner = object->object->model->indices + 3 * (size_t)hit->triangle;
  const pl_shot_piece *piece = pl_shot_piece_of(object, hit->triangle);
  const float *positions = object->object->model->positions;
  const pl_vec3 a = pl_shot_corner(object, piece, positions + 3 * (size_t)corner[0]);
  const pl_vec3 e1 =
      pl_vec3_sub(pl_shot_corner(object, piece, positions + 3 * (size_t)corner[1]), a);
  const pl_vec3 e2 =
      pl_vec3_sub(pl_shot_corner(object, piece, positions + 3 * (size_t)corner[2]), a);
  const pl_vec3 normal = pl_vec3_cross(e1, e2);
  const pl_vec3 from = pl_vec3_sub(beam->origin, a);
  const double facing = pl_vec3_dot(normal, beam->direction);
  const double area2 = pl_vec3_dot(normal, normal);
  if (!(fabs(facing) > 1e-9 * sqrt(area2)))
    return;
  const double t = -pl_vec3_dot(normal, from) / facing;
  if (!(fabs(t - out->t) <= 1e-3 * object->radius_m))
    return;
  const pl_vec3 p = pl_vec3_madd(from, t, beam->direction);
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
  out->ng = pl_vec3_to_float(pl_vec3_unit(normal));
  if (piece != NULL)
    out->ng = pl_vec3f_scale(out->ng, piece->side);
  set_weights(out, pl_vec3_dot(pl_vec3_cross(p, e2), normal) / area2,
              pl_vec3_dot(pl_vec3_cross(e1, p), normal) / area2);
}

/* Sets the point at distance t along the beam. */
static void set_body_point(const pl_shot_body *body, const pl_beam *beam, double t,
                           pl_vertex *out) {
  const pl_mat3 m = body->rotation;
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
  const pl_vec3 local = pl_mat3_mul_vec_t(m, pl_vec3_sub(out->position, body->center));
  const pl_vec3 normal = pl_ellipsoid_normal(body->state->radii_m, local);
  out->ng = pl_vec3_to_float(pl_mat3_mul_vec(m, normal));
  out->w[0] = out->w[1] = out->w[2] = 0.0f;
}

static bool meet_body(const pl_shot_body *body, const pl_beam *beam, double *t) {
  if (body->shape != NULL)
    return false;
  const pl_vec3 origin =
      pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(body->to_unit, beam->origin));
  return pl_unit_sphere_intersect(origin, pl_mat3_mul_vec(body->to_unit, beam->direction), 0.0, t);
}

static void locate_body(const pl_shot_body *body, const pl_beam *beam, const pl_hit *hit,
                        pl_vertex *out) {
  double t = hit->t;
  meet_body(body, beam, &t);
  set_body_point(body, beam, t, out);
}

bool pl_vertex_meet_bodies(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *out) {
  double nearest = INFINITY;
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    double t;
    if (!meet_body(body, beam, &t) || !(t < nearest))
      continue;
    nearest = t;
    out->surface_id = pl_surface_of_body(i);
  }
  if (nearest == INFINITY)
    return false;
  out->triangle = 0;
  set_body_point(pl_shot_body_of(shot, out->surface_id), beam, nearest, out);
  return true;
}

void pl_vertex_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                      pl_vertex *out) {
  out->surface_id = hit->surface_id;
  out->triangle = hit->triangle;
  if (!pl_surface_is_mesh(hit->surface_id)) {
    locate_body(pl_shot_body_of(shot, hit->surface_id), beam, hit, out);
    return;
  }
  locate_mesh(pl_shot_object_of(shot, hit->surface_id), beam, hit, out);
  if (exact)
    refine_mesh(pl_shot_object_of(shot, hit->surface_id), beam, hit, out);
}

void pl_vertex_footprint(const pl_vertex *vertex, const pl_beam *beam, pl_vec3f *a, pl_vec3f *b) {
  const float width = beam->width_m + beam->spread * (float)vertex->t;
  const pl_vec3f d = pl_vec3_to_float(beam->direction), n = vertex->ng;
  const float cosine = pl_maxf(fabsf(pl_vec3f_dot(d, n)), 0.02f);
  pl_vec3f across = pl_vec3f_cross(n, d);
  if (pl_vec3f_dot(across, across) < 1e-8f)
    across = pl_basis_make(n).t;
  across = pl_vec3f_unit(across);
  *a = pl_vec3f_scale(across, width);
  *b = pl_vec3f_scale(pl_vec3f_cross(across, n), width / cosine);
}

/* Evaluates the surface's graph. Without maps its footprint is infinite, so that patterns are
 * replaced by their means. */
static void shade_graph(const pl_shot_object *object, const pl_object_graph *graph,
                        const pl_triangle_point *triangle, pl_detail detail, const pl_beam *beam,
                        pl_vertex *vertex) {
  pl_surface *s = &vertex->surface;
  /* A circle with the area of the pixel's parallelogram. */
  const float area = pl_vec3f_norm(triangle->footprint_a) * pl_vec3f_norm(triangle->footprint_b);
  pl_graph_point point = {
      .world = pl_vec3_to_float(pl_vec3_sub(vertex->position, object->position)),
      .t = s->t,
      .b = s->b,
      .n = s->n,
      .ng = vertex->ng,
      .view = pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0)),
      .filter = detail.filter,
      .bumps = detail.bumps,
      .radius = detail.maps ? sqrtf(area / PL_PI_F) : INFINITY,
      .random = object->object->materials->random,
      .model = object->object->model,
      .triangle = *triangle,
      .offset = object->object->offset,
      .scale = (float)object->scale,
  };
  point.object = pl_graph_point_object(&point);
  const pl_value *own = object->parameters;
  pl_graph_surface(graph->graph, &point, own != NULL ? own + graph->first_parameter : NULL, s);
}

/* Whether the beam sees the back of a material that emits from its front only. */
static bool is_dark(const pl_shot_object *object, const pl_beam *beam, const pl_vertex *vertex) {
  return pl_material_of(object->object->model, vertex->triangle)->dark_behind &&
         pl_vec3_dot(pl_vec3f_to_double(vertex->ng), beam->direction) > 0.0;
}

static void shade_mesh(const pl_shot_object *object, const pl_beam *beam, pl_detail detail,
                       pl_vertex *vertex) {
  pl_shot_frame(object, vertex->triangle, vertex->w, vertex->ng, &vertex->surface);
  pl_triangle_point point = {.triangle = vertex->triangle,
                             .w = {vertex->w[0], vertex->w[1], vertex->w[2]},
                             .edge1 = vertex->edge1,
                             .edge2 = vertex->edge2};
  pl_vertex_footprint(vertex, beam, &point.footprint_a, &point.footprint_b);
  const pl_object_graph *graph =
      pl_object_materials_at(object->object->materials, vertex->triangle);
  if (graph == NULL || pl_graph_wraps(graph->graph))
    pl_material_surface(object->object->model, &point, detail, &vertex->surface);
  if (graph != NULL)
    shade_graph(object, graph, &point, detail, beam, vertex);
  if (is_dark(object, beam, vertex))
    vertex->surface.emission = (pl_vec3f){0.0f, 0.0f, 0.0f};
}

/* An interpolated normal can face away from a viewer who sees the surface. It is bent back to this
 * cosine. */
#define GRAZING 1e-3f

static pl_vec3f bring_back(pl_vec3f n, float cosine, pl_vec3f view) {
  return pl_vec3f_unit(pl_vec3f_madd(n, GRAZING - cosine, view));
}

/* Surfaces are two-sided, because the winding of published models is not reliable. */
static void face_viewer(pl_surface *surface, pl_vec3f ng, pl_vec3f view) {
  surface->ng = ng;
  if (pl_vec3f_dot(ng, view) < 0.0f) {
    surface->ng = pl_vec3f_scale(ng, -1.0f);
    surface->n = pl_vec3f_scale(surface->n, -1.0f);
    surface->b = pl_vec3f_scale(surface->b, -1.0f);
  }
  const float cosine = pl_vec3f_dot(surface->n, view);
  if (cosine < GRAZING)
    pl_surface_set_frame(surface, bring_back(surface->n, cosine, view), surface->t, 1.0f);
}

void pl_vertex_face_layers(pl_vertex *vertex) {
  pl_lobes *lobes = &vertex->surface.lobes;
  if (!(pl_vec3f_dot(vertex->ng, vertex->surface.ng) < 0.0f))
    return;
  lobes->coat_normal = pl_vec3f_scale(lobes->coat_normal, -1.0f);
  lobes->inside = lobes->ior > 0.0f;
}

void pl_vertex_orient(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex) {
  const bool on_mesh = pl_surface_is_mesh(vertex->surface_id);
  const pl_vec3f n = on_mesh ? pl_shot_normal(pl_shot_object_of(shot, vertex->surface_id),
                                              vertex->triangle, vertex->w, vertex->ng)
                             : vertex->ng;
  const bool behind = pl_vec3_dot(pl_vec3f_to_double(vertex->ng), beam->direction) > 0.0;
  vertex->surface.ng = behind ? pl_vec3f_scale(vertex->ng, -1.0f) : vertex->ng;
  vertex->surface.n = behind ? pl_vec3f_scale(n, -1.0f) : n;
  const pl_vec3f view = pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0));
  const float cosine = pl_vec3f_dot(vertex->surface.n, view);
  if (on_mesh && cosine < GRAZING) /* normals of bodies are exact */
    vertex->surface.n = bring_back(vertex->surface.n, cosine, view);
}

void pl_vertex_shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                     pl_vertex *vertex) {
  if (pl_surface_kind_of(vertex->surface_id) == PL_SURFACE_MESH)
    shade_mesh(pl_shot_object_of(shot, vertex->surface_id), beam, detail, vertex);
  else if (pl_surface_is_shape(vertex->surface_id))
    pl_body_surface_shade(shot,
                          &shot->bodies[pl_shot_object_of(shot, vertex->surface_id)->object->body],
                          beam, detail, vertex);
  else
    pl_body_surface_shade(shot, pl_shot_body_of(shot, vertex->surface_id), beam, detail, vertex);
  face_viewer(&vertex->surface, vertex->ng, pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0)));
  /* the hemisphere of rays that start at the lifted origin, see lift */
  if (pl_surface_is_shape(vertex->surface_id))
    vertex->surface.ng = pl_shot_normal(pl_shot_object_of(shot, vertex->surface_id),
                                        vertex->triangle, vertex->w, vertex->surface.ng);
}

/* pl_ray.leaves of a ray that leaves a shape, m. In hollows the smooth surface is below the facets,
 * and facets that face away from the sun, or are in the shadow of these, are on its lit side.
 * Triangles farther away cast true shadows. */
static float facet_size(const pl_vertex *vertex) {
  return pl_maxf(pl_vec3f_norm(vertex->edge1), pl_vec3f_norm(vertex->edge2));
}

/* Offset from a point of a facet to the smooth surface that the vertex normals describe: the mean,
 * with barycentric weights, of its offsets to the tangent planes at the corners (Hanika 2021,
 * "Hacking the shadow terminator", Ray Tracing Gems II, chapter 4). Rays from there do not hit
 * neighbouring facets only because of the tessellation, which would make shadows on round ground
 * start with jagged edges. Never inwards, and zero on flat facets. */
static pl_vec3f lift(const pl_shot_object *object, const pl_vertex *vertex) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)vertex->triangle;
  const float *w = vertex->w;
  const pl_vec3f from = pl_vec3f_madd(pl_vec3f_scale(vertex->edge1, w[1]), w[2], vertex->edge2);
  const pl_vec3f to_corner[3] = {{0.0f, 0.0f, 0.0f}, vertex->edge1, vertex->edge2};
  pl_vec3f out = {0.0f, 0.0f, 0.0f};
  for (int k = 0; k < 3; k++) {
    const float *n = model->normals + 3 * (size_t)corner[k];
    const pl_vec3f normal = pl_shot_rotate(&object->rotation, pl_vec3f_make(n[0], n[1], n[2]));
    const float below = pl_vec3f_dot(pl_vec3f_sub(to_corner[k], from), normal);
    out = pl_vec3f_madd(out, w[k] * pl_maxf(below, 0.0f), normal);
  }
  return out;
}

/* Offset of secondary rays from a mesh, over its radius: about sixteen rounding errors of its
 * coordinates. */
static const double CLEARANCE = 0x1p-20;

pl_ray pl_vertex_ray(const pl_vertex *vertex, const pl_snapshot *shot, pl_vec3f direction,
                     double t_max) {
  const bool on_body = !pl_surface_is_mesh(vertex->surface_id);
  const float side = pl_vec3f_dot(direction, vertex->surface.ng) < 0.0f ? -1.0f : 1.0f;
  const double offset =
      on_body ? 0.0
              : (double)side * CLEARANCE * pl_shot_object_of(shot, vertex->surface_id)->radius_m;
  pl_vec3 origin = pl_vec3_madd(vertex->position, offset, pl_vec3f_to_double(vertex->surface.ng));
  const bool outwards = pl_surface_is_shape(vertex->surface_id) && side > 0.0f;
  if (outwards)
    origin = pl_vec3_add(
        origin, pl_vec3f_to_double(lift(pl_shot_object_of(shot, vertex->surface_id), vertex)));
  return (pl_ray){
      .origin = origin,
      .t_max = t_max,
      .direction = pl_vec3_unit(pl_vec3f_to_double(direction)),
      .skip_body = on_body ? pl_surface_index(vertex->surface_id) : PL_NO_BODY,
      .from_surface = vertex->surface_id,
      .from_triangle = on_body ? 0 : vertex->triangle + 1,
      .leaves = outwards ? facet_size(vertex) : 0.0f,
  };
}
