/* Reflectance levels of detail: cheaper photometric laws that replace Hapke's in camera rays. */
#ifndef PL_RENDER_REFLECTANCE_LOD_H
#define PL_RENDER_REFLECTANCE_LOD_H

#include "render/render.h"

/* For every body in the frame with Hapke's law: measures the errors of the cheaper laws at visible
 * points, and so for the angles in view, shaded with `detail`, and stores them in the view, whose
 * entities are copied to `arena` for that. */
pl_status pl_reflectance_lod_fit(const pl_snapshot *shot, pl_detail detail, pl_arena *arena,
                                 pl_view *view);

/* Replaces the reflectance law of a shaded vertex in view by the law of the settings. Leaves out
 * bodies that others light, because that light arrives at other angles than those measured. */
void pl_reflectance_lod_apply(const pl_snapshot *shot, const pl_render_settings *settings,
                              pl_vertex *vertex);

#endif
