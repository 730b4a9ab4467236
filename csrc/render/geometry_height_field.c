/* Terrain of bodies: height fields with the surface of the body. In a vertex on terrain, `triangle`
 * is the tile, and the last two weights are the tile's grid coordinates. */
#include "render/body_surface.h"
#include "render/geometry.h"
#include "terrain/height_field.h"

static pl_vec3f to_root(const pl_shot_body *body, pl_vec3 v) {
  return pl_vec3_to_float(pl_mat3_mul_vec(body->rotation, v));
}

/* The two edges of the triangle that was hit, and its first corner relative to the field's origin;
 * body axes, m. */
typedef struct facet {
  pl_vec3 corner, edge1, edge2;
} facet;

static facet facet_at(const pl_height_field *field, uint32_t tile, float u, float v) {
  pl_vec3 corners[3];
  double weights[3];
  pl_height_field_corners(field, tile, u, v, corners, weights);
  return (facet){corners[0], pl_vec3_sub(corners[1], corners[0]),
                 pl_vec3_sub(corners[2], corners[0])};
}

/* Intersects the plane of the triangle in double precision. A plane that is seen edge-on keeps the
 * tracer's result. */
static void refine(const pl_shot_body *body, const facet *facet, pl_vec3 normal,
                   const pl_beam *beam, pl_vertex *out) {
  const pl_vec3 origin =
      pl_vec3_sub(pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(beam->origin, body->center)),
                  body->field->origin);
  const pl_vec3 along = pl_mat3_mul_vec_t(body->rotation, beam->direction);
  const double facing = pl_vec3_dot(normal, along);
  if (!(fabs(facing) > 1e-6))
    return;
  const double t = pl_vec3_dot(normal, pl_vec3_sub(facet->corner, origin)) / facing;
  if (!(fabs(t - out->t) <= pl_vec3_norm(facet->edge1) + 1e-6 * out->t))
    return;
  out->t = t;
  out->position = pl_vec3_madd(beam->origin, t, beam->direction);
}

static void locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                   pl_vertex *out) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  const facet facet = facet_at(body->field, hit->triangle, hit->u, hit->v);
  const pl_vec3 normal = pl_vec3_unit(pl_vec3_cross(facet.edge1, facet.edge2));
  out->w[0] = 0.0f;
  out->w[1] = hit->u;
  out->w[2] = hit->v;
  out->t = hit->t;
  out->position = pl_vec3_madd(beam->origin, out->t, beam->direction);
  out->edge1 = to_root(body, facet.edge1);
  out->edge2 = to_root(body, facet.edge2);
  out->ng = to_root(body, normal);
  if (exact)
    refine(body, &facet, normal, beam, out);
}

static pl_vec3f smooth_normal(const pl_snapshot *shot, const pl_vertex *vertex) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  return to_root(body,
                 pl_height_field_normal(body->field, vertex->triangle, vertex->w[1], vertex->w[2]));
}

static void shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                  pl_vertex *vertex) {
  pl_body_surface_shade(shot, pl_shot_body_of(shot, vertex->surface_id), beam, detail, vertex);
}

/* Secondary rays start above the surface by several rounding errors of the hit, which was found in
 * single precision relative to the field's origin, and by a small part of a cell. */
static const double ROUNDING = 0x1p-21, PART_OF_CELL = 0x1p-12;

void pl_height_field_leave(const pl_snapshot *shot, const pl_vertex *vertex, float side,
                           pl_ray *ray) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  const pl_vec3 from =
      pl_vec3_sub(vertex->position,
                  pl_vec3_add(body->center, pl_mat3_mul_vec(body->rotation, body->field->origin)));
  const double clear_m = ROUNDING * (pl_vec3_norm(from) + vertex->t) +
                         PART_OF_CELL * (double)pl_vec3f_norm(vertex->edge1);
  ray->origin = pl_vec3_madd(vertex->position, (double)side * clear_m,
                             pl_vec3f_to_double(vertex->surface.ng));
}

/* Points are camera-relative: floats resolve them best where cells are smallest. */
static void set_spot(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 point, pl_spot *spot) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  spot->point = pl_vec3_to_float(point);
  spot->normal = to_root(body, pl_height_field_normal(body->field, hit->triangle, hit->u, hit->v));
}

static void cover(const pl_coverage_job *job, pl_surface_id id, size_t slice) {
  const pl_geometry_bounds bounds = pl_body_bounds(job->shot, id);
  if (slice == 0 && pl_shot_body_of(job->shot, id)->field != NULL)
    pl_coverage_sphere(job, bounds.center, bounds.radius_m);
}

static void label(const pl_snapshot *shot, pl_surface_id id, pl_geometry_label *out) {
  const pl_body *body = pl_shot_body_of(shot, id)->body;
  pl_body_label(shot, id, out);
  if (body->ground_classes)
    out->crater_class_ids = body->crater_class_ids;
}

const pl_geometry_kind pl_geometry_height_field = {
    .name = "height field",
    .bounds = pl_body_bounds,
    .intersect = &pl_intersect_height_fields,
    .cover = cover,
    .locate = locate,
    .smooth_normal = smooth_normal,
    .shade = shade,
    .leave = pl_height_field_leave,
    .set_spot = set_spot,
    .label = label,
};
