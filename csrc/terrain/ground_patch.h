/* The smooth surface of a cell of the ground: the distance from the body's centre as a bicubic
 * Hermite patch through the posts and the slopes of a tile, without twists (Ferguson's patch). Its
 * edges depend on their two posts alone, so patches of a tile fit each other.
 *
 * Rays meet the triangles of a cell, which cut tops off and fill hollows: at a top in the middle of
 * a cell they are lower by all of the relief that the cell shows. What is labelled is this patch.
 */
#ifndef PL_TERRAIN_GROUND_PATCH_H
#define PL_TERRAIN_GROUND_PATCH_H

#include "terrain/height_field.h"

typedef struct pl_ground_patch {
  const pl_ground_tile *tile;
  int column, row;              /* of the cell */
  pl_vec3 origin;               /* of the field, body axes, m */
  pl_vec3 corner, edge1, edge2; /* of the triangle that was hit, relative to it */
  pl_vec3 normal;               /* of the triangle, unit, outwards */
  double cell_m;                /* length of the longer edge */
  bool upper;                   /* whether the triangle's corner is at x = y = 1 of the cell */
  pl_vec3 across[2];            /* dot products with them are weights of both edges */
  /* By [y][x] of the cell's corners: distance from the centre, m, and its change along a whole
   * cell in x and in y, at the corner's slope. */
  double radius_m[2][2], along_m[2][2][2];
} pl_ground_patch;

/* Sets all but the corners: the triangle that was hit. */
void pl_ground_patch_at(const pl_height_field *field, uint32_t tile, float u, float v,
                        pl_ground_patch *out);

/* Moves a point of a ray near the triangle to where the ray meets the patch, whose corners it sets.
 * `from` is relative to the field's origin, `along` unit, `t` the distance of the triangle's plane.
 * Returns `t` itself on the skirt, and where the patch is not met over its cell, as at outlines. */
double pl_ground_patch_meet(pl_ground_patch *patch, pl_vec3 from, pl_vec3 along, double t);

#endif
