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
static float smoothstep(float x, float a, float b) {
  if (a == b)
    return x < a ? 0.0f : 1.0f;
  const float t = pl_minf(pl_maxf((x - a) / (b - a), 0.0f), 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/* x wrapped into [a, b) by whole periods. */
static float wrap(float x, float a, float b) {
  return b == a ? a : x - (b - a) * floorf((x - a) / (b - a));
}

static float apply_rounding(int function, float a, float b, float c) {
  switch (function) {
  case LESS_THAN:
    return a < b ? 1.0f : 0.0f;
  case GREATER_THAN:
    return a > b ? 1.0f : 0.0f;
  case SIGN:
    return a > 0.0f ? 1.0f : a < 0.0f ? -1.0f : 0.0f;
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
  case ATAN2:
    return atan2f(a, b);
  default:
    return smoothstep(a, b, c);
  }
}

static float apply(int function, float a, float b, float c) {
  switch (function) {
  case ADD:
    return a + b;
  case SUBTRACT:
    return a - b;
  case MULTIPLY:
    return a * b;
  case DIVIDE:
    return b == 0.0f ? 0.0f : a / b;
  case MULTIPLY_ADD:
    return a * b + c;
  case POWER:
    return powf(a, b);
  case SQRT:
    return sqrtf(a);
  case EXP:
    return expf(a);
  case LOG:
    return logf(a);
  case ABSOLUTE:
    return fabsf(a);
  case MINIMUM:
    return pl_minf(a, b);
  case MAXIMUM:
    return pl_maxf(a, b);
  default:
    return apply_rounding(function, a, b, c);
  }
}

static void math(const pl_node_call *call) {
  const float a = call->in[0][0], b = call->in[1][0], c = call->in[2][0];
  float x = apply((int)call->constants[0].number, a, b, c);
  x = isfinite(x) ? x : 0.0f;
  if (call->constants[1].number != 0.0)
    x = pl_minf(pl_maxf(x, 0.0f), 1.0f);
  pl_value_scalar(call->out[0], x);
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
};

static void mean(const pl_node_call *call) {
  const float *v = call->in[0];
  pl_value_scalar(call->out[0], (v[0] + v[1] + v[2]) / 3.0f);
}

static void luminance(const pl_node_call *call) {
  pl_value_scalar(call->out[0], pl_luminance(pl_value_vec(call->in[0])));
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
};
