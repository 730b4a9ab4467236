#include "shade/clouds.h"

#include <math.h>

#include "base/work.h"
#include "math/fractal.h"
#include "shade/body_map.h"

#define SQRT_HALF 0.70710678118654752440

static bool within(double x, double low, double high) { return x >= low && x <= high; }

bool pl_clouds_valid(const pl_clouds *c) {
  if (c->altitude_m == 0.0)
    return true;
  bool good = within(c->altitude_m, 1e-6, 1e15) && within(c->thickness_m, 1e-6, 1e15) &&
              within(c->turn_rad, -1e9, 1e9) && within((double)c->opacity, 0.0, 1.0) &&
              within((double)c->depth, 0.0, 1e6);
  for (int k = 0; k < 3; k++)
    good = good && within((double)c->color[k], 0.0, 1.0);
  return good && within((double)c->coverage, 0.0, 1.0) && within((double)c->softness, 1e-3, 1e3) &&
         (c->octaves == 0.0f || within((double)c->octaves, 1.0, PL_FRACTAL_OCTAVES)) &&
         within((double)c->roughness, 0.0, 1.0) && within(c->size_m, 1e-6, 1e15) &&
         within((double)c->depth_spread, 0.0, 5.0) && within((double)c->relief_m, 0.0, 1e15) &&
         within((double)c->warp, -10.0, 10.0) && within((double)c->phase, -1e6, 1e6);
}

/* Quantile of the standard normal distribution at `fraction`, 0 < fraction < 1, to 1e-6, by the
 * inverse error function (Giles 2010, Approximating the erfinv function, GPU Computing Gems). */
static float normal_place(float fraction) {
  static const float middle[9] = {2.81022636e-08f,  3.43273939e-07f, -3.5233877e-06f,
                                  -4.39150654e-06f, 0.00021858087f,  -0.00125372503f,
                                  -0.00417768164f,  0.246640727f,    1.50140941f};
  static const float tails[9] = {-0.000200214257f, 0.000100950558f, 0.00134934322f,
                                 -0.00367342844f,  0.00573950773f,  -0.0076224613f,
                                 0.00943887047f,   1.00167406f,     2.83297682f};
  const float w = -logf(4.0f * fraction * (1.0f - fraction));
  const float *row = w < 5.0f ? middle : tails, at = w < 5.0f ? w - 2.5f : sqrtf(w) - 3.0f;
  float p = row[0];
  for (int i = 1; i < 9; i++)
    p = row[i] + p * at;
  return p * (2.0f * fraction - 1.0f) * (float)(2.0 * SQRT_HALF);
}

/* Amplitudes of the octaves, as in math/fractal.c. */
static int list_octaves(const pl_clouds *clouds, float out[PL_FRACTAL_OCTAVES]) {
  int count = 0;
  float power = 1.0f;
  for (; count < PL_FRACTAL_OCTAVES && (float)count < clouds->octaves; count++) {
    out[count] = power * pl_minf(clouds->octaves - (float)count, 1.0f);
    power *= clouds->roughness;
  }
  return count;
}

pl_cloud_cover pl_cloud_cover_make(const pl_clouds *clouds, const pl_texture *map, int detail) {
  pl_cloud_cover out = {
      .clouds = clouds,
      .map = map,
      .sine = (float)sin(clouds->turn_rad),
      .cosine = (float)cos(clouds->turn_rad),
  };
  const int count = list_octaves(clouds, out.amplitudes);
  float looked_up = 0.0f;
  out.detail = detail < count ? detail : count;
  for (int i = 0; i < count; i++) {
    out.total += out.amplitudes[i];
    out.variance += out.amplitudes[i] * out.amplitudes[i] * (float)PL_NOISE_VARIANCE;
    looked_up += i < out.detail ? out.amplitudes[i] : 0.0f;
  }
  if (count == 0)
    return out;
  out.variance /= out.total * out.total;
  out.scale = looked_up / out.total;
  out.spread = sqrtf(out.variance * (1.0f + clouds->softness * clouds->softness));
  return out;
}

/* Octaves of the domain warp: only coarse ones, so that the shape of footprints changes little. */
enum { BENDS = 2 };

/* Noise at the first `count` points; of one alone it costs less than of all lanes. */
static void find_fbm(const pl_fractal *noise, const pl_point_lanes *points,
                     const float width[PL_LANES], size_t count, float out[PL_LANES]) {
  const pl_fractal_row *fbm = &pl_fractal_rows[PL_FRACTAL_FBM];
  const pl_vec3 first = {points->at[0][0], points->at[1][0], points->at[2][0]};
  if (count > 1)
    fbm->evaluate_lanes(noise, points, width, out);
  else
    out[0] = fbm->evaluate(noise, first, width[0]);
}

/* Displacement of points by the domain warp, in cells. Each axis has its own noise. */
static void bend(const pl_clouds *clouds, const pl_point_lanes *cells, const float width[PL_LANES],
                 size_t count, double moved[3][PL_LANES]) {
  pl_fractal noise = {.octaves = BENDS, .roughness = 0.5f, .lacunarity = 2.0f};
  pl_point_lanes at = *cells;
  float value[PL_LANES];
  PL_EACH_LANE(i) at.at[2][i] += (double)clouds->phase;
  for (uint32_t k = 0; k < 3; k++) {
    noise.seed = clouds->seed + 0x9e3779b9u * (k + 1);
    find_fbm(&noise, &at, width, count, value);
    for (size_t i = 0; i < count; i++)
      moved[k][i] = (double)(clouds->warp * value[i]);
  }
}

static float normal_density(float x) { return expf(-0.5f * x * x) / sqrtf(2.0f * PL_PI_F); }

/* Result of applying the noise to the mean cover. */
typedef struct broken {
  float cover, unsure;
  /* Mean of the noise in the covered part minus its usual mean there, over its spread. */
  float excess;
  pl_vec3f gradient; /* of the resolved noise, per cell */
} broken;

/* Conditional mean of the noise in the covered part, minus its usual value for that mean cover: the
 * resolved noise plus the expected hidden noise given that the threshold is exceeded. `spread`:
 * standard deviation of hidden noise and soft edges; `lost`: variance of the hidden noise; `at`:
 * resolved noise above the threshold, over `spread`. */
static float excess_of(const pl_cloud_cover *cover, float mean, float value, float lost,
                       float spread, float at) {
  if (!(mean < 1.0f))
    return value / cover->spread;
  const float covered = pl_maxf(0.5f * erfcf(-at * (float)SQRT_HALF), 1e-4f);
  const float hidden = lost / spread * normal_density(at) / covered;
  const float usual = cover->variance / cover->spread * normal_density(normal_place(mean)) / mean;
  return (value + hidden - usual) / cover->spread;
}

static pl_fractal noise_of(const pl_cloud_cover *cover) {
  return (pl_fractal){.octaves = pl_minf((float)cover->detail, cover->clouds->octaves),
                      .roughness = cover->clouds->roughness,
                      .lacunarity = 2.0f,
                      .seed = cover->clouds->seed};
}

/* Noise below the footprint in each lane: its variance, and the squared error that remains,
 * relative to one octave. */
PL_WIDE static void find_hidden(const pl_cloud_cover *cover, const float *restrict width,
                                float *restrict lost, float *restrict uneven) {
  float frequency = 1.0f;
  PL_EACH_LANE(k) lost[k] = uneven[k] = 0.0f;
  for (int i = 0; i < PL_FRACTAL_OCTAVES && (float)i < cover->clouds->octaves; i++) {
    const float amplitude = cover->amplitudes[i] / cover->total;
    const bool seen = i < cover->detail; /* others are missing from narrower footprints too */
    PL_EACH_LANE(k) {
      const float kept = seen ? pl_noise_fade(width[k] * frequency) : 0.0f;
      const float missed = seen ? amplitude * pl_noise_missed(width[k] * frequency) : 0.0f;
      lost[k] += amplitude * amplitude * (1.0f - kept * kept);
      uneven[k] += missed * missed;
    }
    frequency *= 2.0f;
  }
}

/* Cover for a mean cover of `mean`, from the value of the resolved noise; find_hidden gives the
 * noise below the footprint. */
static broken break_cover(const pl_cloud_cover *cover, float mean, float lost, float uneven,
                          const pl_fractal_value *seen, unsigned wants) {
  const pl_clouds *clouds = cover->clouds;
  const float value = cover->scale * seen->value;
  broken out = {.cover = 1.0f, .gradient = pl_vec3f_scale(seen->gradient, cover->scale)};
  lost *= (float)PL_NOISE_VARIANCE;
  const float edge = clouds->softness * clouds->softness * cover->variance;
  const float spread = sqrtf(edge + lost);
  float at = 0.0f; /* relative to the threshold */
  if (mean < 1.0f) {
    const float threshold = -cover->spread * normal_place(mean);
    at = (value - threshold) / spread;
    out.cover = 0.5f * erfcf((threshold - value) / (spread * (float)(2.0 * SQRT_HALF)));
    if ((wants & PL_CLOUD_UNSURE) != 0)
      out.unsure = sqrtf(uneven * (float)PL_NOISE_VARIANCE) / spread *
                   normal_density(pl_maxf(fabsf(at) - 1.0f, 0.0f));
  }
  if (clouds->depth_spread > 0.0f)
    out.excess = excess_of(cover, mean, value, lost, spread, at);
  return out;
}

/* From body axes to the axes of the shell. */
static pl_vec3 turn_back(const pl_cloud_cover *cover, pl_vec3 v) {
  const double c = (double)cover->cosine, s = (double)cover->sine;
  return (pl_vec3){c * v.x + s * v.y, c * v.y - s * v.x, v.z};
}

/* Converts a gradient per cell to a slope in body axes. */
static pl_vec3f slope_of(const pl_cloud_cover *cover, pl_vec3f gradient) {
  const float c = cover->cosine, s = cover->sine;
  const float scale = cover->clouds->relief_m / (cover->spread * (float)cover->clouds->size_m);
  return pl_vec3f_make(scale * (c * gradient.x - s * gradient.y),
                       scale * (s * gradient.x + c * gradient.y), scale * gradient.z);
}

/* A footprint on its way to the clouds over it. */
typedef struct sight {
  pl_body_place place; /* axes of the shell */
  pl_vec3 cell;        /* its point, in cells of the first octave */
  float width;         /* its diameter in cells */
  float mean;          /* cover */
  bool noisy;          /* noise breaks the mean cover */
} sight;

static sight sight_of(const pl_cloud_cover *cover, const pl_cloud_spot *spot) {
  const pl_clouds *clouds = cover->clouds;
  const double area = pl_vec3_norm(pl_vec3_cross(spot->across, spot->along));
  sight out = {.place = {turn_back(cover, spot->point), turn_back(cover, spot->across),
                         turn_back(cover, spot->along), 0.0, cover->oblate},
               .width = (float)(2.0 * sqrt(area / PL_PI) / clouds->size_m)};
  out.cell = pl_vec3_scale(out.place.point, 1.0 / clouds->size_m);
  return out;
}

/* Cells and widths of all lanes; unused ones have those of the first. `wider`: factor on the width.
 */
static void gather(const sight *sights, size_t count, float wider, pl_point_lanes *cells,
                   float width[PL_LANES]) {
  for (size_t i = 0; i < PL_LANES; i++) {
    const sight *from = &sights[i < count ? i : 0];
    cells->at[0][i] = from->cell.x;
    cells->at[1][i] = from->cell.y;
    cells->at[2][i] = from->cell.z;
    width[i] = from->width * wider;
  }
}

static void warp(const pl_clouds *clouds, sight *sights, size_t count) {
  pl_point_lanes cells;
  float width[PL_LANES];
  double moved[3][PL_LANES];
  if (clouds->warp == 0.0f)
    return;
  gather(sights, count, 1.0f, &cells, width);
  bend(clouds, &cells, width, count, moved);
  for (size_t i = 0; i < count; i++) {
    const pl_vec3 by = {moved[0][i], moved[1][i], moved[2][i]};
    sights[i].cell = pl_vec3_add(sights[i].cell, by);
    sights[i].place.point = pl_vec3_madd(sights[i].place.point, clouds->size_m, by);
  }
}

static void find_mean(const pl_cloud_cover *cover, unsigned wants, sight *sight) {
  const pl_clouds *clouds = cover->clouds;
  sight->mean = clouds->coverage;
  if (cover->map != NULL) {
    float value[4];
    if ((wants & PL_CLOUD_BOX) != 0)
      pl_body_map_box(cover->map, &sight->place, PL_FILTER_FINEST, value);
    else
      pl_body_map_sample(cover->map, &sight->place, PL_FILTER_FINEST, value);
    sight->mean *= value[0];
  }
  sight->noisy = pl_clouds_noisy(clouds) && sight->mean > 0.0f &&
                 (sight->mean < 1.0f || pl_clouds_uneven(clouds));
}

/* What the noise is in each lane. */
typedef struct resolved {
  pl_fractal_value seen[PL_LANES];
  float lost[PL_LANES], uneven[PL_LANES]; /* see find_hidden */
} resolved;

static void find_noise(const pl_cloud_cover *cover, const sight *sights, size_t count, bool tops,
                       resolved *out) {
  const pl_fractal noise = noise_of(cover);
  pl_point_lanes cells;
  float width[PL_LANES], value[PL_LANES];
  gather(sights, count, 1.0f + fabsf(cover->clouds->warp), &cells, width);
  find_hidden(cover, width, out->lost, out->uneven);
  if (cover->detail == 0)
    return;
  if (tops) {
    for (size_t i = 0; i < count; i++)
      out->seen[i] = pl_fractal_gradient(&noise, sights[i].cell, width[i]);
    return;
  }
  find_fbm(&noise, &cells, width, count, value);
  for (size_t i = 0; i < count; i++)
    out->seen[i].value = value[i];
}

static pl_cloud_place place_by(const pl_cloud_cover *cover, const sight *sight, unsigned wants,
                               const resolved *noise, size_t lane) {
  const pl_clouds *clouds = cover->clouds;
  pl_cloud_place out = {.cover = sight->mean, .depth = clouds->depth};
  if (sight->noisy) {
    const broken b = break_cover(cover, sight->mean, noise->lost[lane], noise->uneven[lane],
                                 &noise->seen[lane], wants);
    out.cover = b.cover;
    out.unsure = clouds->opacity * b.unsure;
    if (clouds->depth_spread > 0.0f)
      out.depth *= expf(clouds->depth_spread * b.excess);
    if ((wants & PL_CLOUD_TOPS) != 0)
      out.slope = slope_of(cover, b.gradient);
  }
  out.cover *= clouds->opacity;
  return out;
}

void pl_cloud_places(const pl_cloud_cover *cover, const pl_cloud_spot *spots, size_t count,
                     unsigned wants, pl_cloud_place *out) {
  sight sights[PL_LANES];
  resolved noise = {.lost = {0.0f}};
  bool noisy = false;
  if (count == 0)
    return;
  if (!(cover->clouds->relief_m > 0.0f))
    wants &= ~(unsigned)PL_CLOUD_TOPS;
  for (size_t i = 0; i < count; i++)
    sights[i] = sight_of(cover, &spots[i]);
  warp(cover->clouds, sights, count);
  for (size_t i = 0; i < count; i++) {
    find_mean(cover, wants, &sights[i]);
    noisy |= sights[i].noisy;
  }
  pl_work_add(PL_WORK_cloud_octaves, count * (noisy ? 1 + (size_t)cover->detail : 1));
  if (noisy)
    find_noise(cover, sights, count, (wants & PL_CLOUD_TOPS) != 0, &noise);
  for (size_t i = 0; i < count; i++)
    out[i] = place_by(cover, &sights[i], wants, &noise, i);
}

pl_cloud_place pl_cloud_place_at(const pl_cloud_cover *cover, pl_vec3 point, pl_vec3 across,
                                 pl_vec3 along, unsigned wants) {
  const pl_cloud_spot spot = {point, across, along};
  pl_cloud_place out;
  pl_cloud_places(cover, &spot, 1, wants, &out);
  return out;
}

float pl_cloud_cover_at(const pl_cloud_cover *cover, pl_vec3 point, pl_vec3 across, pl_vec3 along) {
  return pl_cloud_place_at(cover, point, across, along, 0).cover;
}

double pl_clouds_detail_error(const pl_clouds *clouds, int detail, double width_m) {
  float amplitudes[PL_FRACTAL_OCTAVES];
  double total = 0.0, left = 0.0, variance = 0.0, known = 0.0, frequency = 1.0;
  if (!pl_clouds_noisy(clouds))
    return 0.0;
  const int count = list_octaves(clouds, amplitudes);
  for (int i = 0; i < count; i++) {
    const double a = (double)amplitudes[i];
    const bool hidden = frequency * width_m >= (double)PL_NOISE_WIDEST * clouds->size_m;
    total += a;
    variance += a * a;
    left += i >= detail && !hidden ? a : 0.0;
    known += i >= detail && !hidden ? 0.0 : a * a;
    frequency *= 2.0;
  }
  if (left == 0.0)
    return 0.0;
  /* The normal distribution function changes by at most 1/sqrt(2 pi) per standard deviation, and a
   * change of the standard deviation by the factor e^x changes it by at most 0.242 x, where 0.242
   * is the maximum of t phi(t). The narrowest distribution has the softness only; the widest also
   * has the variance of all omitted octaves. */
  const double sigma = sqrt(PL_NOISE_VARIANCE), soft = (double)clouds->softness;
  const double edge = soft * soft * variance;
  const double narrow = sqrt(edge) * sigma, wide = sqrt(edge + variance - known) * sigma;
  return fmin(1.0, left / (narrow * sqrt(2.0 * PL_PI)) + 0.242 * log(wide / narrow));
}

float pl_cloud_reflected(float depth, float mu) {
  const float scaled = (1.0f - PL_CLOUD_G * PL_CLOUD_G) * depth;
  const float g = PL_CLOUD_G / (1.0f + PL_CLOUD_G);
  const float g1 = 0.75f * (1.0f - g), g3 = 0.5f - 0.75f * g * mu;
  return (g1 * scaled - (g3 - g1 * mu) * expm1f(-scaled / mu)) / (1.0f + g1 * scaled);
}

float pl_cloud_straight(float depth, float mu) { return expf(-depth / mu); }
