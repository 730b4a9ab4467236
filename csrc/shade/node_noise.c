/* Noise: octaves of gradient noise, and Musgrave's fractals. */
#include "math/fractal.h"
#include "shade/node_pattern.h"
#include "shade/node_rows.h"

enum { OCTAVES = 2, ROUGHNESS, LACUNARITY, OFFSET, GAIN };

#define SHAPE_INPUTS                                                                               \
  PL_PATTERN_VECTOR, {"octaves", PL_SCALAR, {4.0f, 4.0f, 4.0f}, "1..16; parts of one count"},      \
      {"roughness", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "Amplitude of an octave by the one before"}, {  \
    "lacunarity", PL_SCALAR, {2.0f, 2.0f, 2.0f}, "Frequency of an octave by the one before"        \
  }

static pl_fractal shape_of(const pl_node_call *call, uint32_t seed, size_t lane) {
  return (pl_fractal){.octaves = pl_node_number(call, OCTAVES, lane),
                      .roughness = pl_node_number(call, ROUGHNESS, lane),
                      .lacunarity = pl_node_number(call, LACUNARITY, lane),
                      .offset =
                          call->in[OFFSET] != NULL ? pl_node_number(call, OFFSET, lane) : 0.0f,
                      .gain = call->in[GAIN] != NULL ? pl_node_number(call, GAIN, lane) : 0.0f,
                      .seed = seed};
}

/* The fractal in all lanes: together if they have one shape, and one by one otherwise. */
static void fractal_of(const pl_node_call *call, const pl_fractal_row *row, uint32_t seed,
                       unsigned shaped, float out[PL_LANES]) {
  pl_pattern_place place;
  pl_pattern_place_of(call, &place);
  const pl_fractal shape = shape_of(call, seed, 0);
  if ((call->uniform & shaped) == shaped) {
    row->evaluate_lanes(&shape, &place.point, place.width, out);
    return;
  }
  for (size_t i = 0; i < call->count; i++) {
    const pl_fractal own = shape_of(call, seed, i);
    out[i] = row->evaluate(&own, pl_pattern_point(&place, i), place.width[i]);
  }
  for (size_t i = call->count; i < PL_LANES; i++)
    out[i] = out[0];
}

/* Fractals of one shape in all lanes alone have gradients, and only along the coordinates. */
static void gradient_of(const pl_node_call *call, const pl_fractal_row *row, uint32_t seed,
                        float out[PL_LANES], float gradient[3][PL_LANES]) {
  pl_pattern_place place;
  pl_pattern_place_of(call, &place);
  const pl_fractal shape = shape_of(call, seed, 0);
  row->gradient_lanes(&shape, &place.point, place.width, out, gradient);
}

static float finite_or(float x, float other) { return isfinite(x) ? x : other; }

static const unsigned NOISE_SHAPED = 1u << OCTAVES | 1u << ROUGHNESS | 1u << LACUNARITY;

static void noise(const pl_node_call *call) {
  float value[PL_LANES];
  fractal_of(call, &pl_fractal_rows[PL_FRACTAL_FBM], pl_pattern_seed(call, 0), NOISE_SHAPED, value);
  PL_EACH_LANE(i) pl_lane_scalar(call->out[0], i, finite_or(0.5f + 0.5f * value[i], 0.5f));
}

static void noise_slopes(const pl_node_call *call) {
  float value[PL_LANES], gradient[3][PL_LANES];
  gradient_of(call, &pl_fractal_rows[PL_FRACTAL_FBM], pl_pattern_seed(call, 0), value, gradient);
  PL_EACH_LANE(i) {
    pl_lane_scalar(call->out[0], i, finite_or(0.5f + 0.5f * value[i], 0.5f));
    for (int axis = 0; axis < 3; axis++)
      gradient[axis][i] *= 0.5f;
  }
  pl_pattern_slopes(call, (const float(*)[PL_LANES])gradient);
}

static bool noise_has_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  (void)constants;
  (void)read;
  return (uniform & NOISE_SHAPED) == NOISE_SHAPED;
}

static const pl_socket noise_inputs[] = {SHAPE_INPUTS};
static const pl_socket noise_outputs[] = {{"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "0..1"}};
static const pl_constant_row noise_constants[] = {PL_PATTERN_SEED};

const pl_node_kind pl_node_noise = {
    .name = "noise",
    .doc = "Smooth random values, 0..1 about a mean of 1/2, to which they fade with the footprint",
    .inputs = noise_inputs,
    .input_count = 5,
    .outputs = noise_outputs,
    .output_count = 1,
    .constants = noise_constants,
    .constant_count = 1,
    .evaluate = noise,
    .evaluate_slopes = noise_slopes,
    .has_slopes = noise_has_slopes,
};

/* In the order of pl_fractal_kind, whose rows have the same names (a test compares them). */
static const char *const fractals[] = {"fbm",    "multifractal", "hetero_terrain",
                                       "ridged", "hybrid",       NULL};

static const unsigned MUSGRAVE_SHAPED =
    1u << OCTAVES | 1u << ROUGHNESS | 1u << LACUNARITY | 1u << OFFSET | 1u << GAIN;

static void musgrave(const pl_node_call *call) {
  const pl_fractal_row *row = &pl_fractal_rows[(int)call->constants[0].number];
  float value[PL_LANES];
  fractal_of(call, row, pl_pattern_seed(call, 1), MUSGRAVE_SHAPED, value);
  PL_EACH_LANE(i) pl_lane_scalar(call->out[0], i, finite_or(value[i], 0.0f));
}

static void musgrave_slopes(const pl_node_call *call) {
  const pl_fractal_row *row = &pl_fractal_rows[(int)call->constants[0].number];
  float value[PL_LANES], gradient[3][PL_LANES];
  gradient_of(call, row, pl_pattern_seed(call, 1), value, gradient);
  PL_EACH_LANE(i) pl_lane_scalar(call->out[0], i, finite_or(value[i], 0.0f));
  pl_pattern_slopes(call, (const float(*)[PL_LANES])gradient);
}

static bool musgrave_has_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  (void)constants;
  (void)read;
  return (uniform & MUSGRAVE_SHAPED) == MUSGRAVE_SHAPED;
}

static const pl_socket musgrave_inputs[] = {
    SHAPE_INPUTS,
    {"offset", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Added to each octave; not fbm, multifractal"},
    {"gain",
     PL_SCALAR,
     {2.0f, 2.0f, 2.0f},
     "How much octaves let finer ones through; ridged, "
     "hybrid"},
};
static const pl_socket musgrave_outputs[] = {{"value",
                                              PL_SCALAR,
                                              {0.0f, 0.0f, 0.0f},
                                              "fbm: -1..1 about 0; multifractal: about 1; others: "
                                              "about a mean that depends on the inputs"}};
static const pl_constant_row musgrave_constants[] = {
    {"fractal", PL_CHOICE, PL_FRACTAL_FBM, 0, 0, fractals, 0,
     "fbm: evenly rough; multifractal: rough where it is high; hetero_terrain: smooth valleys, "
     "rough heights; ridged: sharp ridges; hybrid: smooth plains, rough peaks"},
    PL_PATTERN_SEED};

const pl_node_kind pl_node_musgrave = {
    .name = "musgrave",
    .doc = "Musgrave's fractals of noise; octaves too fine for the footprint count as their mean",
    .inputs = musgrave_inputs,
    .input_count = 7,
    .outputs = musgrave_outputs,
    .output_count = 1,
    .constants = musgrave_constants,
    .constant_count = 2,
    .evaluate = musgrave,
    .evaluate_slopes = musgrave_slopes,
    .has_slopes = musgrave_has_slopes,
};
