/* Assignment of hits to patches. */
#include "render/patch.h"

#include "render/geometry.h"

static pl_spot spot_at(const pl_snapshot *shot, const pl_hit *hit, pl_vec3 direction) {
  pl_spot spot = {.surface_id = hit->surface_id, .range_m = (float)hit->t};
  pl_geometry_of(hit->surface_id)->set_spot(shot, hit, pl_vec3_scale(direction, hit->t), &spot);
  return spot;
}

uint32_t pl_patch_meet(pl_pixel_patches *patches, const pl_snapshot *shot, const pl_hit *hit,
                       pl_vec3 direction, float spread) {
  for (uint32_t i = 0; i < patches->count; i++) {
    pl_patch *patch = &patches->patch[i];
    if (patch->triangle == hit->triangle &&
        pl_surface_same(patch->spot.surface_id, hit->surface_id))
      return patch->seen++, i;
  }
  const pl_spot met = spot_at(shot, hit, direction);
  const float depth_m = pl_spot_depth(&met, spread);
  for (uint32_t i = 0; i < patches->count; i++) {
    pl_patch *patch = &patches->patch[i];
    if (!pl_spot_fits(&patch->spot, &met, depth_m))
      continue;
    patch->triangle = hit->triangle;
    return patch->seen++, i;
  }
  if (patches->count == PL_PATCHES)
    return PL_PATCH_NONE;
  patches->patch[patches->count] = (pl_patch){.spot = met, .triangle = hit->triangle, .seen = 1};
  return patches->count++;
}
