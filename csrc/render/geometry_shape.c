/* Shapes of bodies: meshes with the surface of the body. */
#include "render/body_surface.h"
#include "render/geometry.h"
#include "scene/shot_frame.h"

static void shade_shape(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                        pl_vertex *vertex) {
  const pl_object *object = pl_shot_object_of(shot, vertex->surface_id)->object;
  pl_body_surface_shade(shot, &shot->bodies[object->body], beam, detail, vertex);
}

static void classify(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex,
                     uint16_t *ids) {
  const pl_object *object = pl_shot_object_of(shot, vertex->surface_id)->object;
  pl_body_surface_classify(shot, &shot->bodies[object->body], beam, vertex, ids);
}

/* The hemisphere of rays that start at the lifted origin, see lift. */
static void set_horizon(const pl_snapshot *shot, pl_vertex *vertex) {
  vertex->surface.ng = pl_shot_normal(pl_shot_object_of(shot, vertex->surface_id), vertex->triangle,
                                      vertex->w, vertex->surface.ng);
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

static void leave_shape(const pl_snapshot *shot, const pl_vertex *vertex, float side, pl_ray *ray) {
  pl_mesh_leave(shot, vertex, side, ray);
  if (!(side > 0.0f))
    return;
  const pl_vec3f up = lift(pl_shot_object_of(shot, vertex->surface_id), vertex);
  ray->origin = pl_vec3_add(ray->origin, pl_vec3f_to_double(up));
  ray->leaves = facet_size(vertex);
}

static void label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out) {
  const pl_object *object = pl_shot_object_of(shot, id)->object;
  pl_mesh_label(shot, id, out);
  pl_body_surface_label(shot->bodies[object->body].body, out);
}

const pl_geometry_kind pl_geometry_shape = {
    .name = "shape",
    .bounds = pl_mesh_bounds,
    .intersect = &pl_intersect_objects,
    .cover = pl_coverage_object,
    .locate = pl_mesh_locate,
    .smooth_normal = pl_mesh_smooth_normal,
    .shade = shade_shape,
    .set_horizon = set_horizon,
    .leave = leave_shape,
    .set_spot = pl_mesh_set_spot,
    .label = label,
    .classify = classify,
};
