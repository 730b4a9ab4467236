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

/* Below 90 degrees, where tan theta is infinite: no real lens has a wider image plane. */
#define BROWN_CONRADY_MAX_RAD (89.9 * PL_PI / 180.0)

const pl_lens_model pl_lens_models[] = {
    {"brown_conrady",
     "radial and tangential polynomials about the pinhole image; up to a right angle off the axis",
     brown_conrady_names, 8, BROWN_CONRADY_MAX_RAD, brown_conrady_radius, brown_conrady_shift,
     brown_conrady_shift_max},
    {"fisheye",
     "the angle off the axis becomes the radius, with a polynomial; sees up to straight behind",
     fisheye_names, 4, PL_PI, fisheye_radius, NULL, NULL},
};
const size_t pl_lens_model_count = sizeof pl_lens_models / sizeof pl_lens_models[0];
