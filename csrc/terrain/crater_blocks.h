/* Where fresh craters leave blocks: how many more rocks lie about them.
 *
 * At x radii from the centre of a crater the density is exp(-(x - 1) / 0.7) of that at the rim, and
 * 1/20 of it within; it ends at 5 radii. With age it falls as (1 - age/life)^3, or as
 * (1 - tau/0.02)^3 of small craters, which are worn down sooner. Blocks are of at
 * most 0.25 D^0.7 (m; Lee et al. 1986); small craters lie in the soil, and have none. */
#ifndef PL_TERRAIN_CRATER_BLOCKS_H
#define PL_TERRAIN_CRATER_BLOCKS_H

#include "terrain/crater_field.h"

typedef struct pl_crater_blocks {
  double life_ga; /* above 0 */
  double least_m; /* diameter of the smallest craters with blocks */
} pl_crater_blocks;

/* A crater with blocks. */
typedef struct pl_crater_source {
  pl_vec3 direction;
  double radius;   /* over that of the body */
  double fraction; /* of the blocks of a new crater */
  double most_m;   /* diameter of its largest blocks */
} pl_crater_source;

/* Lists those that have blocks within an angle of an axis; *out is freed with pl_free. `field` and
 * `model` may be NULL. */
pl_status pl_crater_sources(const pl_crater_field *field, const pl_crater_model *model,
                            const pl_crater_blocks *blocks, pl_vec3 axis, double angle_rad,
                            pl_crater_source **out, size_t *count);

/* Density of blocks of a diameter in a direction, over that at the rim of a new crater; at most 1.
 * The same bits for any list that has all sources about the direction. */
double pl_crater_blocks_at(const pl_crater_source *sources, size_t count, pl_vec3 direction,
                           double diameter_m);

#endif
