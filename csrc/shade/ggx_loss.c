/* Interpolates the table of the energy loss of isotropic GGX lobes. */
#include "shade/ggx_loss.h"

#include "shade/ggx_loss_table.h"
#include "shade/table.h"

static const float LOSS_SCALE = 1.0f / 65535.0f, GAIN_SCALE = 1.0f / 16384.0f;

pl_ggx_loss pl_ggx_loss_of(float roughness) {
  float t;
  const size_t i = pl_table_node(roughness, ROUGHNESSES, &t);
  return (pl_ggx_loss){.low = loss_table[i],
                       .high = loss_table[i + 1],
                       .way = t,
                       .mean = pl_table_mix(mean_table[i], mean_table[i + 1], t),
                       .broad_mean = pl_table_mix(broad_table[i], broad_table[i + 1], t)};
}

/* Bilinear interpolation in roughness and cosine of the loss (0), its broad part (1) or the gain
 * (2). */
static float between(const pl_ggx_loss *l, size_t node, float s, int which) {
  const float low = pl_table_mix(l->low[node][which], l->low[node + 1][which], s);
  const float high = pl_table_mix(l->high[node][which], l->high[node + 1][which], s);
  return pl_table_mix(low, high, l->way);
}

static size_t node_at(float cosine, float *s) {
  return pl_table_node(sqrtf(pl_maxf(cosine, 0.0f)), COSINES, s);
}

float pl_ggx_loss_at(const pl_ggx_loss *l, float cosine) {
  float s;
  const size_t node = node_at(cosine, &s);
  return LOSS_SCALE * between(l, node, s, 0);
}

pl_ggx_lost pl_ggx_lost_at(const pl_ggx_loss *l, float cosine) {
  float s;
  const size_t node = node_at(cosine, &s);
  return (pl_ggx_lost){.broad = LOSS_SCALE * between(l, node, s, 1),
                       .gain = GAIN_SCALE * between(l, node, s, 2)};
}
