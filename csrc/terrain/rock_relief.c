/* Sums of noise in the rock's own axes: lengths are in its plan diameters, so that large rocks are
 * as rough as small ones, as surfaces of fracture are. */
#include "terrain/rock_relief.h"

#include "math/noise.h"

/* Cells of the coarsest octave, over the diameter: near those of the finest octaves of shapes
 * (terrain/rock_shape.c), which the meshes of all but the nearest rocks leave out. */
#define COARSEST 0.03
/* Finest cells, m: grains of minerals. */
#define FINEST_M 0.0005
enum { OCTAVES = 12 };
/* Deviation of the slopes of an octave along an axis, and its part in the next. By eye, beside
 * boulders of Apollo 17: surfaces of fracture grow steeper by 1.15 an octave (Bouchaud 1997), those
 * on the Moon are worn and dusty. With pits, slopes have about 0.5 in all. */
#define ROUGH 0.2
#define GROWTH 0.85
/* Parts of a rock are rough or smooth over cells of this part of its diameter. */
#define WORN_CELL 0.3
#define WORN 1.8
/* Variance along an axis of the gradient of noise (measured over 2e6 points). */
#define NOISE_SLOPES 0.331

/* Pits are where a noise is above LEVEL: bowls, on a tenth of the surface. */
#define LEVEL 0.3
#define PIT_SIZES 3
static const double PIT_CELLS[PIT_SIZES] = {0.09, 0.04, 0.017};
#define PIT_DEPTH 8.0
#define PIT_SLOPES (8.48e-4 * PIT_DEPTH * PIT_DEPTH) /* variance along an axis (measured) */

/* Cracks are grooves along the zeros of a wide noise, on rough parts. */
#define CRACK_CELL 0.55
#define CRACK_WIDTH 0.008
#define CRACK_STEEP 1.6

#define GRAINS 5
#define GRAIN_CELL 0.06
#define GRAIN_TINT 0.16
#define ROCK_TINT 0.12

static double fade(double footprint_m, double cell_m) {
  return (double)pl_noise_fade((float)(footprint_m / cell_m));
}

static pl_vec3 gradient_of(pl_noise_value at) { return pl_vec3f_to_double(at.gradient); }

static uint32_t seed_of(const pl_rock *rock) {
  return pl_lattice_hash3((uint32_t)rock->id, (uint32_t)(rock->id >> 32), 0x726f636bu, 0);
}

/* A point in cells of the rock. */
static pl_vec3 in_cells(const pl_rock *rock, pl_vec3 point, double cell) {
  return pl_vec3_scale(pl_mat3_mul_vec_t(rock->rotation, point), 1.0 / (cell * rock->diameter_m));
}

/* `worn`: how rough this part of the rock is. */
static void add_octaves(const pl_rock *rock, pl_vec3 point, double footprint_m, uint32_t seed,
                        double worn, pl_rock_relief *out) {
  double cell = COARSEST, deviation = ROUGH;
  for (uint32_t k = 0; k < OCTAVES && cell * rock->diameter_m >= FINEST_M; k++) {
    const double left = fade(footprint_m, cell * rock->diameter_m), size = deviation * left;
    out->variance += size * size;
    out->unseen += deviation * deviation - size * size;
    if (left > 0.0) {
      const pl_noise_value at = pl_noise_gradient(in_cells(rock, point, cell), seed + k);
      out->slope = pl_vec3_madd(out->slope, worn * size / sqrt(NOISE_SLOPES), gradient_of(at));
    }
    cell *= 0.5;
    deviation *= GROWTH;
  }
}

static void add_pits(const pl_rock *rock, pl_vec3 point, double footprint_m, uint32_t seed,
                     pl_rock_relief *out) {
  for (uint32_t k = 0; k < PIT_SIZES; k++) {
    const double left = fade(footprint_m, PIT_CELLS[k] * rock->diameter_m);
    out->variance += PIT_SLOPES * left * left;
    out->unseen += PIT_SLOPES * (1.0 - left * left);
    if (!(left > 0.0))
      continue;
    const pl_noise_value at =
        pl_noise_gradient(in_cells(rock, point, PIT_CELLS[k]), seed + OCTAVES + k);
    const double deep = (double)at.value - LEVEL;
    if (deep > 0.0)
      out->slope = pl_vec3_madd(out->slope, -2.0 * PIT_DEPTH * left * deep, gradient_of(at));
  }
}

/* Depth is exp(-(distance / width)^2), the distance from the zeros to first order. */
static void add_cracks(const pl_rock *rock, pl_vec3 point, double footprint_m, uint32_t seed,
                       double worn, pl_rock_relief *out) {
  const double width_m = CRACK_WIDTH * rock->diameter_m, cell_m = CRACK_CELL * rock->diameter_m;
  const double wide_m = hypot(width_m, footprint_m);
  const pl_vec3 at = in_cells(rock, point, CRACK_CELL);
  const pl_noise_value wall = pl_noise_gradient(at, seed + 32);
  const pl_vec3 across = gradient_of(wall);
  const double steep = pl_vec3_norm(across), away = (double)wall.value * cell_m / steep / wide_m;
  if (!(fabs(away) < 3.0))
    return;
  const double open = fmin(fmax(2.0 * worn - 1.4, 0.0), 1.0);
  const double slope =
      2.0 * CRACK_STEEP * open * (width_m / wide_m) * (width_m / wide_m) * away * exp(-away * away);
  out->slope = pl_vec3_madd(out->slope, slope / steep, across);
}

pl_rock_relief pl_rock_relief_at(const pl_rock *rock, pl_vec3 point, pl_vec3 normal,
                                 double footprint_m) {
  pl_rock_relief out = {.variance = 0.0};
  const uint32_t seed = seed_of(rock);
  const double place = (double)pl_noise(in_cells(rock, point, WORN_CELL), seed + 33);
  const double worn = fmin(fmax(1.0 + WORN * place, 0.3), 1.7);
  add_octaves(rock, point, footprint_m, seed, worn, &out);
  add_pits(rock, point, footprint_m, seed, &out);
  add_cracks(rock, point, footprint_m, seed, worn, &out);
  out.slope = pl_mat3_mul_vec(rock->rotation, out.slope);
  out.slope = pl_vec3_madd(out.slope, -pl_vec3_dot(out.slope, normal), normal);
  return out;
}

double pl_rock_relief_variance(double diameter_m) {
  double cell_m = COARSEST * diameter_m, deviation = ROUGH, sum = PIT_SIZES * PIT_SLOPES;
  for (int k = 0; k < OCTAVES && cell_m >= FINEST_M; k++) {
    sum += deviation * deviation;
    cell_m *= 0.5;
    deviation *= GROWTH;
  }
  return sum;
}

double pl_rock_tint(const pl_rock *rock, pl_vec3 point, double footprint_m) {
  const uint32_t seed = seed_of(rock);
  double sum = 1.0 + ROCK_TINT * (2.0 * (double)pl_lattice_uniform(seed, 0) - 1.0);
  double cell = GRAIN_CELL;
  for (uint32_t k = 0; k < GRAINS; k++) {
    const double left = fade(footprint_m, cell * rock->diameter_m);
    if (!(left > 0.0))
      break;
    sum += GRAIN_TINT * left * (double)pl_noise(in_cells(rock, point, cell), seed + 64 + k);
    cell *= 0.5;
  }
  return fmin(fmax(sum, 2.0 - PL_ROCK_TINT_MOST), PL_ROCK_TINT_MOST);
}
