/* Longitude and latitude on bodies, with the footprint of a pixel in them. Inline because it runs
 * at every hit on a body with a map. */
#ifndef PL_SHADE_BODY_MAP_H
#define PL_SHADE_BODY_MAP_H

#include <math.h>
#include <stdbool.h>

#include "geom/texture.h"
#include "math/angle.h"

/* Precomputed terms for longitude and latitude at a point of a body, body axes, m. */
typedef struct pl_body_spot {
  pl_vec3 point;
  double axis_m;                /* distance from the axis */
  double rho, per_rho2, per_r2; /* for derivatives: distance from the axis, 1 / rho^2, 1 / r^2 */
} pl_body_spot;

/* At the poles, where longitude has no derivative, the point is moved to a millionth of the radius
 * from the axis, at longitude 0. */
static inline pl_body_spot pl_body_spot_of(pl_vec3 p) {
  const double r2 = pl_vec3_dot(p, p);
  double rho2 = p.x * p.x + p.y * p.y;
  pl_body_spot out = {p, sqrt(rho2), 0.0, 0.0, 1.0 / r2};
  out.rho = out.axis_m;
  if (rho2 < 1e-12 * r2) {
    rho2 = 1e-12 * r2;
    out.rho = sqrt(rho2);
    out.point = (pl_vec3){out.rho, 0.0, p.z};
  }
  out.per_rho2 = 1.0 / rho2;
  return out;
}

/* Change of map coordinates (u, v) over a step in body axes. */
static inline void pl_body_map_step(const pl_body_spot *s, pl_vec3 step, float out[2]) {
  const pl_vec3 p = s->point;
  const double lon = (p.x * step.y - p.y * step.x) * s->per_rho2;
  const double outwards = (p.x * step.x + p.y * step.y) * s->per_rho2 * s->rho;
  const double lat = (s->rho * step.z - p.z * outwards) * s->per_r2;
  out[0] = (float)(lon * (0.5 / PL_PI));
  out[1] = (float)(lat * (-1.0 / PL_PI));
}

/* Coordinates in an equirectangular map whose centre column is at longitude `center_lon_rad`: u
 * eastwards, 0..1, v from the north pole to the south pole. `across`, `along`: extent of the
 * footprint on the surface, body axes, metres; a, b: the same in map coordinates. They are computed
 * from derivatives, so that there is no seam where u wraps. Latitude is planetocentric, or geodetic
 * if the arguments have been transformed by pl_body_map_stretch. */
static inline void pl_body_map_uv(pl_vec3 point, double center_lon_rad, pl_vec3 across,
                                  pl_vec3 along, float uv[2], float a[2], float b[2]) {
  const pl_body_spot spot = pl_body_spot_of(point);
  pl_body_map_step(&spot, across, a);
  pl_body_map_step(&spot, along, b);
  const double lon = pl_arctan2(point.y, point.x), lat = pl_arctan2(point.z, spot.axis_m);
  const double u = 0.5 + (lon - center_lon_rad) / (2.0 * PL_PI);
  uv[0] = (float)(u - floor(u));
  uv[1] = (float)(0.5 - lat / PL_PI);
}

/* Argument of pl_body_map_stretch: square of the ratio of equatorial to polar radius, less 1. For a
 * triaxial body the equatorial radius is the geometric mean. */
static inline double pl_body_map_oblate(pl_vec3 radii_m) {
  return radii_m.x * radii_m.y / (radii_m.z * radii_m.z) - 1.0;
}
/* On a spheroid, tan(geodetic latitude) is tan(planetocentric latitude) times the square of the
 * ratio of the radii. Scaling along the axis by that factor makes the planetocentric latitude of
 * the result the geodetic latitude of the point; footprints are scaled likewise. */
static inline pl_vec3 pl_body_map_stretch(pl_vec3 v, double oblate) {
  return (pl_vec3){v.x, v.y, v.z + oblate * v.z};
}

/* A point of a body with its footprint, body axes, metres, and the convention of its maps. */
typedef struct pl_body_place {
  pl_vec3 point, across, along;
  double center_lon_rad; /* longitude of the map's centre */
  double oblate;         /* pl_body_map_oblate for maps in geodetic latitude; otherwise 0 */
} pl_body_place;

/* Splits a footprint for sampling: into itself, or near a pole into 16 parts of a quarter of the
 * width (except with PL_FILTER_NONE). The parts are already transformed by pl_body_map_stretch.
 * Returns their number. */
enum { PL_BODY_MAP_PARTS = 16 };
int pl_body_map_split(const pl_body_place *place, pl_filter filter,
                      pl_body_place parts[PL_BODY_MAP_PARTS]);
/* Samples a map over a part; `of_many`: the footprint was split. */
void pl_body_map_read(const pl_texture *map, const pl_body_place *part, bool of_many,
                      pl_filter filter, float out[4]);

/* Samples an equirectangular map as pl_texture_sample does, as the mean over the parts. */
void pl_body_map_sample(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                        float out[4]);
/* The same with pl_texture_box, except at the poles. */
void pl_body_map_box(const pl_texture *map, const pl_body_place *place, pl_filter filter,
                     float out[4]);

#endif
