#include "math/fractal.h"

#include <string.h>

#include "base/work.h"
#include "math/lattice.h"

/* Distribution of |noise| as 8 values of equal weight, the means of its octiles; measured with 4e5
 * points. Used in place of an unresolved octave where it enters a clamp. */
#define NODES 8
static const float MAGNITUDE[NODES] = {0.0184f, 0.0564f, 0.0957f, 0.1377f,
                                       0.1834f, 0.2340f, 0.2974f, 0.4176f};

/* Iterator over the octaves from coarse to fine. */
typedef struct walk {
  const pl_fractal *fractal;
  float octaves;
  int index;              /* of the current octave; -1 before the first */
  double scale;           /* frequency of the octave */
  float power, amplitude; /* roughness^index; power times the fraction of a partial last octave */
} walk;

static inline walk begin(const pl_fractal *fractal) {
  const float most = pl_minf(pl_maxf(fractal->octaves, 1.0f), (float)PL_FRACTAL_OCTAVES);
  return (walk){.fractal = fractal, .octaves = most, .index = -1};
}

/* Advances to the next octave; false after the last. */
static inline bool next(walk *w) {
  w->index++;
  const float part = pl_minf(w->octaves - (float)w->index, 1.0f);
  if (!(part > 0.0f))
    return false;
  w->scale = w->index == 0 ? 1.0 : w->scale * (double)w->fractal->lacunarity;
  w->power = w->index == 0 ? 1.0f : w->power * w->fractal->roughness;
  w->amplitude = w->power * part;
  return true;
}

/* Factor of the footprint's filter on the current octave. */
PL_WIDE_PART float kept_of(const walk *w, float width) {
  return pl_noise_fade(width * (float)fabs(w->scale));
}

/* Where the current octave evaluates the noise, and its seed: it is scaled, and moved. */
typedef struct octave_place {
  double scale, offset[3];
  uint32_t seed;
} octave_place;

static inline octave_place place_of(const walk *w) {
  const uint32_t seed = pl_lattice_hash(pl_sampler_mix(w->fractal->seed), (uint32_t)w->index);
  return (octave_place){.scale = w->scale,
                        .offset = {(double)pl_lattice_uniform(seed, 0),
                                   (double)pl_lattice_uniform(seed, 1),
                                   (double)pl_lattice_uniform(seed, 2)},
                        .seed = seed};
}

static inline pl_vec3 placed(const octave_place *to, pl_vec3 point) {
  return pl_vec3_make(point.x * to->scale + to->offset[0], point.y * to->scale + to->offset[1],
                      point.z * to->scale + to->offset[2]);
}

/* A point is evaluated with an octave in each lane if it has as many that the footprint shows: the
 * run takes as long as three points alone. */
enum { FEW_OCTAVES = 4 };

/* Noise of the octaves at one point; of those that the footprint hides it may be anything. */
typedef struct octaves {
  float value[PL_FRACTAL_OCTAVES], gradient[3][PL_FRACTAL_OCTAVES];
} octaves;

/* Frequencies of the octaves, and up to which of them the footprint shows any. */
typedef struct spectrum {
  double scale[PL_FRACTAL_OCTAVES];
  bool seen[PL_FRACTAL_OCTAVES];
  uint32_t last; /* behind the last that is seen */
  int count;     /* of those seen */
} spectrum;

static inline void find_spectrum(const pl_fractal *fractal, float width, spectrum *out) {
  *out = (spectrum){.count = 0};
  for (walk w = begin(fractal); next(&w);) {
    out->scale[w.index] = w.scale;
    out->seen[w.index] = kept_of(&w, width) > 0.0f;
    if (!out->seen[w.index])
      continue;
    out->last = (uint32_t)w.index + 1;
    out->count++;
  }
}

/* place_of octaves `first` and on, one in each lane. */
PL_WIDE static void place_octaves(const pl_fractal *fractal, pl_vec3 point, uint32_t first,
                                  const double scale[restrict PL_LANES],
                                  pl_point_lanes *restrict at, uint32_t seed[restrict PL_LANES]) {
  const uint32_t start = pl_sampler_mix(fractal->seed);
  PL_EACH_LANE(i) {
    seed[i] = pl_lattice_hash(start, first + (uint32_t)i);
    at->at[0][i] = point.x * scale[i] + (double)pl_lattice_uniform(seed[i], 0);
    at->at[1][i] = point.y * scale[i] + (double)pl_lattice_uniform(seed[i], 1);
    at->at[2][i] = point.z * scale[i] + (double)pl_lattice_uniform(seed[i], 2);
  }
}

static void find_octaves(const pl_fractal *fractal, pl_vec3 point, const spectrum *s, bool sloped,
                         octaves *out) {
  uint32_t seed[PL_LANES];
  pl_point_lanes at;
  pl_work_add(PL_WORK_noise_octaves, s->last);
  for (uint32_t first = 0; first < s->last; first += PL_LANES) {
    float gradient[3][PL_LANES];
    place_octaves(fractal, point, first, s->scale + first, &at, seed);
    if (!sloped) {
      pl_noise_seeds_lanes(&at, seed, out->value + first);
      continue;
    }
    pl_noise_gradient_seeds_lanes(&at, seed, out->value + first, gradient);
    for (int axis = 0; axis < 3; axis++)
      memcpy(out->gradient[axis] + first, gradient[axis], sizeof gradient[axis]);
  }
}

static float value_at(const walk *w, pl_vec3 point) {
  const octave_place to = place_of(w);
  return pl_noise(placed(&to, point), to.seed);
}

static pl_noise_value gradient_at(const walk *w, pl_vec3 point) {
  const octave_place to = place_of(w);
  return pl_noise_gradient(placed(&to, point), to.seed);
}

static pl_noise_value octave_of(const octaves *found, int i) {
  return (pl_noise_value){found->value[i],
                          {found->gradient[0][i], found->gradient[1][i], found->gradient[2][i]}};
}

pl_fractal_value pl_fractal_gradient(const pl_fractal *fractal, pl_vec3 point, float width) {
  pl_fractal_value result = {0};
  float total = 0.0f;
  spectrum s;
  octaves found;
  find_spectrum(fractal, width, &s);
  const bool many = s.count >= FEW_OCTAVES;
  if (many)
    find_octaves(fractal, point, &s, true, &found);
  for (walk w = begin(fractal); next(&w);) {
    const float kept = kept_of(&w, width);
    total += fabsf(w.amplitude);
    const float amplitude = w.amplitude * kept;
    result.lost_variance +=
        (w.amplitude * w.amplitude - amplitude * amplitude) * (float)PL_NOISE_VARIANCE;
    if (!(kept > 0.0f))
      continue;
    const pl_noise_value noise = many ? octave_of(&found, w.index) : gradient_at(&w, point);
    result.value += amplitude * noise.value;
    result.gradient = pl_vec3f_madd(result.gradient, amplitude * (float)w.scale, noise.gradient);
  }
  result.value /= total;
  result.gradient = pl_vec3f_scale(result.gradient, 1.0f / total);
  result.lost_variance /= total * total;
  return result;
}

/* What an octave changes at a point: the value so far, and the weight of the next octave.
 * `noise`: of the octave, not faded; 0 if the footprint hides it. `faded`: kept may be below 1. */
typedef struct sum {
  float value, weight;
} sum;
typedef sum (*step_fn)(const walk *w, sum s, float kept, float noise, bool faded);

PL_WIDE_PART sum fbm(const walk *w, sum s, float kept, float noise, bool faded) {
  (void)faded;
  return (sum){s.value + w->amplitude * kept * noise, s.weight};
}

PL_WIDE_PART sum multifractal(const walk *w, sum s, float kept, float noise, bool faded) {
  (void)faded;
  return (sum){s.value * (1.0f + w->amplitude * kept * noise), s.weight};
}

PL_WIDE_PART sum hetero_terrain(const walk *w, sum s, float kept, float noise, bool faded) {
  (void)faded;
  const float height = kept * noise + w->fractal->offset;
  return (sum){w->index == 0 ? s.value + height : s.value + height * w->amplitude * s.value,
               s.weight};
}

PL_WIDE_PART float clamp01(float x) { return pl_minf(pl_maxf(x, 0.0f), 1.0f); }
PL_WIDE_PART float square(float x) { return x * x; }

PL_WIDE_PART sum ridged(const walk *w, sum s, float kept, float noise, bool faded) {
  const float offset = w->fractal->offset, gain = w->fractal->gain;
  const float ridge = square(offset - fabsf(noise)) * s.weight;
  float mean = 0.0f, mean_weight = 0.0f;
#pragma GCC unroll 8
  for (int i = 0; faded && i < NODES; i++) {
    const float node = square(offset - MAGNITUDE[i]) * s.weight;
    mean += node * (1.0f / NODES);
    mean_weight += clamp01(gain * node) * (1.0f / NODES);
  }
  mean = kept < 1.0f ? mean : 0.0f;
  mean_weight = kept < 1.0f ? mean_weight : 0.0f;
  return (sum){s.value + w->amplitude * (mean + kept * (ridge - mean)),
               mean_weight + kept * (clamp01(gain * ridge) - mean_weight)};
}

PL_WIDE_PART sum hybrid(const walk *w, sum s, float kept, float noise, bool faded) {
  const float offset = w->fractal->offset, gain = w->fractal->gain;
  const float step = s.weight * gain * w->amplitude;
  float mean = 0.0f;
#pragma GCC unroll 8
  for (int i = 0; faded && i < NODES; i++)
    mean += (pl_minf(step * (offset + MAGNITUDE[i]), 1.0f) +
             pl_minf(step * (offset - MAGNITUDE[i]), 1.0f)) *
            (0.5f / NODES);
  mean = kept < 1.0f ? mean : 0.0f;
  return (sum){s.value + s.weight * (kept * noise + offset) * w->amplitude,
               mean + kept * (pl_minf(step * (offset + noise), 1.0f) - mean)};
}

/* Partial derivatives of a step: of the value by the value before, by the
 * weight before and by the noise; of the weight by the weight before and by the noise. */
typedef struct partials {
  float value, weight, noise, weight_weight, weight_noise;
} partials;
typedef partials (*partials_fn)(const walk *w, sum s, float kept, float noise, bool faded);

PL_WIDE_PART partials fbm_partials(const walk *w, sum s, float kept, float noise, bool faded) {
  (void)faded;
  (void)s;
  (void)noise;
  return (partials){.value = 1.0f, .noise = w->amplitude * kept};
}

PL_WIDE_PART partials multifractal_partials(const walk *w, sum s, float kept, float noise,
                                            bool faded) {
  (void)faded;
  return (partials){.value = 1.0f + w->amplitude * kept * noise,
                    .noise = s.value * w->amplitude * kept};
}

PL_WIDE_PART partials hetero_terrain_partials(const walk *w, sum s, float kept, float noise,
                                              bool faded) {
  (void)faded;
  const float height = kept * noise + w->fractal->offset;
  return w->index == 0 ? (partials){.value = 1.0f, .noise = kept}
                       : (partials){.value = 1.0f + height * w->amplitude,
                                    .noise = kept * w->amplitude * s.value};
}

PL_WIDE_PART partials ridged_partials(const walk *w, sum s, float kept, float noise, bool faded) {
  const float offset = w->fractal->offset, gain = w->fractal->gain;
  const float ridge = square(offset - fabsf(noise));
  const float slope = 2.0f * (fabsf(noise) - offset) * (noise < 0.0f ? -1.0f : 1.0f) * s.weight;
  float mean = 0.0f, mean_weight = 0.0f;
#pragma GCC unroll 8
  for (int i = 0; faded && i < NODES; i++) {
    const float node = square(offset - MAGNITUDE[i]), passed = gain * node * s.weight;
    mean += node * (1.0f / NODES);
    mean_weight += passed > 0.0f && passed < 1.0f ? gain * node * (1.0f / NODES) : 0.0f;
  }
  const float passed = gain * ridge * s.weight;
  const float open = passed > 0.0f && passed < 1.0f ? kept * gain : 0.0f;
  return (partials){.value = 1.0f,
                    .weight = w->amplitude * ((1.0f - kept) * mean + kept * ridge),
                    .noise = w->amplitude * kept * slope,
                    .weight_weight = (1.0f - kept) * mean_weight + open * ridge,
                    .weight_noise = open * slope};
}

PL_WIDE_PART partials hybrid_partials(const walk *w, sum s, float kept, float noise, bool faded) {
  const float offset = w->fractal->offset, amplitude = w->fractal->gain * w->amplitude;
  float mean = 0.0f;
#pragma GCC unroll 8
  for (int i = 0; faded && i < NODES; i++) {
    const float high = amplitude * (offset + MAGNITUDE[i]),
                low = amplitude * (offset - MAGNITUDE[i]);
    mean += ((s.weight * high < 1.0f ? high : 0.0f) + (s.weight * low < 1.0f ? low : 0.0f)) *
            (0.5f / NODES);
  }
  const float step = amplitude * (offset + noise), open = s.weight * step < 1.0f ? kept : 0.0f;
  return (partials){.value = 1.0f,
                    .weight = (kept * noise + offset) * w->amplitude,
                    .noise = s.weight * kept * w->amplitude,
                    .weight_weight = (1.0f - kept) * mean + open * step,
                    .weight_noise = open * amplitude * s.weight};
}

/* Sums the octaves at a point; `start`: the value before the first. `total`: of the amplitudes. */
PL_WIDE_PART float add_octaves(step_fn step, const pl_fractal *fractal, float start, pl_vec3 point,
                               float width, float *total) {
  sum s = {start, 1.0f};
  spectrum shown;
  octaves found;
  find_spectrum(fractal, width, &shown);
  const bool many = shown.count >= FEW_OCTAVES;
  if (many)
    find_octaves(fractal, point, &shown, false, &found);
  *total = 0.0f;
  for (walk w = begin(fractal); next(&w);) {
    const float kept = kept_of(&w, width);
    float noise = 0.0f;
    if (shown.seen[w.index])
      noise = many ? found.value[w.index] : value_at(&w, point);
    s = step(&w, s, kept, noise, kept < 1.0f);
    *total += fabsf(w.amplitude);
  }
  return s.value;
}

PL_WIDE_PART void place_lanes(const octave_place *to, const pl_point_lanes *points,
                              pl_point_lanes *out) {
  for (size_t axis = 0; axis < 3; axis++)
    PL_EACH_LANE(i) out->at[axis][i] = points->at[axis][i] * to->scale + to->offset[axis];
}

/* Noise of the current octave in all lanes; 0 where the footprint hides it. */
PL_WIDE_PART void find_octave(const walk *w, const pl_point_lanes *points,
                              const float *restrict kept, float *restrict noise) {
  const octave_place to = place_of(w);
  pl_point_lanes at;
  place_lanes(&to, points, &at);
  pl_noise_lanes(&at, to.seed, noise);
  PL_EACH_LANE(i) noise[i] = kept[i] > 0.0f ? noise[i] : 0.0f;
}

PL_WIDE_PART void step_lanes(step_fn step, const walk *w, bool faded, const float *restrict kept,
                             const float *restrict noise, float *restrict value,
                             float *restrict weight) {
  PL_EACH_LANE(i) {
    const sum s = step(w, (sum){value[i], weight[i]}, kept[i], noise[i], faded);
    value[i] = s.value;
    weight[i] = s.weight;
  }
}

/* As add_octaves, of all lanes. */
PL_WIDE_PART float add_octaves_lanes(step_fn step, const pl_fractal *fractal, float start,
                                     const pl_point_lanes *points, const float *restrict width,
                                     float *restrict value) {
  float weight[PL_LANES], kept[PL_LANES], noise[PL_LANES] = {0.0f}, total = 0.0f;
  PL_EACH_LANE(i) {
    value[i] = start;
    weight[i] = 1.0f;
  }
  for (walk w = begin(fractal); next(&w);) {
    int seen = 0, faded = 0;
    PL_EACH_LANE(i) {
      kept[i] = kept_of(&w, width[i]);
      seen |= kept[i] > 0.0f ? 1 : 0;
      faded |= kept[i] < 1.0f ? 1 : 0;
    }
    if (seen != 0)
      find_octave(&w, points, kept, noise);
    if (faded != 0)
      step_lanes(step, &w, true, kept, noise, value, weight);
    else
      step_lanes(step, &w, false, kept, noise, value, weight);
    total += fabsf(w.amplitude);
  }
  return total;
}

/* Value, weight and their gradients so far, in all lanes. */
typedef struct sloped {
  float value[PL_LANES], weight[PL_LANES], slope[3][PL_LANES], weight_slope[3][PL_LANES];
} sloped;

PL_WIDE_PART void step_gradient(step_fn step, partials_fn partials_of, const walk *w, bool faded,
                                const float *restrict kept, const float *restrict noise,
                                float (*restrict gradient)[PL_LANES], sloped *restrict s) {
  const float scale = (float)w->scale;
  PL_EACH_LANE(i) {
    const sum before = {s->value[i], s->weight[i]};
    const partials p = partials_of(w, before, kept[i], noise[i], faded);
    const sum after = step(w, before, kept[i], noise[i], faded);
    const float seen = kept[i] > 0.0f ? scale : 0.0f;
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; axis++) {
      const float by_noise = seen * gradient[axis][i], by_weight = s->weight_slope[axis][i];
      s->slope[axis][i] = p.value * s->slope[axis][i] + p.weight * by_weight + p.noise * by_noise;
      s->weight_slope[axis][i] = p.weight_weight * by_weight + p.weight_noise * by_noise;
    }
    s->value[i] = after.value;
    s->weight[i] = after.weight;
  }
}

/* As add_octaves_lanes, with gradients. */
PL_WIDE_PART float add_gradients(step_fn step, partials_fn partials_of, const pl_fractal *fractal,
                                 float start, const pl_point_lanes *points,
                                 const float *restrict width, sloped *restrict s) {
  float kept[PL_LANES], noise[PL_LANES], gradient[3][PL_LANES], total = 0.0f;
  *s = (sloped){.value = {0.0f}};
  PL_EACH_LANE(i) {
    s->value[i] = start;
    s->weight[i] = 1.0f;
  }
  for (walk w = begin(fractal); next(&w);) {
    const octave_place to = place_of(&w);
    pl_point_lanes at;
    int faded = 0;
    PL_EACH_LANE(i) {
      kept[i] = kept_of(&w, width[i]);
      faded |= kept[i] < 1.0f ? 1 : 0;
    }
    place_lanes(&to, points, &at);
    pl_noise_gradient_lanes(&at, to.seed, noise, gradient);
    PL_EACH_LANE(i) noise[i] = kept[i] > 0.0f ? noise[i] : 0.0f;
    if (faded != 0)
      step_gradient(step, partials_of, &w, true, kept, noise, gradient, s);
    else
      step_gradient(step, partials_of, &w, false, kept, noise, gradient, s);
    total += fabsf(w.amplitude);
  }
  return total;
}

/* A kind at one point, in all lanes, and with gradients; `result` is linear. */
#define PL_KIND(kind, start, result)                                                               \
  static float kind##_at(const pl_fractal *fractal, pl_vec3 point, float width) {                  \
    float total;                                                                                   \
    const float value = add_octaves(kind, fractal, start, point, width, &total);                   \
    (void)total;                                                                                   \
    return result;                                                                                 \
  }                                                                                                \
  PL_WIDE static void kind##_lanes(const pl_fractal *fractal, const pl_point_lanes *points,        \
                                   const float width[PL_LANES], float out[PL_LANES]) {             \
    float values[PL_LANES];                                                                        \
    const float total = add_octaves_lanes(kind, fractal, start, points, width, values);            \
    (void)total;                                                                                   \
    PL_EACH_LANE(i) {                                                                              \
      const float value = values[i];                                                               \
      out[i] = result;                                                                             \
    }                                                                                              \
  }                                                                                                \
  PL_WIDE static void kind##_gradient(const pl_fractal *fractal, const pl_point_lanes *points,     \
                                      const float width[PL_LANES], float out[PL_LANES],            \
                                      float gradient[3][PL_LANES]) {                               \
    sloped s;                                                                                      \
    const float total = add_gradients(kind, kind##_partials, fractal, start, points, width, &s);   \
    (void)total;                                                                                   \
    PL_EACH_LANE(i) {                                                                              \
      float value = s.value[i];                                                                    \
      out[i] = result;                                                                             \
      value = s.slope[0][i];                                                                       \
      gradient[0][i] = result;                                                                     \
      value = s.slope[1][i];                                                                       \
      gradient[1][i] = result;                                                                     \
      value = s.slope[2][i];                                                                       \
      gradient[2][i] = result;                                                                     \
    }                                                                                              \
  }
PL_KIND(fbm, 0.0f, value / total)
PL_KIND(multifractal, 1.0f, value)
PL_KIND(hetero_terrain, 0.0f, value)
PL_KIND(ridged, 0.0f, value)
PL_KIND(hybrid, 0.0f, value)

#define PL_EVALUATES(kind) kind##_at, kind##_lanes, kind##_gradient
const pl_fractal_row pl_fractal_rows[PL_FRACTAL_KINDS] = {
    [PL_FRACTAL_FBM] = {"fbm", "Sum of octaves: evenly rough everywhere", PL_EVALUATES(fbm)},
    [PL_FRACTAL_MULTIFRACTAL] = {"multifractal", "Product of octaves: rough where it is high",
                                 PL_EVALUATES(multifractal)},
    [PL_FRACTAL_HETERO_TERRAIN] = {"hetero_terrain", "Smooth valleys, rough heights",
                                   PL_EVALUATES(hetero_terrain)},
    [PL_FRACTAL_RIDGED] = {"ridged", "Sharp ridges, each carrying finer ones",
                           PL_EVALUATES(ridged)},
    [PL_FRACTAL_HYBRID] = {"hybrid", "Smooth plains, rough peaks", PL_EVALUATES(hybrid)},
};
