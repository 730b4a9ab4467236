/* Searches the tree of tiles for the nearest ground. */
#include "terrain/ground_distance.h"

#include "base/memory.h"
#include "terrain/cube.h"
#include "terrain/ground_tile_need.h"
#include "terrain/rock_field.h"

/* The search ends when the sphere around the nearest ground is this much smaller than its distance,
 * or at this number of nodes. */
#define SHARPNESS 0.8
enum { NODES = 512 };

/* No point of a rock is farther than this many diameters from where it is set on the ground. */
#define ROCK_REACH 2.0
/* Rocks whose reach is below this part of the distance are not looked up one by one. */
#define SMALL_ROCK 0.15

typedef struct search {
  pl_ground_tile_need need;
  pl_ground_tile_node nodes[NODES];
  int count;
} search;

/* Distance to which the ground of a node is not. */
static double gap_m(const search *search, const pl_ground_tile_node *node) {
  return pl_vec3_norm(pl_vec3_sub(node->center, search->need.view->eye)) - node->radius_m;
}

static int nearest_of(const search *search) {
  int best = 0;
  for (int k = 1; k < search->count; k++)
    if (gap_m(search, &search->nodes[k]) < gap_m(search, &search->nodes[best]))
      best = k;
  return best;
}

static pl_status start(search *search) {
  for (uint8_t face = 0; face < PL_CUBE_FACES; face++)
    search->nodes[face] = (pl_ground_tile_node){.face = face};
  search->count = PL_CUBE_FACES;
  return pl_ground_tile_need_place(&search->need, search->nodes, PL_CUBE_FACES);
}

/* Replaces a node by its parts. */
static pl_status split(search *search, int index) {
  const pl_ground_tile_node node = search->nodes[index];
  pl_ground_tile_node parts[4];
  for (uint32_t k = 0; k < 4; k++)
    parts[k] = (pl_ground_tile_node){.i = 2 * node.i + (k & 1),
                                     .j = 2 * node.j + (k >> 1),
                                     .face = node.face,
                                     .level = (uint8_t)(node.level + 1)};
  PL_TRY(pl_ground_tile_need_place(&search->need, parts, 4));
  search->nodes[index] = parts[0];
  for (int k = 1; k < 4; k++)
    search->nodes[search->count++] = parts[k];
  return PL_OK;
}

/* The distance of the ground alone. */
static double ground_m(search *search) {
  if (start(search) != PL_OK)
    return 0.0;
  for (;;) {
    const int k = nearest_of(search);
    const pl_ground_tile_node *node = &search->nodes[k];
    const double gap = gap_m(search, node);
    const bool finest = node->level + 1 + PL_GROUND_TILE_SHIFT >= PL_CUBE_LEVELS - 1;
    if (gap >= SHARPNESS * (gap + node->radius_m) || finest || search->count + 3 > NODES)
      return fmax(gap, 0.0);
    if (split(search, k) != PL_OK)
      return 0.0;
  }
}

/* The same with the rocks that reach far up. */
static double rocks_m(const pl_terrain *terrain, const pl_rock_field *rocks, pl_vec3 eye,
                      double ground) {
  const double most_m = pl_rock_field_frame(rocks)->max_m;
  const double small_m = SMALL_ROCK / ROCK_REACH * ground;
  double clear_m = ground - fmin(small_m, most_m) * ROCK_REACH;
  if (most_m <= small_m)
    return clear_m;
  pl_rock *list;
  size_t count;
  if (pl_rock_list(rocks, terrain, pl_vec3_unit(eye), 2.0 * ground + ROCK_REACH * most_m, small_m,
                   1.001 * most_m, &list, &count) != PL_OK)
    return 0.0;
  for (size_t k = 0; k < count; k++)
    clear_m = fmin(clear_m, pl_vec3_norm(pl_vec3_sub(list[k].center, eye)) -
                                ROCK_REACH * list[k].diameter_m);
  pl_free(list);
  return fmax(clear_m, 0.0);
}

double pl_ground_clear_m(const pl_terrain *terrain, pl_vec3 eye) {
  void *memory;
  if (!(pl_vec3_norm(eye) > 0.0) ||
      pl_alloc_or_fail(1, sizeof(search), "a search for the ground", &memory) != PL_OK)
    return 0.0;
  search *search = memory;
  const pl_ground_tile_view view = {
      .eye = eye, .axis = pl_vec3_unit(eye), .half_angle_rad = PL_PI, .finest_m = 1.0};
  search->need = pl_ground_tile_need_of(terrain, &view, 1.0);
  const double ground = ground_m(search);
  pl_free(memory);
  return ground;
}

double pl_ground_distance_m(const pl_terrain *terrain, pl_vec3 eye) {
  const double ground = pl_ground_clear_m(terrain, eye);
  const pl_rock_field *rocks = pl_terrain_rocks(terrain);
  return rocks != NULL && ground > 0.0 ? rocks_m(terrain, rocks, eye, ground) : ground;
}
