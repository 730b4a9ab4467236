/* Intersects ellipsoids with the centre rays of a tile, with pixels side by side in vector lanes.
 */
#include "render/body_points.h"

#include "base/wide.h"
#include "geom/ellipsoid.h"

/* A row of pixels: their rays, and the nearest body that each ray hits. */
typedef struct row {
  const double *x, *y, *z;
  double *t;
  uint32_t *body; /* index; PL_NO_BODY where none is hit */
  size_t count;
} row;

/* Records the body where its hit is nearer than the one stored; same arithmetic as
 * pl_unit_sphere_intersect. */
PL_WIDE static void meet(size_t count, const pl_shot_body *body, uint32_t index,
                         const double *restrict x, const double *restrict y,
                         const double *restrict z, double *restrict nearest,
                         uint32_t *restrict bodies) {
  const pl_mat3 m = body->to_unit;
  const pl_vec3 zero = {0.0, 0.0, 0.0};
  const pl_vec3 f = pl_vec3_add(body->camera_unit, pl_mat3_mul_vec(m, zero));
  const double c = pl_vec3_dot(f, f) - 1.0;
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 d = pl_mat3_mul_vec(m, (pl_vec3){x[i], y[i], z[i]});
    const double a = pl_vec3_dot(d, d), b = -pl_vec3_dot(f, d);
    const pl_vec3 middle = pl_vec3_madd(f, b / a, d);
    const double discriminant = a * (1.0 - pl_vec3_dot(middle, middle));
    const double q = b + copysign(sqrt(discriminant), b);
    const double first = q != 0.0 ? c / q : 0.0, second = q / a;
    const double low = first > second ? second : first, high = first > second ? first : second;
    const double t = low > 0.0 ? low : high;
    const bool met = (discriminant >= 0.0) & (t > 0.0) & (t < nearest[i]);
    nearest[i] = met ? t : nearest[i];
    bodies[i] = met ? index : bodies[i];
  }
}

/* Points of a run of pixels on one body; vectors are stored as three arrays each. */
typedef struct surface_run {
  double position[3][PL_TILE_SIDE];
  float normal[3][PL_TILE_SIDE], facing[3][PL_TILE_SIDE]; /* outward; towards the viewer */
} surface_run;

PL_WIDE static void locate(size_t count, const pl_shot_body *body, const double *restrict x,
                           const double *restrict y, const double *restrict z,
                           const double *restrict t, surface_run *restrict out) {
  const pl_mat3 m = body->rotation;
  const pl_vec3 center = body->center, radii = body->state->radii_m;
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 direction = {x[i], y[i], z[i]};
    const pl_vec3 p = pl_vec3_madd((pl_vec3){0.0, 0.0, 0.0}, t[i], direction);
    const pl_vec3 local = pl_mat3_mul_vec_t(m, pl_vec3_sub(p, center));
    const pl_vec3 gradient = {local.x / (radii.x * radii.x), local.y / (radii.y * radii.y),
                              local.z / (radii.z * radii.z)};
    const pl_vec3f n = pl_vec3_to_float(pl_mat3_mul_vec(m, pl_vec3_unit(gradient)));
    const float side = pl_vec3_dot(pl_vec3f_to_double(n), direction) > 0.0 ? -1.0f : 1.0f;
    out->position[0][i] = p.x;
    out->position[1][i] = p.y;
    out->position[2][i] = p.z;
    out->normal[0][i] = n.x;
    out->normal[1][i] = n.y;
    out->normal[2][i] = n.z;
    out->facing[0][i] = side * n.x;
    out->facing[1][i] = side * n.y;
    out->facing[2][i] = side * n.z;
  }
}

static void put(const surface_run *run, const double *t, pl_surface_id id, size_t count,
                pl_point *points) {
  for (size_t i = 0; i < count; i++) {
    pl_point *point = &points[i];
    point->position = (pl_vec3){run->position[0][i], run->position[1][i], run->position[2][i]};
    point->t = t[i];
    point->surface_id = id;
    point->triangle = 0;
    point->w[0] = point->w[1] = point->w[2] = 0.0f;
    point->ng = (pl_vec3f){run->normal[0][i], run->normal[1][i], run->normal[2][i]};
    point->n = point->facet = (pl_vec3f){run->facing[0][i], run->facing[1][i], run->facing[2][i]};
  }
}

static void fill_row(const pl_snapshot *shot, const row *row, pl_point *points) {
  surface_run run;
  for (size_t i = 0, end; i < row->count; i = end) {
    const uint32_t body = row->body[i];
    for (end = i + 1; end < row->count && row->body[end] == body;)
      end++;
    if (body == PL_NO_BODY) {
      for (size_t k = i; k < end; k++)
        points[k].surface_id = PL_NO_SURFACE;
      continue;
    }
    locate(end - i, &shot->bodies[body], row->x + i, row->y + i, row->z + i, row->t + i, &run);
    put(&run, row->t + i, pl_surface_of_body(body), end - i, points + i);
  }
}

void pl_body_points(const pl_snapshot *shot, pl_tile tile, pl_vec3 axis, double half_angle_rad,
                    double directions[3][PL_TILE_PIXELS], pl_point *points) {
  double t[PL_TILE_PIXELS];
  uint32_t hit[PL_TILE_PIXELS];
  row rows[PL_TILE_SIDE];
  for (int y = 0; y < tile.height; y++) {
    const size_t first = (size_t)y * PL_TILE_SIDE, count = (size_t)tile.width;
    double *d[3] = {directions[0] + first, directions[1] + first, directions[2] + first};
    rows[y] = (row){d[0], d[1], d[2], t + first, hit + first, count};
    pl_snapshot_rays(shot, tile.x0, tile.y0 + y, count, d[0], d[1], d[2]);
    for (size_t x = 0; x < count; x++) {
      rows[y].t[x] = INFINITY;
      rows[y].body[x] = PL_NO_BODY;
    }
  }
  for (size_t i = 0; i < shot->body_count; i++) {
    const pl_shot_body *body = &shot->bodies[i];
    if (!pl_shot_is_smooth(body) ||
        !pl_snapshot_sees(shot, body->center, body->radius_m, axis, half_angle_rad))
      continue;
    for (int y = 0; y < tile.height; y++)
      meet(rows[y].count, body, (uint32_t)i, rows[y].x, rows[y].y, rows[y].z, rows[y].t,
           rows[y].body);
  }
  for (int y = 0; y < tile.height; y++)
    fill_row(shot, &rows[y], points + (size_t)y * PL_TILE_SIDE);
}
