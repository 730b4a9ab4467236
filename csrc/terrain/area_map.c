/* Numbers of areas at places of a body. */
#include "terrain/area_map.h"

pl_status pl_area_map_check(const pl_area_map *map, size_t areas) {
  for (size_t k = 0; k < map->count; k++) {
    const pl_raster_frame *frame = pl_raster_frame_of(map->rasters[k]);
    if (frame->type != PL_RASTER_UINT8 || frame->scale != 1.0 || frame->offset != 0.0)
      return pl_fail(PL_E_RANGE, "raster %zu of areas: its samples must be plain bytes", k);
    double low, high;
    pl_raster_bounds(map->rasters[k], PL_INTERPOLATION_BILINEAR, &low, &high);
    if (high > (double)areas)
      return pl_fail(PL_E_RANGE, "raster %zu of areas: number %g, but there are %zu areas", k, high,
                     areas);
  }
  return PL_OK;
}

uint32_t pl_area_map_at(const pl_area_map *map, pl_vec3 direction) {
  double value;
  for (size_t k = map->count; k-- > 0;)
    if (pl_raster_nearest(map->rasters[k], direction, &value) && value > 0.0)
      return (uint32_t)value;
  return 0;
}
