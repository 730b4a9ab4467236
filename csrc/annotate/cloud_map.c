#include "annotate/cloud_map.h"

#include <string.h>

#include "annotate/channel.h"
#include "render/cloud_opacity.h"

float *pl_cloud_map_find(void *const *channels) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (strcmp(pl_channels[i].name, "cloud_opacity") == 0)
      return channels[i];
  return NULL;
}

static void write_row(const pl_snapshot *shot, const pl_tile_result *result, int y, float *out) {
  const pl_camera *camera = &shot->rays.camera;
  pl_vec3 directions[PL_TILE_SIDE];
  double rows[3][PL_TILE_SIDE];
  double t_max[PL_TILE_SIDE];
  float passed[PL_TILE_SIDE];
  const size_t count = (size_t)result->tile.width;
  pl_snapshot_rays(shot, result->tile.x0, result->tile.y0 + y, count, rows[0], rows[1], rows[2]);
  for (size_t x = 0; x < count; x++) {
    const pl_point *point = result->empty ? NULL : &result->points[(size_t)(y * PL_TILE_SIDE) + x];
    const bool hit = point != NULL && !pl_surface_is_none(point->surface_id);
    directions[x] = (pl_vec3){rows[0][x], rows[1][x], rows[2][x]};
    t_max[x] = hit ? point->t : INFINITY;
    passed[x] = 1.0f;
  }
  const pl_cloud_rays rays = {.count = count,
                              .directions = directions,
                              .t_max = t_max,
                              .spread = (float)(1.0 / fmax(camera->fx, camera->fy))};
  pl_cloud_pass(shot, &rays, passed);
  for (size_t x = 0; x < count; x++)
    out[x] = 1.0f - passed[x];
}

void pl_cloud_map_write(float *image, const pl_snapshot *shot, const pl_tile_result *result) {
  const size_t width = (size_t)shot->rays.camera.width;
  for (int y = 0; y < result->tile.height; y++)
    write_row(shot, result, y,
              image + (size_t)(result->tile.y0 + y) * width + (size_t)result->tile.x0);
}
