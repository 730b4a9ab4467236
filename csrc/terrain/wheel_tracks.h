/* Tracks of wheels on the ground: two ruts along a path, with soil heaped beside them, imprints of
 * the wheels' grousers, and the albedo of soil that was turned and pressed.
 *
 * A point belongs to the piece of the path between whose two normal planes it lies, those at the
 * path's points; so there are no gaps and no overlaps at bends. Where the path crosses itself or
 * others, the deepest rut counts. */
#ifndef PL_TERRAIN_WHEEL_TRACKS_H
#define PL_TERRAIN_WHEEL_TRACKS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "math/vec.h"

typedef struct pl_wheel_shape {
  double gauge_m;     /* between the middles of the wheels of both sides, above width_m */
  double width_m;     /* of a wheel; above 0 */
  double depth_m;     /* of a rut below the ground; soil beside it is BERM of it high */
  double spacing_m;   /* of grousers along the path; 0: smooth wheels */
  double imprint_m;   /* depth of their imprints below the rut */
  double chevron_rad; /* of the bars from across the path, to both sides of a wheel's middle */
  double albedo;      /* factor on that of the ground, in a rut; 0 to 4 */
} pl_wheel_shape;

typedef struct pl_wheel_track {
  const pl_vec3 *points; /* of the ellipsoid, body axes, m; at least 2, none as that before it */
  size_t count;
  pl_wheel_shape shape;
} pl_wheel_track;

typedef struct pl_wheel_tracks pl_wheel_tracks;

/* PL_E_RANGE for numbers that are not valid. Points are copied; the result is immutable. */
pl_status pl_wheel_tracks_create(const pl_wheel_track *tracks, size_t count, pl_wheel_tracks **out);
void pl_wheel_tracks_destroy(pl_wheel_tracks *tracks);

/* Adds to heights (m) in unit directions what cells of a width (m) show: ruts from 1 to 2 cells of
 * width on, imprints from 2 to 4 of their spacing on, and otherwise their mean. */
void pl_wheel_tracks_add_heights(const pl_wheel_tracks *tracks, const pl_vec3 *directions,
                                 size_t count, double cell_m, double *heights_m);
/* Returns the factor on the albedo in a unit direction: the mean over a footprint across the path.
 */
double pl_wheel_tracks_albedo(const pl_wheel_tracks *tracks, pl_vec3 direction, double footprint_m);
/* Returns the greatest factor on the albedo, at least 1. */
double pl_wheel_tracks_brightest(const pl_wheel_tracks *tracks);
/* Returns whether a disc about a unit direction touches a rut. */
bool pl_wheel_tracks_touch(const pl_wheel_tracks *tracks, pl_vec3 direction, double radius_m);
/* Writes bounds of the relief. */
void pl_wheel_tracks_bounds(const pl_wheel_tracks *tracks, double *low_m, double *high_m);

#endif
