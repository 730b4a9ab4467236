/* Interpolates the table of lost light. */
#include "shade/ggx_loss.h"

#include <math.h>
#include <stddef.h>

#include "math/vec.h"
#include "shade/ggx_loss_table.h"

/* Node below x in 0..1, and the way to the next. */
static size_t node_of(float x, float *fraction) {
  const float at = pl_minf(pl_maxf(x, 0.0f), 1.0f) * (float)(TABLE_SIDE - 1);
  const size_t node = at < (float)(TABLE_SIDE - 2) ? (size_t)at : (size_t)(TABLE_SIDE - 2);
  *fraction = at - (float)node;
  return node;
}

float pl_ggx_loss(float roughness, float cosine) {
  float r, s;
  const size_t i = node_of(roughness, &r), k = node_of(sqrtf(pl_maxf(cosine, 0.0f)), &s);
  const uint16_t *low = loss_table[i] + k, *high = loss_table[i + 1] + k;
  const float below = (1.0f - s) * (float)low[0] + s * (float)low[1];
  const float above = (1.0f - s) * (float)high[0] + s * (float)high[1];
  return ((1.0f - r) * below + r * above) * (1.0f / 65535.0f);
}

float pl_ggx_loss_mean(float roughness) {
  float r;
  const size_t i = node_of(roughness, &r);
  return (1.0f - r) * mean_table[i] + r * mean_table[i + 1];
}
