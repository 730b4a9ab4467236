/* Ellipsoids of bodies. */
#include "geom/ellipsoid.h"
#include "render/body_surface.h"
#include "render/geometry.h"
#include "shade/graph_classes.h"

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

static void locate_body(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                        pl_vertex *out) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  double t = hit->t;
  (void)exact; /* it always is */
  meet_body(body, beam, &t);
  set_body_point(body, beam, t, out);
}

bool pl_vertex_meet_bodies(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *out) {
  double nearest = INFINITY;
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    double t;
    if (pl_shot_kind_of(body) != PL_SURFACE_ELLIPSOID || !meet_body(body, beam, &t) ||
        !(t < nearest))
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

static void classify(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex,
                     uint16_t *ids) {
  pl_body_surface_classify(shot, pl_shot_body_of(shot, vertex->surface_id), beam, vertex, ids);
}

static void shade_body(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                       pl_vertex *vertex) {
  pl_body_surface_shade(shot, pl_shot_body_of(shot, vertex->surface_id), beam, detail, vertex);
}

static void leave_body(const pl_snapshot *shot, const pl_vertex *vertex, float side, pl_ray *ray) {
  (void)shot;
  (void)side;
  ray->origin = vertex->position;
  ray->skip_body = pl_surface_index(vertex->surface_id);
}

/* `point`: relative to the body's centre. */
static pl_vec3f body_normal(const pl_shot_body *body, pl_vec3 point) {
  const pl_vec3 local = pl_mat3_mul_vec_t(body->rotation, point);
  return pl_vec3_to_float(
      pl_mat3_mul_vec(body->rotation, pl_ellipsoid_normal(body->state->radii_m, local)));
}

static void set_body_spot(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 point,
                          pl_spot *spot) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  const pl_vec3 from_center = pl_vec3_sub(point, body->center);
  spot->point = pl_vec3_to_float(from_center);
  spot->normal = body_normal(body, from_center);
}

pl_geometry_bounds pl_body_bounds(const pl_snapshot *shot, pl_surface_id id) {
  const pl_shot_body *body = pl_shot_body_of(shot, id);
  return (pl_geometry_bounds){body->center, body->outer_m, body->in_frame};
}

void pl_body_surface_label(const pl_body *body, pl_geometry_label *out) {
  out->parts = NULL;
  out->areas = body->area_map.count > 0 ? &body->area_map : NULL;
  out->class_ids = body->parts.class_ids;
  out->part_ids = body->parts.part_ids;
  out->instance_id = body->instance_id;
  out->classified = body->graph != NULL && pl_graph_has_levels(body->graph);
}

void pl_body_label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out) {
  const pl_shot_body *body = pl_shot_body_of(shot, id);
  *out = (pl_geometry_label){.origin = body->center, .rotation = body->rotation};
  pl_body_surface_label(body->body, out);
}

const pl_geometry_kind pl_geometry_ellipsoid = {
    .name = "ellipsoid",
    .bounds = pl_body_bounds,
    .intersect = &pl_intersect_ellipsoids,
    .locate = locate_body,
    .shade = shade_body,
    .leave = leave_body,
    .set_spot = set_body_spot,
    .label = pl_body_label,
    .classify = classify,
};
