/* Nodes with a constant number or colour, which drivers can set. */
#include <string.h>

#include "shade/node_rows.h"

static void pass(const pl_node_call *call) { memcpy(call->out[0], call->in[0], sizeof(pl_lanes)); }

static void pass_slopes(const pl_node_call *call) {
  pass(call);
  memcpy(call->out_slopes[0], call->in_slopes[0], sizeof(pl_slopes));
}

static const pl_socket number[] = {{"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "The number"}};
static const pl_socket color[] = {{"color", PL_COLOR, {0.5f, 0.5f, 0.5f}, "Linear RGB"}};

const pl_node_kind pl_node_value = {
    .name = "value",
    .doc = "A number, for several inputs or for a driver",
    .inputs = number,
    .input_count = 1,
    .outputs = number,
    .output_count = 1,
    .evaluate = pass,
    .evaluate_slopes = pass_slopes,
};

const pl_node_kind pl_node_color = {
    .name = "color",
    .doc = "A colour, for several inputs or for a driver",
    .inputs = color,
    .input_count = 1,
    .outputs = color,
    .output_count = 1,
    .evaluate = pass,
    .evaluate_slopes = pass_slopes,
};
