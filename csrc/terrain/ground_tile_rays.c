#include "terrain/ground_tile_rays.h"

#include <stdlib.h>

#include "base/memory.h"
#include "terrain/cube.h"

enum { POSTS = PL_GROUND_TILE_POSTS, CELLS = PL_GROUND_TILE_CELLS };

/* A line of posts. */
typedef struct line {
  int start, step, side; /* indices of posts; bit of the side */
} line;

static const line LINES[4] = {{0, POSTS, PL_GROUND_TILE_WEST},
                              {CELLS, POSTS, PL_GROUND_TILE_EAST},
                              {0, 1, PL_GROUND_TILE_SOUTH},
                              {CELLS * POSTS, 1, PL_GROUND_TILE_NORTH}};

static void find_directions(pl_ground_tile_id id, pl_vec3 *directions) {
  const int level = pl_ground_tile_lattice(id);
  double across[POSTS];
  for (int i = 0; i < POSTS; i++)
    across[i] = pl_cube_tangent(pl_cube_node(level, (int64_t)id.i * CELLS + i));
  for (int j = 0; j < POSTS; j++) {
    const double along = pl_cube_tangent(pl_cube_node(level, (int64_t)id.j * CELLS + j));
    for (int i = 0; i < POSTS; i++)
      directions[j * POSTS + i] = pl_cube_tangent_direction(id.face, across[i], along);
  }
}

/* Posts that coarser neighbours have, too, take their values; those between are their means. */
static pl_status match_line(const pl_terrain *terrain, pl_ground_tile_id id, const line *line,
                            const pl_vec3 *directions, float *excess) {
  enum { NODES = CELLS / 2 + 1 };
  pl_vec3 nodes[NODES];
  float coarse[NODES];
  for (int n = 0; n < NODES; n++)
    nodes[n] = directions[line->start + 2 * n * line->step];
  PL_TRY(pl_terrain_rays(terrain, nodes, NODES, pl_ground_tile_lattice(id) - 1, coarse));
  for (int n = 0; n < NODES; n++) {
    float *post = &excess[line->start + 2 * n * line->step];
    *post = coarse[n];
    if (n > 0)
      post[-line->step] = 0.5f * (coarse[n - 1] + coarse[n]);
  }
  return PL_OK;
}

/* Corners that touch a coarser tile. */
static pl_status match_corners(const pl_terrain *terrain, pl_ground_tile_id id,
                               const pl_vec3 *directions, float *excess) {
  static const int corners[4] = {0, CELLS, CELLS * POSTS, CELLS * POSTS + CELLS};
  for (int k = 0; k < 4; k++)
    if (id.coarse & PL_GROUND_TILE_SOUTH_WEST << k)
      PL_TRY(pl_terrain_rays(terrain, &directions[corners[k]], 1, pl_ground_tile_lattice(id) - 1,
                             &excess[corners[k]]));
  return PL_OK;
}

static pl_status find(const pl_terrain *terrain, pl_ground_tile_id id, float *excess) {
  pl_vec3 directions[POSTS * POSTS];
  find_directions(id, directions);
  PL_TRY(pl_terrain_rays(terrain, directions, POSTS * POSTS, pl_ground_tile_lattice(id), excess));
  for (int k = 0; k < 4; k++)
    if (id.coarse & LINES[k].side)
      PL_TRY(match_line(terrain, id, &LINES[k], directions, excess));
  return match_corners(terrain, id, directions, excess);
}

pl_status pl_ground_rays_make(const pl_terrain *terrain, pl_ground_tile_id id,
                              struct pl_ground_rays **out) {
  float excess[POSTS * POSTS];
  void *memory;
  PL_TRY(find(terrain, id, excess));
  PL_TRY(pl_alloc_or_fail(1, sizeof(struct pl_ground_rays), "rays of a tile of ground", &memory));
  *out = memory;
  for (int k = 0; k < POSTS * POSTS; k++) {
    const float steps = excess[k] / PL_GROUND_RAYS_UNIT;
    (*out)->posts[k] = (int16_t)lrintf(fminf(fmaxf(steps, INT16_MIN), INT16_MAX));
  }
  return PL_OK;
}
