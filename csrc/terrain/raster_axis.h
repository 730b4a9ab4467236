/* The lattice of a raster's posts along one axis of its projection. Posts are counted from the
 * origin of the projection, and places are rounded to a small part of a post: a raster that is cut
 * out of another has the columns of the other less a whole number, to the bit. */
#ifndef PL_TERRAIN_RASTER_AXIS_H
#define PL_TERRAIN_RASTER_AXIS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct pl_raster_axis {
  double step;    /* from post to post, rad or m; may be negative */
  int64_t first;  /* number of the raster's first post in the lattice */
  double phase;   /* place of the lattice's post 0, in steps from the origin: -0.25 to 0.75 */
  double quantum; /* places are rounded to it, in posts */
  double turn;    /* posts around the body; 0: the axis is no longitude */
  int64_t period; /* `turn` where it is whole, else 0 */
} pl_raster_axis;

/* `origin`: place of the first post; `size`: of the body along the axis, in the unit of `step`;
 * `around`: whether the axis is a longitude. A step within rounding of a whole part of the turn
 * must have been made one. */
void pl_raster_axis_init(double origin, double step, double size, bool around, pl_raster_axis *out);
/* Returns the column of a place, of a longitude in the turn that is nearest to `middle`. */
double pl_raster_axis_column(const pl_raster_axis *axis, double place, double middle);
/* Returns the place of a column, in fractions too. */
double pl_raster_axis_place(const pl_raster_axis *axis, double column);
/* Returns the place of post 0 of the lattice plus `posts`. */
double pl_raster_axis_lattice(const pl_raster_axis *axis, double posts);

#endif
