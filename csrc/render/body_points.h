/* Hits of the pixels' centre rays on bodies. */
#ifndef PL_RENDER_BODY_POINTS_H
#define PL_RENDER_BODY_POINTS_H

#include "render/render.h"

/* Fills the points of a tile, with PL_TILE_SIDE pixels per row. The result equals that of
 * pl_vertex_meet_bodies and pl_vertex_orient for each pixel, bit for bit; PL_NO_SURFACE where no
 * ellipsoid is hit. The cone about `axis` encloses the tile. `directions`: set to the ray
 * directions, unit, root axes. */
void pl_body_points(const pl_snapshot *shot, pl_tile tile, pl_vec3 axis, double half_angle_rad,
                    double directions[3][PL_TILE_PIXELS], pl_point *points);

#endif
