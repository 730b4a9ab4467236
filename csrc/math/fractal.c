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

pl_fractal_value pl_fractal_gradient(const pl_fractal *fractal, pl_vec3 point, float width) {
  pl_fractal_value result = {0};
  float total = 0.0f;
  for (walk w = begin(fractal); next(&w);) {
    const float kept = kept_of(&w, width);
    total += fabsf(w.amplitude);
    const float amplitude = w.amplitude * kept;
    result.lost_variance +=
        (w.amplitude * w.amplitude - amplitude * amplitude) * (float)PL_NOISE_VARIANCE;
    if (!(kept > 0.0f))
      continue;
    const octave_place to = place_of(&w);
    const pl_noise_value noise = pl_noise_gradient(placed(&to, point), to.seed);
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

/* Sums the octaves at a point; `start`: the value before the first. `total`: of the amplitudes. */
PL_WIDE_PART float add_octaves(step_fn step, const pl_fractal *fractal, float start, pl_vec3 point,
                               float width, float *total) {
  sum s = {start, 1.0f};
  *total = 0.0f;
  for (walk w = begin(fractal); next(&w);) {
    const float kept = kept_of(&w, width);
    const octave_place to = place_of(&w);
    const float noise = kept > 0.0f ? pl_noise(placed(&to, point), to.seed) : 0.0f;
    s = step(&w, s, kept, noise, kept < 1.0f);
    *total += fabsf(w.amplitude);
  }
  return s.value;
}

/* Noise of the current octave in all lanes; 0 where the footprint hides it. */
PL_WIDE_PART void find_octave(const walk *w, const pl_point_lanes *points,
                              const float *restrict kept, float *restrict noise) {
  const octave_place to = place_of(w);
  pl_point_lanes at;
  for (size_t axis = 0; axis < 3; axis++)
    PL_EACH_LANE(i) at.at[axis][i] = points->at[axis][i] * to.scale + to.offset[axis];
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

/* A kind at one point and in all lanes. */
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
  }
PL_KIND(fbm, 0.0f, value / total)
PL_KIND(multifractal, 1.0f, value)
PL_KIND(hetero_terrain, 0.0f, value)
PL_KIND(ridged, 0.0f, value)
PL_KIND(hybrid, 0.0f, value)

#define PL_EVALUATES(kind) kind##_at, kind##_lanes
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
