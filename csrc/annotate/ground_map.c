#include "annotate/ground_map.h"

#include <string.h>

#include "annotate/ground_channels.h"

/* Channels of rows; those of the table of channels without a function of their own. */
static const struct {
  const char *name;
  pl_status (*write)(const pl_ground_map *map, int y0, int y1, void *image);
} writers[] = {
    {"slope_sobel", pl_write_slope_sobel},
    {"roughness_laplacian", pl_write_roughness_laplacian},
};
enum { WRITERS = sizeof writers / sizeof writers[0] };

/* The image of a channel; NULL if it is not asked for. */
static void *image_of(void *const *images, const char *name) {
  for (size_t i = 0; i < pl_channel_count; i++)
    if (strcmp(pl_channels[i].name, name) == 0)
      return images[i];
  return NULL;
}

bool pl_ground_map_needed(void *const *images) {
  for (size_t k = 0; k < WRITERS; k++)
    if (image_of(images, writers[k].name) != NULL)
      return true;
  return false;
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
  for (size_t k = 0; k < WRITERS; k++) {
    void *image = image_of(map->images, writers[k].name);
    if (image != NULL)
      PL_TRY(writers[k].write(map, y0, y1, image));
  }
  return PL_OK;
}
