/* State of the world at instants while the shutter is open. */
#ifndef PL_SCENE_SHUTTER_H
#define PL_SCENE_SHUTTER_H

#include "scene/snapshot.h"

/* Returns the time from the opening of the first row to the closing of the last, s; 0 for a single
 * instant. */
double pl_shutter_window_s(const pl_placement *placement);

/* Returns the fraction (0..1) of that time at the middle of a row's exposure; with shutter.held
 * that of the nearest key. */
double pl_shutter_row_share(const pl_placement *placement, double row);

/* Makes the static placement at the fraction u (0..1) of that time. Allocated in `arena`; constant
 * parts stay borrowed. With shutter.held, u is rounded to the nearest key. */
pl_status pl_placement_at(const pl_scene *scene, const pl_placement *placement, double u,
                          pl_arena *arena, pl_placement *out);

/* Sets the view's blur_px and skew_px, upper bounds of image motion. `shot` is in the middle of the
 * exposure. `sky`: stars or a sky map are visible; they move when the camera rotates. */
void pl_shutter_measure(const pl_placement *placement, const pl_snapshot *shot, bool sky,
                        pl_view *view);

#endif
