/* Adaptive sampling: which pixels get no more samples. Decided after fixed numbers of samples, from
 * the samples of a pixel and its neighbours in the tile alone: the same for any number of threads.
 *
 * A sample is spent where it lowers the frame's mean square error the most. With n samples that
 * scatter by s, one more gains s^2/n^2, so that equal gains everywhere mean numbers in proportion
 * to the scatter (Neyman 1934, optimal allocation): few in quiet places, more than `samples` where
 * outlines of high contrast cross a pixel. */
#include "math/color.h"
#include "render/path.h"
#include "render/irradiance_record.h"

/* The scatter of a pixel's samples, digital numbers, for which `samples` are the right number. By
 * measurement, and fitted to two close views of spacecraft: there the frame's error is that of
 * `samples` in every pixel, or less (benchmarks/samples.py). It is no bound: clean frames, whose
 * error is below QUIET tolerances anyway, come out noisier (tests/c/test_prune.c: a tenth). */
static const float SCATTER_DN = 56.0f;
/* In flat places noise is seen that the mean over the frame forgives: up to `samples`, a pixel goes
 * on until its standard error is below so many tolerances. */
static const float QUIET = 3.0f;
/* Samples before which nothing ends: on bodies, which are smooth; where a mesh may show; where the
 * centre rays of a pixel and its neighbours meet different things. Outlines have slivers that few
 * samples miss. */
enum { BODY_MIN = 2, MESH_MIN = 4, OUTLINE_MIN = 8 };
/* And at least this part of `samples`, on outlines that: whatever luck says of a pixel, with more
 * samples it gets more. */
enum { LEAST_PART = 16, OUTLINE_PART = 2 };

/* Pixels whose light is pooled with a pixel's, as a rule; fewer, for what is left of the noise is
 * alike in neighbours, which makes it easier to see. */
static const float POOL = 8.0f;

/* A tile with a border of zeros: sums over neighbours need no cases. */
enum { SIDE = PL_TILE_SIDE + 2 };

typedef struct moments {
  float mean[SIDE * SIDE];     /* of the luminance */
  float variance[SIDE * SIDE]; /* of one sample's */
  float shared[SIDE * SIDE];   /* the part of that which is of light that is shared */
  float followed[SIDE * SIDE]; /* likewise, as if all paths were followed */
  float weight[SIDE * SIDE];   /* 1 in the tile, 0 on the border */
} moments;

static size_t bordered(uint32_t pixel) {
  return (pixel / PL_TILE_SIDE + 1) * SIDE + pixel % PL_TILE_SIDE + 1;
}

/* Radiance that a path from a thing may find and has not: that of a white surface in the sun. In a
 * body's umbra there is none but the bodies. */
static float unseen_radiance(const pl_path_context *context, uint32_t thing) {
  const pl_snapshot *shot = context->shot;
  if (thing >= shot->object_count)
    return 0.0f; /* what lights bodies is convex and drawn to, or too little to count */
  return shot->objects[thing].dark ? 0.0f : context->suns[thing].irradiance / PL_PI_F;
}

/* A mesh may show where none is seen yet: as if one of the samples of these pixels had met this
 * part of white. */
static const float UNSEEN_MESH = 0.3f, UNSEEN_FILTERED = 9.0f;

static float unseen_mesh(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  if (b->points[pixel].thing < context->shot->object_count || b->counts[pixel] == 0 ||
      !pl_coverage_pixel(context->coverage, x, y))
    return 0.0f;
  const float step = UNSEEN_MESH * context->settings->white_radiance;
  return step * step / (UNSEEN_FILTERED * (float)b->counts[pixel]);
}

/* Variance of the light that is shared, in one pixel's mean, after pooling with its neighbours;
 * `unseen`: as if one path of all their pixels had found that. */
static float shared_variance(const pl_patch *patch, float n, float unseen) {
  if (patch->lit == 0)
    return 0.0f;
  const float lit = (float)patch->lit, mean = pl_luminance(patch->shared) / lit;
  const float carried = unseen * pl_luminance(patch->lit_weight) / lit;
  float variance = carried * carried / (POOL * lit);
  if (patch->lit > 1)
    variance += pl_maxf(patch->lit_square / lit - mean * mean, 0.0f);
  const float part = (float)patch->wide / n;
  return part * part * variance / (POOL * pl_maxf(lit - 1.0f, 1.0f));
}

/* Light that is shared counts in a sample as what it is in the mean; its noise comes after. */
static void measure_pixel(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel,
                          size_t k, moments *out) {
  const pl_pixel_patches *patches = &b->patches[pixel];
  const float n = (float)b->counts[pixel];
  float sum = pl_luminance(b->radiance[pixel]), square = b->square[pixel];
  for (uint32_t i = 0; i < patches->count; i++) {
    const pl_patch *patch = &patches->patch[i];
    const float seen = (float)patch->seen, own = pl_luminance(patch->own);
    const float each = patch->lit > 0 ? (float)patch->wide / (seen * (float)patch->lit) : 0.0f;
    const float lit = each * pl_luminance(patch->shared);
    sum += own + seen * lit;
    square += patch->own_square + lit * (2.0f * own + seen * lit);
    const float shared = n * shared_variance(patch, n, unseen_radiance(context, patch->spot.thing));
    out->shared[k] += shared;
    if (patch->wide > 0)
      out->followed[k] += shared * (float)patch->lit / (float)patch->wide;
  }
  out->mean[k] = sum / n;
  out->weight[k] = 1.0f;
  out->variance[k] = out->shared[k] + unseen_mesh(context, b, pixel);
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

static float error_dn(float white, float mean, float error) {
  const float low = pl_minf(mean / white, 1.0f), high = pl_minf((mean + error) / white, 1.0f);
  return 255.0f * (pl_srgb_encode(high) - pl_srgb_encode(low));
}

float pl_path_error_dn(const pl_render_settings *settings, float mean, float error) {
  const float found = error_dn(settings->white_radiance, mean, error),
              other = settings->white_other;
  return other > 0.0f ? pl_maxf(found, error_dn(other, mean, error)) : found;
}

/* Over the neighbours of a pixel. */
static float sum8(const float *values, size_t k) {
  float sum = values[k - 1] + values[k + 1];
  for (size_t row = k - SIDE; row <= k + SIDE; row += 2 * SIDE)
    sum += values[row - 1] + values[row] + values[row + 1];
  return sum;
}

/* Standard error of a pixel's mean after n samples, digital numbers: by its neighbours alone. Its
 * own samples would end it where they are alike by luck, and go on where one is bright: what few
 * paths find would be too dark in the mean. */
static float standard_error_dn(const pl_render_settings *settings, const moments *moments, size_t k,
                               float n) {
  const float count = sum8(moments->weight, k);
  if (!(count > 0.0f))
    return INFINITY; /* the one pixel of its tile: nobody says that it is quiet */
  const float around = sqrtf(sum8(moments->variance, k) / (count * n));
  return pl_path_error_dn(settings, sum8(moments->mean, k) / count, around);
}

static bool is_finished(const pl_render_settings *settings, const moments *moments, uint32_t pixel,
                        float n) {
  const float samples = (float)settings->samples;
  const float error = standard_error_dn(settings, moments, bordered(pixel), n);
  if (!(error > settings->noise_dn))
    return true;
  if (error > QUIET * settings->noise_dn && n < samples)
    return false;
  return n >= samples * error * sqrtf(n) / SCATTER_DN;
}

/* Of PL_IRRADIANCE_ROW paths so many are worth following: with the part f of them, of the cost of
 * what leads there, an error falls the fastest where f^2 is the ratio of the two variances. */
static uint8_t worth_following(const moments *moments, size_t k) {
  const float shared = sum8(moments->followed, k);
  const float own = sum8(moments->variance, k) - sum8(moments->shared, k);
  return shared > 0.5f * own     ? PL_IRRADIANCE_ROW
         : shared > 0.125f * own ? PL_IRRADIANCE_ROW / 2
                                 : 0;
}

static bool on_outline(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  const int x = (int)(pixel % PL_TILE_SIDE), y = (int)(pixel / PL_TILE_SIDE);
  const int right = context->tile.width - 1, bottom = context->tile.height - 1;
  for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v <= bottom; v++)
    for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u <= right; u++)
      if (b->points[v * PL_TILE_SIDE + u].thing != b->points[pixel].thing)
        return true;
  return false;
}

/* Part of a pixel that a white thing in the sun must fill to be noticed before black. */
static double faint_part(const pl_path_context *context) {
  static const double BLACK_SLOPE = 12.92 * 255.0; /* of sRGB */
  const pl_render_settings *s = context->settings;
  const double sun = (double)context->camera_sun.irradiance;
  const float white =
      s->white_other > 0.0f ? pl_minf(s->white_radiance, s->white_other) : s->white_radiance;
  return (double)s->noise_dn / BLACK_SLOPE * (double)white * PL_PI / fmax(sun, 1e-9);
}

/* Media may be thinner than a pixel, as an outline's slivers are; beside it they may lie on the
 * edge between two. */
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

/* Whether the sun's limb may cross the pixel: no part of its disc is too small to be seen. */
static bool has_suns_limb(const pl_path_context *context, uint32_t pixel) {
  if (!context->sun)
    return false;
  const pl_sun_view *sun = &context->camera_sun;
  const int x = context->tile.x0 + (int)(pixel % PL_TILE_SIDE);
  const int y = context->tile.y0 + (int)(pixel / PL_TILE_SIDE);
  const pl_vec3 ray = pl_snapshot_ray(context->shot, x, y);
  const pl_vec3 toward = pl_vec3f_to_double(sun->direction);
  const double off = pl_vec3_norm(pl_vec3_cross(ray, toward));
  return pl_vec3_dot(ray, toward) > 0.0 && fabs(off - (double)sun->sin_radius) < context->pixel_rad;
}

/* What a few samples of a pixel may all miss, though the plan knows that it may be there. */
static bool may_miss(const pl_path_context *context, const pl_tile_buffers *b, uint32_t pixel) {
  return b->narrow[pixel] || has_thin_medium(context, pixel) || has_suns_limb(context, pixel);
}

void pl_path_drop_single(pl_tile_buffers *b) {
  size_t kept = b->active_meshes; /* they cover what is behind */
  for (size_t i = kept; i < b->active_count; i++)
    if (!b->single[b->active[i]])
      b->active[kept++] = b->active[i];
  b->active_count = kept;
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
    const bool early = n < least || n < (i < b->active_meshes ? MESH_MIN : BODY_MIN) ||
                       (n < outline && on_outline(context, b, pixel));
    if (early || !is_finished(context->settings, &moments, pixel, (float)n) ||
        (n < samples && may_miss(context, b, pixel)))
      b->active[kept++] = pixel;
    if (i + 1 == b->active_meshes)
      meshes = kept;
  }
  b->active_count = kept;
  b->active_meshes = meshes;
}
