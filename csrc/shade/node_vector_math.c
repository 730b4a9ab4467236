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

#define PL_FUNCTIONS(row)                                                                          \
  row(ADD) row(SUBTRACT) row(MULTIPLY) row(SCALE) row(CROSS) row(NORMALIZE) row(ABSOLUTE)          \
      row(MINIMUM) row(MAXIMUM) row(DOT) row(LENGTH) row(DISTANCE)

/* One loop for each function. */
PL_WIDE static void vector_math(const pl_node_call *call) {
#define PL_IN_LANES(function)                                                                      \
  case function:                                                                                   \
    each_lane(call, function);                                                                     \
    break;
  switch ((int)call->constants[0].number) { PL_FUNCTIONS(PL_IN_LANES) }
#undef PL_IN_LANES
}

/* Derivatives of vector_of and number_of for changes da, db, dfactor. */
PL_WIDE_PART pl_vec3f vector_slope(int function, pl_vec3f a, pl_vec3f b, float factor, pl_vec3f da,
                                   pl_vec3f db, float dfactor) {
  const float length = pl_vec3f_norm(a);
  const bool a_x = function == MINIMUM ? a.x < b.x : a.x > b.x;
  const bool a_y = function == MINIMUM ? a.y < b.y : a.y > b.y;
  const bool a_z = function == MINIMUM ? a.z < b.z : a.z > b.z;
  switch (function) {
  case ADD:
    return pl_vec3f_add(da, db);
  case SUBTRACT:
    return pl_vec3f_sub(da, db);
  case MULTIPLY:
    return pl_vec3f_add(pl_vec3f_mul(a, db), pl_vec3f_mul(b, da));
  case SCALE:
    return pl_vec3f_madd(pl_vec3f_scale(da, factor), dfactor, a);
  case CROSS:
    return pl_vec3f_add(pl_vec3f_cross(a, db), pl_vec3f_cross(da, b));
  case NORMALIZE:
    return length > 0.0f
               ? pl_vec3f_scale(pl_vec3f_madd(da, -pl_vec3f_dot(a, da) / (length * length), a),
                                1.0f / length)
               : da;
  case ABSOLUTE:
    return pl_vec3f_make(a.x < 0.0f ? -da.x : da.x, a.y < 0.0f ? -da.y : da.y,
                         a.z < 0.0f ? -da.z : da.z);
  default:
    return pl_vec3f_make(a_x ? da.x : db.x, a_y ? da.y : db.y, a_z ? da.z : db.z);
  }
}

/* Of the length of v; 0 at 0. */
PL_WIDE_PART float length_slope(pl_vec3f v, pl_vec3f dv) {
  const float length = pl_vec3f_norm(v);
  return length > 0.0f ? pl_vec3f_dot(v, dv) / length : 0.0f;
}

PL_WIDE_PART float number_slope(int function, pl_vec3f a, pl_vec3f b, pl_vec3f da, pl_vec3f db) {
  switch (function) {
  case DOT:
    return pl_vec3f_dot(a, db) + pl_vec3f_dot(b, da);
  case LENGTH:
    return length_slope(a, da);
  default:
    return length_slope(pl_vec3f_sub(a, b), pl_vec3f_sub(da, db));
  }
}

PL_WIDE_PART void each_slope(const pl_node_call *call, int function) {
  const float(*a)[PL_LANES] = *call->in[0], (*b)[PL_LANES] = *call->in[1];
  const float *factor = (*call->in[2])[0];
  const float(*da)[3][PL_LANES] = *call->in_slopes[0], (*db)[3][PL_LANES] = *call->in_slopes[1],
        (*dfactor)[3][PL_LANES] = *call->in_slopes[2];
  for (size_t axis = 0; axis < 2; axis++)
    PL_EACH_LANE(i) {
      const pl_vec3f va = pl_lane_vec(a, i), vb = pl_lane_vec(b, i);
      const pl_vec3f sa = pl_slope_vec(da, axis, i), sb = pl_slope_vec(db, axis, i);
      if (function >= DOT) {
        const float slope = number_slope(function, va, vb, sa, sb);
        pl_slope_scalar(call->out_slopes[0], axis, i, slope);
        pl_slope_scalar(call->out_slopes[1], axis, i, slope);
        continue;
      }
      const pl_vec3f slope = vector_slope(function, va, vb, factor[i], sa, sb, dfactor[axis][0][i]);
      pl_slope_vector(call->out_slopes[0], axis, i, slope);
      pl_slope_scalar(call->out_slopes[1], axis, i,
                      length_slope(pl_lane_vec(call->out[0], i), slope));
    }
}

PL_WIDE static void vector_math_slopes(const pl_node_call *call) {
#define PL_IN_LANES(function)                                                                      \
  case function:                                                                                   \
    each_slope(call, function);                                                                    \
    break;
  vector_math(call);
  switch ((int)call->constants[0].number) { PL_FUNCTIONS(PL_IN_LANES) }
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
    .evaluate_slopes = vector_math_slopes,
};
