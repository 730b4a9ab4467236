/* Slope and roughness by filters over the elevation in view, pixel by pixel.
 *
 * With the distances of neighbouring points along the ground in place of one width of a pixel,
 * Sobel gradients are exact on planes seen from any side. */
#include <math.h>

#include "annotate/ground_channels.h"
#include "math/rotation.h"

/* A pixel and its neighbours: elevations and places on the ground, m. */
typedef struct window {
  double height[3][3];
  double east[3][3], north[3][3]; /* of the middle's axes */
} window;

static const pl_ground_point *point_at(const pl_ground_map *map, int x, int y) {
  const pl_camera *camera = &map->shot->rays.camera;
  const bool inside = x >= 0 && y >= 0 && x < camera->width && y < camera->height;
  return inside ? map->points + (size_t)y * (size_t)camera->width + (size_t)x : NULL;
}

/* The pixel's neighbour; NULL if it does not see the same body. */
static const pl_ground_point *neighbour(const pl_ground_map *map, int x, int y, int dx, int dy) {
  const pl_ground_point *at = point_at(map, x, y), *to = point_at(map, x + dx, y + dy);
  return to != NULL && to->body == at->body ? to : NULL;
}

/* The pixels of a window; false if not all see the body of the middle. */
static bool look_around(const pl_ground_map *map, int x, int y, const pl_ground_point *out[3][3]) {
  if (point_at(map, x, y)->body < 0)
    return false;
  for (int j = 0; j < 3; j++)
    for (int i = 0; i < 3; i++)
      if ((out[j][i] = neighbour(map, x, y, i - 1, j - 1)) == NULL)
        return false;
  return true;
}

/* Whether all have one elevation, as on an ellipsoid. */
static bool is_level(const pl_ground_point *const points[3][3]) {
  for (int k = 1; k < 9; k++)
    if (points[k / 3][k % 3]->elevation_m != points[0][0]->elevation_m)
      return false;
  return true;
}

static window window_of(const pl_ground_point *const points[3][3]) {
  window out;
  pl_vec3 east, north;
  pl_ground_axes(pl_vec3_unit(points[1][1]->position), &east, &north);
  for (int j = 0; j < 3; j++)
    for (int i = 0; i < 3; i++) {
      const pl_ground_point *to = points[j][i];
      out.height[j][i] = to->elevation_m;
      out.east[j][i] = pl_vec3_dot(to->position, east);
      out.north[j][i] = pl_vec3_dot(to->position, north);
    }
  return out;
}

/* Sobel's derivatives along columns and rows, per pixel. */
static void sobel(const double v[3][3], double *along_x, double *along_y) {
  *along_x = 0.125 * ((v[0][2] - v[0][0]) + 2.0 * (v[1][2] - v[1][0]) + (v[2][2] - v[2][0]));
  *along_y = 0.125 * ((v[2][0] - v[0][0]) + 2.0 * (v[2][1] - v[0][1]) + (v[2][2] - v[0][2]));
}

static float slope_of(const pl_ground_point *const points[3][3]) {
  if (is_level(points))
    return 0.0f;
  const window of = window_of(points), *w = &of;
  double hx, hy, ex, ey, nx, ny;
  sobel(w->height, &hx, &hy);
  sobel(w->east, &ex, &ey);
  sobel(w->north, &nx, &ny);
  const double area = ex * ny - nx * ey;
  if (!(fabs(area) > 1e-9 * (ex * ex + ey * ey + nx * nx + ny * ny)))
    return NAN;
  return (float)atan(hypot(hx * ny - hy * nx, hy * ex - hx * ey) / fabs(area));
}

void pl_write_slope_sobel(const pl_ground_map *map, int y0, int y1) {
  const int width = map->shot->rays.camera.width;
  float *out = (float *)map->images[PL_GROUND_SLOPE_SOBEL] + (size_t)y0 * (size_t)width;
  for (int y = y0; y < y1; y++)
    for (int x = 0; x < width; x++) {
      const pl_ground_point *around[3][3];
      *out++ = look_around(map, x, y, around) ? slope_of(around) : NAN;
    }
}

static float laplacian_of(const pl_ground_map *map, int x, int y) {
  static const int around[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  const pl_ground_point *at = point_at(map, x, y);
  double sum = 0.0;
  if (at->body < 0)
    return NAN;
  for (int k = 0; k < 4; k++) {
    const pl_ground_point *to = neighbour(map, x, y, around[k][0], around[k][1]);
    if (to == NULL)
      return NAN;
    sum += to->elevation_m - at->elevation_m;
  }
  return (float)fabs(sum);
}

void pl_write_roughness_laplacian(const pl_ground_map *map, int y0, int y1) {
  const int width = map->shot->rays.camera.width;
  float *out = (float *)map->images[PL_GROUND_ROUGHNESS_LAPLACIAN] + (size_t)y0 * (size_t)width;
  for (int y = y0; y < y1; y++)
    for (int x = 0; x < width; x++)
      *out++ = laplacian_of(map, x, y);
}
