/* How fine the tiles of a frame are needed: of the tree of tiles, one node at a time. */
#ifndef PL_TERRAIN_GROUND_TILE_NEED_H
#define PL_TERRAIN_GROUND_TILE_NEED_H

#include "terrain/ground_tile_tree.h"

/* A tile that is chosen, or its four parts are. */
typedef struct pl_ground_tile_node {
  uint32_t i, j;
  uint32_t child; /* index of the first of its four parts; 0: none */
  uint8_t face, level;
  bool seen;       /* in the frame and not beyond the horizon; of inner nodes, any part */
  double cell_m;   /* root of the mean area of its cells; of inner nodes, least of seen parts */
  pl_vec3 center;  /* of a sphere around its ground, body axes, m */
  double radius_m; /* of this sphere */
} pl_ground_tile_node;

/* A frame, prepared. `factor`: all cells may be so much wider. */
typedef struct pl_ground_tile_need {
  const pl_terrain *terrain;
  const pl_ground_tile_view *view;
  double factor;
  double low_m;       /* all ground is at least as far from the centre of the body */
  double relief_m;    /* between the least and the greatest height */
  double horizon_rad; /* angle at the centre from the eye to the horizon of a sphere of low_m */
} pl_ground_tile_need;

pl_ground_tile_need pl_ground_tile_need_of(const pl_terrain *terrain,
                                           const pl_ground_tile_view *view, double factor);

enum { PL_GROUND_TILE_PLACED = 6 };
/* Fills in nodes of one level from their places, at most PL_GROUND_TILE_PLACED. */
pl_status pl_ground_tile_need_place(const pl_ground_tile_need *need, pl_ground_tile_node *nodes,
                                    int count);
/* Returns whether the node's cells are too wide for the frame, and may be halved. */
bool pl_ground_tile_need_split(const pl_ground_tile_need *need, const pl_ground_tile_node *node);
/* Returns whether a leaf's cells are too wide for the shadows that it may cast on seen tiles. Of
 * these, parts at index `count` and beyond are not regarded. */
bool pl_ground_tile_need_shadow(const pl_ground_tile_need *need, const pl_ground_tile_node *nodes,
                                uint32_t count, const pl_ground_tile_node *leaf);

#endif
