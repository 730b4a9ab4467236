/* Rocks on the terrain of bodies: meshes with the surface of the body. In a vertex on a rock,
 * `triangle` counts among the rocks of all tiles of the body's height field. */
#include "render/body_surface.h"
#include "render/fine_slopes.h"
#include "render/geometry.h"
#include "terrain/height_field.h"
#include "terrain/rock_relief.h"

static pl_vec3f to_root(const pl_shot_body *body, pl_vec3 v) {
  return pl_vec3_to_float(pl_mat3_mul_vec(body->rotation, v));
}

/* Intersects the plane of the triangle in double precision, with barycentric weights from areas. A
 * triangle seen edge-on keeps the tracer's result. */
static void refine(const pl_shot_body *body, const pl_vec3 corners[3], const pl_beam *beam,
                   pl_vertex *out) {
  const pl_vec3 e1 = pl_vec3_sub(corners[1], corners[0]), e2 = pl_vec3_sub(corners[2], corners[0]);
  const pl_vec3 normal = pl_vec3_cross(e1, e2);
  const pl_vec3 origin =
      pl_vec3_sub(pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(beam->origin, body->center)),
                  body->field->origin);
  const pl_vec3 from = pl_vec3_sub(origin, corners[0]);
  const pl_vec3 along = pl_mat3_mul_vec_t(body->rotation, beam->direction);
  const double facing = pl_vec3_dot(normal, along), area2 = pl_vec3_dot(normal, normal);
  if (!(fabs(facing) > 1e-6 * sqrt(area2)))
    return;
  const double t = -pl_vec3_dot(normal, from) / facing;
  if (!(fabs(t - out->t) <= pl_vec3_norm(e1) + 1e-6 * out->t))
    return;
  const pl_vec3 p = pl_vec3_madd(from, t, along);
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
  const double v = pl_vec3_dot(pl_vec3_cross(p, e2), normal) / area2;
  const double w = pl_vec3_dot(pl_vec3_cross(e1, p), normal) / area2;
  out->w[1] = pl_minf(pl_maxf((float)v, 0.0f), 1.0f);
  out->w[2] = pl_minf(pl_maxf((float)w, 0.0f), 1.0f - out->w[1]);
  out->w[0] = 1.0f - out->w[1] - out->w[2];
}

static void locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                   pl_vertex *out) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  const pl_rock_hit rock = pl_height_field_rock(body->field, hit->triangle);
  pl_vec3 corners[3];
  pl_rock_hit_corners(body->field, &rock, corners);
  out->w[1] = hit->u;
  out->w[2] = hit->v;
  out->w[0] = 1.0f - hit->u - hit->v;
  out->t = hit->t;
  out->position = pl_vec3_madd(beam->origin, out->t, beam->direction);
  out->edge1 = to_root(body, pl_vec3_sub(corners[1], corners[0]));
  out->edge2 = to_root(body, pl_vec3_sub(corners[2], corners[0]));
  out->ng = pl_vec3f_across(out->edge1, out->edge2);
  if (exact)
    refine(body, corners, beam, out);
}

static pl_vec3f smooth_normal(const pl_snapshot *shot, const pl_vertex *vertex) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  const pl_rock_hit rock = pl_height_field_rock(body->field, vertex->triangle);
  return to_root(body, pl_rock_hit_normal(&rock, vertex->w));
}

/* Grain and relief of the rock itself. */
static void shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                  pl_vertex *vertex) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  pl_surface *surface = &vertex->surface;
  pl_body_surface_shade(shot, body, beam, detail, vertex);
  if (!detail.maps && !detail.sub_cell)
    return;
  const pl_rock *rock = &pl_height_field_rock(body->field, vertex->triangle).rock->rock;
  const pl_vec3 from =
      pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center));
  const pl_vec3 point = pl_vec3_sub(from, rock->center);
  const double footprint_m = pl_fine_slopes_footprint_m(vertex, beam);
  if (detail.maps)
    surface->color = pl_vec3f_scale(surface->color, (float)pl_rock_tint(rock, point, footprint_m));
  if (!detail.sub_cell || detail.color_only)
    return;
  const pl_vec3 normal = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(surface->n));
  const pl_rock_relief relief = pl_rock_relief_at(rock, point, normal, footprint_m);
  const double whole = relief.variance + relief.unseen;
  const pl_rough rough = {.slope = to_root(body, relief.slope),
                          .variance = (float)relief.unseen,
                          .whole = (float)whole};
  pl_fine_slopes_set(vertex, &rough, whole);
}

/* As terrain: points are camera-relative. */
static void set_spot(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 point, pl_spot *spot) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  const pl_rock_hit rock = pl_height_field_rock(body->field, hit->triangle);
  const float weights[3] = {1.0f - hit->u - hit->v, hit->u, hit->v};
  spot->point = pl_vec3_to_float(point);
  spot->normal = to_root(body, pl_rock_hit_normal(&rock, weights));
}

static void label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out) {
  pl_body_label(shot, id, out);
  out->on_ground = pl_shot_body_of(shot, id)->body->ground_labels;
  out->on_ground.crater = 0;
}

const pl_geometry_kind pl_geometry_rocks = {
    .name = "rocks",
    .bounds = pl_body_bounds,
    .locate = locate,
    .smooth_normal = smooth_normal,
    .shade = shade,
    .leave = pl_height_field_leave,
    .set_spot = set_spot,
    .label = label,
};
