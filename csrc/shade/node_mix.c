/* Blends two values, and maps a number to a colour (ramp). */
#include <math.h>

#include "shade/node_rows.h"

enum { MIX, MULTIPLY, ADD, SCREEN };
static const char *const modes[] = {"mix", "multiply", "add", "screen", NULL};

PL_WIDE_PART float blend(int mode, float a, float b) {
  switch (mode) {
  case MULTIPLY:
    return a * b;
  case ADD:
    return a + b;
  case SCREEN:
    return a + b - a * b;
  default:
    return b;
  }
}

PL_WIDE static void mix(const pl_node_call *call) {
  const float(*a)[PL_LANES] = *call->in[1], (*b)[PL_LANES] = *call->in[2];
  const float *fraction = (*call->in[0])[0];
  float(*out)[PL_LANES] = call->out[0];
  const int mode = (int)call->constants[0].number;
  for (int k = 0; k < 3; k++)
    PL_EACH_LANE(i) {
      const float factor = pl_minf(pl_maxf(fraction[i], 0.0f), 1.0f);
      out[k][i] = (1.0f - factor) * a[k][i] + factor * blend(mode, a[k][i], b[k][i]);
    }
  PL_EACH_LANE(i) out[3][i] = pl_maxf(a[3][i], b[3][i]);
}

/* Derivative of `blend`. */
PL_WIDE_PART float blend_slope(int mode, float a, float b, float da, float db) {
  switch (mode) {
  case MULTIPLY:
    return a * db + b * da;
  case ADD:
    return da + db;
  case SCREEN:
    return da + db - a * db - b * da;
  default:
    return db;
  }
}

PL_WIDE static void mix_slopes(const pl_node_call *call) {
  const float(*a)[PL_LANES] = *call->in[1], (*b)[PL_LANES] = *call->in[2];
  const float *fraction = (*call->in[0])[0];
  const float(*da)[3][PL_LANES] = *call->in_slopes[1], (*db)[3][PL_LANES] = *call->in_slopes[2];
  const float(*dfraction)[3][PL_LANES] = *call->in_slopes[0];
  float(*out)[3][PL_LANES] = call->out_slopes[0];
  const int mode = (int)call->constants[0].number;
  mix(call);
  for (size_t axis = 0; axis < 2; axis++)
    for (int k = 0; k < 3; k++)
      PL_EACH_LANE(i) {
        const float factor = pl_minf(pl_maxf(fraction[i], 0.0f), 1.0f);
        const float rise = factor == fraction[i] ? dfraction[axis][0][i] : 0.0f;
        const float slope =
            rise * (blend(mode, a[k][i], b[k][i]) - a[k][i]) + (1.0f - factor) * da[axis][k][i] +
            factor * blend_slope(mode, a[k][i], b[k][i], da[axis][k][i], db[axis][k][i]);
        out[axis][k][i] = isfinite(slope) ? slope : 0.0f;
      }
}

static const pl_constant_row mix_constants[] = {
    {"blend", PL_CHOICE, MIX, 0, 0, modes, 0,
     "What a becomes at a factor of 1: b, a b, a + b, or 1 - (1 - a) (1 - b)"}};
static const pl_socket mix_inputs[] = {
    {"factor", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "0: a, 1: b; cut off outside"},
    {"a", PL_COLOR, {0.0f, 0.0f, 0.0f}, "Number, vector or colour"},
    {"b", PL_COLOR, {1.0f, 1.0f, 1.0f}, "The same"},
};
static const pl_socket color_output[] = {{"color", PL_COLOR, {0.0f, 0.0f, 0.0f}, "The result"}};

const pl_node_kind pl_node_mix = {
    .name = "mix",
    .doc = "Between two values",
    .inputs = mix_inputs,
    .input_count = 3,
    .outputs = color_output,
    .output_count = 1,
    .constants = mix_constants,
    .constant_count = 1,
    .evaluate = mix,
    .evaluate_slopes = mix_slopes,
};

enum { LINEAR, EASE, STEP };
static const char *const interpolations[] = {"linear", "ease", "step", NULL};
enum { STOP = 4 }; /* position, red, green, blue */

/* The colour, and how it changes with x if `slope` is not NULL. */
static pl_vec3f ramp_at(const pl_constant *stops, int how, float x, pl_vec3f *slope) {
  const size_t count = stops->count / STOP;
  size_t next = 0;
  while (next < count && stops->numbers[STOP * next] <= x)
    next++;
  const size_t from = next == 0 ? 0 : next - 1, to = next == count ? count - 1 : next;
  const float *a = stops->numbers + STOP * from, *b = stops->numbers + STOP * to;
  float t = to > from ? (x - a[0]) / (b[0] - a[0]) : 0.0f;
  const pl_vec3f change = {b[1] - a[1], b[2] - a[2], b[3] - a[3]};
  if (slope != NULL)
    *slope =
        to > from
            ? pl_vec3f_scale(change, (how == EASE ? 6.0f * t * (1.0f - t) : 1.0f) / (b[0] - a[0]))
            : (pl_vec3f){0.0f, 0.0f, 0.0f};
  t = how == STEP ? 0.0f : how == EASE ? t * t * (3.0f - 2.0f * t) : t;
  return pl_vec3f_make(a[1] + t * change.x, a[2] + t * change.y, a[3] + t * change.z);
}

static void ramp(const pl_node_call *call) {
  for (size_t i = 0; i < call->count; i++)
    pl_lane_vector(call->out[0], i,
                   ramp_at(&call->constants[0], (int)call->constants[1].number,
                           pl_node_number(call, 0, i), NULL),
                   0.0f);
  pl_lanes_fill(call->out[0], call->count);
}

static void ramp_slopes(const pl_node_call *call) {
  const float(*dx)[3][PL_LANES] = *call->in_slopes[0];
  ramp(call);
  for (size_t i = 0; i < PL_LANES; i++) {
    pl_vec3f slope;
    (void)ramp_at(&call->constants[0], (int)call->constants[1].number,
                  pl_node_number(call, 0, i < call->count ? i : 0), &slope);
    for (size_t axis = 0; axis < 2; axis++)
      pl_slope_vector(call->out_slopes[0], axis, i, pl_vec3f_scale(slope, dx[axis][0][i]));
  }
}

static bool ramp_has_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  (void)uniform;
  (void)read;
  return (int)constants[1].number != STEP;
}

static pl_status check_ramp(const pl_constant *constants) {
  const pl_constant *stops = &constants[0];
  if (stops->count < STOP)
    return pl_fail(PL_E_RANGE, "stops: a ramp needs at least one");
  for (size_t i = STOP; i < stops->count; i += STOP)
    if (!(stops->numbers[i] > stops->numbers[i - STOP]))
      return pl_fail(PL_E_RANGE, "stops: positions must rise (%g is not above %g)",
                     (double)stops->numbers[i], (double)stops->numbers[i - STOP]);
  return PL_OK;
}

static const pl_constant_row ramp_constants[] = {
    {"stops", PL_NUMBERS, 0, 0, 0, NULL, STOP, "[position, red, green, blue], by rising position"},
    {"interpolation", PL_CHOICE, LINEAR, 0, 0, interpolations, 0,
     "Between two stops: straight, without slope at the stops, or the lower one's colour"}};
static const pl_socket ramp_inputs[] = {
    {"value", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "Position; the end colours hold beyond the stops"}};

const pl_node_kind pl_node_ramp = {
    .name = "ramp",
    .doc = "Colour by a number",
    .inputs = ramp_inputs,
    .input_count = 1,
    .outputs = color_output,
    .output_count = 1,
    .constants = ramp_constants,
    .constant_count = 2,
    .check = check_ramp,
    .evaluate = ramp,
    .evaluate_slopes = ramp_slopes,
    .has_slopes = ramp_has_slopes,
};
