#include "annotate/ground_map.h"

#include <string.h>

#include "annotate/ground_channels.h"

static const char *const names[PL_GROUND_IMAGES] = {
    [PL_GROUND_SLOPE_SOBEL] = "slope_sobel",
    [PL_GROUND_ROUGHNESS_LAPLACIAN] = "roughness_laplacian",
    [PL_GROUND_SLOPE_BASELINE] = "slope_baseline",
    [PL_GROUND_RMS_HEIGHT] = "rms_height",
};

bool pl_ground_map_init(const pl_snapshot *shot, const pl_ground_settings *settings,
                        void *const *channels, pl_ground_map *out) {
  bool needed = false;
  *out = (pl_ground_map){.shot = shot, .settings = settings};
  for (size_t i = 0; i < pl_channel_count; i++)
    for (size_t k = 0; k < PL_GROUND_IMAGES && channels[i] != NULL; k++)
      if (strcmp(pl_channels[i].name, names[k]) == 0) {
        out->images[k] = channels[i];
        needed = true;
      }
  return needed;
}

static bool has_planes(const pl_ground_map *map) {
  return map->images[PL_GROUND_SLOPE_BASELINE] != NULL || map->images[PL_GROUND_RMS_HEIGHT] != NULL;
}

pl_status pl_ground_map_check(pl_ground_map *map) {
  const pl_ground_settings *settings = map->settings;
  if (!has_planes(map))
    return PL_OK;
  if (settings->baseline_count < 1)
    return pl_fail(PL_E_ARGUMENT, "a channel at a baseline is asked for, but there is no baseline");
  for (int k = 0; k < settings->baseline_count; k++)
    if (!(settings->baselines_m[k] > 0.0 && isfinite(settings->baselines_m[k])))
      return pl_fail(PL_E_RANGE, "a baseline of %g m; must be above 0", settings->baselines_m[k]);
  return pl_disc_init(settings->disc_points, &map->disc);
}

void pl_ground_map_take(const pl_ground_map *map, const pl_snapshot *shot, const pl_vertex *points,
                        size_t stride, const int tile[4]) {
  const size_t width = (size_t)map->shot->camera.width;
  for (int y = 0; y < tile[3]; y++) {
    const pl_vertex *from = points + (size_t)y * stride;
    pl_ground_point *to = map->points + (size_t)(tile[1] + y) * width + (size_t)tile[0];
    for (int x = 0; x < tile[2]; x++) {
      const pl_shot_body *body = pl_ground_body(shot, from[x].surface_id);
      to[x].body = body != NULL ? (int32_t)(body - shot->bodies) : -1;
      if (body == NULL)
        continue;
      const pl_vec3 p = pl_vec3_sub(from[x].position, body->center);
      to[x].position = pl_mat3_mul_vec_t(body->rotation, p);
      to[x].elevation_m = pl_vec3_norm(p) - pl_ground_datum_m(body, p);
    }
  }
}

pl_status pl_ground_map_write(const pl_ground_map *map, int y0, int y1) {
  if (map->images[PL_GROUND_SLOPE_SOBEL] != NULL)
    pl_write_slope_sobel(map, y0, y1);
  if (map->images[PL_GROUND_ROUGHNESS_LAPLACIAN] != NULL)
    pl_write_roughness_laplacian(map, y0, y1);
  return has_planes(map) ? pl_write_planes(map, y0, y1) : PL_OK;
}
