/* Samples of one instant of an exposure. A sample keeps its number, whatever its instant: over all
 * instants the samples are the well-distributed set of a pixel without motion, and (position, time)
 * is a Hammersley set if the number of instants divides that of the samples. */
#include "render/path.h"

static bool is_of(const pl_path_context *context, int y, uint32_t seed, int sample) {
  return pl_slice_has(context->settings->slice, context->tile.y0 + y, seed, sample,
                      context->settings->samples);
}

bool pl_path_count_slice(const pl_path_context *context, pl_tile_buffers *b) {
  bool any = false;
  for (int y = 0; y < context->tile.height; y++) {
    int range[2];
    pl_slice_range(context->settings->slice, context->tile.y0 + y, context->settings->samples,
                   range);
    for (int x = 0; x < context->tile.width; x++) {
      const int pixel = y * PL_TILE_SIDE + x;
      b->sample_counts[pixel] = 0;
      for (int j = range[0]; j < range[1]; j++)
        b->sample_counts[pixel] += is_of(context, y, b->seeds[pixel], j);
      any |= b->sample_counts[pixel] > 0;
    }
  }
  return any;
}

/* Makes active the pixels of `all` with sample j in the slice; those with meshes stay first. */
static void choose(const pl_path_context *context, const uint32_t *all, size_t count, size_t meshes,
                   int j, pl_tile_buffers *b) {
  b->active_count = b->active_meshes = 0;
  for (size_t i = 0; i < count; i++) {
    if (i == meshes)
      b->active_meshes = b->active_count;
    const uint32_t pixel = all[i];
    if (b->sample_counts[pixel] > 0 &&
        is_of(context, (int)(pixel / PL_TILE_SIDE), b->seeds[pixel], j))
      b->active[b->active_count++] = pixel;
  }
  if (meshes == count)
    b->active_meshes = b->active_count;
}

void pl_path_slice(const pl_path_context *context, pl_tile_buffers *b) {
  const int samples = context->settings->samples;
  uint32_t all[PL_TILE_PIXELS];
  const size_t count = b->active_count, meshes = b->active_meshes;
  int low = samples, high = 0;
  for (size_t i = 0; i < count; i++)
    all[i] = b->active[i];
  for (int y = 0; y < context->tile.height; y++) {
    int range[2];
    pl_slice_range(context->settings->slice, context->tile.y0 + y, samples, range);
    low = range[0] < low ? range[0] : low;
    high = range[1] > high ? range[1] : high;
    for (int x = 0; x < context->tile.width; x++) { /* the pixels that need no samples */
      const int pixel = y * PL_TILE_SIDE + x;
      b->radiance[pixel] = pl_vec3f_scale(b->radiance[pixel], (float)b->sample_counts[pixel]);
    }
  }
  for (int j = low; j < high; j++) {
    choose(context, all, count, meshes, j, b);
    if (b->active_count > 0)
      pl_path_sample(context, (uint32_t)j, b);
  }
  for (int pixel = 0; pixel < PL_TILE_PIXELS; pixel++)
    b->radiance[pixel] = pl_vec3f_scale(b->radiance[pixel], 1.0f / (float)samples);
}
