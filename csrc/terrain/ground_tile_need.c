/* How fine the tiles of a frame are needed. */
#include "terrain/ground_tile_need.h"

#include "terrain/cube.h"
#include "terrain/rock_field.h"

/* Sines of elevations at which ground is seen count as at least this. */
#define LEAST_SINE 0.25
/* Cells are halved where they are this much too wide, so that their areas are right on average. */
#define ROUNDING 1.41421356237309505
/* Cells that cast a shadow are halved where they are this much wider than the cells that it falls
 * on: they end up at most twice as wide. */
#define SHADOW_ROUNDING (2.0 * ROUNDING)
/* Ground of a tile is within this fraction of its width above and below its middle, which slopes of
 * 30 degrees all the way to a corner reach. Beyond, tiles may be chosen too coarse. */
#define STEEP 0.4
/* The height of a tile's middle is that of a lattice whose cells are a quarter as wide. */
enum { HEIGHT_LEVELS = 2 };

pl_ground_tile_need pl_ground_tile_need_of(const pl_terrain *terrain,
                                           const pl_ground_tile_view *view, double factor) {
  static const pl_vec3 axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  pl_ground_tile_need need = {
      .terrain = terrain, .view = view, .factor = factor, .low_m = INFINITY};
  double low_m, high_m;
  pl_terrain_bounds(terrain, &low_m, &high_m);
  for (int a = 0; a < 3; a++)
    need.low_m = fmin(need.low_m, pl_terrain_datum_m(terrain, axes[a]) + low_m);
  need.relief_m = high_m - low_m;
  need.horizon_rad = acos(fmin(1.0, need.low_m / pl_vec3_norm(view->eye)));
  return need;
}

/* Returns whether a sphere is partly in the frame. */
static bool in_frame(const pl_ground_tile_need *need, pl_vec3 to_center, double radius_m) {
  const pl_ground_tile_view *view = need->view;
  const double distance = pl_vec3_norm(to_center);
  if (distance <= radius_m)
    return true;
  for (int k = 0; k < view->side_count; k++)
    if (pl_vec3_dot(view->sides[k], to_center) < -radius_m)
      return false;
  const double off_axis =
      acos(fmax(-1.0, fmin(1.0, pl_vec3_dot(view->axis, to_center) / distance)));
  return off_axis - asin(radius_m / distance) <= view->half_angle_rad;
}

/* Returns whether a node is wholly beyond the horizon of a sphere below all ground. */
static bool is_hidden(const pl_ground_tile_need *need, const pl_ground_tile_node *node) {
  const double up = pl_vec3_norm(node->center), eye = pl_vec3_norm(need->view->eye);
  if (up <= node->radius_m)
    return false;
  const double cosine = pl_vec3_dot(node->center, need->view->eye) / (up * eye);
  const double away = acos(fmax(-1.0, fmin(1.0, cosine))) - asin(node->radius_m / up);
  return away > need->horizon_rad + acos(fmin(1.0, need->low_m / (up + node->radius_m)));
}

/* Root of the mean area of cells around tangent-plane coordinates, over that at the middle of a
 * face. */
static double narrowing(double x, double y) {
  const double square = 1.0 + x * x + y * y;
  return sqrt((1.0 + x * x) * (1.0 + y * y) / (square * sqrt(square)));
}

/* Tangent-plane coordinates of the sides and the middle of a node. */
typedef struct extent {
  double x[3], y[3];
} extent;

static extent extent_of(const pl_ground_tile_node *node) {
  extent out;
  for (int k = 0; k < 3; k++) {
    out.x[k] = pl_cube_tangent(pl_cube_node(node->level + 1, 2 * (int64_t)node->i + k));
    out.y[k] = pl_cube_tangent(pl_cube_node(node->level + 1, 2 * (int64_t)node->j + k));
  }
  return out;
}

static void place(const pl_ground_tile_need *need, pl_ground_tile_node *node, const extent *at,
                  pl_vec3 up, double height_m) {
  const double far_m = pl_terrain_datum_m(need->terrain, up) + height_m;
  const double radius_m = pl_terrain_radius_m(need->terrain);
  double across = 0.0;
  for (int k = 0; k < 4; k++) {
    const pl_vec3 corner = pl_cube_tangent_direction(node->face, at->x[k & 2], at->y[2 * (k & 1)]);
    across = fmax(across, pl_vec3_norm(pl_vec3_sub(corner, up)));
  }
  node->center = pl_vec3_scale(up, far_m);
  across *= far_m;
  const double steep = fmin(STEEP * pl_cube_cell_m(node->level, radius_m), need->relief_m);
  node->radius_m = sqrt(across * across * (1.0 + steep / far_m) + steep * steep);
  node->cell_m =
      pl_cube_cell_m(node->level + PL_GROUND_TILE_SHIFT, radius_m) * narrowing(at->x[1], at->y[1]);
  node->child = 0;
  /* Rocks reach into the frame from tiles beside it. Those that are wider than a tile are shown by
   * the wider tiles out of the frame, too. */
  const double rocks_m =
      fmin(pl_rock_reach_m(pl_terrain_rocks(need->terrain)), pl_cube_cell_m(node->level, radius_m));
  node->seen =
      in_frame(need, pl_vec3_sub(node->center, need->view->eye), node->radius_m + rocks_m) &&
      !is_hidden(need, node);
}

pl_status pl_ground_tile_need_place(const pl_ground_tile_need *need, pl_ground_tile_node *nodes,
                                    int count) {
  extent at[PL_GROUND_TILE_PLACED];
  pl_vec3 up[PL_GROUND_TILE_PLACED] = {{0.0, 0.0, 0.0}};
  double heights_m[PL_GROUND_TILE_PLACED];
  for (int k = 0; k < count; k++) {
    at[k] = extent_of(&nodes[k]);
    up[k] = pl_cube_tangent_direction(nodes[k].face, at[k].x[1], at[k].y[1]);
  }
  PL_TRY(pl_terrain_heights_below_fillets(need->terrain, up, (size_t)count,
                                          nodes[0].level + HEIGHT_LEVELS, heights_m));
  for (int k = 0; k < count; k++)
    place(need, &nodes[k], &at[k], up[k], heights_m[k]);
  return PL_OK;
}

/* Returns whether the parts of a node would have cells that are narrower than the view allows. */
static bool is_finest(const pl_ground_tile_need *need, const pl_ground_tile_node *node) {
  const double radius_m = pl_terrain_radius_m(need->terrain);
  const int lattice = node->level + 1 + PL_GROUND_TILE_SHIFT;
  const int most = need->view->finest_level > 0 ? need->view->finest_level : PL_CUBE_LEVELS;
  return lattice > most || lattice >= PL_CUBE_LEVELS - 1 || node->level >= 31 ||
         pl_cube_cell_m(lattice, radius_m) < need->view->finest_m * need->factor;
}

bool pl_ground_tile_need_split(const pl_ground_tile_need *need, const pl_ground_tile_node *node) {
  const pl_ground_tile_view *view = need->view;
  if (is_finest(need, node) || pl_terrain_beside_patch(need->terrain, node->center, node->radius_m))
    return false;
  const pl_vec3 to_eye = pl_vec3_sub(view->eye, node->center);
  const double distance = pl_vec3_norm(to_eye), nearest = distance - node->radius_m;
  if (nearest <= 0.0)
    return true;
  const double sine = pl_vec3_dot(to_eye, node->center) / (distance * pl_vec3_norm(node->center));
  const double seen_at = fmin(1.0, fmax(LEAST_SINE, sine + node->radius_m / distance));
  const double wanted = nearest * view->pixel_rad / (view->cells_per_pixel * sqrt(seen_at));
  const double spared = node->seen ? 1.0 : PL_GROUND_TILE_UNSEEN;
  return node->cell_m > ROUNDING * wanted * spared * need->factor;
}

/* Returns whether no sunlight reaches a sphere because the body is in between. */
static bool is_night(const pl_ground_tile_need *need, const pl_ground_tile_node *node) {
  const pl_vec3 sun = need->view->to_sun;
  const double up = pl_vec3_dot(node->center, sun);
  const double beside = pl_vec3_norm(pl_vec3_madd(node->center, -up, sun));
  const double penumbra = 0.5 * need->view->sun_diameter_rad * fabs(up);
  return up < -node->radius_m && beside + node->radius_m + penumbra < need->low_m;
}

bool pl_ground_tile_need_shadow(const pl_ground_tile_need *need, const pl_ground_tile_node *nodes,
                                uint32_t count, const pl_ground_tile_node *leaf) {
  enum { DEPTH = 4 * 32 };
  uint32_t stack[DEPTH + PL_CUBE_FACES];
  int top = 0;
  if (is_finest(need, leaf))
    return false;
  for (uint32_t face = 0; face < PL_CUBE_FACES; face++)
    stack[top++] = face;
  const double sun_rad = need->view->sun_diameter_rad;
  while (top > 0) {
    const pl_ground_tile_node *on = &nodes[stack[--top]];
    const pl_vec3 way = pl_vec3_sub(leaf->center, on->center);
    const double both = leaf->radius_m + on->radius_m;
    const double along = pl_vec3_dot(way, need->view->to_sun);
    const double penumbra = fmax(0.0, pl_vec3_norm(way) - both) * sun_rad;
    if (!on->seen || along < -both ||
        leaf->cell_m <= fmax(SHADOW_ROUNDING * on->cell_m, ROUNDING * need->factor * penumbra))
      continue;
    const pl_vec3 beside = pl_vec3_madd(way, -along, need->view->to_sun);
    const double wide = both + 0.5 * fmax(0.0, along) * sun_rad;
    if (pl_vec3_dot(beside, beside) > wide * wide || is_night(need, on))
      continue;
    if (on->child == 0 || on->child >= count)
      return true;
    for (uint32_t k = 0; k < 4; k++)
      stack[top++] = on->child + k;
  }
  return false;
}
