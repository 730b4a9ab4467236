/* Columns of density on lines to the sun, a grid of them across the shape. */
#include "render/volume_columns.h"

#include <math.h>

#include "math/sampling.h"
#include "shade/graph_medium.h"

/* A line: between its places in the shape along the direction to the sun; columns are
 * sides + 1 sums, from each place to the last. */
typedef struct line {
  double start, end; /* m along `toward`; equal: it misses the shape */
} line;

struct pl_volume_columns {
  pl_vec3 across[2], toward; /* orthonormal, axes of the bound */
  double low[2], step[2];    /* of the grid of lines, m */
  int side;                  /* cells */
  line *lines;               /* [(side + 1)^2], the first axis runs fastest */
  float *columns;            /* [line * (side + 1) + place], m */
};

pl_graph_point pl_volume_point(const pl_shot_volume *shot, pl_vec3 place, pl_vec3f view,
                               float radius_m) {
  const pl_mat3 m = shot->rotation;
  const pl_vec3f x = pl_vec3_to_float(pl_mat3_mul_vec(m, (pl_vec3){1.0, 0.0, 0.0}));
  const pl_vec3f y = pl_vec3_to_float(pl_mat3_mul_vec(m, (pl_vec3){0.0, 1.0, 0.0}));
  const pl_vec3f z = pl_vec3_to_float(pl_mat3_mul_vec(m, (pl_vec3){0.0, 0.0, 1.0}));
  return (pl_graph_point){
      .object = pl_vec3_to_float(place),
      .world = pl_vec3_to_float(pl_mat3_mul_vec(m, place)),
      .t = x,
      .b = y,
      .n = z,
      .ng = z,
      .view = view,
      .filter = PL_FILTER_FINEST,
      .radius = radius_m,
      .random = shot->volume->random,
      .scale = 1.0f,
  };
}

static void fill_line(const pl_shot_volume *shot, const pl_volume_columns *c, pl_vec3 foot,
                      double radius_m, line *out, float *columns) {
  const pl_volume *volume = shot->volume;
  double t[2];
  *out = (line){0.0, 0.0};
  for (int k = 0; k <= c->side; k++)
    columns[k] = 0.0f;
  if (!pl_bound_span(volume->bound, volume->size, foot, c->toward, t))
    return;
  *out = (line){t[0], t[1]};
  const double cell = (t[1] - t[0]) / c->side;
  const pl_vec3f view = pl_vec3_to_float(pl_mat3_mul_vec(shot->rotation, c->toward));
  const float radius = (float)(0.5 * fmax(cell, radius_m));
  for (int k = c->side; k-- > 0;) {
    const pl_vec3 place = pl_vec3_madd(foot, t[0] + (k + 0.5) * cell, c->toward);
    const pl_graph_point point = pl_volume_point(shot, place, view, radius);
    const float density = pl_graph_density(volume->graph, &point, volume->parameters);
    columns[k] = columns[k + 1] + density * (float)cell;
  }
}

static void set_grid(const pl_volume *volume, pl_vec3 toward, int side, pl_volume_columns *out) {
  const pl_basis basis = pl_basis_make(pl_vec3_to_float(toward));
  out->toward = toward;
  out->across[0] = pl_vec3_unit(pl_vec3_cross(pl_vec3f_to_double(basis.b), toward));
  out->across[1] = pl_vec3_cross(toward, out->across[0]);
  out->side = side;
  for (int k = 0; k < 2; k++) {
    const pl_bound *bound = volume->bound;
    const double high = bound->support(volume->size, out->across[k]);
    out->low[k] = -bound->support(volume->size, pl_vec3_scale(out->across[k], -1.0));
    out->step[k] = (high - out->low[k]) / side;
  }
}

pl_status pl_volume_columns_build(const pl_shot_volume *shot, pl_vec3 toward, int side,
                                  pl_arena *arena, const pl_volume_columns **out) {
  const size_t nodes = (size_t)side + 1;
  pl_volume_columns *made = pl_arena_alloc(arena, 1, sizeof *made);
  line *lines = pl_arena_alloc(arena, nodes * nodes, sizeof *lines);
  float *columns = pl_arena_alloc(arena, nodes * nodes * nodes, sizeof *columns);
  if (made == NULL || lines == NULL || columns == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the shadows in volume '%s'", shot->volume->name);
  set_grid(shot->volume, toward, side, made);
  made->lines = lines;
  made->columns = columns;
  const double across_m = fmax(made->step[0], made->step[1]);
  for (size_t i = 0; i < nodes * nodes; i++) {
    const double u = made->low[0] + made->step[0] * (double)(i % nodes);
    const double v = made->low[1] + made->step[1] * (double)(i / nodes);
    const pl_vec3 foot = pl_vec3_madd(pl_vec3_scale(made->across[0], u), v, made->across[1]);
    fill_line(shot, made, foot, across_m, &lines[i], columns + i * nodes);
  }
  *out = made;
  return PL_OK;
}

/* Of one line, from a place on it. */
static float column_on(const pl_volume_columns *c, size_t at, double w) {
  const line *l = &c->lines[at];
  const float *columns = c->columns + at * ((size_t)c->side + 1);
  if (!(w < l->end))
    return 0.0f;
  const double place = fmax(0.0, (w - l->start) / (l->end - l->start) * c->side);
  const int k = (int)fmin(place, c->side - 1);
  const float part = (float)(place - k);
  return columns[k] + part * (columns[k + 1] - columns[k]);
}

float pl_volume_column(const pl_volume_columns *c, pl_vec3 point) {
  const double w = pl_vec3_dot(point, c->toward);
  int first[2];
  float part[2];
  for (int k = 0; k < 2; k++) {
    const double at = (pl_vec3_dot(point, c->across[k]) - c->low[k]) / c->step[k];
    if (!(at > 0.0 && at < c->side))
      return 0.0f;
    first[k] = (int)fmin(at, c->side - 1);
    part[k] = (float)(at - first[k]);
  }
  const size_t nodes = (size_t)c->side + 1;
  const size_t corner = (size_t)first[1] * nodes + (size_t)first[0];
  const float a = column_on(c, corner, w), b = column_on(c, corner + 1, w);
  const float below = a + part[0] * (b - a);
  const float d = column_on(c, corner + nodes, w), e = column_on(c, corner + nodes + 1, w);
  const float above = d + part[0] * (e - d);
  return below + part[1] * (above - below);
}
