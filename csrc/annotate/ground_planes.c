/* Slope and roughness at baselines in metres: planes through the ground's own heights around each
 * point, whatever the camera and the mesh. Rocks are no part of them. */
#include <math.h>

#include "annotate/ground_channels.h"

/* Writes component `k`; without fits nan. */
static void put(const pl_ground_group *group, int k, const pl_plane_fit *fits) {
  const pl_ground_map *map = group->map;
  const size_t components = (size_t)map->settings->baseline_count;
  float *slope = map->images[PL_GROUND_SLOPE_BASELINE], *rms = map->images[PL_GROUND_RMS_HEIGHT];
  for (size_t i = 0; i < group->count; i++) {
    const size_t at = group->pixels[i] * components + (size_t)k;
    if (slope != NULL)
      slope[at] = fits != NULL ? (float)fits[i].slope_rad : NAN;
    if (rms != NULL)
      rms[at] = fits != NULL ? (float)fits[i].rms_m : NAN;
  }
}

pl_status pl_write_planes(const pl_ground_group *group) {
  const pl_ground_map *map = group->map;
  pl_plane_fit fits[PL_GROUND_ROWS * PL_GROUND_ROWS];
  for (int k = 0; k < map->settings->baseline_count; k++) {
    if (group->terrain != NULL)
      PL_TRY(pl_plane_fits(group->terrain, &map->disc, group->directions, group->count,
                           map->settings->baselines_m[k], fits));
    put(group, k, group->terrain != NULL ? fits : NULL);
  }
  return PL_OK;
}
