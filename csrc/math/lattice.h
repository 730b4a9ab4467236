/* Lattice of unit cells: position of a point within its cell, and hashes keyed by the cell.
 *
 * Coordinates are double and split into an integer cell and a float fraction, so that the position
 * in the cell has float precision for any cell: at 1e7 a double still resolves 2e-9 of a cell. All
 * further computation uses fractions and integers: results are bitwise equal on all machines. */
#ifndef PL_MATH_LATTICE_H
#define PL_MATH_LATTICE_H

#include <stddef.h>
#include <stdint.h>

#include "base/wide.h"
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

/* Points of all lanes, in cells. */
typedef struct pl_point_lanes {
  double at[3][PL_LANES];
} pl_point_lanes;

typedef struct pl_lattice_lanes {
  uint32_t cell[3][PL_LANES];
  float fraction[3][PL_LANES];
} pl_lattice_lanes;

/* One coordinate of all lanes, as pl_lattice_floor. Cells that fit 32 bits, as nearly all do, are
 * found in vectors: before AVX-512 there is no conversion of doubles to 64 bits. */
PL_WIDE_PART void pl_lattice_split_axis(const double *restrict x, uint32_t *restrict cell,
                                        float *restrict fraction) {
  int64_t far = 0; /* as wide as the numbers that are compared */
  PL_EACH_LANE(i) far |= fabs(x[i]) < 0x1p31 ? 0 : 1;
  if (far != 0) {
    for (size_t i = 0; i < PL_LANES; i++) {
      double rest;
      cell[i] = (uint32_t)pl_lattice_floor(x[i], &rest);
      fraction[i] = (float)rest;
    }
    return;
  }
  PL_EACH_LANE(i) {
    const int32_t toward_zero = (int32_t)x[i];
    const double whole = (double)toward_zero, below = whole > x[i] ? 1.0 : 0.0;
    cell[i] = (uint32_t)(toward_zero - (int32_t)below);
    fraction[i] = (float)(x[i] - (whole - below));
  }
}

PL_WIDE_PART void pl_lattice_split_lanes(const pl_point_lanes *points, pl_lattice_lanes *out) {
  for (size_t axis = 0; axis < 3; axis++)
    pl_lattice_split_axis(points->at[axis], out->cell[axis], out->fraction[axis]);
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
  return (float)(int32_t)(pl_lattice_hash(hash, i) >> 8) * 0x1p-24f; /* signed: one instruction */
}

#endif
