#include "annotate/ground_map.h"

#include <string.h>

#include "annotate/ground_channels.h"

static const char *const names[PL_GROUND_IMAGES] = {
    [PL_GROUND_SLOPE_SOBEL] = "slope_sobel",
    [PL_GROUND_ROUGHNESS_LAPLACIAN] = "roughness_laplacian",
    [PL_GROUND_SLOPE_BASELINE] = "slope_baseline",
    [PL_GROUND_RMS_HEIGHT] = "rms_height",
    [PL_GROUND_HAZARD] = "hazard",
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

static pl_status check_baselines(const pl_ground_settings *settings) {
  if (settings->baseline_count < 1)
    return pl_fail(PL_E_ARGUMENT, "a channel at a baseline is asked for, but there is no baseline");
  for (int k = 0; k < settings->baseline_count; k++)
    if (!(settings->baselines_m[k] > 0.0 && isfinite(settings->baselines_m[k])))
      return pl_fail(PL_E_RANGE, "a baseline of %g m; must be above 0", settings->baselines_m[k]);
  return PL_OK;
}

static pl_status check_limits(const pl_hazard_limits *limits) {
  if (!(limits->footprint_m > 0.0 && isfinite(limits->footprint_m)))
    return pl_fail(PL_E_RANGE, "hazards of a footprint of %g m; must be above 0",
                   limits->footprint_m);
  if (!(limits->slope_rad >= 0.0 && limits->rms_m >= 0.0 && limits->rock_m >= 0.0))
    return pl_fail(PL_E_RANGE,
                   "hazards above a slope of %g rad, an RMS height of %g m and rocks of %g m; must "
                   "be 0 or more",
                   limits->slope_rad, limits->rms_m, limits->rock_m);
  return PL_OK;
}

pl_status pl_ground_map_check(pl_ground_map *map) {
  const bool hazard = map->images[PL_GROUND_HAZARD] != NULL;
  if (has_planes(map))
    PL_TRY(check_baselines(map->settings));
  if (hazard)
    PL_TRY(check_limits(&map->settings->hazard));
  return has_planes(map) || hazard ? pl_disc_init(map->settings->disc_points, &map->disc) : PL_OK;
}

void pl_ground_map_take(const pl_ground_map *map, const pl_snapshot *shot, const pl_point *points,
                        size_t stride, const int tile[4]) {
  const size_t width = (size_t)map->shot->rays.camera.width;
  for (int y = 0; y < tile[3]; y++) {
    const pl_point *from = points + (size_t)y * stride;
    pl_ground_point *to = map->points + (size_t)(tile[1] + y) * width + (size_t)tile[0];
    for (int x = 0; x < tile[2]; x++) {
      const pl_shot_body *body = pl_ground_body(shot, from[x].surface_id);
      to[x].body = body != NULL ? (int32_t)(body - shot->bodies) : -1;
      if (body == NULL)
        continue;
      const pl_vec3 p = pl_vec3_sub(from[x].position, body->center);
      to[x].position = pl_mat3_mul_vec_t(body->rotation, p);
      /* that of an ellipsoid is its datum's, which rounding would miss */
      to[x].elevation_m = pl_surface_is_ellipsoid(from[x].surface_id)
                              ? 0.0
                              : pl_vec3_norm(p) - pl_ground_datum_m(body, p);
    }
  }
}

/* Fills a group with the pixels of a square that see a body, or with `body` -1 none. */
static void gather(const pl_ground_map *map, const int square[4], int32_t body,
                   pl_ground_group *out) {
  out->count = 0;
  out->terrain = body >= 0 ? map->shot->bodies[body].body->terrain : NULL;
  for (int y = square[1]; y < square[3]; y++)
    for (int x = square[0]; x < square[2]; x++) {
      const size_t pixel = (size_t)y * (size_t)map->shot->rays.camera.width + (size_t)x;
      if (map->points[pixel].body != body)
        continue;
      if (out->terrain != NULL)
        out->directions[out->count] = pl_vec3_unit(map->points[pixel].position);
      out->pixels[out->count++] = pixel;
    }
}

/* Visits all groups of the rows. */
static pl_status visit_groups(const pl_ground_map *map, int y0, int y1, int worker,
                              pl_ground_group_fn visit) {
  const int width = map->shot->rays.camera.width;
  pl_ground_group group = {.map = map};
  if (map->memos != NULL)
    group.memos = map->memos + (size_t)worker * PL_ROCK_MEMOS;
  for (int x = 0; x < width; x += PL_GROUND_ROWS) {
    const int end = x + PL_GROUND_ROWS < width ? x + PL_GROUND_ROWS : width;
    const int square[4] = {x, y0, end, y1};
    for (int32_t body = -1; body < (int32_t)map->shot->body_count; body++) {
      gather(map, square, body, &group);
      if (group.count > 0)
        PL_TRY(visit(&group));
    }
  }
  return PL_OK;
}

pl_status pl_ground_map_write(const pl_ground_map *map, int y0, int y1, int worker) {
  if (map->images[PL_GROUND_SLOPE_SOBEL] != NULL)
    pl_write_slope_sobel(map, y0, y1);
  if (map->images[PL_GROUND_ROUGHNESS_LAPLACIAN] != NULL)
    pl_write_roughness_laplacian(map, y0, y1);
  if (has_planes(map))
    PL_TRY(visit_groups(map, y0, y1, worker, pl_write_planes));
  if (map->images[PL_GROUND_HAZARD] != NULL)
    PL_TRY(visit_groups(map, y0, y1, worker, pl_write_hazard));
  return PL_OK;
}
