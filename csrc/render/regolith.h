/* Parameters of the photometric laws at a point of a body. */
#ifndef PL_RENDER_REGOLITH_H
#define PL_RENDER_REGOLITH_H

#include "render/vertex.h"

/* Fills surface->regolith from the body's map and what the frame gives instead; where no colour map
 * says the albedo, the map's colours surface->color. Without `maps` the map counts as its mean.
 * Only for rows that are photometric. */
void pl_regolith_shade(const pl_shot_body *body, const pl_beam *beam, bool maps, pl_vertex *vertex);

#endif
