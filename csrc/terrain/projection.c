/* The table of projections. */
#include "terrain/projection.h"

#include <string.h>

typedef struct projection_row {
  const char *name;
  bool centred; /* has a centre and metres */
  bool (*forward)(const pl_projection *p, pl_vec3 d, double *x, double *y);
  pl_vec3 (*inverse)(const pl_projection *p, double x, double y);
} projection_row;

/* Coordinates along the axes of the centre, of a vector of any length. */
static pl_vec3 to_axes(const pl_projection *p, pl_vec3 d) {
  return (pl_vec3){pl_vec3_dot(d, p->east), pl_vec3_dot(d, p->north), pl_vec3_dot(d, p->up)};
}

static pl_vec3 from_axes(const pl_projection *p, pl_vec3 a) {
  const pl_vec3 flat = pl_vec3_madd(pl_vec3_scale(p->east, a.x), a.y, p->north);
  return pl_vec3_unit(pl_vec3_madd(flat, a.z, p->up));
}

/* With arctangents only, which are accurate at the poles, too. */
static bool cylindrical_forward(const pl_projection *p, pl_vec3 d, double *x, double *y) {
  *x = atan2(d.y, d.x);
  *y = atan2(d.z, p->axis_ratio * p->axis_ratio * sqrt(d.x * d.x + d.y * d.y));
  return true;
}

static pl_vec3 cylindrical_inverse(const pl_projection *p, double x, double y) {
  const double c = cos(y), squared = p->axis_ratio * p->axis_ratio;
  return pl_vec3_unit((pl_vec3){c * cos(x), c * sin(x), squared * sin(y)});
}

static bool stereographic_forward(const pl_projection *p, pl_vec3 d, double *x, double *y) {
  const pl_vec3 a = to_axes(p, d);
  const double length = pl_vec3_norm(d), below = length + a.z;
  if (!(below > 1e-12 * length)) /* the point opposite to the centre */
    return false;
  const double by = 2.0 * p->radius_m * p->scale / below;
  *x = by * a.x;
  *y = by * a.y;
  return true;
}

static pl_vec3 stereographic_inverse(const pl_projection *p, double x, double y) {
  const double by = 0.5 / (p->radius_m * p->scale), u = by * x, v = by * y;
  return from_axes(p, (pl_vec3){2.0 * u, 2.0 * v, 1.0 - (u * u + v * v)});
}

static bool orthographic_forward(const pl_projection *p, pl_vec3 d, double *x, double *y) {
  const pl_vec3 a = to_axes(p, d);
  const double by = p->radius_m / pl_vec3_norm(d);
  *x = by * a.x;
  *y = by * a.y;
  return a.z > 0.0;
}

static pl_vec3 orthographic_inverse(const pl_projection *p, double x, double y) {
  const double u = x / p->radius_m, v = y / p->radius_m, squared = u * u + v * v;
  return from_axes(p, (pl_vec3){u, v, sqrt(squared < 1.0 ? 1.0 - squared : 0.0)});
}

static const projection_row ROWS[PL_PROJECTION_COUNT] = {
    [PL_PROJECTION_CYLINDRICAL] = {"cylindrical", false, cylindrical_forward, cylindrical_inverse},
    [PL_PROJECTION_STEREOGRAPHIC] = {"stereographic", true, stereographic_forward,
                                     stereographic_inverse},
    [PL_PROJECTION_ORTHOGRAPHIC] = {"orthographic", true, orthographic_forward,
                                    orthographic_inverse},
};

pl_status pl_projection_find(const char *name, pl_projection_kind *out) {
  char names[128] = "";
  for (int k = 0; k < PL_PROJECTION_COUNT; k++) {
    if (strcmp(name, ROWS[k].name) == 0) {
      *out = (pl_projection_kind)k;
      return PL_OK;
    }
    pl_names_append(names, sizeof names, ROWS[k].name);
  }
  return pl_fail(PL_E_ARGUMENT, "no projection '%.40s'; there are %s", name, names);
}

/* Sine and cosine of a latitude; exact at the poles. */
static void latitude(double lat_rad, double *sine, double *cosine) {
  const bool pole = fabs(lat_rad) >= 0.5 * PL_PI;
  *sine = pole ? copysign(1.0, lat_rad) : sin(lat_rad);
  *cosine = pole ? 0.0 : cos(lat_rad);
}

static pl_status init_centre(pl_projection *p) {
  if (!isfinite(p->lon0_rad))
    return pl_fail(PL_E_RANGE, "the longitude of a projection's centre is not finite");
  if (!(fabs(p->lat0_rad) <= 0.5 * PL_PI * (1.0 + 1e-12)))
    return pl_fail(PL_E_RANGE, "the latitude of a projection's centre is %g rad", p->lat0_rad);
  if (!(p->radius_m > 0.0 && isfinite(p->radius_m)))
    return pl_fail(PL_E_RANGE, "the radius of a projection is %g m", p->radius_m);
  if (p->scale == 0.0)
    p->scale = 1.0;
  if (!(p->scale > 0.0 && isfinite(p->scale)))
    return pl_fail(PL_E_RANGE, "the scale of a projection is %g", p->scale);
  double sine, cosine;
  latitude(p->lat0_rad, &sine, &cosine);
  const double s = sin(p->lon0_rad), c = cos(p->lon0_rad);
  p->east = (pl_vec3){-s, c, 0.0};
  p->north = (pl_vec3){-sine * c, -sine * s, cosine};
  p->up = (pl_vec3){cosine * c, cosine * s, sine};
  return PL_OK;
}

pl_status pl_projection_init(pl_projection *p) {
  if (!(p->kind < PL_PROJECTION_COUNT))
    return pl_fail(PL_E_ARGUMENT, "no projection %d", (int)p->kind);
  if (ROWS[p->kind].centred)
    return init_centre(p);
  if (p->axis_ratio == 0.0)
    p->axis_ratio = 1.0;
  if (!(p->axis_ratio > 0.0 && isfinite(p->axis_ratio)))
    return pl_fail(PL_E_RANGE, "the ratio of axes of a projection is %g", p->axis_ratio);
  return PL_OK;
}

bool pl_projection_forward(const pl_projection *p, pl_vec3 direction, double *x, double *y) {
  return ROWS[p->kind].forward(p, direction, x, y);
}

pl_vec3 pl_projection_inverse(const pl_projection *p, double x, double y) {
  return ROWS[p->kind].inverse(p, x, y);
}
