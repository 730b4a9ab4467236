/* The textures of a terrain. */
#include <math.h>

#include "terrain/terrain_parts.h"

pl_status pl_terrain_take_textures(pl_terrain *terrain, const pl_terrain_frame *frame) {
  if (frame->texture_count > PL_GROUND_TEXTURES)
    return pl_fail(PL_E_RANGE, "%zu textures of a terrain; at most %d are supported",
                   frame->texture_count, (int)PL_GROUND_TEXTURES);
  terrain->texture_count = frame->texture_count;
  for (size_t n = 0; n < frame->texture_count; n++) {
    terrain->textures[n] = frame->textures[n];
    PL_TRY(pl_ground_texture_init(&terrain->textures[n], terrain->radius_m));
  }
  return PL_OK;
}

void pl_terrain_add_textures(const pl_terrain *terrain, const pl_vec3 *directions, size_t count,
                             double cell_m, double *heights_m) {
  for (size_t n = 0; n < terrain->texture_count; n++)
    if (cell_m < terrain->textures[n].size_m)
      pl_ground_texture_add_heights(&terrain->textures[n], terrain->radius_m, directions, count,
                                    cell_m, heights_m);
}

bool pl_terrain_has_textures(const pl_terrain *terrain) {
  for (size_t n = 0; n < terrain->texture_count; n++)
    if (terrain->textures[n].roughness != NULL || terrain->textures[n].albedo != NULL)
      return true;
  return false;
}

bool pl_terrain_has_texture_slopes(const pl_terrain *terrain, double footprint_m) {
  for (size_t n = 0; n < terrain->texture_count; n++)
    if (pl_ground_texture_shows(&terrain->textures[n], footprint_m))
      return true;
  return false;
}

double pl_terrain_texture(const pl_terrain *terrain, pl_ground_texture_kind kind, pl_vec3 direction,
                          double footprint_m) {
  double factor = 1.0;
  for (size_t n = 0; n < terrain->texture_count; n++)
    factor *= pl_ground_texture_at(&terrain->textures[n], kind, terrain->radius_m, direction,
                                   footprint_m);
  return factor;
}

double pl_terrain_texture_brightest(const pl_terrain *terrain) {
  double most = 1.0;
  for (size_t n = 0; n < terrain->texture_count; n++)
    most *= pl_ground_texture_brightest(&terrain->textures[n]);
  return most;
}
