/* Patterns of unit cells: white noise and checker. */
#include "math/pattern.h"
#include "shade/node_pattern.h"
#include "shade/node_rows.h"

/* z = 0, as of texture coordinates, would lie on the boundary of two layers of cells: it is moved
 * to the middle of one. */
static void place_of(const pl_node_call *call, pl_pattern_place *out) {
  pl_pattern_place_of(call, out);
  for (size_t i = 0; i < PL_LANES; i++)
    out->point.at[2][i] = out->point.at[2][i] == 0.0 ? 0.5 : out->point.at[2][i];
}

static void white_noise(const pl_node_call *call) {
  pl_pattern_place place;
  const uint32_t seed = pl_pattern_seed(call, 0);
  place_of(call, &place);
  for (size_t i = 0; i < call->count; i++)
    pl_lane_scalar(call->out[0], i,
                   pl_white_noise(pl_pattern_point(&place, i), place.side[i], seed));
  pl_lanes_fill(call->out[0], call->count);
}

static const pl_socket white_inputs[] = {PL_PATTERN_VECTOR};
static const pl_socket white_outputs[] = {
    {"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Uniform in 0..1, one a cell"}};
static const pl_constant_row white_constants[] = {PL_PATTERN_SEED};

const pl_node_kind pl_node_white_noise = {
    .name = "white_noise",
    .doc = "One random number a cell, averaged over the footprint; z = 0 is the middle of cells",
    .inputs = white_inputs,
    .input_count = 2,
    .outputs = white_outputs,
    .output_count = 1,
    .constants = white_constants,
    .constant_count = 1,
    .evaluate = white_noise,
};

static void checker(const pl_node_call *call) {
  pl_pattern_place place;
  place_of(call, &place);
  for (size_t i = 0; i < call->count; i++) {
    const float x = pl_checker(pl_pattern_point(&place, i), place.side[i]);
    const pl_vec3f b = pl_lane_vec(*call->in[3], i);
    const pl_vec3f change = pl_vec3f_sub(pl_lane_vec(*call->in[2], i), b);
    pl_lane_vector(call->out[0], i, pl_vec3f_madd(b, x, change), 0.0f);
    pl_lane_scalar(call->out[1], i, x);
  }
  pl_lanes_fill(call->out[0], call->count);
  pl_lanes_fill(call->out[1], call->count);
}

static const pl_socket checker_inputs[] = {
    PL_PATTERN_VECTOR,
    {"a", PL_COLOR, {0.8f, 0.8f, 0.8f}, "Colour of cells with an even sum of indices"},
    {"b", PL_COLOR, {0.2f, 0.2f, 0.2f}, "Colour of the others"},
};
static const pl_socket checker_outputs[] = {
    {"color", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Mean over the footprint"},
    {"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Fraction of a in the footprint"}};

const pl_node_kind pl_node_checker = {
    .name = "checker",
    .doc =
        "Cubes of two colours in turn, averaged over the footprint; z = 0 is the middle of cubes",
    .inputs = checker_inputs,
    .input_count = 4,
    .outputs = checker_outputs,
    .output_count = 2,
    .evaluate = checker,
};
