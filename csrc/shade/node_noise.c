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

static pl_fractal shape_of(const pl_node_call *call, size_t seed) {
  return (pl_fractal){.octaves = call->in[OCTAVES][0],
                      .roughness = call->in[ROUGHNESS][0],
                      .lacunarity = call->in[LACUNARITY][0],
                      .seed = pl_pattern_seed(call, seed)};
}

static float finite_or(float x, float other) { return isfinite(x) ? x : other; }

static void noise(const pl_node_call *call) {
  const pl_pattern_place place = pl_pattern_place_of(call);
  const pl_fractal shape = shape_of(call, 0);
  const float x = pl_fractal_rows[PL_FRACTAL_FBM].evaluate(&shape, place.point, place.width);
  pl_value_scalar(call->out[0], finite_or(0.5f + 0.5f * x, 0.5f));
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
};

/* In the order of pl_fractal_kind, whose rows have the same names (a test compares them). */
static const char *const fractals[] = {"fbm",    "multifractal", "hetero_terrain",
                                       "ridged", "hybrid",       NULL};

static void musgrave(const pl_node_call *call) {
  const pl_pattern_place place = pl_pattern_place_of(call);
  pl_fractal shape = shape_of(call, 1);
  shape.offset = call->in[OFFSET][0];
  shape.gain = call->in[GAIN][0];
  const pl_fractal_row *row = &pl_fractal_rows[(int)call->constants[0].number];
  pl_value_scalar(call->out[0], finite_or(row->evaluate(&shape, place.point, place.width), 0.0f));
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
};
