/* Map projections: between directions from a body's centre and plane coordinates of a raster. */
#ifndef PL_TERRAIN_PROJECTION_H
#define PL_TERRAIN_PROJECTION_H

#include <stdbool.h>

#include "base/status.h"
#include "math/vec.h"

typedef enum pl_projection_kind {
  PL_PROJECTION_CYLINDRICAL,   /* x = longitude eastwards, y = latitude, rad */
  PL_PROJECTION_STEREOGRAPHIC, /* metres eastwards and northwards at the centre; conformal */
  PL_PROJECTION_ORTHOGRAPHIC,  /* metres in the plane that is tangent at the centre */
  PL_PROJECTION_COUNT
} pl_projection_kind;

/* Directions are in body axes (z to the north pole, x to longitude 0). Fill in the first fields and
 * call pl_projection_init. A polar stereographic map is one with its centre at the pole: its x axis
 * points to longitude lon0 + 90 degrees, as seen from above either pole, its y axis to lon0 on the
 * south pole's map and away from it on the north pole's. */
typedef struct pl_projection {
  pl_projection_kind kind;
  double lon0_rad, lat0_rad; /* centre; not of the cylindrical kind */
  double radius_m;           /* sphere that is projected; not of the cylindrical kind */
  double scale;              /* of lengths at the centre, of the stereographic kind; 0: 1 */
  double
      axis_ratio; /* cylindrical: polar over equatorial radius, where latitudes are planetographic
                   * (geodetic); 0 or 1: latitudes of directions from the centre */
  pl_vec3 east, north, up; /* axes at the centre, by pl_projection_init */
} pl_projection;

/* Finds a kind by name; PL_E_ARGUMENT with a text that lists the names. */
pl_status pl_projection_find(const char *name, pl_projection_kind *out);

/* Checks the fields and completes the axes; PL_E_RANGE with a text that names the field. */
pl_status pl_projection_init(pl_projection *projection);
/* Writes the place of a direction of any length but 0; false where the map has no such place. */
bool pl_projection_forward(const pl_projection *projection, pl_vec3 direction, double *x,
                           double *y);
/* Returns the unit direction of a place. A latitude beyond a pole is that on the other side of it.
 * Places beyond the edge of an orthographic map are moved to its edge. */
pl_vec3 pl_projection_inverse(const pl_projection *projection, double x, double y);

#endif
