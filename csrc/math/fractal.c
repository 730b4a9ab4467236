#include "math/fractal.h"

#include "math/lattice.h"

/* Distribution of |noise| as 8 values of equal weight, the means of its octiles; measured with 4e5
 * points. Used in place of an unresolved octave where it enters a clamp. */
#define NODES 8
static const float MAGNITUDE[NODES] = {0.0184f, 0.0564f, 0.0957f, 0.1377f,
                                       0.1834f, 0.2340f, 0.2974f, 0.4176f};

/* Iterator over the octaves from coarse to fine. */
typedef struct walk {
  const pl_fractal *fractal;
  pl_vec3 point;
  float width, octaves;
  int index;              /* of the current octave; -1 before the first */
  double scale;           /* frequency of the octave */
  float power, amplitude; /* roughness^index; power times the fraction of a partial last octave */
  float kept;             /* factor of the footprint's filter on the octave */
} walk;

static walk begin(const pl_fractal *fractal, pl_vec3 point, float width) {
  const float most = pl_minf(pl_maxf(fractal->octaves, 1.0f), (float)PL_FRACTAL_OCTAVES);
  return (walk){.fractal = fractal, .point = point, .width = width, .octaves = most, .index = -1};
}

/* Advances to the next octave; false after the last. */
static bool next(walk *w) {
  w->index++;
  const float part = pl_minf(w->octaves - (float)w->index, 1.0f);
  if (!(part > 0.0f))
    return false;
  w->scale = w->index == 0 ? 1.0 : w->scale * (double)w->fractal->lacunarity;
  w->power = w->index == 0 ? 1.0f : w->power * w->fractal->roughness;
  w->amplitude = w->power * part;
  w->kept = pl_noise_fade(w->width * (float)fabs(w->scale));
  return true;
}

/* Point and seed at which the current octave evaluates the noise. */
static pl_vec3 place(const walk *w, uint32_t *seed) {
  *seed = pl_lattice_hash(pl_sampler_mix(w->fractal->seed), (uint32_t)w->index);
  return pl_vec3_make(w->point.x * w->scale + (double)pl_lattice_uniform(*seed, 0),
                      w->point.y * w->scale + (double)pl_lattice_uniform(*seed, 1),
                      w->point.z * w->scale + (double)pl_lattice_uniform(*seed, 2));
}

/* Noise of the current octave, not faded; 0 if the footprint hides it. */
static float octave(const walk *w) {
  if (!(w->kept > 0.0f))
    return 0.0f;
  uint32_t seed;
  const pl_vec3 at = place(w, &seed);
  return pl_noise(at, seed);
}

static float fbm(const pl_fractal *fractal, pl_vec3 point, float width) {
  float sum = 0.0f, total = 0.0f;
  for (walk w = begin(fractal, point, width); next(&w);) {
    sum += w.amplitude * w.kept * octave(&w);
    total += fabsf(w.amplitude);
  }
  return sum / total;
}

pl_fractal_value pl_fractal_gradient(const pl_fractal *fractal, pl_vec3 point, float width) {
  pl_fractal_value result = {0};
  float total = 0.0f;
  for (walk w = begin(fractal, point, width); next(&w);) {
    total += fabsf(w.amplitude);
    const float amplitude = w.amplitude * w.kept;
    result.lost_variance +=
        (w.amplitude * w.amplitude - amplitude * amplitude) * (float)PL_NOISE_VARIANCE;
    if (!(w.kept > 0.0f))
      continue;
    uint32_t seed;
    const pl_vec3 at = place(&w, &seed);
    const pl_noise_value noise = pl_noise_gradient(at, seed);
    result.value += amplitude * noise.value;
    result.gradient = pl_vec3f_madd(result.gradient, amplitude * (float)w.scale, noise.gradient);
  }
  result.value /= total;
  result.gradient = pl_vec3f_scale(result.gradient, 1.0f / total);
  result.lost_variance /= total * total;
  return result;
}

static float multifractal(const pl_fractal *fractal, pl_vec3 point, float width) {
  float value = 1.0f;
  for (walk w = begin(fractal, point, width); next(&w);)
    value *= 1.0f + w.amplitude * w.kept * octave(&w);
  return value;
}

static float hetero_terrain(const pl_fractal *fractal, pl_vec3 point, float width) {
  float value = 0.0f;
  for (walk w = begin(fractal, point, width); next(&w);) {
    const float height = w.kept * octave(&w) + fractal->offset;
    value += w.index == 0 ? height : height * w.amplitude * value;
  }
  return value;
}

static inline float clamp01(float x) { return pl_minf(pl_maxf(x, 0.0f), 1.0f); }
static inline float square(float x) { return x * x; }

static float ridged(const pl_fractal *fractal, pl_vec3 point, float width) {
  const float offset = fractal->offset, gain = fractal->gain;
  float value = 0.0f, weight = 1.0f;
  for (walk w = begin(fractal, point, width); next(&w);) {
    const float ridge = square(offset - fabsf(octave(&w))) * weight;
    float mean = 0.0f, mean_weight = 0.0f;
    for (int i = 0; w.kept < 1.0f && i < NODES; i++) {
      const float node = square(offset - MAGNITUDE[i]) * weight;
      mean += node * (1.0f / NODES);
      mean_weight += clamp01(gain * node) * (1.0f / NODES);
    }
    value += w.amplitude * (mean + w.kept * (ridge - mean));
    weight = mean_weight + w.kept * (clamp01(gain * ridge) - mean_weight);
  }
  return value;
}

static float hybrid(const pl_fractal *fractal, pl_vec3 point, float width) {
  const float offset = fractal->offset, gain = fractal->gain;
  float value = 0.0f, weight = 1.0f;
  for (walk w = begin(fractal, point, width); next(&w);) {
    const float noise = octave(&w);
    value += weight * (w.kept * noise + offset) * w.amplitude;
    const float step = weight * gain * w.amplitude;
    float mean = 0.0f;
    for (int i = 0; w.kept < 1.0f && i < NODES; i++)
      mean += (pl_minf(step * (offset + MAGNITUDE[i]), 1.0f) +
               pl_minf(step * (offset - MAGNITUDE[i]), 1.0f)) *
              (0.5f / NODES);
    weight = mean + w.kept * (pl_minf(step * (offset + noise), 1.0f) - mean);
  }
  return value;
}

const pl_fractal_row pl_fractal_rows[PL_FRACTAL_KINDS] = {
    [PL_FRACTAL_FBM] = {"fbm", "Sum of octaves: evenly rough everywhere", fbm},
    [PL_FRACTAL_MULTIFRACTAL] = {"multifractal", "Product of octaves: rough where it is high",
                                 multifractal},
    [PL_FRACTAL_HETERO_TERRAIN] = {"hetero_terrain", "Smooth valleys, rough heights",
                                   hetero_terrain},
    [PL_FRACTAL_RIDGED] = {"ridged", "Sharp ridges, each carrying finer ones", ridged},
    [PL_FRACTAL_HYBRID] = {"hybrid", "Smooth plains, rough peaks", hybrid},
};
