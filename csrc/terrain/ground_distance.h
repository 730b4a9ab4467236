/* How near the ground is to a point above it. */
#ifndef PL_TERRAIN_GROUND_DISTANCE_H
#define PL_TERRAIN_GROUND_DISTANCE_H

#include "math/vec.h"
#include "terrain/terrain.h"

/* Returns a distance in m to which there is neither ground nor a rock around a point above the
 * ground (body axes, m): seven tenths of the way to the nearest ground or more where no rock is in
 * between. 0 in the reach of a rock, or without memory. Slopes are taken to be below 30 degrees
 * over the width of a tile, as for the choice of tiles. */
double pl_ground_distance_m(const pl_terrain *terrain, pl_vec3 eye);
/* The same of the ground alone, without rocks. */
double pl_ground_clear_m(const pl_terrain *terrain, pl_vec3 eye);

#endif
