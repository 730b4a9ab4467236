/* Planes fitted to the ground around a place: slope at a baseline, and what departs from it.
 *
 * Heights are taken in a disc about the place, with a baseline for its diameter, as a lattice with
 * cells of 1/8 of the baseline or less resolves them. The plane is that of least squares. So both
 * numbers are a function of the place, of nothing else. */
#ifndef PL_TERRAIN_PLANE_FIT_H
#define PL_TERRAIN_PLANE_FIT_H

#include "terrain/terrain.h"

enum { PL_DISC_LEAST = 8, PL_DISC_MOST = 256 };

/* Points spread evenly over a disc of diameter 1, and weights that give the gradient of the plane:
 * the sums of weights times heights. */
typedef struct pl_disc {
  int count;
  double x[PL_DISC_MOST], y[PL_DISC_MOST], of_x[PL_DISC_MOST], of_y[PL_DISC_MOST];
} pl_disc;

typedef struct pl_plane_fit {
  double slope_rad; /* of the plane to the ellipsoid, along the radius */
  double rms_m;     /* RMS height over the plane */
} pl_plane_fit;

/* PL_E_RANGE unless PL_DISC_LEAST <= points <= PL_DISC_MOST. */
pl_status pl_disc_init(int points, pl_disc *out);

/* Fits planes in `count` unit directions. Faster where neighbours in the array are near each other.
 * Fails only if there is no memory for craters. */
pl_status pl_plane_fits(const pl_terrain *terrain, const pl_disc *disc, const pl_vec3 *directions,
                        size_t count, double baseline_m, pl_plane_fit *out);

#endif
