/* Interpolates the table of light lost by anisotropic lobes. */
#include "shade/ggx_loss_xy.h"

#include <stddef.h>

#include "shade/ggx.h"
#include "shade/ggx_loss_xy_table.h"

/* Node below x in 0..1 of `count` nodes, and the way to the next. */
static size_t node_of(float x, int count, float *fraction) {
  const float at = pl_minf(pl_maxf(x, 0.0f), 1.0f) * (float)(count - 1);
  const size_t node = at < (float)(count - 2) ? (size_t)at : (size_t)(count - 2);
  *fraction = at - (float)node;
  return node;
}

/* Between four values of two coordinates. */
static float mix(const uint16_t *low, const uint16_t *high, float across, float along) {
  const float below = (1.0f - along) * (float)low[0] + along * (float)low[1];
  const float above = (1.0f - along) * (float)high[0] + along * (float)high[1];
  return (1.0f - across) * below + across * above;
}

float pl_ggx_loss_xy(float ax, float ay, pl_vec3f w) {
  const float x = ax * w.x, y = ay * w.y;
  const float x2 = x * x, y2 = y * y, across2 = pl_maxf(x2 + y2, 1e-30f);
  const float cosine = fabsf(w.z) / sqrtf(across2 + w.z * w.z);
  float u[4], sum = 0.0f;
  const size_t i = node_of(ax, ALPHAS, &u[0]), k = node_of(ay / ax, RATIOS, &u[1]);
  const size_t c = node_of(cbrtf(cosine * cosine), COSINES, &u[2]);
  const size_t t = node_of(y2 / across2, TURNS, &u[3]);
  for (size_t corner = 0; corner < 4; corner++) {
    const size_t a = corner >> 1, b = corner & 1;
    const float weight = (a ? u[0] : 1.0f - u[0]) * (b ? u[1] : 1.0f - u[1]);
    const uint16_t(*slice)[TURNS] = loss_table[i + a][k + b];
    sum += weight * mix(&slice[c][t], &slice[c + 1][t], u[2], u[3]);
  }
  return sum * (1.0f / 65535.0f);
}

float pl_ggx_loss_xy_mean(float ax, float ay) {
  float a, b;
  const size_t i = node_of(ax, MEAN_ALPHAS, &a), k = node_of(ay / ax, MEAN_RATIOS, &b);
  const float *low = mean_table[i] + k, *high = mean_table[i + 1] + k;
  return (1.0f - a) * ((1.0f - b) * low[0] + b * low[1]) + a * ((1.0f - b) * high[0] + b * high[1]);
}
