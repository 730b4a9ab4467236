/* The mask of shadows: which points of the geometry buffer do not see the centre of the sun. */
#ifndef PL_RENDER_SHADOW_MASK_H
#define PL_RENDER_SHADOW_MASK_H

#include "render/path.h"

/* Why a point is in shadow: by the first entity that the sun's light meets on its way to it. */
typedef enum pl_shadow_cause {
  PL_SHADOW_NONE,
  PL_SHADOW_SELF,   /* the surface faces away, or is hidden by another part of itself */
  PL_SHADOW_OBJECT, /* another object */
  PL_SHADOW_BODY,   /* a body without terrain: an eclipse */
  PL_SHADOW_GROUND  /* terrain or its rocks */
} pl_shadow_cause;

/* Sets in_shadow of all points of the tile. It is geometry: no effect of the plan switches it, and
 * it does not depend on samples. Sets shadow_cause if settings ask for it. Uses the buffers of
 * shadow rays. */
void pl_shadow_mask(const pl_path_context *context, pl_tile_buffers *buffers);

#endif
