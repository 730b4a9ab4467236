/* The world at instants while the shutter is open. */
#ifndef PL_SCENE_SHUTTER_H
#define PL_SCENE_SHUTTER_H

#include "scene/snapshot.h"

/* From the opening of the first row to the closing of the last, s; 0: an instant. */
double pl_shutter_window_s(const pl_placement *placement);

/* The placement at a part u of that time, 0..1: nothing moves in it any more. In `arena`; what does
 * not change stays borrowed. With shutter.held u counts as that of the nearest key. */
pl_status pl_placement_at(const pl_scene *scene, const pl_placement *placement, double u,
                          pl_arena *arena, pl_placement *out);

/* Sets the view's blur_px and skew_px: what moves, and how far at most. `shot`: of the middle.
 * `sky`: whether stars or a map of the sky are seen, too, which move as the camera turns. */
void pl_shutter_measure(const pl_placement *placement, const pl_snapshot *shot, bool sky,
                        pl_view *view);

#endif
