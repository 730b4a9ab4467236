/* Sparse convolution noise (Lewis 1989, Algorithms for Solid Noise Synthesis): each cell of space
 * has a spot of compact support at a random position. Positions are uniform in their cells
 * (stratified), so that the spatial mean of an octave is the integral of one spot times the mean of
 * the strengths, both 1 by construction. Octaves have independent hashes: the mean of their product
 * is the product of their means. */
#include "shade/towns.h"

#include <math.h>
#include <stddef.h>

#include "math/lattice.h"
#include "math/noise.h"

enum { OCTAVES = 3 };
#define STEP 3.0

/* Spots are 1 - (d/r)^2 within r = 1/2 cell, so that only the eight cells nearest to a point affect
 * it; the integral over space is 8 pi r^3/15. SPOT normalises it to 1. */
#define SPOT 4.7746483f

/* Domain warp, in cells per unit of the noise's gradient: makes towns irregular. It keeps the mean,
 * because a stationary pattern has the same mean at any displaced position. */
#define BEND 0.22
#define BEND_SCALE 2.0

/* Part of an octave's light that is uniform between the spots: little around towns, more between
 * the quarters of a town. */
static const float GLOW[OCTAVES] = {0.1f, 0.2f, 0.4f};

/* The strength of a spot of the first octave is u^-k of a uniform u in [LEAST, 1]. The darker the
 * map, the more the strengths differ. */
#define LEAST 0.02f
typedef struct strengths {
  float power, scale; /* scale: normalises the mean to 1 */
} strengths;

static strengths strengths_of(float brightness) {
  const float k = 0.25f - 0.15f * brightness, left = 1.0f - k;
  return (strengths){-k, (1.0f - LEAST) * left / (1.0f - powf(LEAST, left))};
}

/* Light of an octave, mean 1; `law` NULL: all spots are equal. */
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

float pl_towns_factor(pl_vec3 point, double size_m, float width_m, float brightness) {
  const strengths law = strengths_of(pl_minf(pl_maxf(brightness, 0.0f), 1.0f));
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
