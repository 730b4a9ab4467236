/* Column density between the points of a volume and the sun, where its density varies: a table for
 * the direction of the sun in the frame. */
#ifndef PL_RENDER_VOLUME_COLUMNS_H
#define PL_RENDER_VOLUME_COLUMNS_H

#include "base/memory.h"
#include "scene/snapshot.h"

typedef struct pl_volume_columns pl_volume_columns;

/* Builds a table with `side` cells across and along, in `arena`; `toward`: direction to the sun,
 * unit, axes of the bound. The density is filtered over cells. */
pl_status pl_volume_columns_build(const pl_shot_volume *shot, pl_vec3 toward, int side,
                                  pl_arena *arena, const pl_volume_columns **out);

/* Density times length from a point (axes of the bound) to the sun, m; interpolated linearly in the
 * table. */
float pl_volume_column(const pl_volume_columns *columns, pl_vec3 point);

/* The graph's input at a point in the axes of the bound, with the footprint's radius; `view`: unit,
 * towards the viewer, root axes. */
pl_graph_point pl_volume_point(const pl_shot_volume *shot, pl_vec3 place, pl_vec3f view,
                               float radius_m);

#endif
