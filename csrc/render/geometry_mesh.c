/* Meshes of objects, with materials and graphs. */
#include "render/geometry.h"
#include "scene/graph_point.h"
#include "scene/shot_frame.h"
#include "shade/graph_classes.h"

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
 * areas. A sliver whose plane is undefined or seen edge-on keeps the tracer's result: the place on
 * the plane is then far from it, and beside the triangle. That of a beam that grazes a large
 * triangle may be far, but is on it. */
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
  const pl_vec3 p = pl_vec3_madd(from, t, beam->direction);
  const double u = pl_vec3_dot(pl_vec3_cross(p, e2), normal) / area2;
  const double v = pl_vec3_dot(pl_vec3_cross(e1, p), normal) / area2;
  const bool inside = t > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0;
  if (!(inside || fabs(t - out->t) <= 1e-3 * object->radius_m))
    return;
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
  out->ng = pl_vec3_to_float(pl_vec3_unit(normal));
  if (piece != NULL)
    out->ng = pl_vec3f_scale(out->ng, piece->side);
  set_weights(out, u, v);
}

void pl_mesh_locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                    pl_vertex *out) {
  const pl_shot_object *object = pl_shot_object_of(shot, hit->surface_id);
  locate_mesh(object, beam, hit, out);
  if (exact)
    refine_mesh(object, beam, hit, out);
}

pl_vec3f pl_mesh_smooth_normal(const pl_snapshot *shot, const pl_vertex *vertex) {
  return pl_shot_normal(pl_shot_object_of(shot, vertex->surface_id), vertex->triangle, vertex->w,
                        vertex->ng);
}

/* The point of a graph. Without maps its footprint is infinite, so that patterns are replaced by
 * their means. */
static pl_graph_point graph_point(const pl_shot_object *object, const pl_triangle_point *triangle,
                                  pl_detail detail, const pl_vertex_view *at) {
  const pl_vertex *vertex = at->vertex;
  const pl_surface *s = &vertex->surface;
  /* A circle with the area of the pixel's parallelogram. */
  const float area = pl_vec3f_norm(triangle->footprint_a) * pl_vec3f_norm(triangle->footprint_b);
  pl_graph_point point = {
      .world = pl_vec3_to_float(pl_vec3_sub(vertex->position, object->position)),
      .t = s->t,
      .b = s->b,
      .n = s->n,
      .ng = vertex->ng,
      .view = pl_vec3_to_float(pl_vec3_scale(at->beam->direction, -1.0)),
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
  return point;
}

/* Points of one graph with one set of parameters. */
typedef struct graph_batch {
  const pl_shot_object *object;
  const pl_object_graph *graph;
  pl_graph_point points[PL_LANES];
  pl_surface *surfaces[PL_LANES];
  size_t count;
} graph_batch;

static void shade_batch(pl_detail detail, graph_batch *batch) {
  const pl_value *own = batch->object->parameters;
  const pl_value *params = own != NULL ? own + batch->graph->first_parameter : NULL;
  (detail.color_only ? pl_graph_colors : pl_graph_surfaces)(batch->graph->graph, batch->points,
                                                            batch->count, params, batch->surfaces);
  batch->count = 0;
}

/* What a vertex of a mesh is, before its graph is evaluated. */
typedef struct mesh_shading {
  const pl_shot_object *object;
  const pl_object_graph *graph; /* NULL: none, or evaluated */
  pl_triangle_point triangle;
} mesh_shading;

/* Sets the frame, and the surface of the model's material where that is seen. */
static mesh_shading start_shading(const pl_snapshot *shot, pl_detail detail,
                                  const pl_vertex_view *at) {
  pl_vertex *vertex = at->vertex;
  const pl_shot_object *object = pl_shot_object_of(shot, vertex->surface_id);
  mesh_shading out = {.object = object,
                      .triangle = {.triangle = vertex->triangle,
                                   .w = {vertex->w[0], vertex->w[1], vertex->w[2]},
                                   .edge1 = vertex->edge1,
                                   .edge2 = vertex->edge2}};
  pl_shot_frame(object, vertex->triangle, vertex->w, vertex->ng, &vertex->surface);
  pl_vertex_footprint(vertex, at->beam, &out.triangle.footprint_a, &out.triangle.footprint_b);
  out.graph = pl_object_materials_at(object->object->materials, vertex->triangle);
  if (out.graph == NULL || pl_graph_wraps(out.graph->graph))
    pl_material_surface(object->object->model, &out.triangle, detail, &vertex->surface);
  return out;
}

/* Evaluates the graph of vertex `first` at all that have the same, as many at a time as there are
 * lanes. */
static void shade_graph(pl_detail detail, const pl_vertex_view *run, mesh_shading *meshes,
                        size_t first, size_t count) {
  graph_batch batch = {.object = meshes[first].object, .graph = meshes[first].graph};
  for (size_t i = first; i < count; i++) {
    if (meshes[i].graph != batch.graph || meshes[i].object != batch.object)
      continue;
    meshes[i].graph = NULL;
    batch.points[batch.count] = graph_point(batch.object, &meshes[i].triangle, detail, &run[i]);
    batch.surfaces[batch.count++] = &run[i].vertex->surface;
    if (batch.count == PL_LANES)
      shade_batch(detail, &batch);
  }
  if (batch.count > 0)
    shade_batch(detail, &batch);
}

/* Labels are those of the point itself, not of a footprint. */
static void classify_mesh(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex,
                          uint16_t *ids) {
  const pl_shot_object *object = pl_shot_object_of(shot, vertex->surface_id);
  const pl_object_graph *graph =
      pl_object_materials_at(object->object->materials, vertex->triangle);
  if (graph == NULL || !pl_graph_has_levels(graph->graph))
    return;
  const pl_graph_point point = pl_shot_graph_point(
      object, vertex->triangle, vertex->w, pl_vec3_to_float(pl_vec3_scale(beam->direction, -1.0)));
  pl_graph_classify(graph->graph, &point, pl_shot_parameters(object, graph), ids);
}

/* Whether the beam sees the back of a material that emits from its front only. */
static bool is_dark(const pl_shot_object *object, const pl_beam *beam, const pl_vertex *vertex) {
  return pl_material_of(object->object->model, vertex->triangle)->dark_behind &&
         pl_vec3_dot(pl_vec3f_to_double(vertex->ng), beam->direction) > 0.0;
}

static void shade_meshes(const pl_snapshot *shot, pl_detail detail, const pl_vertex_view *run,
                         size_t count) {
  mesh_shading meshes[PL_SHADE_RUN];
  for (size_t i = 0; i < count; i++)
    meshes[i] = start_shading(shot, detail, &run[i]);
  for (size_t i = 0; i < count; i++)
    if (meshes[i].graph != NULL)
      shade_graph(detail, run, meshes, i, count);
  for (size_t i = 0; i < count; i++)
    if (is_dark(meshes[i].object, run[i].beam, run[i].vertex))
      run[i].vertex->surface.emission = (pl_vec3f){0.0f, 0.0f, 0.0f};
}

/* Offset of secondary rays from a mesh, over its radius: about sixteen rounding errors of its
 * coordinates. */
static const double CLEARANCE = 0x1p-20;

void pl_mesh_leave(const pl_snapshot *shot, const pl_vertex *vertex, float side, pl_ray *ray) {
  const double offset =
      (double)side * CLEARANCE * pl_shot_object_of(shot, vertex->surface_id)->radius_m;
  ray->origin = pl_vec3_madd(vertex->position, offset, pl_vec3f_to_double(vertex->surface.ng));
  ray->from_triangle = vertex->triangle + 1;
}

static pl_vec3f facet_normal(const pl_shot_object *object, uint32_t triangle) {
  const pl_model *model = object->object->model;
  const uint32_t *corner = model->indices + 3 * (size_t)triangle;
  const float *a = model->positions + 3 * (size_t)corner[0];
  const pl_shot_piece *piece = pl_shot_piece_of(object, triangle);
  const float *to_view = piece != NULL ? piece->to_view : object->to_view;
  return pl_vec3f_across(pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[1]),
                         pl_shot_edge(to_view, a, model->positions + 3 * (size_t)corner[2]));
}

void pl_mesh_set_spot(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 point, pl_spot *spot) {
  const pl_shot_object *object = pl_shot_object_of(shot, hit->surface_id);
  spot->point = pl_vec3_to_float(pl_vec3_sub(point, object->center));
  spot->part = pl_object_part(object->object, hit->triangle);
  spot->normal = facet_normal(object, hit->triangle);
}

pl_geometry_bounds pl_mesh_bounds(const pl_snapshot *shot, pl_surface_id id) {
  const pl_shot_object *object = pl_shot_object_of(shot, id);
  return (pl_geometry_bounds){object->center, object->radius_m, object->in_frame};
}

void pl_mesh_label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out) {
  const pl_shot_object *object = pl_shot_object_of(shot, id);
  *out = (pl_geometry_label){.origin = object->position,
                             .rotation = object->rotation,
                             .parts = object->object,
                             .class_ids = object->object->class_ids,
                             .part_ids = object->object->part_ids,
                             .instance_id = object->object->instance_id,
                             .classified = pl_object_materials_classify(object->object->materials)};
}

const pl_geometry_kind pl_geometry_mesh = {
    .name = "mesh",
    .bounds = pl_mesh_bounds,
    .intersect = &pl_intersect_objects,
    .cover = pl_coverage_object,
    .locate = pl_mesh_locate,
    .smooth_normal = pl_mesh_smooth_normal,
    .shade_run = shade_meshes,
    .leave = pl_mesh_leave,
    .set_spot = pl_mesh_set_spot,
    .label = pl_mesh_label,
    .classify = classify_mesh,
};
