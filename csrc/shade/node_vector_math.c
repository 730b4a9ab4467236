/* Vector arithmetic. The radius of the footprint is propagated where possible: sums add radii,
 * factors scale them, and products use the largest component of the other operand as the factor. */
#include <math.h>

#include "shade/node_rows.h"

enum {
  ADD,
  SUBTRACT,
  MULTIPLY,
  SCALE,
  CROSS,
  NORMALIZE,
  ABSOLUTE,
  MINIMUM,
  MAXIMUM,
  DOT,
  LENGTH,
  DISTANCE
};
static const char *const functions[] = {"add",       "subtract", "multiply", "scale",   "cross",
                                        "normalize", "absolute", "minimum",  "maximum", "dot",
                                        "length",    "distance", NULL};

static pl_vec3f each(pl_vec3f a, pl_vec3f b, float (*f)(float, float)) {
  return pl_vec3f_make(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
}

static pl_vec3f vector_of(int function, pl_vec3f a, pl_vec3f b, float factor) {
  switch (function) {
  case ADD:
    return pl_vec3f_add(a, b);
  case SUBTRACT:
    return pl_vec3f_sub(a, b);
  case MULTIPLY:
    return pl_vec3f_mul(a, b);
  case SCALE:
    return pl_vec3f_scale(a, factor);
  case CROSS:
    return pl_vec3f_cross(a, b);
  case NORMALIZE:
    return pl_vec3f_unit(a);
  case ABSOLUTE:
    return pl_vec3f_make(fabsf(a.x), fabsf(a.y), fabsf(a.z));
  case MINIMUM:
    return each(a, b, pl_minf);
  default:
    return each(a, b, pl_maxf);
  }
}

static float largest(const float *v) {
  return pl_maxf(fabsf(v[0]), pl_maxf(fabsf(v[1]), fabsf(v[2])));
}

static float radius_of(int function, const float *a, const float *b, float factor) {
  switch (function) {
  case MULTIPLY:
    return a[3] * largest(b) + b[3] * largest(a);
  case SCALE:
    return a[3] * fabsf(factor);
  case CROSS:
  case NORMALIZE:
    return 0.0f;
  case ABSOLUTE:
    return a[3];
  default:
    return a[3] + b[3];
  }
}

static float number_of(int function, pl_vec3f a, pl_vec3f b) {
  switch (function) {
  case DOT:
    return pl_vec3f_dot(a, b);
  case LENGTH:
    return pl_vec3f_norm(a);
  default:
    return pl_vec3f_norm(pl_vec3f_sub(a, b));
  }
}

static void vector_math(const pl_node_call *call) {
  const float *a = call->in[0], *b = call->in[1], factor = call->in[2][0];
  const int function = (int)call->constants[0].number;
  const pl_vec3f va = pl_value_vec(a), vb = pl_value_vec(b);
  if (function >= DOT) {
    const float x = number_of(function, va, vb);
    pl_value_scalar(call->out[0], isfinite(x) ? x : 0.0f);
    pl_value_scalar(call->out[1], call->out[0][0]);
    return;
  }
  const pl_vec3f v = vector_of(function, va, vb, factor);
  const float radius = radius_of(function, a, b, factor);
  const bool finite = isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
  /* An infinite radius times 0 is NaN; the pattern is then a single value and the radius 0. */
  pl_value_vector(call->out[0], finite ? v : pl_vec3f_make(0.0f, 0.0f, 0.0f),
                  radius >= 0.0f ? radius : 0.0f);
  pl_value_scalar(call->out[1], finite ? pl_vec3f_norm(v) : 0.0f);
}

static const pl_constant_row constants[] = {
    {"function", PL_CHOICE, ADD, 0, 0, functions, 0,
     "Of a and b, component by component but for cross, dot, length (of a) and distance; scale: a "
     "times the factor. Overflow gives 0"}};
static const pl_socket inputs[] = {
    {"a", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "First vector"},
    {"b", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "Second"},
    {"factor", PL_SCALAR, {1.0f, 1.0f, 1.0f}, "Of scale"},
};
static const pl_socket outputs[] = {
    {"vector", PL_VECTOR, {0.0f, 0.0f, 0.0f}, "The result; a number stands in x, y and z"},
    {"value", PL_SCALAR, {0.0f, 0.0f, 0.0f}, "The number, or the vector's length"},
};

const pl_node_kind pl_node_vector_math = {
    .name = "vector_math",
    .doc = "A function of vectors",
    .inputs = inputs,
    .input_count = 3,
    .outputs = outputs,
    .output_count = 2,
    .constants = constants,
    .constant_count = 1,
    .evaluate = vector_math,
};
