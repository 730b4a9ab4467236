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

/* Beyond the outermost rows is a pole: its cap has the number of the row, not of the other side. */
static double nearest_row(const pl_raster *raster, double v) {
  const double last = (double)pl_raster_frame_of(raster)->height - 1.0;
  return fmin(fmax(rint(v), 0.0), last);
}

uint32_t pl_area_map_at(const pl_area_map *map, pl_vec3 direction) {
  for (size_t k = map->count; k-- > 0;) {
    double u, v;
    if (!pl_raster_find(map->rasters[k], direction, &u, &v))
      continue;
    v = nearest_row(map->rasters[k], v);
    const double value = pl_raster_value(map->rasters[k], 0, rint(u), v, PL_INTERPOLATION_BILINEAR);
    if (value > 0.0)
      return (uint32_t)value;
  }
  return 0;
}
