#include "annotate/rim_image.h"

/* A pixel coordinate times z, and z, of a point of the rim: k[0] + k[1] cos t + k[2] sin t. */
typedef struct wave {
  double k[3];
} wave;

static double at(const wave *w, double t) { return w->k[0] + w->k[1] * cos(t) + w->k[2] * sin(t); }

static wave wave_of(const pl_rim *rim, double x, double y, double z) {
  const pl_vec3 row = {x, y, z};
  return (wave){
      {pl_vec3_dot(row, rim->centre), pl_vec3_dot(row, rim->major), pl_vec3_dot(row, rim->minor)}};
}

/* The solutions of k0 + k1 cos t + k2 sin t = 0; returns their number, 0 or 2. */
static int roots_of(double k0, double k1, double k2, double out[2]) {
  const double size = hypot(k1, k2);
  if (!(size > 0.0) || fabs(k0) > size)
    return 0;
  const double middle = atan2(k2, k1), half = acos(-k0 / size);
  out[0] = middle - half;
  out[1] = middle + half;
  return 2;
}

/* Extends [low, high] by p/z where z is at least `near_m`: at the stationary points of p/z, and
 * where the rim crosses the near plane. */
static void extend(const wave *p, const wave *z, double near_m, double *low, double *high) {
  const double *a = p->k, *c = z->k;
  double t[6] = {0.0, PL_PI};
  int count = 2;
  /* (p' z - p z') = 0: its constant term is what the products of cos and sin leave. */
  count += roots_of(a[2] * c[1] - a[1] * c[2], a[2] * c[0] - a[0] * c[2], a[0] * c[1] - a[1] * c[0],
                    t + count);
  count += roots_of(c[0] - near_m, c[1], c[2], t + count);
  const double least = near_m * (1.0 - 1e-9);
  for (int k = 0; k < count; k++) {
    const double depth = at(z, t[k]);
    if (depth < least)
      continue;
    const double value = at(p, t[k]) / depth;
    *low = fmin(*low, value);
    *high = fmax(*high, value);
  }
}

/* From the dual conic H diag(1, 1, -1) H^T, H = K [major minor centre]: no inverse, so it holds for
 * planes seen edge-on, too. Pixels are measured from the image of the rim's centre. */
static void ellipse_of(const wave *u, const wave *v, const wave *z, pl_rim_image *image) {
  const double *a = u->k, *b = v->k, *c = z->k;
  const double scale = 1.0 / (c[0] * c[0] - c[1] * c[1] - c[2] * c[2]);
  const double x = -scale * (a[1] * c[1] + a[2] * c[2] - a[0] * c[0]);
  const double y = -scale * (b[1] * c[1] + b[2] * c[2] - b[0] * c[0]);
  const double xx = scale * (a[1] * a[1] + a[2] * a[2] - a[0] * a[0]) + x * x;
  const double yy = scale * (b[1] * b[1] + b[2] * b[2] - b[0] * b[0]) + y * y;
  const double xy = scale * (a[1] * b[1] + a[2] * b[2] - a[0] * b[0]) + x * y;
  const double q = hypot(xx - yy, 2.0 * xy), major = fmax(0.5 * (xx + yy + q), 0.0);
  const double minor = major > 0.0 ? fmax((xx * yy - xy * xy) / major, 0.0) : 0.0;
  image->centre[0] += x;
  image->centre[1] += y;
  image->semi_axes[0] = sqrt(major);
  image->semi_axes[1] = sqrt(minor);
  image->angle_rad = 0.5 * atan2(2.0 * xy, xx - yy);
}

pl_rim_image pl_rim_project(const pl_rim *rim, const pl_pinhole *camera, double near_m) {
  pl_rim_image image = {.kind = PL_RIM_BEHIND};
  const pl_vec3 normal = pl_vec3_unit(pl_vec3_cross(rim->major, rim->minor));
  image.facing = -pl_vec3_dot(normal, pl_vec3_unit(rim->centre));
  const wave z = wave_of(rim, 0.0, 0.0, 1.0);
  const double spread = hypot(z.k[1], z.k[2]);
  if (!(z.k[0] + spread > near_m))
    return image;
  image.kind = z.k[0] - spread > near_m ? PL_RIM_ELLIPSE : PL_RIM_PARTLY;
  const bool whole = image.kind == PL_RIM_ELLIPSE;
  const double z0 = whole ? z.k[0] : 1.0;
  const pl_vec3 c = rim->centre;
  const double u0 = whole ? (camera->fx * c.x + camera->skew * c.y) / z0 + camera->cx : 0.0;
  const double v0 = whole ? camera->fy * c.y / z0 + camera->cy : 0.0;
  const wave u = wave_of(rim, camera->fx, camera->skew, camera->cx - u0);
  const wave v = wave_of(rim, 0.0, camera->fy, camera->cy - v0);
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  extend(&u, &z, near_m, &low[0], &high[0]);
  extend(&v, &z, near_m, &low[1], &high[1]);
  image.box[0] = u0 + low[0];
  image.box[1] = v0 + low[1];
  image.box[2] = u0 + high[0];
  image.box[3] = v0 + high[1];
  if (whole) {
    image.centre[0] = u0;
    image.centre[1] = v0;
    ellipse_of(&u, &v, &z, &image);
  }
  return image;
}
