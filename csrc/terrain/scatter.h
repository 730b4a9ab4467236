/* Things scattered over a whole body by a size-frequency law, as a function of place: nothing is
 * stored.
 *
 * Sizes are cut into octaves, each with a lattice of the cube (terrain/cube.h) whose cells are 8 to
 * 16 diameters wide. What is in a cell is drawn from random numbers keyed by (seed, cell): the
 * number is Poisson, the centres are uniform on the sphere. */
#ifndef PL_TERRAIN_SCATTER_H
#define PL_TERRAIN_SCATTER_H

#include <stdbool.h>
#include <stdint.h>

#include "terrain/cube.h"
#include "terrain/size_table.h"

enum { PL_SCATTER_LEVELS = 26, PL_SCATTER_CELL_MOST = 1023 };
/* Cells are this many times as wide as the least diameter of their octave. */
#define PL_SCATTER_CELLS_OVER_LEAST 16.0
/* Least and greatest diameter over the body's radius: 5 mm on the Moon, and an eighth of a face. */
#define PL_SCATTER_MIN_OF_RADIUS 3e-9
#define PL_SCATTER_MAX_OF_RADIUS 0.196

/* One octave of sizes; empty if low_m >= high_m. */
typedef struct pl_scatter_octave {
  double low_m, high_m;
  double width;             /* of a cell in s and t */
  const double *cumulative; /* cumulative[k]: probability of k items or fewer in a cell */
  size_t count;             /* of `cumulative` */
} pl_scatter_octave;

typedef struct pl_scatter {
  double radius_m;
  uint64_t key[2];
  pl_size_table *sizes; /* owned */
  double *cumulative;   /* of all octaves; owned */
  int first, last;      /* levels in use; last < first if there are none */
  pl_scatter_octave octaves[PL_SCATTER_LEVELS];
} pl_scatter;

/* PL_E_RANGE unless the diameters are within the bounds above, on a body of a valid radius.
 * `noun` names them in the error. */
pl_status pl_scatter_check(const char *noun, double radius_m, double min_m, double max_m);
/* Diameters of an octave of a range of diameters; false if it has none. */
bool pl_scatter_sizes(int level, double radius_m, double min_m, double max_m, double *low_m,
                      double *high_m);

/* `purpose` makes numbers independent of those of other scatters of the same seed. Diameters must
 * have been checked. PL_E_RANGE if the law rises or a cell would hold too many. */
pl_status pl_scatter_init(double radius_m, uint64_t seed, uint64_t purpose,
                          pl_size_density_fn density, const void *law, double min_m, double max_m,
                          pl_scatter *out);
void pl_scatter_clear(pl_scatter *scatter);

/* A cell of the lattice of an octave. */
typedef struct pl_scatter_cell {
  int level, face;
  uint64_t i, j;
} pl_scatter_cell;

typedef struct pl_scatter_site {
  uint64_t id; /* below 2^63, not 0 */
  pl_scatter_cell cell;
  uint64_t place[2]; /* in the cell, along s and t, in 2^-53 of it */
  pl_vec3 direction;
  double diameter_m;
} pl_scatter_site;

/* Number of candidates in a cell. */
uint64_t pl_scatter_count(const pl_scatter *scatter, const pl_scatter_cell *cell);
/* Part of a face: a range of each coordinate of the lattice, and a cap of the sphere. */
typedef struct pl_scatter_window {
  double from[2], to[2];
  pl_vec3 axis;
  double chord2; /* from the axis, squared */
} pl_scatter_window;
/* Draws candidate `n` of a cell. Returns false if there is nothing: candidates are thinned where
 * cells are smaller, so that items are uniform on the sphere. Also false for what is outside of a
 * window, which may be NULL. */
bool pl_scatter_draw(const pl_scatter *scatter, const pl_scatter_cell *cell, uint64_t n,
                     const pl_scatter_window *window, pl_scatter_site *out);
/* Finds the item of an id; false if there is none. */
bool pl_scatter_find(const pl_scatter *scatter, uint64_t id, pl_scatter_site *out);

/* Random words of an item for one of its purposes, from 2 on. */
void pl_scatter_words(const pl_scatter *scatter, uint64_t id, uint64_t purpose, uint64_t words[4]);

#endif
