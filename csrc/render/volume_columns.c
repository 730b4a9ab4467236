/* Column density along lines towards the sun, on a grid across the shape. */
#include "render/volume_columns.h"

#include <math.h>

#include "math/sampling.h"
#include "shade/graph_medium.h"

/* A line: its interval within the shape along the direction to the sun; equal ends: it misses the
 * shape. Columns are side + 1 sums, from each node of the line to the last. Nodes and lines are
 * evenly spaced in warped lengths. */
typedef struct line {
  double start, end; /* warped */
} line;

struct pl_volume_columns {
  pl_vec3 across[2], toward; /* orthonormal, axes of the bound */
  double low[2], step[2];    /* of the grid of lines, warped */
  double core_m;             /* as in pl_volume */
  int side;                  /* number of cells */
  line *lines;               /* [(side + 1)^2], the first axis runs fastest */
  float *columns;            /* [line * (side + 1) + node], m */
};

/* Warped length from the shape's origin: equal steps are shortest at the origin, and grow with the
 * square of the distance beyond the core. Without a core it is the length itself. */
static double warp(const pl_volume_columns *c, double x) {
  return c->core_m > 0.0 ? x / (c->core_m + fabs(x)) : x;
}
static double unwarp(const pl_volume_columns *c, double s) {
  return c->core_m > 0.0 ? c->core_m * s / fmax(1e-12, 1.0 - fabs(s)) : s;
}

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
                      double across_m, line *out, float *columns) {
  const pl_volume *volume = shot->volume;
  double t[2];
  *out = (line){0.0, 0.0};
  for (int k = 0; k <= c->side; k++)
    columns[k] = 0.0f;
  if (!pl_bound_span(volume->bound, volume->size, &shot->ball, foot, c->toward, t))
    return;
  *out = (line){warp(c, t[0]), warp(c, t[1])};
  const pl_vec3f view = pl_vec3_to_float(pl_mat3_mul_vec(shot->rotation, c->toward));
  for (int k = c->side; k-- > 0;) {
    const double a = unwarp(c, out->start + (out->end - out->start) * k / c->side);
    const double b = unwarp(c, out->start + (out->end - out->start) * (k + 1) / c->side);
    /* Where a density that falls with the square of the distance has its mean over the cell. */
    const double at = c->core_m > 0.0 && a * b > 0.0 ? copysign(sqrt(a * b), a) : 0.5 * (a + b);
    const pl_vec3 place = pl_vec3_madd(foot, at, c->toward);
    const float radius = (float)(0.5 * fmax(b - a, across_m));
    const pl_graph_point point = pl_volume_point(shot, place, view, radius);
    const float density = pl_graph_density(volume->graph, &point, volume->parameters);
    columns[k] = columns[k + 1] + density * (float)(b - a);
  }
}

static void set_grid(const pl_volume *volume, pl_vec3 toward, int side, pl_volume_columns *out) {
  const pl_basis basis = pl_basis_make(pl_vec3_to_float(toward));
  out->toward = toward;
  out->across[0] = pl_vec3_unit(pl_vec3_cross(pl_vec3f_to_double(basis.b), toward));
  out->across[1] = pl_vec3_cross(toward, out->across[0]);
  out->side = side;
  out->core_m = volume->core_m;
  for (int k = 0; k < 2; k++) {
    const pl_bound *bound = volume->bound;
    const double high = warp(out, bound->support(volume->size, out->across[k]));
    out->low[k] = warp(out, -bound->support(volume->size, pl_vec3_scale(out->across[k], -1.0)));
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
  for (size_t i = 0; i < nodes * nodes; i++) {
    const double s[2] = {made->low[0] + made->step[0] * (double)(i % nodes),
                         made->low[1] + made->step[1] * (double)(i / nodes)};
    const double u = unwarp(made, s[0]), v = unwarp(made, s[1]);
    const pl_vec3 foot = pl_vec3_madd(pl_vec3_scale(made->across[0], u), v, made->across[1]);
    const double across_m = fmax(fabs(unwarp(made, s[0] + copysign(made->step[0], -s[0])) - u),
                                 fabs(unwarp(made, s[1] + copysign(made->step[1], -s[1])) - v));
    fill_line(shot, made, foot, across_m, &lines[i], columns + i * nodes);
  }
  *out = made;
  return PL_OK;
}

/* Column density of one line, from a point on it. */
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
  const double w = warp(c, pl_vec3_dot(point, c->toward));
  int first[2];
  float part[2];
  for (int k = 0; k < 2; k++) {
    const double at = (warp(c, pl_vec3_dot(point, c->across[k])) - c->low[k]) / c->step[k];
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
