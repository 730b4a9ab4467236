/* What the pixels' centre rays meet of the bodies. */
#ifndef PL_RENDER_BODY_POINTS_H
#define PL_RENDER_BODY_POINTS_H

#include "render/render.h"

/* Fills the points of a tile, with PL_TILE_SIDE pixels a row: what pl_vertex_meet_bodies and
 * pl_vertex_orient give for each pixel, to the last bit; PL_NOTHING where no ellipsoid is met. The
 * cone about `axis` holds the tile. `directions`: set to the rays', unit, root axes. */
void pl_body_points(const pl_snapshot *shot, pl_tile tile, pl_vec3 axis, double half_angle_rad,
                    double directions[3][PL_TILE_PIXELS], pl_vertex *points);

#endif
