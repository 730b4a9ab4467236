/* Regular patterns with box filters in closed form, from integrals of pulse trains: white noise of
 * cells, checker, waves, bricks, solar panels. Unless stated otherwise, a filtered value is the
 * exact mean over the box of `width` (per axis, in the pattern's coordinates) about the point.
 * Infinite widths give the mean of the pattern; negative widths and NaN are treated as 0. Boxes
 * below 1e-6 are treated as points, above PL_PATTERN_WIDEST periods as infinite: the deviation from
 * the mean is then below 1e-3. */
#ifndef PL_MATH_PATTERN_H
#define PL_MATH_PATTERN_H

#include <stdint.h>

#include "math/vec.h"

#define PL_PATTERN_WIDEST 1024.0f

/* One number per unit cell, uniform in [0, 1): mean 1/2, variance 1/12. The mean over the box as
 * long as it touches at most two cells per axis (width <= 1); for wider boxes the value fades to
 * 1/2, which it is from 3 cells on. */
float pl_white_noise(pl_vec3 point, float width, uint32_t seed);

/* 1 in the unit cells whose indices have an even sum, else 0; exact over the box. Mean 1/2. */
float pl_checker(pl_vec3 point, float width);

/* A wave of period 1 in `phase`, 0..1, mean 1/2; exact over the box. */
typedef enum pl_wave_shape {
  PL_WAVE_SINE,
  PL_WAVE_SAW,
  PL_WAVE_TRIANGLE,
  PL_WAVE_SHAPES
} pl_wave_shape;
float pl_wave(pl_wave_shape shape, double phase, float width);

/* Bricks of size 1 x 1 (u along the rows, in bricks; v in rows), each with half of the mortar joint
 * around it; odd rows are shifted by `shift` bricks. */
typedef struct pl_bricks {
  float mortar_u, mortar_v; /* widths of the joints, in bricks and rows; clamped to [0, 1] */
  float shift;
} pl_bricks;
/* Part of the box that is brick, exact; mean (1 - mortar_u)(1 - mortar_v). */
float pl_brick_cover(const pl_bricks *bricks, double u, double v, float width_u, float width_v);
/* Hash of the brick at a point, mortar included. */
uint32_t pl_brick_id(const pl_bricks *bricks, double u, double v, uint32_t seed);

/* Solar cells of size 1 x 1 including gaps: busbars run along v, fingers along u. Widths are
 * relative to the pitch of the cells; lines are evenly spaced over the cell inside the gaps. */
typedef struct pl_panel {
  float gap_u, gap_v;               /* between cells; clamped to [0, 1] */
  float busbars, fingers;           /* number per cell; rounded down, negative values become 0 */
  float busbar_width, finger_width; /* clamped to the spacing of the lines */
} pl_panel;
/* Parts of the box that are bare cell, metal (busbars and fingers) and gap; exact, with sum 1. */
typedef struct pl_panel_cover {
  float cell, metal, gap;
} pl_panel_cover;
pl_panel_cover pl_panel_covers(const pl_panel *panel, double u, double v, float width_u,
                               float width_v);
uint32_t pl_panel_id(double u, double v, uint32_t seed);

#endif
