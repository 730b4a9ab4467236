/* Scalar arithmetic. The result is 0 where a function is undefined, so that no pixel becomes NaN.
 */
#include <math.h>

#include "math/color.h"
#include "shade/node_rows.h"

enum {
  ADD,
  SUBTRACT,
  MULTIPLY,
  DIVIDE,
  MULTIPLY_ADD,
  POWER,
  SQRT,
  EXP,
  LOG,
  ABSOLUTE,
  MINIMUM,
  MAXIMUM,
  LESS_THAN,
  GREATER_THAN,
  SIGN,
  FLOOR,
  FRACTION,
  MODULO,
  WRAP,
  SINE,
  COSINE,
  ATAN2,
  SMOOTHSTEP
};
static const char *const functions[] = {
    "add",       "subtract",     "multiply", "divide",   "multiply_add", "power",
    "sqrt",      "exp",          "log",      "absolute", "minimum",      "maximum",
    "less_than", "greater_than", "sign",     "floor",    "fraction",     "modulo",
    "wrap",      "sine",         "cosine",   "atan2",    "smoothstep",   NULL};

/* Cubic step from 0 at a to 1 at b, with zero slope at both; a hard step if they are equal. */
PL_WIDE_PART float smoothstep(float x, float a, float b) {
  const float t = pl_minf(pl_maxf((x - a) / (b - a), 0.0f), 1.0f);
  return a == b ? (x < a ? 0.0f : 1.0f) : t * t * (3.0f - 2.0f * t);
}

/* Derivative by x; 0 for a hard step. */
PL_WIDE_PART float smoothstep_slope(float x, float a, float b) {
  const float t = (x - a) / (b - a);
  return t > 0.0f && t < 1.0f ? 6.0f * t * (1.0f - t) / (b - a) : 0.0f;
}

/* x wrapped into [a, b) by whole periods. */
static float wrap(float x, float a, float b) {
  return b == a ? a : x - (b - a) * floorf((x - a) / (b - a));
}

/* What vectors have an instruction for, in all lanes; false for other functions. */
#define PL_IN_LANES(function, expression)                                                          \
  case function:                                                                                   \
    PL_EACH_LANE(i) {                                                                              \
      const float x = a[i], y = b[i], z = c[i];                                                    \
      (void)y;                                                                                     \
      (void)z;                                                                                     \
      out[i] = (expression);                                                                       \
    }                                                                                              \
    return true;

PL_WIDE static bool apply_lanes(int function, const float *restrict a, const float *restrict b,
                                const float *restrict c, float *restrict out) {
  switch (function) {
    PL_IN_LANES(ADD, x + y)
    PL_IN_LANES(SUBTRACT, x - y)
    PL_IN_LANES(MULTIPLY, x * y)
    PL_IN_LANES(DIVIDE, y == 0.0f ? 0.0f : x / y)
    PL_IN_LANES(MULTIPLY_ADD, x * y + z)
    PL_IN_LANES(SQRT, sqrtf(x))
    PL_IN_LANES(ABSOLUTE, fabsf(x))
    PL_IN_LANES(MINIMUM, pl_minf(x, y))
    PL_IN_LANES(MAXIMUM, pl_maxf(x, y))
    PL_IN_LANES(LESS_THAN, x < y ? 1.0f : 0.0f)
    PL_IN_LANES(GREATER_THAN, x > y ? 1.0f : 0.0f)
    PL_IN_LANES(SIGN, x > 0.0f ? 1.0f : x < 0.0f ? -1.0f : 0.0f)
    PL_IN_LANES(SMOOTHSTEP, smoothstep(x, y, z))
  default:
    return false;
  }
}

/* The functions of libraries. */
static float apply(int function, float a, float b, float c) {
  switch (function) {
  case POWER:
    return powf(a, b);
  case EXP:
    return expf(a);
  case LOG:
    return logf(a);
  case FLOOR:
    return floorf(a);
  case FRACTION:
    return a - floorf(a);
  case MODULO:
    return b == 0.0f ? 0.0f : fmodf(a, b);
  case WRAP:
    return wrap(a, b, c);
  case SINE:
    return sinf(a);
  case COSINE:
    return cosf(a);
  default:
    return atan2f(a, b);
  }
}

PL_WIDE static void put(const float *restrict value, bool cut, pl_lanes out) {
  PL_EACH_LANE(i) {
    const float x = isfinite(value[i]) ? value[i] : 0.0f;
    pl_lane_scalar(out, i, cut ? pl_minf(pl_maxf(x, 0.0f), 1.0f) : x);
  }
}

static void math(const pl_node_call *call) {
  const float *a = (*call->in[0])[0], *b = (*call->in[1])[0], *c = (*call->in[2])[0];
  const int function = (int)call->constants[0].number;
  float value[PL_LANES];
  if (!apply_lanes(function, a, b, c, value)) {
    for (size_t i = 0; i < call->count; i++)
      value[i] = apply(function, a[i], b[i], c[i]);
    for (size_t i = call->count; i < PL_LANES; i++)
      value[i] = value[0];
  }
  put(value, call->constants[1].number != 0.0, call->out[0]);
}

/* Partial derivatives of the result by a, b and c. */
typedef struct partials {
  float by[3][PL_LANES];
} partials;

#define PL_PARTIALS(function, by_a, by_b, by_c)                                                    \
  case function:                                                                                   \
    PL_EACH_LANE(i) {                                                                              \
      const float x = a[i], y = b[i], z = c[i];                                                    \
      (void)x;                                                                                     \
      (void)y;                                                                                     \
      (void)z;                                                                                     \
      out->by[0][i] = (by_a);                                                                      \
      out->by[1][i] = (by_b);                                                                      \
      out->by[2][i] = (by_c);                                                                      \
    }                                                                                              \
    return true;

/* Of what vectors have instructions for; false for other functions. */
PL_WIDE static bool partials_lanes(int function, const float *restrict a, const float *restrict b,
                                   const float *restrict c, partials *restrict out) {
  switch (function) {
    PL_PARTIALS(ADD, 1.0f, 1.0f, 0.0f)
    PL_PARTIALS(SUBTRACT, 1.0f, -1.0f, 0.0f)
    PL_PARTIALS(MULTIPLY, y, x, 0.0f)
    PL_PARTIALS(DIVIDE, y == 0.0f ? 0.0f : 1.0f / y, y == 0.0f ? 0.0f : -x / (y * y), 0.0f)
    PL_PARTIALS(MULTIPLY_ADD, y, x, 1.0f)
    PL_PARTIALS(SQRT, x > 0.0f ? 0.5f / sqrtf(x) : 0.0f, 0.0f, 0.0f)
    PL_PARTIALS(LOG, x > 0.0f ? 1.0f / x : 0.0f, 0.0f, 0.0f)
    PL_PARTIALS(ABSOLUTE, x > 0.0f ? 1.0f : x < 0.0f ? -1.0f : 0.0f, 0.0f, 0.0f)
    PL_PARTIALS(MINIMUM, x < y ? 1.0f : 0.0f, x < y ? 0.0f : 1.0f, 0.0f)
    PL_PARTIALS(MAXIMUM, x > y ? 1.0f : 0.0f, x > y ? 0.0f : 1.0f, 0.0f)
    PL_PARTIALS(ATAN2, y / (x * x + y * y), -x / (x * x + y * y), 0.0f)
    PL_PARTIALS(SMOOTHSTEP, smoothstep_slope(x, y, z),
                smoothstep_slope(x, y, z) * ((x - y) / (z - y) - 1.0f),
                -smoothstep_slope(x, y, z) * ((x - y) / (z - y)))
  default:
    return false;
  }
}

static void partials_at(int function, float a, float b, partials *out, size_t i) {
  const bool power = function == POWER;
  out->by[0][i] = power              ? b * powf(a, b - 1.0f)
                  : function == EXP  ? expf(a)
                  : function == SINE ? cosf(a)
                                     : -sinf(a);
  out->by[1][i] = power ? powf(a, b) * logf(a) : 0.0f;
  out->by[2][i] = 0.0f;
}

/* Chain rule. Inputs that are level take no part, whatever the derivative; beyond a cut the result
 * is level. */
PL_WIDE static void chain(const partials *p, const float (*a)[3][PL_LANES],
                          const float (*b)[3][PL_LANES], const float (*c)[3][PL_LANES], bool cut,
                          const float *restrict value, pl_slopes out) {
  for (size_t axis = 0; axis < 2; axis++)
    PL_EACH_LANE(i) {
      const float da = a[axis][0][i], db = b[axis][0][i], dc = c[axis][0][i];
      const float slope = (da == 0.0f ? 0.0f : da * p->by[0][i]) +
                          (db == 0.0f ? 0.0f : db * p->by[1][i]) +
                          (dc == 0.0f ? 0.0f : dc * p->by[2][i]);
      const bool open = !cut || (value[i] > 0.0f && value[i] < 1.0f);
      pl_slope_scalar(out, axis, i, open ? slope : 0.0f);
    }
}

static void math_slopes(const pl_node_call *call) {
  const float *a = (*call->in[0])[0], *b = (*call->in[1])[0], *c = (*call->in[2])[0];
  const int function = (int)call->constants[0].number;
  partials p;
  math(call);
  if (!partials_lanes(function, a, b, c, &p))
    for (size_t i = 0; i < PL_LANES; i++)
      partials_at(function, i < call->count ? a[i] : a[0], i < call->count ? b[i] : b[0], &p, i);
  chain(&p, *call->in_slopes[0], *call->in_slopes[1], *call->in_slopes[2],
        call->constants[1].number != 0.0, call->out[0][0], call->out_slopes[0]);
}

/* What has steps has no slopes, nor is there one at a step. */
static bool math_has_slopes(const pl_constant *constants, unsigned uniform, unsigned read) {
  (void)uniform;
  (void)read;
  switch ((int)constants[0].number) {
  case LESS_THAN:
  case GREATER_THAN:
  case SIGN:
  case FLOOR:
  case FRACTION:
  case MODULO:
  case WRAP:
    return false;
  default:
    return true;
  }
}

static const pl_constant_row math_constants[] = {
    {"function", PL_CHOICE, ADD, 0, 0, functions, 0,
     "Of a, b and c; angles in radians. wrap: a into [b, c); smoothstep: a from b to c; "
     "multiply_add: a b + c. Where it is not defined (division by zero, roots of negative "
     "numbers, overflow) the result is 0"},
    {"clamp", PL_NUMBER, 0, 0, 1, NULL, 0, "1: the result is cut off at 0 and 1"}};
static const pl_socket math_inputs[] = {
    {"a", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "First number"},
    {"b", PL_SCALAR, {0.5f, 0.5f, 0.5f}, "Second"},
    {"c", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "Third"},
};
static const pl_socket number_output[] = {{"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "The result"}};

const pl_node_kind pl_node_math = {
    .name = "math",
    .doc = "A function of numbers",
    .inputs = math_inputs,
    .input_count = 3,
    .outputs = number_output,
    .output_count = 1,
    .constants = math_constants,
    .constant_count = 2,
    .evaluate = math,
    .evaluate_slopes = math_slopes,
    .has_slopes = math_has_slopes,
};

static void mean(const pl_node_call *call) {
  const float(*v)[PL_LANES] = *call->in[0];
  PL_EACH_LANE(i) pl_lane_scalar(call->out[0], i, (v[0][i] + v[1][i] + v[2][i]) / 3.0f);
}

static void luminance(const pl_node_call *call) {
  PL_EACH_LANE(i) pl_lane_scalar(call->out[0], i, pl_luminance(pl_lane_vec(*call->in[0], i)));
}

static void mean_slopes(const pl_node_call *call) {
  const float(*v)[3][PL_LANES] = *call->in_slopes[0];
  mean(call);
  for (size_t axis = 0; axis < 2; axis++)
    PL_EACH_LANE(i)
  pl_slope_scalar(call->out_slopes[0], axis, i,
                  (v[axis][0][i] + v[axis][1][i] + v[axis][2][i]) / 3.0f);
}

static void luminance_slopes(const pl_node_call *call) {
  luminance(call);
  for (size_t axis = 0; axis < 2; axis++)
    PL_EACH_LANE(i)
  pl_slope_scalar(call->out_slopes[0], axis, i,
                  pl_luminance(pl_slope_vec(*call->in_slopes[0], axis, i)));
}

static const pl_socket vector_input[] = {
    {"vector", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "What is converted"}};

const pl_node_kind pl_node_mean = {
    .name = "mean",
    .doc = "Mean of x, y and z",
    .inputs = vector_input,
    .input_count = 1,
    .outputs = number_output,
    .output_count = 1,
    .hidden = true,
    .evaluate = mean,
    .evaluate_slopes = mean_slopes,
};

const pl_node_kind pl_node_luminance = {
    .name = "luminance",
    .doc = "Luminance of a colour",
    .inputs = vector_input,
    .input_count = 1,
    .outputs = number_output,
    .output_count = 1,
    .hidden = true,
    .evaluate = luminance,
    .evaluate_slopes = luminance_slopes,
};
