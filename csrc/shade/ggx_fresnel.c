/* Interpolates the tables of the directional albedo of rough dielectrics. */
#include "shade/ggx_fresnel.h"

#include "shade/ggx_fresnel_table.h"
#include "shade/table.h"

float pl_fresnel_rise(float cosine, float index) {
  const float n = pl_minf(pl_maxf(index, PL_RISE_INDEX_LEAST), PL_RISE_INDEX_MOST);
  const float root = (n - 1.0f) / (n + 1.0f), f0 = root * root;
  return (pl_fresnel(cosine, n) - f0) / (1.0f - f0);
}

pl_ggx_dielectric pl_ggx_dielectric_rise(float roughness, float index) {
  const float root = (index - 1.0f) / (index + 1.0f);
  pl_ggx_dielectric d = {.mean.all = 1.0f};
  float a, b;
  const size_t i = pl_table_node((root - ROOT_LEAST) / (ROOT_MOST - ROOT_LEAST), INDICES, &a);
  const size_t k = pl_table_node(roughness, ROUGHNESSES, &b);
  for (size_t corner = 0; corner < 4; corner++) {
    const size_t x = corner >> 1, y = corner & 1;
    const float weight = (x ? a : 1.0f - a) * (y ? b : 1.0f - b);
    d.row[corner] = rise_table[i + x][k + y];
    d.weight[corner] = weight;
    d.mean.rise += weight * mean_table[i + x][k + y];
    d.deviation += weight * deviation_table[i + x][k + y];
  }
  return d;
}

pl_ggx_dielectric pl_ggx_dielectric_of(float roughness, float index) {
  pl_ggx_dielectric d = pl_ggx_dielectric_rise(roughness, index);
  d.lost = pl_ggx_loss_of(roughness);
  d.mean.all = 1.0f - d.lost.mean;
  return d;
}

float pl_ggx_rise(const pl_ggx_dielectric *d, float cosine) {
  float s, low = 0.0f, high = 0.0f;
  const size_t c = pl_table_node(sqrtf(pl_maxf(cosine, 0.0f)), COSINES, &s);
  for (size_t i = 0; i < 4; i++) {
    low += d->weight[i] * (float)d->row[i][c];
    high += d->weight[i] * (float)d->row[i][c + 1];
  }
  return ((1.0f - s) * low + s * high) * (1.0f / 32767.0f);
}

pl_ggx_albedo pl_ggx_albedo_of(const pl_ggx_dielectric *d, float cosine) {
  return (pl_ggx_albedo){1.0f - pl_ggx_loss_at(&d->lost, cosine), pl_ggx_rise(d, cosine)};
}

pl_ggx_glass pl_ggx_glass_of(float roughness) {
  float t;
  const size_t k = pl_table_node(roughness, ROUGHNESSES, &t);
  return (pl_ggx_glass){.low = glass_table[k],
                        .high = glass_table[k + 1],
                        .way = t,
                        .mean = (1.0f - t) * glass_mean[k] + t * glass_mean[k + 1],
                        .deviation = (1.0f - t) * glass_deviation[k] + t * glass_deviation[k + 1]};
}

float pl_ggx_glass_albedo(const pl_ggx_glass *g, float cosine) {
  float s;
  const size_t c = pl_table_node(sqrtf(pl_maxf(cosine, 0.0f)), COSINES, &s);
  const float low = (1.0f - s) * (float)g->low[c] + s * (float)g->low[c + 1];
  const float high = (1.0f - s) * (float)g->high[c] + s * (float)g->high[c + 1];
  return ((1.0f - g->way) * low + g->way * high) * (1.0f / 65535.0f);
}
