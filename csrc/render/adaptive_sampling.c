/* Adaptive sampling: decides which pixels need no more samples. The decision is made after fixed
 * sample counts and uses only samples of the pixel and its neighbours within the tile, so that it
 * is the same for any number of threads.
 *
 * A sample is spent where it lowers the frame's mean square error the most. If n samples have
 * standard deviation s, one more sample lowers the squared error by s^2/n^2. Equal gains everywhere
 * mean sample counts in proportion to s (Neyman 1934, optimal allocation): few in quiet places,
 * more than `samples` where high-contrast outlines cross a pixel. */
#include "math/color.h"
#include "render/path.h"
#include "render/irradiance_record.h"

/* Standard deviation of a pixel's samples, in digital numbers, for which `samples` is the right
 * count. Measured, and fitted to two close views of spacecraft: there the frame's error is at most
 * that of `samples` in every pixel (benchmarks/samples.py). It is not a bound: clean frames, whose
 * error is below QUIET tolerances anyway, come out noisier (tests/c/test_adaptive_sampling.c: by a
 * tenth). */
static const float SCATTER_DN = 56.0f;
/* Noise is visible in flat regions even if it is negligible in the mean over the frame. A pixel is
 * therefore sampled, up to `samples` times, until its standard error is below this many tolerances.
 */
static const float QUIET = 3.0f;
/* Minimum number of samples before a pixel may be finished: on bodies and ground, which are without
 * slivers; where another mesh may be visible; and where the centre rays of a pixel and its
 * neighbours hit different entities. Outlines contain slivers that a small number of samples
 * misses.
 */
enum { BODY_MIN = 2, MESH_MIN = 4, OUTLINE_MIN = 8 };
/* A pixel also gets at least samples / LEAST_PART samples, and on outlines samples / OUTLINE_PART,
 * so that a higher `samples` raises the count even in pixels that look quiet by chance. */
enum { LEAST_PART = 16, OUTLINE_PART = 2 };

/* Typical number of pixels over which the irradiance filter averages. The value is lower than the
 * actual number because the remaining noise is correlated between neighbours, which makes it easier
 * to see. */
static const float FILTERED_PIXELS = 8.0f;

/* Side of a tile padded with a border of zeros, so that neighbourhood sums need no bounds checks.
 */
enum { SIDE = PL_TILE_SIDE + 2 };

typedef struct moments {
  float mean[SIDE * SIDE];     /* mean luminance */
  float variance[SIDE * SIDE]; /* variance of the luminance of one sample */
  float filtered[SIDE * SIDE]; /* part of the variance due to filtered irradiance */
  float followed[SIDE * SIDE]; /* the same as if all paths were followed */
  float weight[SIDE * SIDE];   /* 1 in the tile, 0 on the border */
} moments;

static size_t bordered(uint32_t pixel) {
  return (pixel / PL_TILE_SIDE + 1) * SIDE + pixel % PL_TILE_SIDE + 1;
}

/* Radiance that a path from a surface may find but has not found yet: that of a white surface in
 * the sun. In the umbra of a body there is none except from the bodies. */
static float unseen_radiance(const pl_path_context *context, pl_surface_id id) {
  const pl_snapshot *shot = context->shot;
  if (pl_surface_is_ellipsoid(id) || pl_surface_is_none(id))
    return 0.0f; /* sources that light bodies are convex and sampled explicitly, or negligible */
  if (!pl_surface_is_mesh(id))
    return context->camera_sun.irradiance / PL_PI_F;
  return pl_shot_object_of(shot, id)->dark
             ? 0.0f
             : context->suns[pl_surface_index(id)].irradiance / PL_PI_F;
}

/* A mesh may be visible in a pixel in which no sample has hit one yet. The variance is set as if
 * one of the samples of the pixel and its neighbours had differed by this part of white. */
static const float UNSEEN_MESH = 0.3f, UNSEEN_FILTERED = 9.0f;

static float unseen_mesh(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  const pl_surface_id id = b->points[pixel].surface_id;
  const bool met = !pl_surface_is_ellipsoid(id) && !pl_surface_is_none(id);
  if (met || b->counts[pixel] == 0 || !pl_coverage_pixel(context->coverage, x, y))
    return 0.0f;
  const float step = UNSEEN_MESH * context->settings->white_radiance;
  return step * step / (UNSEEN_FILTERED * (float)b->counts[pixel]);
}

/* Variance of the filtered irradiance in the mean of one pixel, after averaging with its
 * neighbours. `unseen`: radiance that one path of all these pixels is assumed to have found in
 * addition. */
static float shared_variance(const pl_patch *patch, float n, float unseen) {
  if (patch->lit == 0)
    return 0.0f;
  const float lit = (float)patch->lit, mean = pl_luminance(patch->filtered) / lit;
  const float carried = unseen * pl_luminance(patch->lit_weight) / lit;
  float variance = carried * carried / (FILTERED_PIXELS * lit);
  if (patch->lit > 1)
    variance += pl_maxf(patch->lit_square / lit - mean * mean, 0.0f);
  const float part = (float)patch->wide / n;
  return part * part * variance / (FILTERED_PIXELS * pl_maxf(lit - 1.0f, 1.0f));
}

/* Filtered irradiance enters each sample with its mean; its noise is added afterwards. */
static void measure_pixel(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel,
                          size_t k, moments *out) {
  const uint32_t count = pl_path_patch_count(b, pixel);
  const float n = (float)b->counts[pixel];
  float sum = pl_luminance(b->radiance[pixel]), square = b->square[pixel];
  for (uint32_t i = 0; i < count; i++) {
    const pl_patch *patch = &b->patches[pixel].patch[i];
    const float seen = (float)patch->seen, own = pl_luminance(patch->own);
    const float each = patch->lit > 0 ? (float)patch->wide / (seen * (float)patch->lit) : 0.0f;
    const float lit = each * pl_luminance(patch->filtered);
    sum += own + seen * lit;
    square += patch->own_square + lit * (2.0f * own + seen * lit);
    const float filtered =
        n * shared_variance(patch, n, unseen_radiance(context, patch->spot.surface_id));
    out->filtered[k] += filtered;
    if (patch->wide > 0)
      out->followed[k] += filtered * (float)patch->lit / (float)patch->wide;
  }
  out->mean[k] = sum / n;
  out->weight[k] = 1.0f;
  out->variance[k] = out->filtered[k] + unseen_mesh(context, b, pixel);
  if (n > 1.0f)
    out->variance[k] += pl_maxf(square / n - out->mean[k] * out->mean[k], 0.0f) * n / (n - 1.0f);
}

static void measure(const pl_path_context *context, const pl_tile_buffers *b, moments *out) {
  *out = (moments){.weight = {0.0f}};
  for (int y = 0; y < context->tile.height; y++)
    for (int x = 0; x < context->tile.width; x++) {
      const uint32_t pixel = (uint32_t)(y * PL_TILE_SIDE + x);
      const size_t k = bordered(pixel);
      measure_pixel(context, b, pixel, k, out);
    }
}

/* Above white an error is not visible. Where it reaches that far, as it does around glints, a mean
 * that is too low by as much counts, too: a pixel may be dark although its neighbours are white on
 * average. */
static float error_dn(float white, float mean, float error) {
  const float shown = pl_srgb_encode(pl_minf(mean / white, 1.0f));
  const float more = pl_srgb_encode(pl_minf((mean + error) / white, 1.0f)) - shown;
  if (!(mean + error > white))
    return 255.0f * more;
  const float least = pl_srgb_encode(pl_minf(pl_maxf(mean - error, 0.0f) / white, 1.0f));
  return 255.0f * pl_maxf(more, shown - least);
}

float pl_path_error_dn(const pl_render_settings *settings, float mean, float error) {
  const float found = error_dn(settings->white_radiance, mean, error),
              other = settings->white_other;
  return other > 0.0f ? pl_maxf(found, error_dn(other, mean, error)) : found;
}

/* Sum over the eight neighbours of a pixel. */
static float sum8(const float *values, size_t k) {
  float sum = values[k - 1] + values[k + 1];
  for (size_t row = k - SIDE; row <= k + SIDE; row += 2 * SIDE)
    sum += values[row - 1] + values[row] + values[row + 1];
  return sum;
}

/* Mean over the neighbours of a pixel as it is shown: if some are below white, the others are no
 * more than white. Some bright ones would else stand for all. */
static float shown_mean(const moments *moments, size_t k, float white) {
  float sum = 0.0f, shown = 0.0f, count = 0.0f, above = 0.0f;
  for (size_t row = k - SIDE; row <= k + SIDE; row += SIDE)
    for (size_t i = row - 1; i <= row + 1; i++) {
      const float weight = i == k ? 0.0f : moments->weight[i], mean = moments->mean[i];
      sum += weight * mean;
      shown += weight * pl_minf(mean, white);
      above += mean > white ? weight : 0.0f;
      count += weight;
    }
  return (above < count ? shown : sum) / count;
}

/* Standard error of a pixel's mean after n samples, in digital numbers, estimated from its
 * neighbours only. With its own samples, a pixel would finish early where they agree by chance and
 * continue where one is bright. Features that few paths find would then be too dark in the mean. */
static float standard_error_dn(const pl_render_settings *settings, const moments *moments, size_t k,
                               float n) {
  const float count = sum8(moments->weight, k);
  if (!(count > 0.0f))
    return INFINITY; /* a tile of one pixel has no neighbours to estimate the noise from */
  const float around = sqrtf(sum8(moments->variance, k) / (count * n));
  const float white = settings->white_radiance, other = settings->white_other;
  const float found = error_dn(white, shown_mean(moments, k, white), around);
  return other > 0.0f ? pl_maxf(found, error_dn(other, shown_mean(moments, k, other), around))
                      : found;
}

/* Variance of a pixel's samples by those of its neighbours: their mean, or the second largest if
 * that is more. A line through the pixel crosses two of its neighbours, too, and only these. */
static float variance_around(const moments *moments, size_t k) {
  float first = 0.0f, second = 0.0f;
  for (size_t row = k - SIDE; row <= k + SIDE; row += SIDE)
    for (size_t i = row - 1; i <= row + 1; i++) {
      const float variance = i != k ? moments->variance[i] : 0.0f;
      second = pl_maxf(second, pl_minf(first, variance));
      first = pl_maxf(first, variance);
    }
  return pl_maxf(second, sum8(moments->variance, k) / sum8(moments->weight, k));
}

/* Whether a pixel's error is within the target, judged by its neighbours only, as above. */
static bool is_on_target(const pl_render_settings *settings, const moments *moments, size_t k,
                         float n) {
  if (!(sum8(moments->weight, k) > 0.0f))
    return false;
  const float error = settings->target_sigmas * sqrtf(variance_around(moments, k) / n);
  const float white = settings->white_radiance, other = settings->white_other;
  return error_dn(white, shown_mean(moments, k, white), error) <= settings->target_dn &&
         (!(other > 0.0f) ||
          error_dn(other, shown_mean(moments, k, other), error) <= settings->target_dn);
}

static bool is_finished(const pl_render_settings *settings, const moments *moments, uint32_t pixel,
                        float n) {
  if (settings->target_dn > 0.0f)
    return is_on_target(settings, moments, bordered(pixel), n);
  const float samples = (float)settings->samples;
  const float error = standard_error_dn(settings, moments, bordered(pixel), n);
  if (!(error > settings->noise_dn))
    return true;
  if (error > QUIET * settings->noise_dn && n < samples)
    return false;
  return n >= samples * error * sqrtf(n) / SCATTER_DN;
}

/* Number of paths of PL_IRRADIANCE_ROW that are worth following. If following a path costs as much
 * as tracing it up to there, the error falls fastest for a followed part f of the paths whose
 * square is the ratio of the two variances. */
static uint8_t worth_following(const moments *moments, size_t k) {
  const float filtered = sum8(moments->followed, k);
  const float own = sum8(moments->variance, k) - sum8(moments->filtered, k);
  return filtered > 0.5f * own     ? PL_IRRADIANCE_ROW
         : filtered > 0.125f * own ? PL_IRRADIANCE_ROW / 2
                                   : 0;
}

static bool on_outline(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  const int x = (int)(pixel % PL_TILE_SIDE), y = (int)(pixel / PL_TILE_SIDE);
  const int right = context->tile.width - 1, bottom = context->tile.height - 1;
  for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v <= bottom; v++)
    for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u <= right; u++)
      if (!pl_surface_same(b->points[v * PL_TILE_SIDE + u].surface_id, b->points[pixel].surface_id))
        return true;
  return false;
}

/* Whether a mesh may be visible in a pixel, other than ground. */
static bool sees_mesh(const pl_path_context *context, uint32_t pixel) {
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  return pl_coverage_of(context->coverage, x, y) == PL_COVERED_BY_MESH;
}

/* Part of a pixel that a white object in the sun must fill to be distinguishable from black. */
static double faint_part(const pl_path_context *context) {
  static const double BLACK_SLOPE = 12.92 * 255.0; /* of sRGB */
  const pl_render_settings *s = context->settings;
  const double sun = (double)context->camera_sun.irradiance;
  const float white =
      s->white_other > 0.0f ? pl_minf(s->white_radiance, s->white_other) : s->white_radiance;
  return (double)s->noise_dn / BLACK_SLOPE * (double)white * PL_PI / fmax(sun, 1e-9);
}

/* True if a medium thinner than the pixel may cross it, as slivers do on outlines. The four
 * neighbours are tested too, since such a medium may lie on the edge between two pixels. */
static bool has_thin_medium(const pl_path_context *context, uint32_t pixel) {
  static const int beside[5][2] = {{0, 0}, {0, -1}, {0, 1}, {-1, 0}, {1, 0}};
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  const double faint = faint_part(context);
  for (int i = 0; context->media && i < 5; i++) {
    const pl_vec3 direction = pl_snapshot_ray(context->shot, x + beside[i][0], y + beside[i][1]);
    const pl_beam beam = {.direction = direction, .spread = (float)context->pixel_rad};
    if (pl_media_thin(context->settings->media, context->shot, &beam, faint))
      return true;
  }
  return false;
}

/* True if the centre ray of the pixel, or of a neighbour in the tile, meets nothing. */
static bool sees_sky(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  const int x = (int)(pixel % PL_TILE_SIDE), y = (int)(pixel / PL_TILE_SIDE);
  const int right = context->tile.width - 1, bottom = context->tile.height - 1;
  for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v <= bottom; v++)
    for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u <= right; u++)
      if (pl_surface_is_none(b->points[v * PL_TILE_SIDE + u].surface_id))
        return true;
  return false;
}

void pl_path_keep_limb(const pl_path_context *context, pl_tile_buffers *b) {
  size_t kept = 0, meshes = 0;
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    if (pl_path_on_limb(context, pixel) && sees_sky(context, b, pixel))
      b->active[kept++] = pixel;
    if (i + 1 == b->active_meshes)
      meshes = kept;
  }
  b->active_count = kept;
  b->active_meshes = meshes;
}

/* True if the pixel may contain something that the plan expects but a small number of samples may
 * miss. */
static bool may_miss(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  return b->narrow[pixel] || has_thin_medium(context, pixel) || pl_path_on_limb(context, pixel);
}

void pl_path_drop_single(pl_tile_buffers *b) {
  size_t kept = b->active_meshes; /* mesh pixels stay active: meshes occlude what is behind them */
  for (size_t i = kept; i < b->active_count; i++)
    if (!b->single[b->active[i]])
      b->active[kept++] = b->active[i];
  b->active_count = kept;
}

size_t pl_path_missed(const pl_path_context *context, const pl_tile_buffers *b) {
  moments moments;
  size_t missed = 0;
  measure(context, b, &moments);
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    missed += !is_on_target(context->settings, &moments, bordered(pixel), (float)b->counts[pixel]);
  }
  return missed;
}

void pl_path_adapt(const pl_path_context *context, pl_tile_buffers *b) {
  moments moments;
  measure(context, b, &moments);
  const int samples = context->settings->samples, least = samples / LEAST_PART;
  const int outline = samples / OUTLINE_PART > OUTLINE_MIN ? samples / OUTLINE_PART : OUTLINE_MIN;
  size_t kept = 0, meshes = 0;
  for (size_t i = 0; i < b->active_count; i++) {
    const uint32_t pixel = b->active[i];
    const int n = b->counts[pixel];
    b->followed[pixel] = worth_following(&moments, bordered(pixel));
    const bool early = n < least || n < (sees_mesh(context, pixel) ? MESH_MIN : BODY_MIN) ||
                       (n < outline && on_outline(context, b, pixel));
    if (early || !is_finished(context->settings, &moments, pixel, (float)n) ||
        (n < samples && may_miss(context, b, pixel)) ||
        (pl_path_on_limb(context, pixel) && sees_sky(context, b, pixel)))
      b->active[kept++] = pixel;
    if (i + 1 == b->active_meshes)
      meshes = kept;
  }
  b->active_count = kept;
  b->active_meshes = meshes;
}
