/* Lens distortion: one table of distortion models with projection, its inverse, and bounds.
 *
 * A direction (x, y, z) in camera axes (x right, y down, z forward) maps to a point on the image
 * plane at unit focal length, which K maps to pixels. Models of lenses have a radial curve,
 * monotone up to the angle `limit_rad`; some add a small tangential shift. Other models bring
 * projection, inverse and bound themselves, as panoramas do. */
#ifndef PL_SCENE_LENS_H
#define PL_SCENE_LENS_H

#include <stddef.h>

#include "base/status.h"
#include "math/vec.h"

enum { PL_LENS_COEFFICIENTS = 8 };

/* Rectangle on the image plane; empty if x0 > x1. */
typedef struct pl_lens_extent {
  double x0, y0, x1, y1;
} pl_lens_extent;

typedef struct pl_lens_model {
  const char *name, *doc;
  const char *const *coefficients; /* their names, in OpenCV's order */
  size_t count;
  double angle_max_rad; /* directions farther off the axis have no image */
  /* Radius on the image plane at the angle theta off the axis; *slope receives the derivative with
   * respect to theta. */
  double (*radius)(const double *c, double theta_rad, double *slope);
  /* Shift added to the radially distorted point, as a function of the undistorted (x / z, y / z);
   * NULL for none. slope: the Jacobian, row-major. */
  pl_vec3 (*shift)(const double *c, double x, double y, double slope[4]);
  /* Upper bound of each component of the shift within undistorted `radius` of the axis. */
  double (*shift_max)(const double *c, double radius);
  /* In place of all of these, for projections that are not symmetric about the axis; as
   * pl_lens_project, pl_lens_unproject and pl_lens_bound. All three, or NULL. */
  bool (*project)(pl_vec3 direction, pl_vec3 *out);
  bool (*unproject)(double x, double y, pl_vec3 *direction);
  pl_lens_extent (*bound)(pl_vec3 axis, double half_angle_rad);
} pl_lens_model;

extern const pl_lens_model pl_lens_models[];
extern const size_t pl_lens_model_count;

typedef struct pl_lens {
  const pl_lens_model *model; /* NULL for none */
  double c[PL_LENS_COEFFICIENTS];
  double limit_rad; /* beyond this angle the radius no longer grows: the image would fold over */
  double limit;     /* radius at limit_rad; infinite if there is no fold */
} pl_lens;

/* `coefficients`: model->count numbers, copied. Returns PL_E_RANGE if one is not finite. */
pl_status pl_lens_init(const pl_lens_model *model, const double *coefficients, pl_lens *out);

/* Projects a direction of any length; out.z = 1. Returns false for directions beyond the limit. */
bool pl_lens_project(const pl_lens *lens, pl_vec3 direction, pl_vec3 *out);
/* Finds the unit direction of a point on the image plane, to within 1e-13 of its radius, by
 * safeguarded Newton iterations on the branch that contains the axis. Returns false if no ray of
 * this branch maps to the point. */
bool pl_lens_unproject(const pl_lens *lens, double x, double y, pl_vec3 *direction);

/* Returns a rectangle that contains the images of all directions within half_angle_rad of a unit
 * axis; x0 > x1 if they have no image. */
pl_lens_extent pl_lens_bound(const pl_lens *lens, pl_vec3 axis, double half_angle_rad);

#endif
