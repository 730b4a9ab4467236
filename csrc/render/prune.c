/* Adaptive sampling: which pixels get no more samples. Decided over blocks of pixels, after fixed
 * numbers of samples, from the samples alone: the same for any number of threads. */
#include "math/color.h"
#include "render/path.h"

/* Digital numbers by which a standard error moves a mean. */
static float error_dn(const pl_render_settings *settings, float mean, float error) {
  const float low = pl_minf(mean / settings->white_radiance, 1.0f);
  const float high = pl_minf((mean + error) / settings->white_radiance, 1.0f);
  return 255.0f * (pl_srgb_encode(high) - pl_srgb_encode(low));
}

enum { BLOCK = 4, BLOCKS = PL_TILE_SIDE / BLOCK };

static size_t block_of(uint32_t pixel) {
  return pixel / PL_TILE_SIDE / BLOCK * BLOCKS + pixel % PL_TILE_SIDE / BLOCK;
}

/* Variance of the mean of a pixel's luminance. Samples that share one shading count once. */
static float pixel_variance(const pl_tile_buffers *b, uint32_t pixel) {
  const float n = (float)b->counts[pixel], m = pl_luminance(b->radiance[pixel]) / n;
  const float independent = (float)b->shaded[pixel];
  return pl_maxf(b->square[pixel] / n - m * m, 0.0f) / pl_maxf(independent - 1.0f, 0.5f);
}

/* Blocks in which the centre rays meet more than one thing have outlines, and outlines have slivers
 * that few samples miss: they get at least so many. */
enum { OUTLINE_SAMPLES = 16 };
/* A pixel's variance means nothing before so many samples that share no shading. */
enum { INDEPENDENT_MIN = 4 };

/* A pixel that is itself so much noisier than its block goes on, whatever its neighbours say. */
static const float OWN_NOISE = 2.0f;

void pl_path_prune(const pl_path_context *context, pl_tile_buffers *b) {
  float mean[BLOCKS * BLOCKS] = {0}, variance[BLOCKS * BLOCKS] = {0};
  float pixels[BLOCKS * BLOCKS] = {0};
  uint32_t thing[BLOCKS * BLOCKS];
  bool outline[BLOCKS * BLOCKS] = {false};
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    const size_t block = block_of(pixel);
    mean[block] += pl_luminance(b->radiance[pixel]) / (float)b->counts[pixel];
    variance[block] += pixel_variance(b, pixel);
    if (pixels[block] == 0.0f)
      thing[block] = b->points[pixel].thing;
    outline[block] |= thing[block] != b->points[pixel].thing;
    pixels[block] += 1.0f;
  }
  size_t kept = 0, meshes = 0;
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    const size_t block = block_of(pixel);
    const bool early = b->shaded[pixel] < INDEPENDENT_MIN ||
                       (outline[block] && b->counts[pixel] < OUTLINE_SAMPLES);
    const float m = mean[block] / pixels[block];
    const float pooled = sqrtf(variance[block] / pixels[block]);
    const float own = sqrtf(pixel_variance(b, pixel)) / OWN_NOISE;
    if (early || error_dn(context->settings, m, pl_maxf(pooled, own)) > context->settings->noise_dn)
      b->active[kept++] = pixel;
    if (i + 1 == b->active_meshes)
      meshes = kept;
  }
  b->active_count = kept;
  b->active_meshes = meshes;
}
