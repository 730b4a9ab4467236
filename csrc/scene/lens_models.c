/* The table of distortion models, with coefficients as in OpenCV. */
#include "scene/lens.h"

/* Brown (1966) and Conrady (1919), with the rational radial part of OpenCV: r (1 + k1 r^2 + k2 r^4
 * + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6), r = tan theta. */
static const char *const brown_conrady_names[] = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};

static double brown_conrady_radius(const double *c, double theta, double *slope) {
  const double r = tan(theta), s = r * r;
  const double top = 1.0 + s * (c[0] + s * (c[1] + s * c[4]));
  const double bottom = 1.0 + s * (c[5] + s * (c[6] + s * c[7]));
  const double top_s = c[0] + s * (2.0 * c[1] + s * 3.0 * c[4]);
  const double bottom_s = c[5] + s * (2.0 * c[6] + s * 3.0 * c[7]);
  const double ratio = top / bottom;
  *slope = (1.0 + s) * (ratio + 2.0 * s * (top_s - ratio * bottom_s) / bottom);
  return r * ratio;
}

static pl_vec3 brown_conrady_shift(const double *c, double x, double y, double slope[4]) {
  const double p1 = c[2], p2 = c[3], s = x * x + y * y;
  slope[0] = 2.0 * p1 * y + 6.0 * p2 * x;
  slope[1] = slope[2] = 2.0 * p1 * x + 2.0 * p2 * y;
  slope[3] = 6.0 * p1 * y + 2.0 * p2 * x;
  return (pl_vec3){2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
                   p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y, 0.0};
}

static double brown_conrady_shift_max(const double *c, double radius) {
  return 3.0 * (fabs(c[2]) + fabs(c[3])) * radius * radius;
}

/* Kannala and Brandt (2006), as OpenCV's fisheye: theta (1 + k1 theta^2 + ... + k4 theta^8). */
static const char *const fisheye_names[] = {"k1", "k2", "k3", "k4"};

static double fisheye_radius(const double *c, double theta, double *slope) {
  const double s = theta * theta;
  *slope = 1.0 + s * (3.0 * c[0] + s * (5.0 * c[1] + s * (7.0 * c[2] + s * 9.0 * c[3])));
  return theta * (1.0 + s * (c[0] + s * (c[1] + s * (c[2] + s * c[3]))));
}

/* Equirectangular panorama: azimuth to the right and elevation downwards, both in radians. Its left
 * and right edges are the same half plane behind the camera, top and bottom one direction each. */
static const double EDGE = 1.0 + 1e-9; /* rounding at the edges of an image of all directions */

static bool equirectangular_project(pl_vec3 d, pl_vec3 *out) {
  const double level = sqrt(d.x * d.x + d.z * d.z);
  *out = (pl_vec3){atan2(d.x, d.z), atan2(d.y, level), 1.0};
  return level > 0.0 || d.y != 0.0;
}

static bool equirectangular_unproject(double x, double y, pl_vec3 *direction) {
  const double level = cos(y);
  *direction = (pl_vec3){level * sin(x), sin(y), level * cos(x)};
  return fabs(x) <= EDGE * PL_PI && fabs(y) <= EDGE * 0.5 * PL_PI;
}

/* A cone that contains a pole, or meets the half plane behind the camera, spans all azimuths. */
static pl_lens_extent equirectangular_bound(pl_vec3 axis, double half_angle_rad) {
  const double room = 1e-12, most = 0.5 * PL_PI;
  const double level = sqrt(axis.x * axis.x + axis.z * axis.z);
  const double azimuth = atan2(axis.x, axis.z), elevation = atan2(axis.y, level);
  const double y0 = elevation - half_angle_rad - room, y1 = elevation + half_angle_rad + room;
  pl_lens_extent out = {-PL_PI - room, fmax(y0, -most), PL_PI + room, fmin(y1, most)};
  if (!(y0 > -most && y1 < most && half_angle_rad < most))
    return out;
  const double half = asin(fmin(1.0, sin(half_angle_rad) / cos(elevation))) + room;
  if (azimuth - half > -PL_PI && azimuth + half < PL_PI) {
    out.x0 = azimuth - half;
    out.x1 = azimuth + half;
  }
  return out;
}

/* Below 90 degrees, where tan theta is infinite: no real lens has a wider image plane. */
#define BROWN_CONRADY_MAX_RAD (89.9 * PL_PI / 180.0)

const pl_lens_model pl_lens_models[] = {
    {.name = "brown_conrady",
     .doc = "radial and tangential polynomials about the pinhole image; up to a right angle off "
            "the axis",
     .coefficients = brown_conrady_names,
     .count = 8,
     .angle_max_rad = BROWN_CONRADY_MAX_RAD,
     .radius = brown_conrady_radius,
     .shift = brown_conrady_shift,
     .shift_max = brown_conrady_shift_max},
    {.name = "fisheye",
     .doc = "the angle off the axis becomes the radius, with a polynomial; sees up to straight "
            "behind",
     .coefficients = fisheye_names,
     .count = 4,
     .angle_max_rad = PL_PI,
     .radius = fisheye_radius},
    {.name = "equirectangular",
     .doc = "a panorama of all directions: azimuth and elevation become column and row",
     .angle_max_rad = PL_PI,
     .project = equirectangular_project,
     .unproject = equirectangular_unproject,
     .bound = equirectangular_bound},
};
const size_t pl_lens_model_count = sizeof pl_lens_models / sizeof pl_lens_models[0];
