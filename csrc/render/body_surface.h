/* The surface of a body: its maps, photometry, ground and graph. */
#ifndef PL_RENDER_BODY_SURFACE_H
#define PL_RENDER_BODY_SURFACE_H

#include "render/vertex.h"

/* Fills the surface of a located vertex of `body`, including its frame, before it is flipped to the
 * viewer's side. */
void pl_body_surface_shade(const pl_snapshot *shot, const pl_shot_body *body, const pl_beam *beam,
                           pl_detail detail, pl_vertex *vertex);
/* See pl_geometry_kind.classify. */
void pl_body_surface_classify(const pl_snapshot *shot, const pl_shot_body *body,
                              const pl_beam *beam, pl_vertex *vertex, uint16_t *ids);

#endif
