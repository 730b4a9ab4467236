/* Parameters of the photometric laws at a point of a body. */
#ifndef PL_RENDER_REGOLITH_H
#define PL_RENDER_REGOLITH_H

#include "render/vertex.h"

/* Fills surface->regolith from the body's map, from the frame's values, which take precedence, and
 * from rasters of roughness on the terrain. Without a colour map, the regolith map's albedo also
 * sets `color`. Without `maps` maps are replaced by their means. Only for photometric reflectances.
 */
void pl_regolith_shade(const pl_shot_body *body, const pl_beam *beam, bool maps, pl_vertex *vertex,
                       float color[3]);

#endif
