/* Parameters of the photometric laws at a point of a body. */
#ifndef PL_RENDER_REGOLITH_H
#define PL_RENDER_REGOLITH_H

#include "render/vertex.h"

/* Fills surface->regolith from the body's map and from the frame's values, which take precedence.
 * Without a colour map, the regolith map's albedo also sets surface->color. Without `maps` the map
 * is replaced by its mean. Only for photometric reflectances. */
void pl_regolith_shade(const pl_shot_body *body, const pl_beam *beam, bool maps, pl_vertex *vertex);

#endif
