/* Ground for tests: a rough body, and frames that look at it. */
#ifndef PL_TESTS_GROUNDS_H
#define PL_TESTS_GROUNDS_H

#include "harness.h"

#include "terrain/ground_tile_tree.h"
#include "terrain/height_field.h"
#include "trace/embree.h"
#include "trace/ground_tile_cache.h"

/* A body of fractal ground alone, `strength` times as rough as the highlands of the Moon. */
static inline pl_terrain *ground_rough(pl_vec3 radii_m, double strength) {
  pl_terrain_frame frame = {.radii_m = radii_m, .detail = pl_terrain_detail_default(radii_m.x)};
  pl_terrain *terrain = NULL;
  frame.detail.on = strength > 0.0;
  frame.detail.strength = strength;
  assert_int_equal(pl_terrain_create(&frame, &terrain), PL_OK);
  return terrain;
}

/* A frame of `pixels` by `pixels` and 60 degrees, `height_m` above the ground under `direction`;
 * its axis is `tilt_rad` from straight down, towards the east. */
static inline pl_ground_tile_view ground_view(const pl_terrain *terrain, pl_vec3 direction,
                                              double height_m, double tilt_rad, int pixels) {
  const pl_vec3 up = pl_vec3_unit(direction);
  const pl_vec3 east = pl_vec3_unit(pl_vec3_cross((pl_vec3){0.0, 0.0, 1.0}, up));
  const pl_vec3 axis = pl_vec3_madd(pl_vec3_scale(up, -cos(tilt_rad)), sin(tilt_rad), east);
  const pl_vec3 north = pl_vec3_cross(up, east), above = pl_vec3_cross(north, axis);
  const double half = tan(PL_PI / 6.0);
  const double ground_m = pl_terrain_datum_m(terrain, up) + pl_terrain_height(terrain, up, 30);
  pl_ground_tile_view view = {
      .eye = pl_vec3_scale(up, ground_m + height_m),
      .axis = axis,
      .half_angle_rad = atan(half * sqrt(2.0)),
      .side_count = 4,
      .pixel_rad = 2.0 * half / pixels,
      .cells_per_pixel = 1.0,
      .finest_m = 0.01,
      .sun_diameter_rad = 0.00925,
      .to_sun = up,
      .limit = PL_GROUND_TILE_LIMIT,
  };
  for (int k = 0; k < 4; k++) {
    const pl_vec3 side = pl_vec3_scale(k < 2 ? north : above, k & 1 ? -1.0 : 1.0);
    view.sides[k] =
        pl_vec3_add(pl_vec3_scale(axis, sin(PL_PI / 6.0)), pl_vec3_scale(side, cos(PL_PI / 6.0)));
  }
  return view;
}

/* The normal of the triangle that was hit, body axes, unit, outwards. */
static inline pl_vec3 ground_facet_normal(const pl_height_field *field, uint32_t tile, float u,
                                          float v) {
  pl_vec3 p[3];
  double weights[3];
  pl_height_field_corners(field, tile, u, v, p, weights);
  return pl_vec3_unit(pl_vec3_cross(pl_vec3_sub(p[1], p[0]), pl_vec3_sub(p[2], p[0])));
}

/* Releases all grounds and evicts all tiles. */
static inline void ground_tiles_evict(pl_accelerators *kept) {
  if (kept->ground == NULL)
    return;
  const size_t limit = kept->ground->limit;
  kept->ground->limit = 0;
  pl_ground_tiles_trim(kept);
  kept->ground->limit = limit;
}
#endif
