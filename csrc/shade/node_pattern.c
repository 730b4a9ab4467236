/* Where patterns are evaluated. */
#include "shade/node_pattern.h"

#include <math.h>

/* In cells; smaller rounding errors are not visible. */
static const float GRAIN = 1e-3f;

PL_WIDE void pl_pattern_place_of(const pl_node_call *call, pl_pattern_place *out) {
  const float(*v)[PL_LANES] = *call->in[0], *scale = (*call->in[1])[0];
  for (size_t axis = 0; axis < 3; axis++)
    PL_EACH_LANE(i) out->point.at[axis][i] = (double)scale[i] * (double)v[axis][i];
  PL_EACH_LANE(i) {
    const float size = fabsf(scale[i]);
    /* A scale of zero gives one point, for any footprint. */
    const float radius = size > 0.0f ? size * v[3][i] : 0.0f;
    /* Large coordinates in float cannot resolve cells: the rounding error is added to the
     * footprint, otherwise neighbouring points would form random blocks. */
    const float most = pl_maxf(fabsf(v[0][i]), pl_maxf(fabsf(v[1][i]), fabsf(v[2][i])));
    const float grain = 0x1p-23f * size * most;
    const float wide = grain > GRAIN ? pl_maxf(radius, 0.5f * grain) : radius;
    out->width[i] = 2.0f * wide;
    out->side[i] = sqrtf(PL_PI_F) * wide;
  }
}

PL_WIDE void pl_pattern_slopes(const pl_node_call *call, const float gradient[3][PL_LANES]) {
  const float(*v)[PL_LANES] = *call->in[0], *scale = (*call->in[1])[0];
  const float(*slope)[3][PL_LANES] = *call->in_slopes[0],
        (*scale_slope)[3][PL_LANES] = *call->in_slopes[1];
  for (size_t axis = 0; axis < 2; axis++)
    PL_EACH_LANE(i) {
      float sum = 0.0f;
#pragma GCC unroll 3
      for (size_t k = 0; k < 3; k++)
        sum += gradient[k][i] * (scale[i] * slope[axis][k][i] + scale_slope[axis][0][i] * v[k][i]);
      pl_slope_scalar(call->out_slopes[0], axis, i, sum);
    }
}
