/* Areas of a body's surface (sea, ice, a mare, the floors of craters): rasters of their numbers,
 * each laid over those before it. */
#ifndef PL_TERRAIN_AREA_MAP_H
#define PL_TERRAIN_AREA_MAP_H

#include <stdint.h>

#include "terrain/raster.h"

enum { PL_AREA_RASTERS = 8 };

/* Rasters of bytes: 0 where a raster says nothing, else the number of an area, from 1 on. */
typedef struct pl_area_map {
  const pl_raster *rasters[PL_AREA_RASTERS]; /* borrowed; from the lowest to the uppermost */
  size_t count;
} pl_area_map;

/* Returns PL_E_RANGE for a raster of other samples than bytes, or of a number above `areas`. */
pl_status pl_area_map_check(const pl_area_map *map, size_t areas);
/* Returns the number at the nearest post of the uppermost raster that says something in a direction
 * from the body's centre (any length but 0); 0 if none does. Borders are not blended, as numbers of
 * areas have no mean. */
uint32_t pl_area_map_at(const pl_area_map *map, pl_vec3 direction);

#endif
