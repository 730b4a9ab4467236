/* Fillets: soil that is heaped at the feet of rocks, as a part of the ground's height.
 *
 * At a rock's outline in the ground they have a height of their own share of the rock's, more on
 * one side than on the other, and fall as a parabola from the slope of repose to nothing. Where
 * several meet the highest counts, so that no bit depends on their order. Rocks are set on the
 * ground without them. */
#ifndef PL_TERRAIN_ROCK_FILLETS_H
#define PL_TERRAIN_ROCK_FILLETS_H

#include "terrain/rock_field.h"

/* Adds to heights (m; without fillets) in unit directions what cells of a width (m) show of
 * fillets: they fade where they are less than 2 cells wide. */
pl_status pl_rock_fillets_add(const pl_rock_field *field, const pl_terrain *terrain,
                              const pl_vec3 *directions, size_t count, double cell_m,
                              double *heights_m);
/* Returns a bound of their height. */
double pl_rock_fillets_bound_m(const pl_rock_field *field);

#endif
