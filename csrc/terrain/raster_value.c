/* Places and values of rasters; interpolation across the date line and the poles. */
#include "terrain/raster_levels.h"

#include <stdlib.h>

#include "terrain/interpolation.h"

const pl_raster_frame *pl_raster_frame_of(const pl_raster *r) { return &r->frame; }

const pl_raster_axis *pl_raster_across(const pl_raster *r) { return &r->across; }

const pl_raster_axis *pl_raster_down(const pl_raster *r) { return &r->down; }

int pl_raster_levels(const pl_raster *r) { return r->level_count; }

bool pl_raster_whole(const pl_raster *r) { return r->wraps && r->crosses[0] && r->crosses[1]; }

bool pl_raster_goes_round(const pl_raster *r) { return r->wraps; }

double pl_raster_spacing_m(const pl_raster *r, double radius_m) {
  const pl_raster_frame *f = &r->frame;
  if (f->projection.kind == PL_PROJECTION_CYLINDRICAL)
    return fabs(f->dy) * radius_m;
  const double scale =
      f->projection.kind == PL_PROJECTION_STEREOGRAPHIC ? f->projection.scale : 1.0;
  return sqrt(fabs(f->dx * f->dy)) / scale * (radius_m / f->projection.radius_m);
}

static double snapped(double u, double within) {
  const double whole = rint(u);
  return fabs(u - whole) <= within ? whole : u;
}

bool pl_raster_find(const pl_raster *r, pl_vec3 direction, double *u, double *v) {
  double x, y;
  if (!pl_projection_forward(&r->frame.projection, direction, &x, &y))
    return false;
  *u = snapped(pl_raster_axis_column(&r->across, x, 0.5 * (r->columns - 1)), r->snap_u);
  *v = snapped(pl_raster_axis_column(&r->down, y, 0.0), r->snap_v);
  return (r->wraps || (*u >= -0.5 && *u <= r->columns - 0.5)) && (r->crosses[0] || *v >= -0.5) &&
         (r->crosses[1] || *v <= r->rows - 0.5);
}

double pl_raster_outside_m(const pl_raster *r, pl_vec3 direction, double radius_m) {
  const pl_raster_frame *f = &r->frame;
  double u = NAN, v = NAN;
  if (pl_raster_find(r, direction, &u, &v))
    return 0.0;
  if (isnan(u))
    return INFINITY;
  const double low_v = r->crosses[0] ? 0.0 : fmax(-0.5 - v, 0.0);
  const double high_v = r->crosses[1] ? 0.0 : fmax(v - (r->rows - 0.5), 0.0);
  double across = r->wraps ? 0.0 : fmax(fmax(-0.5 - u, u - (r->columns - 0.5)), 0.0);
  double along = fmax(low_v, high_v);
  across *= fabs(f->dx);
  along *= fabs(f->dy);
  if (f->projection.kind == PL_PROJECTION_CYLINDRICAL) {
    across *= radius_m * hypot(direction.x, direction.y);
    along *= radius_m;
  }
  return hypot(across, along);
}

bool pl_raster_far(const pl_raster *r, pl_vec3 direction, double distance) {
  const pl_vec3 away = pl_vec3_sub(direction, r->middle);
  const double near = r->reach + distance + 1e-9;
  return pl_vec3_dot(away, away) > near * near;
}

pl_vec3 pl_raster_direction(const pl_raster *r, double u, double v) {
  return pl_projection_inverse(&r->frame.projection, pl_raster_axis_place(&r->across, u),
                               pl_raster_axis_place(&r->down, v));
}

/* 0 at 0, 1 from 1 on; first and second derivatives vanish at both. */
static double ramp(double t) {
  if (t >= 1.0)
    return 1.0;
  return t > 0.0 ? t * t * t * (10.0 + t * (6.0 * t - 15.0)) : 0.0;
}

/* Weight along one axis with `count` posts; closed: whether each of its ends has no border. */
static double axis_weight(double u, int count, double border, const bool closed[2]) {
  const double inside[2] = {u + 0.5, count - 0.5 - u};
  const double width = fmin(border, 0.5 * count);
  double weight = 1.0;
  for (int end = 0; end < 2; end++)
    if (!closed[end])
      weight *= width > 0.0 ? ramp(inside[end] / width) : inside[end] >= 0.0 ? 1.0 : 0.0;
  return weight;
}

double pl_raster_weight(const pl_raster *r, double u, double v, double border_posts) {
  const bool around[2] = {r->wraps, r->wraps};
  return axis_weight(u, r->columns, border_posts, around) *
         axis_weight(v, r->rows, border_posts, r->crosses);
}

/* Integral of ramp(x / width) from 0 to x. */
static double ramp_area(double x, double width) {
  if (!(x > 0.0))
    return 0.0;
  if (x >= width)
    return x - 0.5 * width;
  const double t = x / width, t2 = t * t;
  return width * t2 * t2 * (2.5 + t * (t - 3.0));
}

/* Mean of axis_weight between u - half and u + half. Borders of both ends do not overlap, so it is
 * the sum of both ramps, less 1. */
static double axis_cover(double u, double half, int count, double border, const bool closed[2]) {
  const double width = fmin(border, 0.5 * count);
  double cover = 1.0;
  if (!(half > 1e-6))
    return axis_weight(u, count, border, closed);
  for (int end = 0; end < 2; end++) {
    const double inside = end == 0 ? u + 0.5 : count - 0.5 - u;
    if (!closed[end] && !(inside - half >= width))
      cover +=
          (ramp_area(inside + half, width) - ramp_area(inside - half, width)) / (2.0 * half) - 1.0;
  }
  return fmax(cover, 0.0);
}

double pl_raster_cover(const pl_raster *r, pl_vec3 direction, double width_rad, double border_posts,
                       double *u, double *v) {
  const pl_raster_frame *f = &r->frame;
  const bool around[2] = {r->wraps, r->wraps};
  *u = *v = NAN;
  if (pl_raster_far(r, direction, width_rad))
    return 0.0;
  pl_raster_find(r, direction, u, v);
  if (isnan(*u))
    return 0.0;
  double across = width_rad / fabs(f->dx), along = width_rad / fabs(f->dy); /* in posts */
  if (f->projection.kind == PL_PROJECTION_CYLINDRICAL) {
    across = fmin(across / fmax(hypot(direction.x, direction.y), 1e-9), 2.0 * PL_PI / fabs(f->dx));
  } else {
    const double unit = pl_raster_spacing_m(r, 1.0) / sqrt(fabs(f->dx * f->dy)); /* rad of 1 m */
    across /= unit;
    along /= unit;
  }
  return axis_cover(*u, 0.5 * across, r->columns, border_posts, around) *
         axis_cover(*v, 0.5 * along, r->rows, border_posts, r->crosses);
}

static int modulo(int i, int n) {
  const int rest = i % n;
  return rest < 0 ? rest + n : rest;
}

/* A cell of any column: around the body, or continued in a straight line. */
static double column_tap(const pl_raster *r, const pl_raster_level *level, int column, int row) {
  const int last = level->width - 1;
  if (column >= 0 && column <= last)
    return pl_raster_cell(level, column, row);
  if (r->wraps)
    return pl_raster_cell(level, modulo(column, level->width), row);
  if (last == 0)
    return pl_raster_cell(level, 0, row);
  const int end = column < 0 ? 0 : last, next = column < 0 ? 1 : last - 1;
  const double edge = pl_raster_cell(level, end, row);
  return edge + abs(column - end) * (edge - pl_raster_cell(level, next, row));
}

/* A cell on the other side of a pole: half a turn on, which with an odd number of columns lies
 * between two. */
static double across_pole(const pl_raster *r, const pl_raster_level *level, int column, int row) {
  const int inside = row < 0 ? 0 : level->height - 1;
  const double pole = (r->pole_rows[row > 0] + 0.5) * level->height / r->rows - 0.5;
  int other = (int)rint(2.0 * pole) - row;
  other = other < 0 ? 0 : other > level->height - 1 ? inside : other;
  const int opposite = column + level->width / 2;
  const double value = column_tap(r, level, opposite, other);
  if (level->width % 2 == 0 || level->width == 1)
    return value;
  return 0.5 * (value + column_tap(r, level, opposite + 1, other));
}

/* A cell of any column and row. */
static double tap(const pl_raster *r, const pl_raster_level *level, int column, int row) {
  const int last = level->height - 1;
  if (row >= 0 && row <= last)
    return column_tap(r, level, column, row);
  if (r->crosses[row > 0])
    return across_pole(r, level, column, row);
  if (last == 0)
    return column_tap(r, level, column, 0);
  const int end = row < 0 ? 0 : last, next = row < 0 ? 1 : last - 1;
  const double edge = column_tap(r, level, column, end);
  return edge + abs(row - end) * (edge - column_tap(r, level, column, next));
}

/* Reads `side` by `side` cells from a column and row on, all inside. */
static void inner_window(const pl_raster_level *level, int column, int row, int side, double *out) {
  const size_t from = (size_t)row * level->stride + (size_t)column;
  if (level->type == PL_RASTER_FLOAT32) {
    const float *cells = (const float *)level->samples + from;
    for (int j = 0; j < side; j++, cells += level->stride)
      for (int i = 0; i < side; i++)
        *out++ = (double)cells[i];
    return;
  }
  for (int j = 0; j < side; j++)
    for (int i = 0; i < side; i++)
      *out++ = pl_raster_sample(level, from + (size_t)j * level->stride + (size_t)i);
}

/* Reads `side` by `side` cells from a column and row on. */
static void window(const pl_raster *r, const pl_raster_level *level, int column, int row, int side,
                   double *out) {
  const bool inside =
      column >= 0 && row >= 0 && column + side <= level->width && row + side <= level->height;
  if (inside) {
    inner_window(level, column, row, side, out);
    return;
  }
  for (int j = 0; j < side; j++)
    for (int i = 0; i < side; i++)
      *out++ = tap(r, level, column + i, row + j);
}

static double bilinear_at(const pl_raster *r, const pl_raster_level *level, int i, int j, double s,
                          double t) {
  double p[4];
  window(r, level, i, j, 2, p);
  return pl_linear(pl_linear(p[0], p[1], s), pl_linear(p[2], p[3], s), t);
}

static double cubic_at(const pl_raster *r, const pl_raster_level *level, int i, int j, double s,
                       double t) {
  double p[16], rows[4];
  window(r, level, i - 1, j - 1, 4, p);
  for (int k = 0; k < 4; k++)
    rows[k] = pl_catmull_rom(p + (size_t)4 * (size_t)k, s);
  return pl_catmull_rom(rows, t);
}

/* Place in a level of a column (or row) of level 0; clamped unless the axis continues there. */
static double in_level(double u, int fine, int coarse, bool before, bool after) {
  const double place = fine == coarse ? u : (u + 0.5) * coarse / fine - 0.5;
  if (!before && !(place > 0.0))
    return 0.0;
  return !after && place > coarse - 1.0 ? coarse - 1.0 : place;
}

double pl_raster_value(const pl_raster *r, int level, double u, double v,
                       pl_raster_interpolation how) {
  const int k = level < 0 ? 0 : level < r->level_count ? level : r->level_count - 1;
  const pl_raster_level *at = &r->levels[k];
  const double x = in_level(u, r->columns, at->width, r->wraps, r->wraps);
  const double y = in_level(v, r->rows, at->height, r->crosses[0], r->crosses[1]);
  const double i = floor(x), j = floor(y);
  const double sample = how == PL_INTERPOLATION_CUBIC
                            ? cubic_at(r, at, (int)i, (int)j, x - i, y - j)
                            : bilinear_at(r, at, (int)i, (int)j, x - i, y - j);
  return r->frame.scale * sample + r->frame.offset;
}

double pl_raster_value_slope(const pl_raster *r, int level, double u, double v, double slope[2]) {
  const int k = level < 0 ? 0 : level < r->level_count ? level : r->level_count - 1;
  const pl_raster_level *at = &r->levels[k];
  const double x = in_level(u, r->columns, at->width, r->wraps, r->wraps);
  const double y = in_level(v, r->rows, at->height, r->crosses[0], r->crosses[1]);
  const double i = floor(x), j = floor(y);
  double p[16], rows[4], across[4];
  window(r, at, (int)i - 1, (int)j - 1, 4, p);
  for (size_t n = 0; n < 4; n++) {
    rows[n] = pl_catmull_rom(p + 4 * n, x - i);
    across[n] = pl_catmull_rom_slope(p + 4 * n, x - i);
  }
  slope[0] = r->frame.scale * pl_catmull_rom(across, y - j) * at->width / r->columns;
  slope[1] = r->frame.scale * pl_catmull_rom_slope(rows, y - j) * at->height / r->rows;
  return r->frame.scale * pl_catmull_rom(rows, y - j) + r->frame.offset;
}

/* A product of two Catmull-Rom curves has weights of which the negative ones sum to -9/32 at
 * most. */
void pl_raster_bounds(const pl_raster *r, pl_raster_interpolation how, double *low, double *high) {
  const double a = r->frame.scale * r->least + r->frame.offset;
  const double b = r->frame.scale * r->greatest + r->frame.offset;
  const double beyond = how == PL_INTERPOLATION_CUBIC ? 9.0 / 32.0 * fabs(b - a) : 0.0;
  *low = fmin(a, b) - beyond;
  *high = fmax(a, b) + beyond;
}

/* Beyond the outermost rows is a pole, whose cap has the number of the row: between numbers of the
 * other side there may be none. */
bool pl_raster_nearest(const pl_raster *r, pl_vec3 direction, double *value) {
  double u, v;
  if (!pl_raster_find(r, direction, &u, &v))
    return false;
  const double row = fmin(fmax(rint(v), 0.0), r->rows - 1.0);
  const double column = r->wraps ? rint(u) : fmin(fmax(rint(u), 0.0), r->columns - 1.0);
  *value = pl_raster_value(r, 0, column, row, PL_INTERPOLATION_BILINEAR);
  return true;
}
