/* Bound of the levels of tiles. */
#include "terrain/ground_levels.h"

#include "terrain/cube.h"
#include "terrain/ground_distance.h"

/* Cells of a tile are halved if they are wider than ROUNDING times the width wanted at the near
 * side of the sphere around it, of at most REACH cells (pl_ground_tile_need_split). */
#define ROUNDING 1.41421356237309505
#define REACH 48.0

int pl_ground_levels(const pl_terrain *terrain, const pl_ground_tile_view *view) {
  const double radius_m = pl_terrain_radius_m(terrain);
  const double fraction = ROUNDING * view->pixel_rad / view->cells_per_pixel;
  const double clear_m = pl_ground_clear_m(terrain, view->eye);
  /* c is halved if c > fraction (distance - REACH c). */
  const double halved_m = fraction * clear_m / (1.0 + fraction * REACH);
  const int level = pl_cube_level(fmax(halved_m, view->finest_m), radius_m);
  return level > PL_GROUND_TILE_SHIFT ? level : PL_GROUND_TILE_SHIFT;
}

/* Most samples along a pixel. */
#define SAMPLES 64.0

bool pl_ground_textures_seen(const pl_terrain *terrain, const pl_ground_tile_view *view) {
  const double least_m = pl_ground_clear_m(terrain, view->eye) * view->pixel_rad / SAMPLES;
  return pl_terrain_has_texture_slopes(terrain, least_m);
}
