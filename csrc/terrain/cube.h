/* Equiangular cube around a body: six faces, each a lattice of 2^level cells on a side.
 *
 * Face coordinates s and t are in [-1, 1] and proportional to angles from the centre of the face;
 * beyond +-1 they continue smoothly on the other faces. Node (i, j) of a level is at
 * s = -1 + 2 i / 2^level, t = -1 + 2 j / 2^level, which are exact. Seen from outside, t points to
 * the left of s. Directions of nodes on an edge or a corner are bitwise equal on all its faces. */
#ifndef PL_TERRAIN_CUBE_H
#define PL_TERRAIN_CUBE_H

#include <stdbool.h>
#include <stdint.h>

#include "math/vec.h"

#define PL_CUBE_FACES 6 /* +x, -x, +y, -y, +z, -z */
#define PL_CUBE_LEVELS 48

/* Returns the tangent-plane coordinate tan(s pi/4): exactly +-1 at s = +-1, and odd. */
double pl_cube_tangent(double s);
/* Returns the unit direction of two tangent-plane coordinates. */
pl_vec3 pl_cube_tangent_direction(int face, double tangent_s, double tangent_t);
pl_vec3 pl_cube_direction(int face, double s, double t);
/* Finds the face and the coordinates of a direction of any length but 0. On edges and corners it is
 * the first of the faces. */
void pl_cube_locate(pl_vec3 direction, int *face, double *s, double *t);

/* Finds the coordinates of a unit direction on a face, which may lie beyond its edges; false if
 * the direction is more than about 60 degrees from the middle of the face. */
bool pl_cube_beside(int face, pl_vec3 direction, double *s, double *t);

/* Returns the part of a direction along the outward axis of a face. */
double pl_cube_outward(int face, pl_vec3 direction);

/* Writes the gradients of both coordinates of a face by the unit direction, along the sphere. */
void pl_cube_gradients(int face, pl_vec3 direction, pl_vec3 *s, pl_vec3 *t);

/* Returns s of node i; t of node j. */
static inline double pl_cube_node(int level, int64_t i) {
  return -1.0 + ldexp((double)i, 1 - level);
}
/* Returns the width of a cell at the centre of a face. Elsewhere cells are up to 0.71 times as
 * wide in one direction, and at corners rhombic. */
double pl_cube_cell_m(int level, double radius_m);
/* Returns the coarsest level with cells of at most `cell_m` there; 0 to PL_CUBE_LEVELS - 1. */
int pl_cube_level(double cell_m, double radius_m);

#endif
