/* Terrain of bodies: height fields with the surface of the body. In a vertex on terrain, `triangle`
 * is the tile, the last two weights are the tile's grid coordinates, and the first is how far the
 * position lies above the plane of the triangle, m. */
#include "render/body_surface.h"
#include "render/fine_slopes.h"
#include "render/geometry.h"
#include "scene/shot_frame.h"
#include "terrain/ground_patch.h"
#include "terrain/sub_cell.h"

static pl_vec3f to_root(const pl_shot_body *body, pl_vec3 v) {
  return pl_vec3_to_float(pl_mat3_mul_vec(body->rotation, v));
}

/* The ray of a beam relative to the field's origin, body axes. */
typedef struct field_ray {
  pl_vec3 from, along;
} field_ray;

static field_ray ray_of(const pl_shot_body *body, const pl_beam *beam) {
  const pl_vec3 from = pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(beam->origin, body->center));
  return (field_ray){pl_vec3_sub(from, body->field->origin),
                     pl_mat3_mul_vec_t(body->rotation, beam->direction)};
}

/* Intersects the plane of the triangle in double precision, and then the patch of its cell. A plane
 * that is seen edge-on keeps the tracer's result. */
static void refine(const pl_shot_body *body, pl_ground_patch *patch, const pl_beam *beam,
                   pl_vertex *out) {
  const field_ray ray = ray_of(body, beam);
  const double facing = pl_vec3_dot(patch->normal, ray.along);
  if (!(fabs(facing) > 1e-6))
    return;
  const double plane = pl_vec3_dot(patch->normal, pl_vec3_sub(patch->corner, ray.from)) / facing;
  if (!(fabs(plane - out->t) <= pl_vec3_norm(patch->edge1) + 1e-6 * out->t))
    return;
  out->t = pl_ground_patch_meet(patch, ray.from, ray.along, plane);
  out->w[0] = (float)((out->t - plane) * facing);
  out->position = pl_vec3_madd(beam->origin, out->t, beam->direction);
}

static void locate(const pl_snapshot *shot, const pl_beam *beam, const pl_hit *hit, bool exact,
                   pl_vertex *out) {
  const pl_shot_body *body = pl_shot_body_of(shot, hit->surface_id);
  pl_ground_patch patch;
  pl_ground_patch_at(body->field, hit->triangle, hit->u, hit->v, &patch);
  out->w[0] = 0.0f;
  out->w[1] = hit->u;
  out->w[2] = hit->v;
  out->t = hit->t;
  out->position = pl_vec3_madd(beam->origin, out->t, beam->direction);
  out->edge1 = to_root(body, patch.edge1);
  out->edge2 = to_root(body, patch.edge2);
  out->ng = to_root(body, patch.normal);
  if (exact)
    refine(body, &patch, beam, out);
}

static pl_vec3f smooth_normal(const pl_snapshot *shot, const pl_vertex *vertex) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  return to_root(body,
                 pl_height_field_normal(body->field, vertex->triangle, vertex->w[1], vertex->w[2]));
}

/* A slope over the horizon as one to a surface with a unit normal, on which it is laid. */
static pl_vec3 slope_on(pl_vec3 normal, pl_vec3 up, pl_vec3 slope) {
  static const double LEAST = 0.1; /* where both are so steep that the sum overhangs */
  const double height = pl_vec3_dot(normal, up), along = pl_vec3_dot(slope, normal);
  const pl_vec3 on = pl_vec3_madd(slope, -along, normal);
  return pl_vec3_scale(on, fmax(height, 0.0) / fmax(1.0 - height * along, LEAST));
}

/* Slopes that the ground has are not in its law of reflectance, too. */
static void add_slopes(const pl_shot_body *body, const pl_beam *beam, bool textures,
                       pl_vertex *vertex) {
  const pl_terrain *terrain = body->field->terrain;
  const pl_ground_tile *tile = body->field->tiles[vertex->triangle];
  const pl_vec3 up =
      pl_vec3_unit(pl_mat3_mul_vec_t(body->rotation, pl_vec3_sub(vertex->position, body->center)));
  const pl_sub_cell left = pl_terrain_sub_cell(terrain, up, pl_ground_tile_lattice(tile->id),
                                               pl_fine_slopes_footprint_m(vertex, beam), textures);
  const pl_vec3 normal = pl_mat3_mul_vec_t(body->rotation, pl_vec3f_to_double(vertex->surface.n));
  const pl_rough rough = {.slope = to_root(body, slope_on(normal, up, left.slope)),
                          .variance = (float)fmax(left.variance, 0.0),
                          .whole = (float)left.whole,
                          .stones = (float)left.stones,
                          .stone_height = (float)left.stone_height,
                          .stone_relief = (float)left.stone_relief};
  pl_fine_slopes_set(vertex, &rough, pl_terrain_shared_variance(terrain));
}

static void shade(const pl_snapshot *shot, const pl_beam *beam, pl_detail detail,
                  pl_vertex *vertex) {
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  pl_body_surface_shade(shot, body, beam, detail, vertex);
  if (detail.sub_cell)
    add_slopes(body, beam, detail.texture_slopes, vertex);
}

static void classify(const pl_snapshot *shot, const pl_beam *beam, pl_vertex *vertex,
                     uint16_t *ids) {
  pl_body_surface_classify(shot, pl_shot_body_of(shot, vertex->surface_id), beam, vertex, ids);
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

/* Rays leave the mesh, not the patch. */
static void leave(const pl_snapshot *shot, const pl_vertex *vertex, float side, pl_ray *ray) {
  pl_height_field_leave(shot, vertex, side, ray);
  if (vertex->w[0] == 0.0f)
    return;
  const pl_shot_body *body = pl_shot_body_of(shot, vertex->surface_id);
  const pl_vec3 met =
      pl_height_field_point(body->field, vertex->triangle, vertex->w[1], vertex->w[2]);
  const pl_vec3 on_mesh = pl_vec3_add(body->center, pl_mat3_mul_vec(body->rotation, met));
  ray->origin = pl_vec3_add(ray->origin, pl_vec3_sub(on_mesh, vertex->position));
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
  pl_body_label(shot, id, out);
  out->on_ground = pl_shot_body_of(shot, id)->body->ground_labels;
  out->on_ground.rock = 0;
}

const pl_geometry_kind pl_geometry_height_field = {
    .name = "height field",
    .bounds = pl_body_bounds,
    .intersect = &pl_intersect_height_fields,
    .cover = cover,
    .locate = locate,
    .smooth_normal = smooth_normal,
    .shade = shade,
    .leave = leave,
    .set_spot = set_spot,
    .label = label,
    .classify = classify,
};
