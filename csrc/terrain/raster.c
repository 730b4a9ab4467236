/* Makes rasters: checks, connections of edges, and layout of the pyramid. */
#include "terrain/raster_levels.h"

#include <float.h>

#include "base/memory.h"

enum { SIDE_MAX = 1 << 24 };
/* Fraction of a post by which a raster may miss a full turn or a pole, as of rounded steps. */
static const double FIT = 0.01;

static pl_status check_size(const pl_raster_frame *f) {
  if (f->samples == NULL || !(f->type < PL_RASTER_TYPE_COUNT))
    return pl_fail(PL_E_ARGUMENT, "a raster without samples of a known type");
  if (f->width < 1 || f->height < 1 || f->width > SIDE_MAX || f->height > SIDE_MAX)
    return pl_fail(PL_E_RANGE, "a raster of %zu x %zu posts; a side has 1 to %d", f->width,
                   f->height, (int)SIDE_MAX);
  if (f->stride < f->width)
    return pl_fail(PL_E_RANGE, "rows of a raster are %zu samples apart, but have %zu", f->stride,
                   f->width);
  if (!(isfinite(f->scale) && isfinite(f->offset)))
    return pl_fail(PL_E_RANGE, "scale %g and offset %g of a raster", f->scale, f->offset);
  if (!(isfinite(f->x0) && isfinite(f->y0) && isfinite(f->dx) && isfinite(f->dy) && f->dx != 0.0 &&
        f->dy != 0.0))
    return pl_fail(PL_E_RANGE, "a raster from (%g, %g) in steps of (%g, %g)", f->x0, f->y0, f->dx,
                   f->dy);
  return PL_OK;
}

/* Whether the posts lie on the body: no latitude beyond a pole, no longitude twice, nothing beyond
 * the edge of an orthographic map. */
static pl_status check_place(const pl_raster_frame *f) {
  const double x1 = f->x0 + (double)(f->width - 1) * f->dx;
  const double y1 = f->y0 + (double)(f->height - 1) * f->dy;
  const double turn = 2.0 * PL_PI / fabs(f->dx), pole = 0.5 * PL_PI + FIT * fabs(f->dy);
  if (f->projection.kind == PL_PROJECTION_CYLINDRICAL) {
    if (fmax(fabs(f->y0), fabs(y1)) > pole)
      return pl_fail(PL_E_RANGE, "rows of a raster from latitude %g to %g deg",
                     f->y0 * 180.0 / PL_PI, y1 * 180.0 / PL_PI);
    if ((double)f->width > turn + 1.0 + FIT)
      return pl_fail(PL_E_RANGE, "columns of a raster from longitude %g to %g deg",
                     f->x0 * 180.0 / PL_PI, x1 * 180.0 / PL_PI);
  }
  if (f->projection.kind == PL_PROJECTION_ORTHOGRAPHIC) {
    const double x = fmax(fabs(f->x0), fabs(x1)), y = fmax(fabs(f->y0), fabs(y1));
    if (!(sqrt(x * x + y * y) < f->projection.radius_m))
      return pl_fail(PL_E_RANGE,
                     "an orthographic raster reaches %g m from its centre on a sphere of %g m",
                     sqrt(x * x + y * y), f->projection.radius_m);
  }
  return PL_OK;
}

/* Steps that fit a turn but for rounding are made to: a cut has those of the whole. */
static const double STEP_FIT = 1e-9;

/* Finds whether the raster goes around the body, and over its poles. */
static void connect(pl_raster *r) {
  pl_raster_frame *f = &r->frame;
  r->columns = (int)f->width;
  r->rows = (int)f->height;
  if (f->projection.kind != PL_PROJECTION_CYLINDRICAL)
    return;
  const double turn = 2.0 * PL_PI / fabs(f->dx), count = rint(turn);
  r->wraps = fabs(turn - count) <= FIT && (double)f->width >= count;
  if (r->wraps || fabs(turn - count) <= fmin(STEP_FIT * turn, FIT))
    f->dx = copysign(2.0 * PL_PI / count, f->dx);
  if (!r->wraps)
    return;
  r->columns = (int)count;
  for (int end = 0; end < 2; end++) {
    const double pole = (end == 0) == (f->dy < 0.0) ? 0.5 * PL_PI : -0.5 * PL_PI;
    const double row = (pole - f->y0) / f->dy, beyond = end == 0 ? -row : row - (r->rows - 1);
    r->pole_rows[end] = row;
    r->crosses[end] = fabs(beyond) <= FIT || fabs(beyond - 0.5) <= FIT;
  }
}

/* Sets the lattices, and the rounding of directions (a few times DBL_EPSILON) in posts, at least
 * 1e-9. */
static void set_axes(pl_raster *r) {
  const pl_raster_frame *f = &r->frame;
  const bool around = f->projection.kind == PL_PROJECTION_CYLINDRICAL;
  const double size = around ? 2.0 * PL_PI : f->projection.radius_m;
  pl_raster_axis_init(f->x0, f->dx, size, around, &r->across);
  pl_raster_axis_init(f->y0, f->dy, size, false, &r->down);
  r->snap_u = fmin(1e-9 + 4.0 * DBL_EPSILON * size / fabs(f->dx), 1e-3);
  r->snap_v = fmin(1e-9 + 4.0 * DBL_EPSILON * size / fabs(f->dy), 1e-3);
}

/* Points along each edge by which a raster's reach is found. */
enum { EDGE_POINTS = 64 };

/* A region that holds its middle and whose edges all lie within a cap about it, below a hemisphere,
 * lies in the cap, or beyond it around the antipode: rasters that reach so far are left out. */
static void set_reach(pl_raster *r) {
  const double u0 = -0.5, v0 = -0.5, u1 = r->columns - 0.5, v1 = r->rows - 0.5;
  double farthest = 0.0, widest = 0.0;
  r->middle = pl_raster_direction(r, 0.5 * (u0 + u1), 0.5 * (v0 + v1));
  r->reach = INFINITY;
  if (r->wraps)
    return;
  for (int edge = 0; edge < 4; edge++) {
    pl_vec3 before = r->middle;
    for (int k = 0; k <= EDGE_POINTS; k++) {
      const double t = k / (double)EDGE_POINTS;
      const double u = edge == 0 ? u0 : edge == 1 ? u1 : u0 + t * (u1 - u0);
      const double v = edge == 2 ? v0 : edge == 3 ? v1 : v0 + t * (v1 - v0);
      const pl_vec3 at = pl_raster_direction(r, u, v);
      farthest = fmax(farthest, pl_vec3_norm(pl_vec3_sub(at, r->middle)));
      if (k > 0)
        widest = fmax(widest, pl_vec3_norm(pl_vec3_sub(at, before)));
      before = at;
    }
  }
  if (farthest + widest < 1.0) /* false for NAN, too */
    r->reach = farthest + widest;
}

static int half(int n) { return n > 1 ? n - n / 2 : 1; }

/* Sets the sizes of all levels; returns the number of values above level 0. */
static size_t lay_out(pl_raster *r) {
  const pl_raster_frame *f = &r->frame;
  size_t values = 0;
  r->levels[0] = (pl_raster_level){f->samples, f->type, f->stride, r->columns, r->rows};
  for (r->level_count = 1;; r->level_count++) {
    const pl_raster_level *fine = &r->levels[r->level_count - 1];
    if (fine->width == 1 && fine->height == 1)
      return values;
    pl_raster_level *coarse = &r->levels[r->level_count];
    *coarse = (pl_raster_level){NULL, PL_RASTER_FLOAT32, 0, half(fine->width), half(fine->height)};
    coarse->stride = (size_t)coarse->width;
    values += coarse->stride * (size_t)coarse->height;
  }
}

static pl_status make(pl_raster *r) {
  void *memory;
  PL_TRY(pl_projection_init(&r->frame.projection));
  PL_TRY(check_size(&r->frame));
  PL_TRY(check_place(&r->frame));
  connect(r);
  set_axes(r);
  set_reach(r);
  PL_TRY(pl_alloc_or_fail(lay_out(r), sizeof(float), "means of a raster", &memory));
  r->memory = memory;
  return pl_raster_fill(r);
}

pl_status pl_raster_create(const pl_raster_frame *frame, pl_raster **out) {
  void *memory;
  *out = NULL;
  PL_TRY(pl_alloc_or_fail(1, sizeof(pl_raster), "a raster", &memory));
  pl_raster *r = memory;
  r->frame = *frame;
  if (r->frame.stride == 0)
    r->frame.stride = r->frame.width;
  const pl_status status = make(r);
  if (status != PL_OK) {
    pl_raster_destroy(r);
    return status;
  }
  *out = r;
  return PL_OK;
}

void pl_raster_destroy(pl_raster *r) {
  if (r == NULL)
    return;
  pl_free(r->memory);
  pl_free(r);
}
