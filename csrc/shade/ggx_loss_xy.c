/* Interpolates the table of the energy loss of anisotropic GGX lobes. */
#include "shade/ggx_loss_xy.h"

#include "shade/ggx.h"
#include "shade/ggx_loss_xy_table.h"
#include "shade/table.h"

static const float LOSS_SCALE = 1.0f / 65535.0f, GAIN_SCALE = 1.0f / 16384.0f;

static float mean_of(const float table[MEAN_ALPHAS][MEAN_RATIOS], float ax, float ratio) {
  float a, b;
  const size_t i = pl_table_node(ax, MEAN_ALPHAS, &a);
  const size_t k = pl_table_node(ratio, MEAN_RATIOS, &b);
  return pl_table_mix(pl_table_mix(table[i][k], table[i][k + 1], b),
                      pl_table_mix(table[i + 1][k], table[i + 1][k + 1], b), a);
}

pl_ggx_loss_xy pl_ggx_loss_xy_of(float ax, float ay) {
  const float ratio = ay / ax;
  pl_ggx_loss_xy l = {.ax = ax,
                      .ay = ay,
                      .mean = mean_of(mean_table, ax, ratio),
                      .broad_mean = mean_of(broad_table, ax, ratio)};
  float a, b;
  const size_t i = pl_table_node(ax, ALPHAS, &a), k = pl_table_node(ratio, RATIOS, &b);
  for (size_t corner = 0; corner < 4; corner++) {
    const size_t x = corner >> 1, y = corner & 1;
    l.weight[corner] = (x ? a : 1.0f - a) * (y ? b : 1.0f - b);
    l.slice[corner] = loss_table[i + x][k + y];
  }
  return l;
}

/* Interpolation in cosine and azimuth within each slice: indices of the first node, and the weights
 * of it and its neighbours. */
typedef struct nodes {
  size_t c, t;
  float weight[2][2];
} nodes;

static nodes nodes_of(const pl_ggx_loss_xy *l, pl_vec3f w) {
  const float x = l->ax * w.x, y = l->ay * w.y, z2 = w.z * w.z;
  const float y2 = y * y, across2 = pl_maxf(x * x + y2, 1e-30f);
  nodes n;
  float u, v;
  /* Cube root of the squared cosine of the stretched direction. */
  n.c = pl_table_node(cbrtf(z2 / (across2 + z2)), COSINES, &u);
  n.t = pl_table_node(y2 / across2, TURNS, &v);
  for (int i = 0; i < 4; i++)
    n.weight[i >> 1][i & 1] = (i & 2 ? u : 1.0f - u) * (i & 1 ? v : 1.0f - v);
  return n;
}

/* Interpolates the loss (0), its broad part (1) or the gain (2). */
static float at(const pl_ggx_loss_xy *l, const nodes *n, int which) {
  float sum = 0.0f;
  for (size_t i = 0; i < 4; i++) {
    const uint16_t(*low)[3] = &l->slice[i][n->c][n->t], (*high)[3] = &l->slice[i][n->c + 1][n->t];
    sum += l->weight[i] *
           (n->weight[0][0] * (float)low[0][which] + n->weight[0][1] * (float)low[1][which] +
            n->weight[1][0] * (float)high[0][which] + n->weight[1][1] * (float)high[1][which]);
  }
  return sum;
}

float pl_ggx_loss_xy_at(const pl_ggx_loss_xy *l, pl_vec3f w) {
  const nodes n = nodes_of(l, w);
  return LOSS_SCALE * at(l, &n, 0);
}

pl_ggx_lost pl_ggx_lost_xy_at(const pl_ggx_loss_xy *l, pl_vec3f w) {
  const nodes n = nodes_of(l, w);
  return (pl_ggx_lost){LOSS_SCALE * at(l, &n, 1), GAIN_SCALE * at(l, &n, 2)};
}
