/* Bounds of alpha over triangles. */
#include "shade/presence.h"

#include <math.h>

#include "math/vec.h"
#include "shade/graph.h"
#include "shade/material_surface.h"

/* Maximum depth of the subdivision of a triangle; parts still undecided are treated as
 * PL_PRESENCE_PART. */
enum { DEPTH_MAX = 8 };
/* Maximum size of a box in texels for a range query; larger boxes are subdivided first. */
static const float BOX_TEXELS = 16.0f;

enum { FOUND_NONE = 1, FOUND_SURFACE = 2, FOUND_BOTH = 3 };

/* Part of a triangle, in texture coordinates of its alpha. */
typedef struct piece {
  float uv[3][2];
  float alpha[3]; /* vertex colour times the factor, without the texture */
} piece;

typedef struct search {
  const pl_texture *texture; /* NULL: none */
  float size[2];             /* texels */
  float cutoff;              /* minimum alpha at which there is a surface */
} search;

/* Classifies a range of alpha; FOUND_BOTH if undecided. */
static unsigned classify(const search *s, float low, float high) {
  if (low >= s->cutoff)
    return FOUND_SURFACE;
  return high < s->cutoff ? FOUND_NONE : FOUND_BOTH;
}

static piece middle_piece(const piece *p, int corner) {
  /* corner 0..2: the part at that corner; 3: the one in the middle. */
  piece out;
  for (int k = 0; k < 3; k++) {
    const int a = corner < 3 ? corner : k, b = corner < 3 ? k : (k + 1) % 3;
    for (int i = 0; i < 2; i++)
      out.uv[k][i] = 0.5f * (p->uv[a][i] + p->uv[b][i]);
    out.alpha[k] = 0.5f * (p->alpha[a] + p->alpha[b]);
  }
  return out;
}

static unsigned find(const search *s, const piece *p, int depth) {
  float low[2], high[2], range[2] = {1.0f, 1.0f}, texels = 0.0f;
  const float *a = p->alpha;
  for (int i = 0; i < 2; i++) {
    low[i] = pl_minf(pl_minf(p->uv[0][i], p->uv[1][i]), p->uv[2][i]);
    high[i] = pl_maxf(pl_maxf(p->uv[0][i], p->uv[1][i]), p->uv[2][i]);
    texels = pl_maxf(texels, (high[i] - low[i]) * s->size[i]);
  }
  unsigned found = FOUND_BOTH;
  if (texels <= BOX_TEXELS) {
    if (s->texture != NULL)
      pl_texture_alpha_range(s->texture, low, high, range);
    found = classify(s, range[0] * pl_minf(pl_minf(a[0], a[1]), a[2]),
                     range[1] * pl_maxf(pl_maxf(a[0], a[1]), a[2]));
  }
  /* Within a texel alpha is nearly linear; vertex colours alone are linear everywhere. */
  if (found != FOUND_BOTH || depth == DEPTH_MAX || texels <= 1.0f)
    return found;
  found = 0;
  for (int k = 0; k < 4 && found != FOUND_BOTH; k++) {
    const piece part = middle_piece(p, k);
    found |= find(s, &part, depth + 1);
  }
  return found;
}

/* Corners of a triangle in texture coordinates of its material's slot. */
static piece piece_of(const pl_model *model, const pl_material *material, size_t triangle) {
  const pl_texture_slot *slot = &material->base_color_map;
  const float *uvs = slot->uv_set == 0 || slot->uv_set == 1 ? model->uvs[slot->uv_set] : NULL;
  piece out = {0};
  for (int k = 0; k < 3; k++) {
    const size_t v = model->indices[3 * triangle + (size_t)k];
    const float u0 = uvs != NULL ? uvs[2 * v] : 0.0f, v0 = uvs != NULL ? uvs[2 * v + 1] : 0.0f;
    for (int i = 0; i < 2; i++) {
      const float *row = slot->transform.m[i];
      out.uv[k][i] = row[0] * u0 + row[1] * v0 + row[2];
    }
    out.alpha[k] = material->base_color[3] * (model->colors != NULL ? model->colors[4 * v + 3] : 1);
  }
  return out;
}

static pl_presence presence_of(const pl_model *model, size_t triangle) {
  const pl_material *material = pl_material_of(model, (uint32_t)triangle);
  if (material->alpha_mode == PL_ALPHA_OPAQUE)
    return PL_PRESENCE_WHOLE;
  search s = {.cutoff =
                  material->alpha_mode == PL_ALPHA_MASK ? material->alpha_cutoff : PL_ALPHA_CUT};
  const int texture = material->base_color_map.texture;
  int width = 0, height = 0, channels = 0;
  if (texture >= 0)
    pl_texture_size(model->textures[texture], &width, &height, &channels);
  if (channels == 2 || channels == 4) {
    s.texture = model->textures[texture];
    s.size[0] = (float)width;
    s.size[1] = (float)height;
  }
  const piece whole = piece_of(model, material, triangle);
  for (int k = 0; k < 3; k++)
    if (!(isfinite(whole.uv[k][0]) && isfinite(whole.uv[k][1]) && isfinite(whole.alpha[k])))
      return PL_PRESENCE_PART;
  const unsigned found = find(&s, &whole, 0);
  return found == FOUND_BOTH      ? PL_PRESENCE_PART
         : found == FOUND_SURFACE ? PL_PRESENCE_WHOLE
                                  : PL_PRESENCE_NONE;
}

void pl_presence_find(const pl_model *model, uint8_t *out) {
  for (size_t t = 0; t < model->triangle_count; t++)
    out[t] = (uint8_t)presence_of(model, t);
}
