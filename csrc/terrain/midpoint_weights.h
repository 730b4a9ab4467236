/* Midpoint displacement of a fractal on a square lattice: how the height of a new node depends on
 * those of the 16 nearest that are there.
 *
 * The field has the structure function S(d) = d^(2H), in widths of a cell. A new node is the
 * best linear unbiased estimate from its neighbours (ordinary kriging), and a random number with
 * the variance of what they leave open: both are exact for the field. The mean of four neighbours,
 * which diamond-square takes by tradition, leaves creases along the lattice, and with its exact
 * variance is up to a fifth too smooth at middle baselines. */
#ifndef PL_TERRAIN_MIDPOINT_WEIGHTS_H
#define PL_TERRAIN_MIDPOINT_WEIGHTS_H

/* The node at the middle of a cell, then those at the middles of its sides. */
typedef enum pl_midpoint_step { PL_MIDPOINT_DIAMOND, PL_MIDPOINT_SQUARE } pl_midpoint_step;

enum { PL_MIDPOINT_AROUND = 16 };

typedef struct pl_midpoint {
  double weights[PL_MIDPOINT_AROUND]; /* sum to 1 */
  double variance;                    /* over that of a difference across one cell along y */
} pl_midpoint;

/* Offset of neighbour `k` from the node, in halves of a cell of the coarse lattice. */
void pl_midpoint_offset(pl_midpoint_step step, int k, int *x, int *y);

/* `hurst` in [0, 1]; `ratio` is the width of cells along x over that along y. */
pl_midpoint pl_midpoint_make(double hurst, double ratio, pl_midpoint_step step);

#endif
