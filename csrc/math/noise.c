#include "math/noise.h"

#include "math/lattice.h"

/* Gradients are the vertices of the icosahedron, (0, 1, phi) and cyclic, with length 2/sqrt(3): the
 * noise is largest in the middle of a cell, where all 8 corners are sqrt(3)/2 away. */
#define A 0.60706199820668634f
#define B 0.98224694637684600f
static const float GRADIENTS[12][3] = {{0, A, B}, {0, -A, B}, {0, A, -B}, {0, -A, -B},
                                       {B, 0, A}, {B, 0, -A}, {-B, 0, A}, {-B, 0, -A},
                                       {A, B, 0}, {-A, B, 0}, {A, -B, 0}, {-A, -B, 0}};

static inline float fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }
static inline float fade_slope(float t) { return 30.0f * t * t * (t * (t - 2.0f) + 1.0f); }

/* floor(12 hash / 2^32) without 64 bits. */
PL_WIDE_PART uint32_t vertex_of(uint32_t hash) {
  return (12u * (hash >> 16) + ((12u * (hash & 0xffffu)) >> 16)) >> 16;
}

/* The gradient and its product with (x, y, z) from the pattern of the table instead of the table,
 * which vectors cannot read: the two components that are not 0, with the signs of the two low bits.
 */
PL_WIDE_PART pl_noise_value product_of(uint32_t vertex, float x, float y, float z) {
  const bool first = vertex < 4u, second = vertex < 8u;
  const float a = (float)(1 - 2 * (int)(vertex & 1u)) * A, b = (float)(1 - (int)(vertex & 2u)) * B;
  const pl_vec3f gradient = {first    ? 0.0f
                             : second ? b
                                      : a,
                             first    ? a
                             : second ? 0.0f
                                      : b,
                             first    ? b
                             : second ? a
                                      : 0.0f};
  return (pl_noise_value){
      a * (first    ? y
           : second ? z
                    : x) +
          b * (first    ? z
               : second ? x
                        : y),
      gradient,
  };
}

/* Linear function of one corner, at offset (x, y, z) from it; the same bits without the table. */
PL_WIDE_PART pl_noise_value corner(uint32_t hash, float x, float y, float z, bool table) {
  const uint32_t vertex = vertex_of(hash);
  if (!table)
    return product_of(vertex, x, y, z);
  const float *g = GRADIENTS[vertex];
  return (pl_noise_value){g[0] * x + g[1] * y + g[2] * z, {g[0], g[1], g[2]}};
}

PL_WIDE_PART pl_noise_value blend(pl_noise_value a, pl_noise_value b, float u) {
  const pl_vec3f slope = pl_vec3f_sub(b.gradient, a.gradient);
  return (pl_noise_value){a.value + u * (b.value - a.value), pl_vec3f_madd(a.gradient, u, slope)};
}

/* A blend of corners along x, or of such blends along y, with its slopes within it. */
typedef struct blended {
  pl_noise_value noise;
  float slope_x, slope_y;
} blended;

PL_WIDE_PART blended edge_of(uint32_t row, uint32_t cell, float u, float x, float y, float z,
                             bool table) {
  const pl_noise_value a = corner(pl_lattice_hash(row, cell), x, y, z, table);
  const pl_noise_value b = corner(pl_lattice_hash(row, cell + 1u), x - 1.0f, y, z, table);
  return (blended){blend(a, b, u), b.value - a.value, 0.0f};
}

PL_WIDE_PART blended plane_of(uint32_t layer, const uint32_t cell[2], const float fraction[2],
                              float z, bool table) {
  const float x = fraction[0], y = fraction[1], u = fade(x), v = fade(y);
  const blended low = edge_of(pl_lattice_hash(layer, cell[1]), cell[0], u, x, y, z, table);
  const blended high =
      edge_of(pl_lattice_hash(layer, cell[1] + 1u), cell[0], u, x, y - 1.0f, z, table);
  return (blended){blend(low.noise, high.noise, v), low.slope_x + v * (high.slope_x - low.slope_x),
                   high.noise.value - low.noise.value};
}

/* Where only the value is used, the compiler removes the computation of the gradient. */
PL_WIDE_PART pl_noise_value evaluate(const uint32_t cell[3], const float fraction[3],
                                     uint32_t start, bool table) {
  const float z = fraction[2], w = fade(z);
  const blended low = plane_of(pl_lattice_hash(start, cell[2]), cell, fraction, z, table);
  const blended high =
      plane_of(pl_lattice_hash(start, cell[2] + 1u), cell, fraction, z - 1.0f, table);
  pl_noise_value result = blend(low.noise, high.noise, w);
  result.gradient.x += fade_slope(fraction[0]) * (low.slope_x + w * (high.slope_x - low.slope_x));
  result.gradient.y += fade_slope(fraction[1]) * (low.slope_y + w * (high.slope_y - low.slope_y));
  result.gradient.z += fade_slope(z) * (high.noise.value - low.noise.value);
  return result;
}

pl_noise_value pl_noise_gradient(pl_vec3 point, uint32_t seed) {
  const pl_lattice at = pl_lattice_split(point);
  return evaluate(at.cell, at.fraction, pl_sampler_mix(seed), true);
}

float pl_noise(pl_vec3 point, uint32_t seed) {
  const pl_lattice at = pl_lattice_split(point);
  return evaluate(at.cell, at.fraction, pl_sampler_mix(seed), true).value;
}

/* Noise of one lane, whose lattice starts from a mixed seed. */
PL_WIDE_PART pl_noise_value evaluate_lane(const pl_lattice_lanes *at, uint32_t start, size_t i) {
  const uint32_t cell[3] = {at->cell[0][i], at->cell[1][i], at->cell[2][i]};
  const float fraction[3] = {at->fraction[0][i], at->fraction[1][i], at->fraction[2][i]};
  return evaluate(cell, fraction, start, false);
}

PL_WIDE void pl_noise_lanes(const pl_point_lanes *points, uint32_t seed,
                            float out[restrict PL_LANES]) {
  pl_lattice_lanes at;
  const uint32_t start = pl_sampler_mix(seed);
  pl_lattice_split_lanes(points, &at);
  PL_EACH_LANE(i) { out[i] = evaluate_lane(&at, start, i).value; }
}

PL_WIDE void pl_noise_seeds_lanes(const pl_point_lanes *points,
                                  const uint32_t seeds[restrict PL_LANES],
                                  float out[restrict PL_LANES]) {
  pl_lattice_lanes at;
  pl_lattice_split_lanes(points, &at);
  PL_EACH_LANE(i) { out[i] = evaluate_lane(&at, pl_sampler_mix(seeds[i]), i).value; }
}

/* Stores the noise of a lane. */
PL_WIDE_PART void store(pl_noise_value noise, size_t i, float *restrict value,
                        float (*restrict gradient)[PL_LANES]) {
  value[i] = noise.value;
  gradient[0][i] = noise.gradient.x;
  gradient[1][i] = noise.gradient.y;
  gradient[2][i] = noise.gradient.z;
}

PL_WIDE void pl_noise_gradient_lanes(const pl_point_lanes *points, uint32_t seed,
                                     float value[restrict PL_LANES],
                                     float gradient[restrict 3][PL_LANES]) {
  pl_lattice_lanes at;
  const uint32_t start = pl_sampler_mix(seed);
  pl_lattice_split_lanes(points, &at);
  PL_EACH_LANE(i) { store(evaluate_lane(&at, start, i), i, value, gradient); }
}

PL_WIDE void pl_noise_gradient_seeds_lanes(const pl_point_lanes *points,
                                           const uint32_t seeds[restrict PL_LANES],
                                           float value[restrict PL_LANES],
                                           float gradient[restrict 3][PL_LANES]) {
  pl_lattice_lanes at;
  pl_lattice_split_lanes(points, &at);
  PL_EACH_LANE(i) { store(evaluate_lane(&at, pl_sampler_mix(seeds[i]), i), i, value, gradient); }
}
