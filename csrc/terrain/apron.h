/* Ground around a patch that is raised or lowered to meet the patch's edges.
 *
 * A fine model and what lies below it rarely agree: over the border in which one fades into the
 * other, a difference would be a wall. An apron spreads it over a width around the patch. The
 * difference is that of means about as wide as the border, smoothed along the edges, and continued
 * by a Coons patch: between the four edges, and beyond them with the slopes that it has there. */
#ifndef PL_TERRAIN_APRON_H
#define PL_TERRAIN_APRON_H

#include "base/status.h"
#include "terrain/raster.h"

/* Pieces of an edge between places at which the difference is known. */
enum { PL_APRON_PIECES = 32 };

typedef struct pl_apron {
  const pl_raster *raster; /* borrowed */
  double radius_m, width_m;
  double most_m; /* bound of what is added */
  /* First and last row, first and last column; one more place before and after each. */
  double edges_m[4][PL_APRON_PIECES + 3];
} pl_apron;

/* Writes the columns and rows of the places along the edges, of which differences are needed:
 * PL_APRON_PLACES of them, around the raster. */
enum { PL_APRON_PLACES = 4 * PL_APRON_PIECES };
void pl_apron_places(const pl_raster *raster, double u[PL_APRON_PLACES], double v[PL_APRON_PLACES]);

/* From the differences at these places, the raster's height less that below it. */
void pl_apron_init(const pl_raster *raster, const double differences_m[PL_APRON_PLACES],
                   double width_m, double radius_m, pl_apron *out);

/* Returns what is added to the ground below the raster in a unit direction: a function with a
 * continuous slope, 0 from the width on. */
double pl_apron_lift_m(const pl_apron *apron, pl_vec3 direction);

#endif
