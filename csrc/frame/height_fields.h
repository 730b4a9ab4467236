/* Makes the height fields of bodies with terrain for one instant. */
#ifndef PL_FRAME_HEIGHT_FIELDS_H
#define PL_FRAME_HEIGHT_FIELDS_H

#include "frame/instant.h"

/* Replaces the bodies of a culled snapshot by copies which have a height field each, where they
 * have terrain, or are smooth, if the choice leaves terrain out (PL_E_RANGE if the camera is then
 * inside one). Does nothing if none has terrain. Allocated in `arena`; borrows tiles that `kept`
 * caches. */
pl_status pl_height_fields_place(pl_accelerators *kept, const pl_choice *choice, pl_arena *arena,
                                 pl_snapshot *shot);

/* Writes what the meshes of terrain of an instant are, see pl_frame_result. */
void pl_height_fields_report(const pl_accelerators *kept, const pl_snapshot *shot,
                             pl_frame_result *result);

#endif
