/* Slope and roughness at baselines in metres: planes through the ground's own heights around each
 * point, whatever the camera and the mesh. Rocks are no part of them. */
#include <math.h>

#include "annotate/ground_channels.h"

/* Pixels are fitted in squares, which are near each other on the ground. */
enum { SIDE = PL_GROUND_ROWS };

typedef struct square {
  const pl_ground_map *map;
  int x0, y0, x1, y1;
} square;

/* Indices of the pixels of a square that see a body; with `body` -1 of those that see none. */
static size_t list(const square *at, int32_t body, size_t *pixels) {
  size_t count = 0;
  for (int y = at->y0; y < at->y1; y++)
    for (int x = at->x0; x < at->x1; x++) {
      const size_t pixel = (size_t)y * (size_t)at->map->shot->camera.width + (size_t)x;
      if (at->map->points[pixel].body == body)
        pixels[count++] = pixel;
    }
  return count;
}

/* Writes component `k` of pixels; without fits nan. */
static void put(const pl_ground_map *map, const size_t *pixels, size_t count, int k,
                const pl_plane_fit *fits) {
  const size_t components = (size_t)map->settings->baseline_count;
  float *slope = map->images[PL_GROUND_SLOPE_BASELINE], *rms = map->images[PL_GROUND_RMS_HEIGHT];
  for (size_t i = 0; i < count; i++) {
    const size_t at = pixels[i] * components + (size_t)k;
    if (slope != NULL)
      slope[at] = fits != NULL ? (float)fits[i].slope_rad : NAN;
    if (rms != NULL)
      rms[at] = fits != NULL ? (float)fits[i].rms_m : NAN;
  }
}

static pl_status write_body(const square *at, int32_t body) {
  const pl_ground_map *map = at->map;
  const pl_terrain *terrain = body >= 0 ? map->shot->bodies[body].body->terrain : NULL;
  size_t pixels[SIDE * SIDE];
  pl_vec3 directions[SIDE * SIDE];
  pl_plane_fit fits[SIDE * SIDE];
  const size_t count = list(at, body, pixels);
  if (count == 0)
    return PL_OK;
  for (size_t i = 0; i < count && terrain != NULL; i++)
    directions[i] = pl_vec3_unit(map->points[pixels[i]].position);
  for (int k = 0; k < map->settings->baseline_count; k++) {
    if (terrain != NULL)
      PL_TRY(pl_plane_fits(terrain, &map->disc, directions, count, map->settings->baselines_m[k],
                           fits));
    put(map, pixels, count, k, terrain != NULL ? fits : NULL);
  }
  return PL_OK;
}

pl_status pl_write_planes(const pl_ground_map *map, int y0, int y1) {
  const int width = map->shot->camera.width;
  for (int x = 0; x < width; x += SIDE) {
    const square at = {map, x, y0, x + SIDE < width ? x + SIDE : width, y1};
    for (int32_t body = -1; body < (int32_t)map->shot->body_count; body++)
      PL_TRY(write_body(&at, body));
  }
  return PL_OK;
}
