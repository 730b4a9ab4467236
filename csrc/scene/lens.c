/* Projection, unprojection and bounds for any distortion model. */
#include "scene/lens.h"

/* SCAN: steps in which the radial curve is searched for a fold. */
enum { SCAN = 512, ITERATIONS = 60 };

static double radius_at(const pl_lens *lens, double theta, double *slope) {
  return lens->model->radius(lens->c, theta, slope);
}

/* Returns the first angle at which the curve stops growing, or the model's largest angle. */
static double find_limit(const pl_lens *lens) {
  const double most = lens->model->angle_max_rad;
  double low = 0.0, high = most, slope;
  bool folds = false;
  for (int i = 1; i <= SCAN && !folds; i++) {
    high = most * i / SCAN;
    const double radius = radius_at(lens, high, &slope);
    folds = !(slope > 0.0) || !isfinite(radius);
    if (!folds)
      low = high;
  }
  for (int i = 0; folds && i < ITERATIONS; i++) {
    const double middle = 0.5 * (low + high);
    radius_at(lens, middle, &slope);
    if (slope > 0.0)
      low = middle;
    else
      high = middle;
  }
  return low;
}

pl_status pl_lens_init(const pl_lens_model *model, const double *coefficients, pl_lens *out) {
  double slope;
  *out = (pl_lens){.model = model};
  for (size_t i = 0; i < model->count; i++) {
    if (!isfinite(coefficients[i]))
      return pl_fail(PL_E_RANGE, "lens: %s must be finite", model->coefficients[i]);
    out->c[i] = coefficients[i];
  }
  out->limit_rad = model->angle_max_rad;
  out->limit = INFINITY;
  if (model->project != NULL)
    return PL_OK;
  out->limit_rad = find_limit(out);
  out->limit = radius_at(out, out->limit_rad, &slope);
  return PL_OK;
}

bool pl_lens_project(const pl_lens *lens, pl_vec3 d, pl_vec3 *out) {
  if (lens->model->project != NULL)
    return lens->model->project(d, out);
  const double across = sqrt(d.x * d.x + d.y * d.y);
  const double theta = atan2(across, d.z);
  if (!(theta < lens->limit_rad))
    return false;
  double slope;
  const double radius = radius_at(lens, theta, &slope);
  *out = (pl_vec3){across > 0.0 ? radius * d.x / across : 0.0,
                   across > 0.0 ? radius * d.y / across : 0.0, 1.0};
  if (lens->model->shift != NULL) {
    double jacobian[4];
    const pl_vec3 shift = lens->model->shift(lens->c, d.x / d.z, d.y / d.z, jacobian);
    out->x += shift.x;
    out->y += shift.y;
  }
  return true;
}

/* Returns the angle that maps to `radius`, by Newton iterations inside a bracket. */
static double angle_of(const pl_lens *lens, double radius) {
  double low = 0.0, high = lens->limit_rad;
  double theta = fmin(atan(radius), 0.5 * (low + high));
  for (int i = 0; i < ITERATIONS; i++) {
    double slope;
    const double error = radius_at(lens, theta, &slope) - radius;
    if (fabs(error) <= 1e-15 * radius)
      break;
    if (error > 0.0)
      high = theta;
    else
      low = theta;
    double next = theta - error / slope;
    if (!(next > low && next < high))
      next = 0.5 * (low + high);
    if (next == theta)
      break;
    theta = next;
  }
  return theta;
}

static pl_vec3 direction_of(double theta, double x, double y) {
  const double radius = sqrt(x * x + y * y), sine = radius > 0.0 ? sin(theta) / radius : 0.0;
  return (pl_vec3){sine * x, sine * y, cos(theta)};
}

/* Distorts the undistorted point (u, v); j receives the Jacobian, row-major. */
static pl_vec3 distort(const pl_lens *lens, double u, double v, double j[4]) {
  const double square = u * u + v * v, r = sqrt(square);
  double slope;
  const double radius = radius_at(lens, atan(r), &slope);
  const double ratio = r > 0.0 ? radius / r : slope;
  const double rest = r > 0.0 ? (slope / (1.0 + square) - ratio) / square : 0.0;
  const pl_vec3 shift = lens->model->shift(lens->c, u, v, j);
  j[0] += ratio + rest * u * u;
  j[1] += rest * u * v;
  j[2] += rest * u * v;
  j[3] += ratio + rest * v * v;
  return (pl_vec3){ratio * u + shift.x, ratio * v + shift.y, 1.0};
}

/* Solves for the undistorted direction by Newton's method, starting from the solution without the
 * shift. */
static bool undo_shift(const pl_lens *lens, double x, double y, pl_vec3 *direction) {
  double u = direction->x / direction->z, v = direction->y / direction->z, last = INFINITY;
  for (int i = 0; i < ITERATIONS; i++) {
    double j[4];
    const pl_vec3 image = distort(lens, u, v, j);
    const double ex = image.x - x, ey = image.y - y, det = j[0] * j[3] - j[1] * j[2];
    const double error = fabs(ex) + fabs(ey);
    if (!(det > 0.0) || !(atan(sqrt(u * u + v * v)) < lens->limit_rad))
      return false;
    if (error <= 1e-15 || (i > 3 && error >= last)) {
      *direction = pl_vec3_unit((pl_vec3){u, v, 1.0});
      return error < 1e-13 * (1.0 + fabs(x) + fabs(y));
    }
    last = error;
    u -= (j[3] * ex - j[1] * ey) / det;
    v -= (j[0] * ey - j[2] * ex) / det;
  }
  return false;
}

bool pl_lens_unproject(const pl_lens *lens, double x, double y, pl_vec3 *direction) {
  if (lens->model->unproject != NULL)
    return lens->model->unproject(x, y, direction);
  const bool shifts = lens->model->shift != NULL;
  double radius = sqrt(x * x + y * y);
  if (!(radius < lens->limit) && !shifts)
    return false;
  const double within = fmin(radius, lens->limit * (1.0 - 1e-9));
  *direction = direction_of(angle_of(lens, within), x, y);
  return !shifts || undo_shift(lens, x, y, direction);
}

/* Returns the bounding rectangle of the polar rectangle with radii r0..r1 and azimuths within
 * `half` of `middle`. */
static pl_lens_extent polar_extent(double r0, double r1, double middle, double half) {
  pl_lens_extent out = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  const double radii[2] = {r0, r1};
  for (int k = -1; k <= 4; k++) {
    /* Both ends, and the axes between them, where a coordinate has its extremum. */
    double turn =
        k < 1 ? (k == 0 ? half : -half) : remainder(0.5 * PL_PI * k - middle, 2.0 * PL_PI);
    if (fabs(turn) > half)
      continue;
    for (int i = 0; i < 2; i++) {
      const double x = radii[i] * cos(middle + turn), y = radii[i] * sin(middle + turn);
      out = (pl_lens_extent){fmin(out.x0, x), fmin(out.y0, y), fmax(out.x1, x), fmax(out.y1, y)};
    }
  }
  return out;
}

pl_lens_extent pl_lens_bound(const pl_lens *lens, pl_vec3 axis, double half_angle_rad) {
  if (lens->model->bound != NULL)
    return lens->model->bound(axis, half_angle_rad);
  const double rounding = 1e-12;
  const double theta = atan2(sqrt(axis.x * axis.x + axis.y * axis.y), axis.z);
  const double from = fmax(theta - half_angle_rad, 0.0);
  const double to = fmin(theta + half_angle_rad, lens->limit_rad);
  if (!(from < to))
    return (pl_lens_extent){1.0, 1.0, -1.0, -1.0};
  double slope;
  const double r0 = radius_at(lens, from, &slope), r1 = radius_at(lens, to, &slope);
  /* A cone that contains the axis, or its opposite, spans all azimuths. */
  const bool around = half_angle_rad >= theta || half_angle_rad >= PL_PI - theta;
  const double half = around ? PL_PI : asin(fmin(1.0, sin(half_angle_rad) / sin(theta)));
  pl_lens_extent out = polar_extent(r0, r1, atan2(axis.y, axis.x), half);
  const double room =
      rounding * r1 + (lens->model->shift ? lens->model->shift_max(lens->c, tan(to)) : 0.0);
  out = (pl_lens_extent){out.x0 - room, out.y0 - room, out.x1 + room, out.y1 + room};
  return out;
}
