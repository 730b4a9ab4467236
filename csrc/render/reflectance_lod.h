/* Cheaper photometric laws in the place of Hapke's, where a body is seen from the camera. */
#ifndef PL_RENDER_REFLECTANCE_LOD_H
#define PL_RENDER_REFLECTANCE_LOD_H

#include "render/render.h"

/* Measures, for every body in the frame that follows Hapke's law, what the cheaper ones do to
 * points that are seen, over the angles that they are seen at, and gives the view the results; its
 * things are then others, in `arena`. */
pl_status pl_reflectance_lod_fit(const pl_snapshot *shot, pl_arena *arena, pl_view *view);

/* Changes the law of a shaded vertex that the camera sees to the settings' one. Not of bodies that
 * others light: what they send on comes at other angles than those that were measured. */
void pl_reflectance_lod_apply(const pl_snapshot *shot, const pl_render_settings *settings,
                              pl_vertex *vertex);

#endif
