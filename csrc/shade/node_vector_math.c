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

PL_WIDE_PART pl_vec3f each(pl_vec3f a, pl_vec3f b, float (*f)(float, float)) {
  return pl_vec3f_make(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
}

PL_WIDE_PART pl_vec3f vector_of(int function, pl_vec3f a, pl_vec3f b, float factor) {
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

PL_WIDE_PART float largest(pl_vec3f v) {
  return pl_maxf(fabsf(v.x), pl_maxf(fabsf(v.y), fabsf(v.z)));
}

/* ra, rb: radii of a and b. */
PL_WIDE_PART float radius_of(int function, pl_vec3f a, float ra, pl_vec3f b, float rb,
                             float factor) {
  switch (function) {
  case MULTIPLY:
    return ra * largest(b) + rb * largest(a);
  case SCALE:
    return ra * fabsf(factor);
  case CROSS:
  case NORMALIZE:
    return 0.0f;
  case ABSOLUTE:
    return ra;
  default:
    return ra + rb;
  }
}

PL_WIDE_PART float number_of(int function, pl_vec3f a, pl_vec3f b) {
  switch (function) {
  case DOT:
    return pl_vec3f_dot(a, b);
  case LENGTH:
    return pl_vec3f_norm(a);
  default:
    return pl_vec3f_norm(pl_vec3f_sub(a, b));
  }
}

PL_WIDE_PART void each_lane(const pl_node_call *call, int function) {
  const float(*a)[PL_LANES] = *call->in[0], (*b)[PL_LANES] = *call->in[1];
  const float *factor = (*call->in[2])[0];
  float(*out)[PL_LANES] = call->out[0], (*value)[PL_LANES] = call->out[1];
  PL_EACH_LANE(i) {
    const pl_vec3f va = pl_lane_vec(a, i), vb = pl_lane_vec(b, i);
    if (function >= DOT) {
      const float x = number_of(function, va, vb), number = isfinite(x) ? x : 0.0f;
      pl_lane_scalar(out, i, number);
      pl_lane_scalar(value, i, number);
      continue;
    }
    const pl_vec3f v = vector_of(function, va, vb, factor[i]);
    const float radius = radius_of(function, va, a[3][i], vb, b[3][i], factor[i]);
    const bool finite = isfinite(v.x) & isfinite(v.y) & isfinite(v.z);
    const pl_vec3f kept = {finite ? v.x : 0.0f, finite ? v.y : 0.0f, finite ? v.z : 0.0f};
    /* An infinite radius times 0 is NaN; the pattern is then a single value and the radius 0. */
    pl_lane_vector(out, i, kept, radius >= 0.0f ? radius : 0.0f);
    pl_lane_scalar(value, i, pl_vec3f_norm(kept));
  }
}

/* One loop for each function. */
PL_WIDE static void vector_math(const pl_node_call *call) {
#define PL_IN_LANES(function)                                                                      \
  case function:                                                                                   \
    each_lane(call, function);                                                                     \
    break;
  switch ((int)call->constants[0].number) {
    PL_IN_LANES(ADD)
    PL_IN_LANES(SUBTRACT)
    PL_IN_LANES(MULTIPLY)
    PL_IN_LANES(SCALE)
    PL_IN_LANES(CROSS)
    PL_IN_LANES(NORMALIZE)
    PL_IN_LANES(ABSOLUTE)
    PL_IN_LANES(MINIMUM)
    PL_IN_LANES(MAXIMUM)
    PL_IN_LANES(DOT)
    PL_IN_LANES(LENGTH)
    PL_IN_LANES(DISTANCE)
  }
#undef PL_IN_LANES
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
