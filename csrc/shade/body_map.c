/* Where points of bodies are in their maps. */
#include "shade/body_map.h"

#include <math.h>

#include "geom/ellipsoid.h"

/* Change of longitude and latitude over a step in body axes, as map coordinates. */
static void map_step(pl_vec3 p, pl_vec3 step, float out[2]) {
  const double r2 = pl_vec3_dot(p, p), nearest2 = 1e-12 * r2;
  if (p.x * p.x + p.y * p.y < nearest2) { /* a pole */
    p.x = sqrt(nearest2);
    p.y = 0.0;
  }
  const double rho2 = p.x * p.x + p.y * p.y, rho = sqrt(rho2);
  const double lon = (p.x * step.y - p.y * step.x) / rho2;
  const double lat = (rho * step.z - p.z * (p.x * step.x + p.y * step.y) / rho) / r2;
  out[0] = (float)(lon / (2.0 * PL_PI));
  out[1] = (float)(-lat / PL_PI);
}

void pl_body_map_uv(pl_vec3 point, double center_lon_rad, pl_vec3 across, pl_vec3 along,
                    float uv[2], float a[2], float b[2]) {
  double lon, lat;
  map_step(point, across, a);
  map_step(point, along, b);
  pl_ellipsoid_lon_lat(point, &lon, &lat);
  const double u = 0.5 + (lon - center_lon_rad) / (2.0 * PL_PI);
  uv[0] = (float)(u - floor(u));
  uv[1] = (float)(0.5 - lat / PL_PI);
}
