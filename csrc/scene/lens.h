/* How a lens bends rays: one table of distortion models, forward, inverse and bounds.
 *
 * A direction (x, y, z) in camera axes (x right, y down, z forward) goes to a point of the image
 * plane at unit focal length, which K takes to pixels. Every model is a radial curve, monotone up
 * to the angle `limit_rad`, and for some a small tangential shift. */
#ifndef PL_SCENE_LENS_H
#define PL_SCENE_LENS_H

#include <stddef.h>

#include "base/status.h"
#include "math/vec.h"

enum { PL_LENS_COEFFICIENTS = 8 };

typedef struct pl_lens_model {
  const char *name, *doc;
  const char *const *coefficients; /* their names, in OpenCV's order */
  size_t count;
  double angle_max_rad; /* no ray farther off the axis has an image */
  /* Radius on the image plane of the angle theta off the axis; slope: its derivative by theta. */
  double (*radius)(const double *c, double theta_rad, double *slope);
  /* Added to the radially distorted point, at the undistorted (x / z, y / z); NULL for nothing.
   * slope: the Jacobian by rows. */
  pl_vec3 (*shift)(const double *c, double x, double y, double slope[4]);
  /* Upper bound of either coordinate of a shift within `radius` of the axis, undistorted. */
  double (*shift_max)(const double *c, double radius);
} pl_lens_model;

extern const pl_lens_model pl_lens_models[];
extern const size_t pl_lens_model_count;

typedef struct pl_lens {
  const pl_lens_model *model; /* NULL: none */
  double c[PL_LENS_COEFFICIENTS];
  double limit_rad; /* beyond, the radius grows no more: the image would fold over */
  double limit;     /* radius there; infinite where there is none */
} pl_lens;

/* `coefficients`: model->count numbers, copied. PL_E_RANGE if one is not finite. */
pl_status pl_lens_init(const pl_lens_model *model, const double *coefficients, pl_lens *out);

/* Image of a direction of any length, out.z = 1. False beyond the limit, where there is none. */
bool pl_lens_project(const pl_lens *lens, pl_vec3 direction, pl_vec3 *out);
/* Direction, unit, of a point on the image plane: within 1e-13 of its radius, by safeguarded Newton
 * iterations on the side of the fold that holds the axis. False where no ray of that side goes. */
bool pl_lens_unproject(const pl_lens *lens, double x, double y, pl_vec3 *direction);

/* A rectangle of the image plane. */
typedef struct pl_lens_extent {
  double x0, y0, x1, y1;
} pl_lens_extent;
/* A rectangle that holds the images of all directions within half_angle_rad of a unit axis; with
 * x0 > x1 if they have none. */
pl_lens_extent pl_lens_bound(const pl_lens *lens, pl_vec3 axis, double half_angle_rad);

#endif
