/* Tabulated cumulative size-frequency law: counts between two sizes, and sizes drawn from it. */
#ifndef PL_TERRAIN_SIZE_TABLE_H
#define PL_TERRAIN_SIZE_TABLE_H

#include "base/status.h"

/* Number of items of diameter_m or more, per square metre; finite, not negative, and not growing
 * with the diameter. */
typedef double (*pl_size_density_fn)(const void *law, double diameter_m);

typedef struct pl_size_table pl_size_table;

/* Tabulates a law between two diameters, at 32 knots an octave with power laws between: relative
 * errors are below 1e-4 where the exponent changes by less than 1.5 per e-fold. A jump of the law
 * is spread over the interval that it lies in. PL_E_RANGE if the law rises or is not finite, with
 * the diameter. */
pl_status pl_size_table_create(pl_size_density_fn density, const void *law, double min_m,
                               double max_m, pl_size_table **out);
void pl_size_table_destroy(pl_size_table *table);

/* Density of items of diameter_m or more (per m^2); beyond the ends, the value there. */
double pl_size_table_density(const pl_size_table *table, double diameter_m);

/* Diameter between two (m) at which the fraction `u`, in [0, 1), of the items between them is
 * smaller: the law's quantile. */
double pl_size_table_draw(const pl_size_table *table, double low_m, double high_m, double u);

#endif
