/* Sparse convolution (Lewis 1989, Algorithms for Solid Noise Synthesis): a spot of compact support
 * at a random place of every cell of space. Cells are stratified and spots lie anywhere in theirs,
 * so the mean of an octave over places is the integral of one spot times the mean of their
 * strengths, both 1 by construction. The octaves have hashes of their own: the mean of the product
 * is the product of the means. */
#include "shade/towns.h"

#include <math.h>
#include <stddef.h>

#include "math/lattice.h"
#include "math/noise.h"

enum { OCTAVES = 3 };
#define STEP 3.0

/* Spots are 1 - (d/r)^2 within r = 1/2 cell, so that only the eight cells nearest to a point
 * reach it; the integral over space is 8 pi r^3/15. */
#define SPOT 4.7746483f

/* By how many cells noise moves a place per unit of its gradient: towns are not round. What is the
 * same everywhere on average is so wherever it is looked up. */
#define BEND 0.22
#define BEND_SCALE 2.0

/* Of an octave's light this part lies evenly between the spots: towns have dark land about them,
 * quarters have other quarters. */
static const float GLOW[OCTAVES] = {0.1f, 0.2f, 0.4f};

/* The strength of a spot of the first octave is u^-k of a uniform u in [LEAST, 1]: the darker the
 * country, the more one town differs from the others. */
#define LEAST 0.02f
typedef struct strengths {
  float power, scale; /* mean 1 */
} strengths;

static strengths strengths_of(float share) {
  const float k = 0.25f - 0.15f * share, left = 1.0f - k;
  return (strengths){-k, (1.0f - LEAST) * left / (1.0f - powf(LEAST, left))};
}

/* Light of an octave, mean 1; without a law all spots are equal. */
static float octave(pl_vec3 cell, uint32_t seed, const strengths *law) {
  const pl_vec3f bend = pl_noise_gradient(pl_vec3_scale(cell, BEND_SCALE), seed).gradient;
  const pl_lattice at = pl_lattice_split(pl_vec3_madd(cell, BEND, pl_vec3f_to_double(bend)));
  float light = 0.0f;
  for (int i = 0; i < 8; i++) {
    float d2 = 0.0f;
    uint32_t corner[3];
    int offset[3];
    for (int k = 0; k < 3; k++) {
      offset[k] = ((i >> k) & 1) - (at.fraction[k] < 0.5f ? 1 : 0);
      corner[k] = at.cell[k] + (uint32_t)offset[k];
    }
    const uint32_t hash = pl_lattice_hash3(seed, corner[0], corner[1], corner[2]);
    for (uint32_t k = 0; k < 3; k++) {
      const float d = (float)offset[k] + pl_lattice_uniform(hash, k) - at.fraction[k];
      d2 += d * d;
    }
    if (!(d2 < 0.25f))
      continue;
    const float u = LEAST + (1.0f - LEAST) * pl_lattice_uniform(hash, 3);
    const float strength = law != NULL ? law->scale * powf(u, law->power) : 1.0f;
    const float fall = 1.0f - 4.0f * d2;
    light += SPOT * fall * strength;
  }
  return light;
}

float pl_towns_factor(pl_vec3 point, double size_m, float width_m, float share) {
  const strengths law = strengths_of(pl_minf(pl_maxf(share, 0.0f), 1.0f));
  float factor = 1.0f;
  double scale = 1.0 / size_m;
  for (uint32_t i = 0; i < OCTAVES; i++) {
    /* A spot is half as wide as a wave of gradient noise. */
    const float kept = pl_noise_fade(2.0f * width_m * (float)scale);
    if (!(kept > 0.0f))
      break;
    const float light = octave(pl_vec3_scale(point, scale), 0x70776e73u + i, i == 0 ? &law : NULL);
    factor *= 1.0f + kept * (1.0f - GLOW[i]) * (light - 1.0f);
    scale *= STEP;
  }
  return pl_minf(factor, PL_TOWNS_PEAK);
}
