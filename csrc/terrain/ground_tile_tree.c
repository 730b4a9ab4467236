/* Chooses tiles: refines a quadtree on each face of the cube, then balances it. */
#include "terrain/ground_tile_tree.h"

#include "terrain/ground_tile_need.h"
#include "terrain/ground_tile_neighbor.h"

/* Parts of a node follow it in the array, in the order of i + 2 j. */
typedef struct tree {
  pl_ground_tile_need need;
  pl_cube_seams seams;
  pl_ground_tile_node *nodes;
  uint32_t count, room;
  bool full;        /* there was no room for all, or heights failed */
  pl_status status; /* of heights */
} tree;

static void place(tree *tree, pl_ground_tile_node *nodes, int count) {
  tree->status = pl_ground_tile_need_place(&tree->need, nodes, count);
  tree->full = tree->status != PL_OK;
}

static void split(tree *tree, uint32_t index) {
  pl_ground_tile_node *node = &tree->nodes[index];
  if (tree->room - tree->count < 4) {
    tree->full = true;
    return;
  }
  pl_ground_tile_node *parts = &tree->nodes[tree->count];
  node->child = tree->count;
  for (uint32_t k = 0; k < 4; k++) {
    parts[k] = (pl_ground_tile_node){.i = 2 * node->i + (k & 1),
                                     .j = 2 * node->j + (k >> 1),
                                     .face = node->face,
                                     .level = (uint8_t)(node->level + 1)};
  }
  tree->count += 4;
  place(tree, parts, 4);
}

/* As fine as the frame asks. New parts come behind, and are looked at in their turn. */
static void refine_for_sight(tree *tree) {
  tree->count = 0;
  for (uint8_t face = 0; face < PL_CUBE_FACES; face++)
    tree->nodes[tree->count++] = (pl_ground_tile_node){.face = face};
  place(tree, tree->nodes, PL_CUBE_FACES);
  for (uint32_t n = 0; n < tree->count && !tree->full; n++)
    if (pl_ground_tile_need_split(&tree->need, &tree->nodes[n]))
      split(tree, n);
}

/* Lets inner nodes know what is seen in them. */
static void gather_seen(tree *tree) {
  for (uint32_t n = tree->count; n-- > 0;) {
    pl_ground_tile_node *node = &tree->nodes[n];
    if (node->child == 0)
      continue;
    node->seen = false;
    node->cell_m = INFINITY;
    for (uint32_t k = 0; k < 4; k++) {
      const pl_ground_tile_node *part = &tree->nodes[node->child + k];
      node->seen |= part->seen;
      if (part->seen)
        node->cell_m = fmin(node->cell_m, part->cell_m);
    }
  }
}

static void refine_for_shadows(tree *tree) {
  const uint32_t count = tree->count;
  gather_seen(tree);
  for (uint32_t n = 0; n < tree->count && !tree->full; n++)
    if (tree->nodes[n].child == 0 &&
        pl_ground_tile_need_shadow(&tree->need, tree->nodes, count, &tree->nodes[n]))
      split(tree, n);
}

/* Returns the part of a node that contains a place of a finer level. */
static uint32_t part_towards(const pl_ground_tile_node *node, int level,
                             pl_ground_tile_place place) {
  const int below = level - node->level - 1;
  return node->child + (uint32_t)(place.i >> below & 1) + 2 * (uint32_t)(place.j >> below & 1);
}

/* Returns the finest node, up to a level, that contains a place of this level. */
static uint32_t find(const tree *tree, int level, pl_ground_tile_place place) {
  uint32_t n = (uint32_t)place.face;
  while (tree->nodes[n].level < level && tree->nodes[n].child != 0)
    n = part_towards(&tree->nodes[n], level, place);
  return n;
}

/* Splits what is more than one level coarser than a leaf beside it. */
static void balance_around(tree *tree, uint32_t leaf) {
  const pl_ground_tile_node node = tree->nodes[leaf];
  const pl_ground_tile_place own = {node.face, node.i, node.j};
  for (int dj = -1; dj <= 1; dj++)
    for (int di = -1; di <= 1; di++) {
      pl_ground_tile_place place;
      if ((di == 0 && dj == 0) ||
          !pl_ground_tile_neighbor(&tree->seams, node.level, own, di, dj, &place))
        continue;
      uint32_t n = find(tree, node.level, place);
      while (tree->nodes[n].level + 1 < node.level && !tree->full) {
        split(tree, n);
        n = find(tree, node.level, place);
      }
    }
}

static void balance(tree *tree) {
  for (uint32_t n = 0; n < tree->count && !tree->full; n++)
    if (tree->nodes[n].child == 0)
      balance_around(tree, n);
}

static bool is_coarser(const tree *tree, const pl_ground_tile_node *node, int di, int dj) {
  const pl_ground_tile_place own = {node->face, node->i, node->j};
  pl_ground_tile_place place;
  return pl_ground_tile_neighbor(&tree->seams, node->level, own, di, dj, &place) &&
         tree->nodes[find(tree, node->level, place)].level < node->level;
}

/* Returns where a leaf meets coarser ones. */
static uint8_t coarse_of(const tree *tree, const pl_ground_tile_node *node) {
  static const int sides[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  static const int corners[4][2] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  bool beside[4];
  unsigned bits = 0;
  for (unsigned k = 0; k < 4; k++) {
    beside[k] = is_coarser(tree, node, sides[k][0], sides[k][1]);
    bits |= (unsigned)beside[k] << k;
  }
  for (unsigned k = 0; k < 4; k++) {
    const bool touched = beside[k & 1] || beside[2 + (k >> 1)] ||
                         is_coarser(tree, node, corners[k][0], corners[k][1]);
    bits |= (unsigned)touched << (4 + k);
  }
  return (uint8_t)bits;
}

/* Writes the leaves, depth first. */
static size_t write_leaves(const tree *tree, pl_ground_tile_id *out) {
  uint32_t stack[4 * 32 + PL_CUBE_FACES];
  size_t count = 0;
  int top = 0;
  for (uint32_t face = PL_CUBE_FACES; face-- > 0;)
    stack[top++] = face;
  while (top > 0) {
    const pl_ground_tile_node *node = &tree->nodes[stack[--top]];
    if (node->child == 0)
      out[count++] = (pl_ground_tile_id){.i = node->i,
                                         .j = node->j,
                                         .face = node->face,
                                         .level = node->level,
                                         .coarse = coarse_of(tree, node)};
    else
      for (uint32_t k = 4; k-- > 0;)
        stack[top++] = node->child + k;
  }
  return count;
}

/* Returns whether the tree was built within its room. */
static bool build(tree *tree) {
  refine_for_sight(tree);
  if (!tree->full && tree->need.view->far_casters)
    refine_for_shadows(tree);
  if (!tree->full)
    balance(tree);
  return !tree->full;
}

static pl_status check(const pl_ground_tile_view *view) {
  if (!pl_vec3_finite(view->eye) || !pl_vec3_finite(view->axis) || !(pl_vec3_norm(view->eye) > 0.0))
    return pl_fail(PL_E_RANGE, "a view of ground has no eye or no axis");
  const double positive[] = {view->half_angle_rad, view->pixel_rad, view->cells_per_pixel,
                             view->finest_m};
  for (size_t k = 0; k < sizeof positive / sizeof *positive; k++)
    if (!(isfinite(positive[k]) && positive[k] > 0.0))
      return pl_fail(
          PL_E_RANGE,
          "the frame's angle, the pixel's, cells per pixel and the finest cell of a view "
          "of ground must be above 0, not %g rad, %g rad, %g and %g m",
          positive[0], positive[1], positive[2], positive[3]);
  if (view->far_casters && !(pl_vec3_finite(view->to_sun) && view->sun_diameter_rad >= 0.0))
    return pl_fail(PL_E_RANGE, "a view of ground has no direction to the sun");
  if (view->limit > UINT32_MAX / 2)
    return pl_fail(PL_E_RANGE, "a limit of %zu tiles is above %u", view->limit, UINT32_MAX / 2);
  return PL_OK;
}

static bool misses_patch(const tree *tree) {
  const pl_terrain *terrain = tree->need.terrain;
  if (!pl_terrain_has_patch(terrain))
    return false;
  for (uint32_t n = 0; n < tree->count; n++) {
    const pl_ground_tile_node *node = &tree->nodes[n];
    if (node->child == 0 && node->seen &&
        !pl_terrain_beside_patch(terrain, node->center, node->radius_m))
      return false;
  }
  return true;
}

pl_status pl_ground_tile_tree_choose(const pl_terrain *terrain, const pl_ground_tile_view *view,
                                     pl_arena *arena, pl_ground_tile_choice *out) {
  PL_TRY(check(view));
  /* A tree with n leaves has (n - 6) / 3 inner nodes. */
  const size_t limit = view->limit < PL_CUBE_FACES ? PL_CUBE_FACES : view->limit;
  const size_t room = limit + (limit - PL_CUBE_FACES) / 3;
  tree tree = {.nodes = pl_arena_alloc(arena, room, sizeof *tree.nodes), .room = (uint32_t)room};
  out->ids = pl_arena_alloc(arena, limit, sizeof *out->ids);
  if (tree.nodes == NULL || out->ids == NULL)
    return pl_fail(PL_E_MEMORY, "out of memory for the choice of tiles");
  pl_cube_seams_find(&tree.seams);
  out->widened = 1.0;
  tree.need = pl_ground_tile_need_of(terrain, view, out->widened);
  for (int step = 1; !build(&tree); step++) {
    PL_TRY(tree.status);
    out->widened = exp2(0.5 * step);
    tree.need = pl_ground_tile_need_of(terrain, view, out->widened);
  }
  out->count = write_leaves(&tree, out->ids);
  out->patch_missed = misses_patch(&tree);
  return PL_OK;
}
