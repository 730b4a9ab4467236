/* Georeferenced rasters: any number on a body (heights, albedo, roughness), of any extent. */
#ifndef PL_TERRAIN_RASTER_H
#define PL_TERRAIN_RASTER_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "terrain/projection.h"
#include "terrain/raster_axis.h"

typedef enum pl_raster_type {
  PL_RASTER_UINT8,
  PL_RASTER_INT16,
  PL_RASTER_UINT16,
  PL_RASTER_FLOAT32,
  PL_RASTER_TYPE_COUNT
} pl_raster_type; /* in the machine's byte order */

typedef enum pl_raster_interpolation {
  PL_INTERPOLATION_BILINEAR,
  PL_INTERPOLATION_CUBIC, /* Catmull-Rom: smooth slopes, posts are kept */
  PL_INTERPOLATION_COUNT
} pl_raster_interpolation;

/* The sample of column c and row r (a post) is at (x0 + c dx, y0 + r dy) of the projection, rad or
 * m; rows from north to south have a negative dy. Value = scale * sample + offset. A cylindrical
 * raster that covers all longitudes wraps around (a last column that repeats the first is
 * recognised); one that reaches a pole continues beyond it on the other side. */
typedef struct pl_raster_frame {
  const void *samples; /* borrowed; may be a memory map */
  pl_raster_type type;
  size_t width, height;
  size_t stride; /* samples from row to row; 0: width */
  double scale, offset;
  pl_projection projection; /* pl_projection_init is called by pl_raster_create */
  double x0, y0, dx, dy;
} pl_raster_frame;

typedef struct pl_raster pl_raster;

/* Makes the pyramid of means (level 0 is the samples themselves); `samples` must outlive the
 * raster. Returns PL_E_RANGE for samples that are not finite, and for frames that are empty or do
 * not fit the body. */
pl_status pl_raster_create(const pl_raster_frame *frame, pl_raster **out);
void pl_raster_destroy(pl_raster *raster);
const pl_raster_frame *pl_raster_frame_of(const pl_raster *raster);
/* Lattices of its columns and rows. */
const pl_raster_axis *pl_raster_across(const pl_raster *raster);
const pl_raster_axis *pl_raster_down(const pl_raster *raster);

/* Distance of posts on a body of this radius, m: along the meridian for the cylindrical kind, else
 * the geometric mean of both directions at the centre. */
double pl_raster_spacing_m(const pl_raster *raster, double radius_m);
/* Number of levels; the last has one cell. A cell of level k is about 2^k posts wide. */
int pl_raster_levels(const pl_raster *raster);
/* Whether the raster covers the whole body. */
bool pl_raster_whole(const pl_raster *raster);

/* Writes column and row of a direction; false outside of the raster, whose edge is half a post
 * beyond its outermost posts. What is nearer to a post than rounding of directions (or 1e-9) is the
 * post. */
bool pl_raster_find(const pl_raster *raster, pl_vec3 direction, double *u, double *v);
/* Returns the distance along the ground to the raster's edge of a direction beside it, on a body of
 * a radius, m; about, at large distances. 0 on the raster, INFINITY where its map does not reach.
 */
double pl_raster_outside_m(const pl_raster *raster, pl_vec3 direction, double radius_m);
/* Whether its columns go around the body. */
bool pl_raster_goes_round(const pl_raster *raster);
/* Whether the raster is surely nowhere within `distance` (of unit vectors) of a unit direction:
 * a quick test, for one of many patches. */
bool pl_raster_far(const pl_raster *raster, pl_vec3 direction, double distance);
/* Returns the unit direction of any column and row. */
pl_vec3 pl_raster_direction(const pl_raster *raster, double u, double v);

/* Returns the value at a column and row of level 0, interpolated in a level of the pyramid (beyond
 * the last: the last). Beyond the outermost posts of a raster that ends there, the value is that of
 * its edge. At posts, level 0 gives scale * sample + offset, to the bit. */
double pl_raster_value(const pl_raster *raster, int level, double u, double v,
                       pl_raster_interpolation how);
/* The same by cubic interpolation, with its slopes by column and row of level 0. */
double pl_raster_value_slope(const pl_raster *raster, int level, double u, double v,
                             double slope[2]);
/* Writes the sample nearest to a direction; false outside of the raster. */
bool pl_raster_nearest(const pl_raster *raster, pl_vec3 direction, double *value);
/* Returns 1 inside; falls to 0 at the edge over `border_posts`, with continuous first and second
 * derivatives; 0 outside. The border is at most half of the raster. Edges where a raster continues
 * around the body have no border. */
double pl_raster_weight(const pl_raster *raster, double u, double v, double border_posts);
/* Returns the mean of that weight over a box `width_rad` wide about a direction, seen from the
 * body's centre, and writes its column and row: a fraction of the footprint, also of directions
 * just outside. 0 where the raster is out of sight. */
double pl_raster_cover(const pl_raster *raster, pl_vec3 direction, double width_rad,
                       double border_posts, double *u, double *v);
/* Writes bounds of pl_raster_value on all levels. */
void pl_raster_bounds(const pl_raster *raster, pl_raster_interpolation how, double *low,
                      double *high);

#endif
