/* Lattice of unit cells: position of a point within its cell, and hashes keyed by the cell.
 *
 * Coordinates are double and split into an integer cell and a float fraction, so that the position
 * in the cell has float precision for any cell: at 1e7 a double still resolves 2e-9 of a cell. All
 * further computation uses fractions and integers: results are bitwise equal on all machines. */
#ifndef PL_MATH_LATTICE_H
#define PL_MATH_LATTICE_H

#include <stdint.h>

#include "math/sampler.h"
#include "math/vec.h"

/* Doubles beyond this have no fractional part. */
#define PL_LATTICE_LIMIT 0x1p52

typedef struct pl_lattice {
  uint32_t cell[3];  /* floor of the coordinates modulo 2^32: patterns repeat after 4e9 cells */
  float fraction[3]; /* [0, 1]; 1 if the fraction rounds to 1 in float */
} pl_lattice;

/* Floor of `x`, and the remainder in [0, 1) in `rest`. NaN and values beyond PL_LATTICE_LIMIT are
 * replaced by 0. */
static inline int64_t pl_lattice_floor(double x, double *rest) {
  if (!(fabs(x) < PL_LATTICE_LIMIT))
    x = 0.0;
  int64_t cell = (int64_t)x;
  cell -= (double)cell > x;
  *rest = x - (double)cell;
  return cell;
}

static inline pl_lattice pl_lattice_split(pl_vec3 point) {
  const double x[3] = {point.x, point.y, point.z};
  pl_lattice lattice;
  for (int i = 0; i < 3; i++) {
    double rest;
    lattice.cell[i] = (uint32_t)pl_lattice_floor(x[i], &rest);
    lattice.fraction[i] = (float)rest;
  }
  return lattice;
}

/* Adds one coordinate to a hash; the first call takes the seed of the pattern. */
static inline uint32_t pl_lattice_hash(uint32_t hash, uint32_t coordinate) {
  return pl_sampler_mix(hash + coordinate * 0x9e3779b1u); /* the odd number nearest 2^32/phi */
}
static inline uint32_t pl_lattice_hash3(uint32_t seed, uint32_t x, uint32_t y, uint32_t z) {
  return pl_lattice_hash(pl_lattice_hash(pl_lattice_hash(pl_sampler_mix(seed), z), y), x);
}

/* The i-th number of a hash: uniform in [0, 1), 24 bits. */
static inline float pl_lattice_uniform(uint32_t hash, uint32_t i) {
  return (float)(pl_lattice_hash(hash, i) >> 8) * 0x1p-24f;
}

#endif
