/* Writes tiles to the request's arrays. */
#include "frame/output.h"

#include <string.h>

void pl_output_colour(const pl_output *output, size_t first, const pl_vec3f *row, size_t count) {
  const pl_frame_request *request = output->request;
  if (request->rgb != NULL)
    pl_encode_rgb(output->encoder, row, count, output->white_radiance, request->rgb + 3 * first);
  if (request->radiance != NULL)
    memcpy(request->radiance + 3 * first, row, count * sizeof *row);
  if (request->bands != NULL)
    pl_bands_write(request->band_parts, request->band_count, row, count,
                   request->bands + (size_t)request->band_count * first);
  if (output->bands != NULL && output->bands + first != row)
    memcpy(output->bands + first, row, count * sizeof *row);
}

pl_status pl_output_tile(void *context, const pl_tile_result *result, int worker) {
  const pl_output *output = context;
  const pl_snapshot *shot = output->shot;
  const size_t width = (size_t)shot->rays.camera.width;
  if (output->colour) {
    pl_vec3f lit[PL_TILE_PIXELS];
    const pl_vec3f *radiance = pl_frame_sky_tile(output->sky, result, lit);
    for (int y = 0; y < result->tile.height; y++)
      pl_output_colour(output, (size_t)(result->tile.y0 + y) * width + (size_t)result->tile.x0,
                       radiance + y * PL_TILE_SIDE, (size_t)result->tile.width);
  }
  if (result->points == NULL)
    return PL_OK;
  /* Row by row, so that the points stay in the L1 cache from channel to channel. */
  void *const *channels = output->request->channels;
  for (int y = 0; y < result->tile.height; y++) {
    const size_t first = (size_t)(result->tile.y0 + y) * width + (size_t)result->tile.x0;
    const size_t count = (size_t)result->tile.width;
    if (result->empty)
      pl_channels_blank(shot, count, first, channels);
    else
      pl_channels_write(shot, result->points + y * PL_TILE_SIDE, count, first, channels);
  }
  pl_labels_tile(&output->labels, shot, result, worker);
  return PL_OK;
}
