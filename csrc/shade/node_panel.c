/* Bricks, and solar cells with busbars and fingers, in the xy plane of the coordinates. */
#include "math/cellular.h"
#include "math/lattice.h"
#include "math/pattern.h"
#include "shade/node_pattern.h"
#include "shade/node_rows.h"

/* Random number of a brick or cell, which fades to the mean 1/2 as it gets smaller than the
 * footprint. */
static float random_of(uint32_t id, float width) {
  return 0.5f + pl_cellular_fade(width) * (pl_lattice_uniform(id, 0) - 0.5f);
}

static float positive(float x) { return x > 1e-9f ? x : 1e-9f; }

static void brick_at(const pl_node_call *call, const pl_pattern_place *place, size_t i) {
  const pl_vec3 point = pl_pattern_point(place, i);
  const float length = positive(pl_node_number(call, 2, i)),
              height = positive(pl_node_number(call, 3, i));
  const float joint = pl_node_number(call, 4, i);
  const pl_bricks bricks = {joint / length, joint / height, pl_node_number(call, 5, i)};
  const double u = point.x / (double)length, v = point.y / (double)height;
  const float cover =
      pl_brick_cover(&bricks, u, v, place->side[i] / length, place->side[i] / height);
  pl_lane_scalar(call->out[0], i, cover);
  pl_lane_scalar(call->out[1], i,
                 random_of(pl_brick_id(&bricks, u, v, pl_pattern_seed(call, 0)),
                           place->width[i] / pl_minf(length, height)));
}

/* Evaluates a pattern of `outputs` values in each lane. */
static void each_lane(const pl_node_call *call, size_t outputs,
                      void (*at)(const pl_node_call *, const pl_pattern_place *, size_t)) {
  pl_pattern_place place;
  pl_pattern_place_of(call, &place);
  for (size_t i = 0; i < call->count; i++)
    at(call, &place, i);
  for (size_t k = 0; k < outputs; k++)
    pl_lanes_fill(call->out[k], call->count);
}

static void brick(const pl_node_call *call) { each_lane(call, 2, brick_at); }

static const pl_socket brick_inputs[] = {
    PL_PATTERN_VECTOR,
    {"length", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Of a brick with its joint, along x"},
    {"height", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "Of a row with its joint, along y"},
    {"joint", PL_SCALAR, {0.04f, 0.04f, 0.04f}, "Width of joints"},
    {"shift", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "Of every second row, in bricks"},
};
static const pl_socket brick_outputs[] = {
    {"cover", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Fraction of the footprint that is brick, not joint"},
    {"random", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Uniform in 0..1, one a brick"}};
static const pl_constant_row seed_constants[] = {PL_PATTERN_SEED};

const pl_node_kind pl_node_brick = {
    .name = "brick",
    .doc = "Rows of bricks or tiles with joints, averaged over the footprint",
    .inputs = brick_inputs,
    .input_count = 6,
    .outputs = brick_outputs,
    .output_count = 2,
    .constants = seed_constants,
    .constant_count = 1,
    .evaluate = brick,
};

static void panel_at(const pl_node_call *call, const pl_pattern_place *place, size_t i) {
  const pl_vec3 point = pl_pattern_point(place, i);
  const float length = positive(pl_node_number(call, 2, i)),
              height = positive(pl_node_number(call, 3, i));
  const float gap = pl_node_number(call, 4, i);
  const pl_panel cells = {.gap_u = gap / length,
                          .gap_v = gap / height,
                          .busbars = pl_node_number(call, 5, i),
                          .busbar_width = pl_node_number(call, 6, i) / length,
                          .fingers = pl_node_number(call, 7, i),
                          .finger_width = pl_node_number(call, 8, i) / height};
  const double u = point.x / (double)length, v = point.y / (double)height;
  const pl_panel_cover cover =
      pl_panel_covers(&cells, u, v, place->side[i] / length, place->side[i] / height);
  pl_lane_scalar(call->out[0], i, cover.cell);
  pl_lane_scalar(call->out[1], i, cover.metal);
  pl_lane_scalar(call->out[2], i, cover.gap);
  pl_lane_scalar(call->out[3], i,
                 random_of(pl_panel_id(u, v, pl_pattern_seed(call, 0)),
                           place->width[i] / pl_minf(length, height)));
}

static void panel(const pl_node_call *call) { each_lane(call, 4, panel_at); }

/* Lengths are in units of the scaled coordinates: metres if the coordinates are in metres and the
 * scale is 1. The default line widths are typical of silicon cells. */
static const pl_socket panel_inputs[] = {
    PL_PATTERN_VECTOR,
    {"length", PL_SCALAR, {0.08f, 0.08f, 0.08f}, "Pitch of cells along x"},
    {"height", PL_SCALAR, {0.04f, 0.04f, 0.04f}, "Pitch of cells along y"},
    {"gap", PL_SCALAR, {0.001f, 0.001f, 0.001f}, "Between cells"},
    {"busbars", PL_SCALAR, {2.0f, 2.0f, 2.0f}, "Number a cell; they run along y"},
    {"busbar_width", PL_SCALAR, {0.001f, 0.001f, 0.001f}, "Of each"},
    {"fingers", PL_SCALAR, {20.0f, 20.0f, 20.0f}, "Number a cell; they run along x"},
    {"finger_width", PL_SCALAR, {0.0001f, 0.0001f, 0.0001f}, "Of each"},
};
static const pl_socket panel_outputs[] = {
    {"cell", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Fraction of the footprint that is bare cell"},
    {"metal", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Fraction that is busbar or finger"},
    {"gap", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Fraction that is gap"},
    {"random", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Uniform in 0..1, one a cell"}};

const pl_node_kind pl_node_panel = {
    .name = "panel",
    .doc = "Solar cells with gaps, busbars and fingers, averaged over the footprint",
    .inputs = panel_inputs,
    .input_count = 9,
    .outputs = panel_outputs,
    .output_count = 4,
    .constants = seed_constants,
    .constant_count = 1,
    .evaluate = panel,
};
